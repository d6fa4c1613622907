"""The check of the site's links finds links to nothing. ``make docs`` applies it to all pages."""

from __future__ import annotations

from pathlib import Path

from finish import dead_links
from make import SECTIONS

ROOT = Path(__file__).parents[2]


def test_links_to_files_and_anchors_that_are_missing_are_found(tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    (tmp_path / "index.html").write_text(
        "<h1 id='top'>A</h1><a href='#top'></a><a href='below/b.html?x=1#there'></a><a href='https://example.org/'></a>"
        "<a href='#gone'></a><a href='below/b.html#gone'></a><img src='gone.png'>",
        encoding="utf-8",
    )
    (tmp_path / "below" / "b.html").write_text("<p id='there'><a href='../index.html'></a></p>", encoding="utf-8")
    assert {each.split(" leads")[0] for each in dead_links(tmp_path)} == {
        "index.html: the link #gone",
        "index.html: the link below/b.html#gone",
        "index.html: the link gone.png",
    }


def test_every_page_has_a_section() -> None:
    listed = {page for pages in SECTIONS.values() for page in pages}
    assert {f"docs/{page.stem}" for page in (ROOT / "docs").glob("*.md")} <= listed
