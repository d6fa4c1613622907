"""Where each character of a YAML text stands in its file: folded lines, block scalars, quotes and escapes."""

from __future__ import annotations

import re

from dse.domain.expression import Piece
from dse.errors import Location

_PROPERTIES = re.compile(r"(?:[&!]\S*[ \t\r\n]+)*")
_ESCAPE = re.compile(r"\\(?:x[0-9A-Fa-f]{2}|u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8}|\r\n|.)", re.DOTALL)
_BLANKS = {"n": "\n", "t": "\t", " ": " "}
_BREAKS = "\r\n"


def content_start(raw: str) -> int:
    """Where in *raw*, a node as it is written, its value starts: after its anchor and tag and an opening quote."""
    found = _PROPERTIES.match(raw)
    start = found.end() if found else 0
    return start + int(raw[start : start + 1] in ("'", '"'))


def place_in(raw: str, offset: int, start: Location) -> Location:
    """Where the character *offset* of *raw* stands in the file, if *raw* starts at *start*."""
    lines = raw.count("\n", 0, offset)
    column = offset - raw.rfind("\n", 0, offset) if lines else start.column + offset
    return Location(start.file, start.line + lines, column)


def pieces(raw: str, value: str, start: Location) -> tuple[Piece, ...]:
    """The pieces of *value*, the text that YAML reads in *raw*, which starts at *start*.

    None if *value* stands there as it is, from `content_start` on.
    """
    first = content_start(raw)
    if raw.startswith(value, first) and not any(sign in value for sign in _BREAKS):
        return ()
    found: list[Piece] = []
    before: int | None = None
    for number, offset in enumerate(_offsets(raw, value, first)):
        if before is None or offset != before + 1 or raw[before] in _BREAKS:
            found.append(Piece(number, place_in(raw, offset, start)))
        before = offset
    return tuple(found)


def _offsets(raw: str, value: str, first: int) -> list[int]:
    """For every character of *value*, where in *raw* it is written; for a fold's blank, where the line ends."""
    quote = raw[first - 1] if first and raw[first - 1] in ("'", '"') else ""
    at = first if quote or raw[first : first + 1] not in ("|", ">") else _line_after(raw, first)
    last = len(raw) - 1
    found: list[int] = []
    for sign in value:
        # Behind a line that goes on, a blank is written as an escape.
        if sign not in " \t\n" or (quote == '"' and raw.startswith(_CONTINUED, at)):
            at = _skip(raw, at, quote)
        at = min(at, last)
        produced, length = _unit(raw, at, quote)
        found.append(at)
        # A blank that a fold made stands for the line's end and the indentation after it: they are still to come.
        if sign not in " \t\n" or produced == sign:
            at += length
    return found


def _line_after(raw: str, start: int) -> int:
    end = raw.find("\n", start)
    return len(raw) if end < 0 else end + 1


def _skip(raw: str, at: int, quote: str) -> int:
    while raw[at : at + 1] in _SPACE or (quote == '"' and raw.startswith(_CONTINUED, at)):
        at += 1
    return at


_SPACE = (" ", "\t", "\r", "\n")
_CONTINUED = ("\\\n", "\\\r")


def _unit(raw: str, at: int, quote: str) -> tuple[str, int]:
    """The blank written at *at*, "" for any other character, and how many characters it takes to write it."""
    if quote == "'" and raw.startswith("''", at):
        return "", 2
    if quote == '"' and (escape := _ESCAPE.match(raw, at)):
        text = escape[0]
        produced = chr(int(text[2:], 16)) if text[1] in "xuU" and len(text) > 2 else _BLANKS.get(text[1], "")
        return produced if produced in _BLANKS.values() else "", len(text)
    return raw[at] if raw[at] in " \t\n" else "", 1
