"""``dse docs``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.completion import pages as known_pages
from dse.cli.terminal import console, plain_table, print_table
from dse.errors import closest, fail
from dse.shipped import content


@app.command()
def docs(
    page: Annotated[
        str | None,
        typer.Argument(
            metavar="[PAGE]", autocompletion=known_pages, help="A page's name; without one, all are listed."
        ),
    ] = None,
    path: Annotated[bool, typer.Option("--path", help="Print the folder of the pages, or the file of PAGE.")] = False,
) -> None:
    """Read the pages about files, commands and methods.

    A page is formatted in a terminal, and plain Markdown in a pipe or file.
    """
    folder = content("docs") / "docs"
    pages = {file.relative_to(folder).with_suffix("").as_posix(): file for file in sorted(folder.rglob("*.md"))}
    if page is not None and page.removesuffix(".md") not in pages:
        raise fail(f"there is no page '{page}'", hint=closest(page, pages) or "'dse docs' lists all")
    if path:
        print(folder if page is None else pages[page.removesuffix(".md")])
    elif page is None:
        _list(pages)
    else:
        _show(pages[page.removesuffix(".md")].read_text(encoding="utf-8"))


def _list(pages: dict[str, Path]) -> None:
    table = plain_table("page", "title")
    for name in sorted(pages, key=lambda name: (name.count("/"), name)):
        with pages[name].open(encoding="utf-8") as file:
            table.add_row(name, file.readline().lstrip("# ").rstrip())
    print_table(table)


def _show(text: str) -> None:
    if not sys.stdout.isatty():
        sys.stdout.write(text)
        return
    from rich.markdown import Markdown

    console().print(Markdown(text))
