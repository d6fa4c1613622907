"""Modelica source text, as far as something has to be found in it that the front-end does not tell."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from dse.errors import Location
from dse.modelica.frontend.sources import SourceText

CLASS_KINDS = "class|model|block|record|connector|type|package|function"
PREFIXES = r"(?:(?:each|final|replaceable|encapsulated|partial|pure|impure)\s+)*"
# Quoted names are not hidden, but what looks like a comment or a string in them begins none.
_HIDDEN = re.compile(r"""'(?:\\.|[^'\\\n])*'|"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/""", re.DOTALL)
_BLANK = re.compile(r"[^\n]")


@dataclass(frozen=True, slots=True)
class Declaration:
    """Where a class is declared."""

    where: Location
    is_partial: bool
    description: str


def code(text: str) -> str:
    """*text* with blanks in place of comments and strings: the same length, and the same lines."""

    def blank(match: re.Match[str]) -> str:
        return match[0] if match[0].startswith("'") else _BLANK.sub(" ", match[0])

    return _HIDDEN.sub(blank, text)


def declarations(sources: Iterable[SourceText], name: str) -> list[Declaration]:
    """What may be the declaration of the class *name*, a full name: those of its last word."""
    word = name.rsplit(".", maxsplit=1)[-1]
    pattern = re.compile(rf"^[ \t]*((?:\w+[ \t]+)*?)(?:{CLASS_KINDS}|operator)\s+({re.escape(word)})\b", re.MULTILINE)
    return [
        Declaration(place, "partial" in match[1].split(), _description(source.text[match.end() :]))
        for source, match, place in found(sources, pattern)
    ]


def found(
    sources: Iterable[SourceText], pattern: re.Pattern[str]
) -> Iterator[tuple[SourceText, re.Match[str], Location]]:
    """Where *pattern* occurs outside of comments and strings; the place is that of its last group."""
    for source in sources:
        for _, match, where in occurring((SourceText(source.path, code(source.text)),), pattern):
            yield source, match, where


def occurring(
    cleaned: Iterable[SourceText], pattern: re.Pattern[str]
) -> Iterator[tuple[SourceText, re.Match[str], Location]]:
    """The same of texts that have neither comments nor strings any more."""
    for source in cleaned:
        for match in pattern.finditer(source.text):
            yield source, match, place(source, match.start(match.lastindex or 0))


def place(source: SourceText, start: int) -> Location:
    """Line and column of the character number *start*."""
    line_start = source.text.rfind("\n", 0, start) + 1
    return Location(source.path, source.text.count("\n", 0, start) + 1, start - line_start + 1)


def _description(following: str) -> str:
    match = re.match(r'\s*"((?:\\.|[^"\\])*)"', following)
    return re.sub(r"\\(.)", r"\1", match[1]) if match else ""


def inside(text: str, start: int) -> str:
    """What stands between the bracket at *start* and the one that closes it, or the end of *text*."""
    depth = 0
    for place_, letter in enumerate(text[start:], start):
        depth += (letter in "([{") - (letter in ")]}")
        if depth == 0:
            return text[start + 1 : place_]
    return text[start + 1 :]


def arguments(text: str) -> list[tuple[int, int]]:
    """Start and end of the parts of *text* between its commas, but for those in brackets."""
    depth, starts, ends = 0, [0], []
    for place_, letter in enumerate(text):
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            ends.append(place_)
            starts.append(place_ + 1)
    return list(zip(starts, [*ends, len(text)], strict=True))
