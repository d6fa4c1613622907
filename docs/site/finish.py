"""What is made when all pages are: the notebooks' reports in the site, llms.txt, and a check of all links."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util.logging import getLogger
from sphinx.util.nodes import clean_astext

NOTEBOOKS = "docs/notebooks"


def finish(app: Sphinx, exception: Exception | None) -> None:
    """Add the files to the site that *app* built. Warns of all dead links."""
    if exception is not None:
        return
    made = Path(app.srcdir, NOTEBOOKS)
    for page in made.rglob("*.html"):
        target = Path(app.outdir, NOTEBOOKS, page.relative_to(made))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(page, target)
    Path(app.outdir, "llms.txt").write_text(list_of_pages(app), encoding="utf-8")
    for dead in sorted(dead_links(Path(app.outdir))):
        getLogger(__name__).warning(dead)


def list_of_pages(app: Sphinx) -> str:
    """All pages by section, each with its title and first sentence, in the form of llmstxt.org."""
    text = f"# {app.config.project}\n\n> {_sentence(app, app.config.root_doc)}\n"
    for contents in app.env.get_doctree(app.config.root_doc).findall(_is_contents):
        text += f"\n## {contents['caption']}\n\n"
        for _, page in contents["entries"]:
            below = [each for each in app.env.toctree_includes.get(page, []) if each != page]
            for name in (page, *below):
                title = clean_astext(app.env.titles[name])
                text += f"- [{title}]({app.builder.get_target_uri(name)}): {_sentence(app, name)}\n"
    return text


def _is_contents(node: nodes.Node) -> bool:
    return isinstance(node, addnodes.toctree)


def _sentence(app: Sphinx, page: str) -> str:
    """The first sentence of *page*: of its first paragraph, or item of a list, that is not its date."""
    for paragraph in app.env.get_doctree(page).findall(nodes.paragraph):
        words = " ".join(paragraph.astext().split())
        if not isinstance(paragraph.parent, nodes.entry) and not re.match(r"\d{4}-\d\d-\d\d", words):
            return words.partition(". ")[0].rstrip(".") + "."
    return ""


class Links(HTMLParser):
    """What the *text* of a page links to, and the anchors that it has."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.targets: set[str] = set()
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note the links and the anchor of an element."""
        for name, value in attrs:
            if name == "id" and value:
                self.anchors.add(value)
            elif name in ("href", "src") and value and tag != "base":
                self.targets.add(value)


def dead_links(site: Path) -> Iterator[str]:
    """The links within *site* to files or anchors that it does not have, each with its page."""
    pages = {path: Links(path.read_text(encoding="utf-8")) for path in site.resolve().rglob("*.html")}
    for path, page in pages.items():
        for target in page.targets:
            if "://" in target or target.startswith(("data:", "mailto:", "javascript:")):
                continue
            name, anchor = (unquote(part) for part in urldefrag(target))
            there = (path.parent / name.partition("?")[0]).resolve() if name else path
            if not there.is_file() or (anchor and there in pages and anchor not in pages[there].anchors):
                yield f"{path.relative_to(site.resolve())}: the link {target} leads nowhere"
