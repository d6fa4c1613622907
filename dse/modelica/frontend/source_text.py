"""Modelica source text, as far as something has to be found in it that the front-end does not tell."""

from __future__ import annotations

import codecs
import re
from bisect import bisect
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from dse.errors import Location

CLASS_KINDS = "class|model|block|record|connector|type|package|function"
# Quoted names are not hidden, but what looks like a comment or a string in them begins none.
_HIDDEN = re.compile(r"""'(?:\\.|[^'\\\n])*'|"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/""", re.DOTALL)
_LINE_END = re.compile("\n")
_DESCRIPTION = re.compile(r'\s*"((?:\\.|[^"\\])*)"')
_BLANK = re.compile(r"[^\n]")


@dataclass(frozen=True, slots=True)
class SourceText:
    """One file as the front-end read it. *path* is spelled as the user does."""

    path: str
    text: str

    def location(self, offset: int) -> Location:
        """Line and column of the byte *offset* of the text in UTF-8; columns count characters."""
        content, starts = _encoded(self.text)
        offset = min(max(offset, 0), len(content))
        line = bisect(starts, offset)
        column = len(content[starts[line - 1] : offset].decode("utf-8", "replace"))
        return Location(self.path, line, column + 1)


@lru_cache(maxsize=16)
def _line_starts(text: str) -> list[int]:
    return [0, *(match.end() for match in _LINE_END.finditer(text))]


@lru_cache(maxsize=16)
def _encoded(text: str) -> tuple[bytes, list[int]]:
    content = text.encode()
    return content, [0, *(match.end() for match in re.finditer(b"\n", content))]


def code(text: str) -> str:
    """*text* with blanks in place of comments and strings: the same length, and the same lines."""

    def blank(match: re.Match[str]) -> str:
        return match[0] if match[0].startswith("'") else _BLANK.sub(" ", match[0])

    return _HIDDEN.sub(blank, text)


def changed(files: Mapping[str, bytes], change: Callable[[str], str]) -> dict[str, bytes]:
    """*files* by name, with the texts of those that contain Modelica changed."""
    return {
        name: change(content.removeprefix(codecs.BOM_UTF8).decode("utf-8", "replace")).encode()
        if name.endswith(".mo")
        else content
        for name, content in files.items()
    }


Change = tuple[int, int, str]
"""Start and end of a piece of text, and what stands there instead."""


def edited(text: str, changes: Iterable[Change]) -> str:
    """*text* with all *changes*, those of one place in their order."""
    parts, at = [], 0
    for start, end, new in sorted(changes, key=lambda change: change[0]):
        parts += [text[at:start], new]
        at = end
    return "".join([*parts, text[at:]])


def declarations(sources: Iterable[SourceText], name: str) -> list[tuple[Location, str]]:
    """Place and description of what may be the class *name*, a full name: all with its last word."""
    word = re.escape(name.rpartition(".")[2])
    pattern = re.compile(rf"^[ \t]*(?:\w+[ \t]+)*?(?:{CLASS_KINDS}|operator)\s+({word})\b", re.MULTILINE)
    listed = found(sources, pattern)
    described = ((place, _DESCRIPTION.match(source.text, match.end())) for source, match, place in listed)
    return [(place, re.sub(r"\\(.)", r"\1", text[1]) if text else "") for place, text in described]


def found(
    sources: Iterable[SourceText], pattern: re.Pattern[str]
) -> Iterator[tuple[SourceText, re.Match[str], Location]]:
    """Where *pattern* occurs outside of comments and strings; the place is that of its last group."""
    for source in sources:
        for match in pattern.finditer(code(source.text)):
            yield source, match, place(source, match.start(match.lastindex or 0))


def place(source: SourceText, start: int) -> Location:
    """Line and column of the character number *start*."""
    starts = _line_starts(source.text)
    line = bisect(starts, start)
    return Location(source.path, line, start - starts[line - 1] + 1)


BRACKET = re.compile(r"[()\[\]{},;]")


def inside(text: str, start: int) -> str:
    """What stands between the bracket at *start* and the one that closes it, or the end of *text*."""
    depth = 0
    for match in BRACKET.finditer(text, start):
        depth += (match[0] in "([{") - (match[0] in ")]}")
        if depth == 0:
            return text[start + 1 : match.start()]
    return text[start + 1 :]


def arguments(text: str) -> list[tuple[int, int]]:
    """Start and end of the parts of *text* between its commas, but for those in brackets."""
    depth, starts, ends = 0, [0], []
    for match in BRACKET.finditer(text):
        depth += (match[0] in "([{") - (match[0] in ")]}")
        if match[0] == "," and depth == 0:
            ends.append(match.start())
            starts.append(match.end())
    return list(zip(starts, [*ends, len(text)], strict=True))
