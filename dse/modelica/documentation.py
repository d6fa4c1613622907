"""The page inside an FMU that tells what it was made from, and what was assumed in making it."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape


def documentation(title: str, model: str, files: Iterable[str], settings: str, notes: Iterable[str]) -> bytes:
    """``documentation/index.html``, which FMI has a place for; no clock, no path of this machine."""
    noted = list(notes)
    lines = [
        "<!DOCTYPE html>",
        '<html lang="en">',
        f'<head><meta charset="utf-8"><title>{escape(title)}</title></head>',
        "<body>",
        f"<h1>{escape(title)}</h1>",
        f"<p>Made by dse from the Modelica model <code>{escape(model)}</code>; {escape(settings)}.</p>",
        "<h2>What was assumed</h2>",
        *(_listed(noted) if noted else ["<p>Nothing: all starts are given, and no event joins states.</p>"]),
        "<h2>Files</h2>",
        *_listed(files),
        "</body>",
        "</html>",
    ]
    return ("\n".join(lines) + "\n").encode()


def _listed(items: Iterable[str]) -> list[str]:
    return ["<ul>", *(f"<li>{escape(item)}</li>" for item in items), "</ul>"]
