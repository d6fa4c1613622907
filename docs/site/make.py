"""Builds the documentation site into build/site: ``python docs/site/make.py`` (``make docs``). Needs no network.

Sphinx reads build/pages: the pages of the repository at their own places, so that their links stay as they are, and
those that are generated. It runs the notebooks. Warnings are errors, and so is a link within the site to nothing.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import reference_pages
from sphinx.cmd.build import main as sphinx

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
BUILD = ROOT / "build"

FOLDERS = ("docs", "components", "clients", "examples", "benchmarks", "changes", "dse")
"""What pages are in, or link to."""

SECTIONS = {
    "Tutorials": ["docs/tour", "docs/tutorial", "docs/notebooks/*", "gallery"],
    "How-to guides": [
        *(
            "docs/bring-your-fmu",
            "docs/ssp",
            "docs/modelica",
            "docs/powertrains",
            "docs/simulink",
            "docs/python",
            "docs/traces",
            "docs/questions",
        ),
        *(
            "docs/boundary",
            "docs/world",
            "docs/opendrive",
            "docs/scenarios",
            "docs/drive",
            "docs/rating",
            "docs/serve",
            "docs/live_page",
        ),
        *("docs/clusters", "docs/udp", "docs/udp_clients", "docs/two_machines", "docs/ci", "docs/assistants"),
    ],
    "Explanations": [
        *("docs/simulation", "docs/findings", "docs/trust", "docs/aeb", "docs/highway", "docs/decisions/README"),
    ],
    "Reference": [
        *("docs/formats", "reference/files/index", "reference/commands", "reference/functions", "reference/python"),
        *("reference/components/index", "docs/rating_cases", "docs/glossary", "docs/licences", "docs/releases"),
    ],
    "Project": ["CHANGELOG", "CONTRIBUTING", "SECURITY", "**/README"],
}
"""The pages by caption. A page that is missing here is an error."""

GALLERY = {
    "cruise/report.html": ("Report: gains of the cruise control", "cruise_control"),
    "cruise/replay.html": ("Replay: a run in three dimensions", "cruise_control"),
    "trucks/report.html": ("Report: two controllers as FMUs, from empty to loaded", "your_fmus"),
    "electric/report.html": ("Report: architectures of an electric car", "electric_car"),
}
"""The pages that notebooks make, with the notebook."""


def main() -> int:
    """Lay out the pages and have Sphinx build them; its exit code."""
    pages, site = BUILD / "pages", BUILD / "site"
    for folder in (pages, site):
        shutil.rmtree(folder, ignore_errors=True)
    for name in FOLDERS:
        shutil.copytree(ROOT / name, pages / name, ignore=shutil.ignore_patterns("__pycache__", "web", "*.so"))
    for page in ROOT.glob("*.md"):
        shutil.copyfile(page, pages / page.name)
    (pages / "README.md").rename(pages / "index.md")
    _add_contents(pages / "index.md", SECTIONS)
    _add_contents(pages / "docs/decisions/README.md", {"": ["*"]})
    reference_pages.write(pages)
    (pages / "gallery.md").write_text(_gallery(), encoding="utf-8")
    # Notebooks call dse; what they build is kept beside the site.
    os.environ["PATH"] = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
    os.environ.setdefault("DSE_CACHE", str(BUILD / "cache"))
    options = ["-W", "-n", "-E", "--keep-going", "-q", "-j", "auto", "-d", str(BUILD / "doctrees"), "-c", str(HERE)]
    code = sphinx([*options, str(pages), str(site)])
    if not code:
        print(f"{site / 'index.html'}: {sum(1 for _ in site.rglob('*.html'))} pages")
    return code


def _add_contents(page: Path, sections: dict[str, list[str]]) -> None:
    """Append hidden tables of contents, by caption, to *page*."""
    with page.open("a", encoding="utf-8") as file:
        for caption, names in sections.items():
            options = [":hidden:", ":glob:", *([f":caption: {caption}"] if caption else []), ""]
            file.write("\n```{toctree}\n" + "\n".join([*options, *names]) + "\n```\n")


def _gallery() -> str:
    text = "# Gallery: reports and a replay\n\nNotebooks made these pages. Each is one file that works offline.\n"
    for path, (title, notebook) in GALLERY.items():
        link = f"docs/notebooks/{path}"
        text += f"\n## {title}\n\n<a href='{link}'>Open the page</a>. "
        text += f"It was made by [this notebook](docs/notebooks/{notebook}.ipynb).\n\n"
        text += f"<iframe src='{link}' title='{title}' width='100%' height='520' loading='lazy'></iframe>\n"
    return text


if __name__ == "__main__":
    sys.exit(main())
