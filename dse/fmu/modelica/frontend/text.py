"""Modelica source text, as far as something has to be found in it that the front-end does not tell."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from dse.errors import Location
from dse.fmu.modelica.frontend.sources import SourceText

_KINDS = "model|block|class|package|function|record|connector|type|operator"
_HIDDEN = re.compile(r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
_BLANK = re.compile(r"[^\n]")


@dataclass(frozen=True, slots=True)
class Declaration:
    """Where a class is declared."""

    where: Location
    is_partial: bool
    description: str


def code(text: str, *, keep_strings: bool = False) -> str:
    """*text* with blanks in place of comments and strings: the same length, and the same lines."""

    def blank(match: re.Match[str]) -> str:
        return match[0] if keep_strings and match[0].startswith('"') else _BLANK.sub(" ", match[0])

    return _HIDDEN.sub(blank, text)


def declarations(sources: Iterable[SourceText], name: str) -> list[Declaration]:
    """What may be the declaration of the class *name*, a full name: those of its last word."""
    word = name.rsplit(".", maxsplit=1)[-1]
    pattern = re.compile(rf"^[ \t]*((?:\w+[ \t]+)*?)(?:{_KINDS})\s+({re.escape(word)})\b", re.MULTILINE)
    return [
        Declaration(place, "partial" in match[1].split(), _description(source.text[match.end() :]))
        for source, match, place in found(sources, pattern)
    ]


def found(
    sources: Iterable[SourceText], pattern: re.Pattern[str]
) -> Iterator[tuple[SourceText, re.Match[str], Location]]:
    """Where *pattern* occurs outside of comments and strings; the place is that of its last group."""
    for source in sources:
        if re.search(r"\w", source.text):
            for match in pattern.finditer(code(source.text)):
                start = match.start(match.lastindex or 0)
                line_start = source.text.rfind("\n", 0, start) + 1
                line = source.text.count("\n", 0, start) + 1
                yield source, match, Location(source.path, line, start - line_start + 1)


def _description(following: str) -> str:
    match = re.match(r'\s*"((?:\\.|[^"\\])*)"', following)
    return re.sub(r"\\(.)", r"\1", match[1]) if match else ""
