"""Text put together of what stands in a file and of what is added to it; every character knows its place."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from dse.domain.expression import Expression, Piece
from dse.errors import Location
from dse.expression import parse_expression


@dataclass(frozen=True, slots=True)
class Passage:
    """A text and where its pieces stand, in order, the first at character 0."""

    text: str
    pieces: tuple[Piece, ...]

    @property
    def where(self) -> Location:
        """Where the text starts."""
        return self.pieces[0].where

    def parse(self) -> Expression:
        """The expression it is. Raises DseError at the exact character."""
        only = self.pieces[0]
        if len(self.pieces) == 1 and not only.inserted and "\n" not in self.text:
            return parse_expression(self.text, only.where)
        return parse_expression(self.text, self.pieces)


def written(text: str, origin: Location | tuple[Piece, ...]) -> Passage:
    """*text* as it stands in a file, without blanks at its end."""
    pieces = (Piece(0, origin),) if isinstance(origin, Location) else origin
    return Passage(text.rstrip(), pieces)


def added(text: str, where: Location) -> Passage:
    """*text* that is not in the file; what is wrong with it is told at *where*."""
    return Passage(text, (Piece(0, where, inserted=True),))


def joined(*passages: Passage) -> Passage:
    """One after the other."""
    text, pieces = "", []
    for passage in passages:
        pieces += [replace(piece, start=piece.start + len(text)) for piece in passage.pieces]
        text += passage.text
    return Passage(text, tuple(pieces))


def listed(separator: str, passages: Iterable[Passage]) -> Passage:
    """One after the other with *separator* between them; there must be one at least."""
    first, *others = passages
    return joined(first, *(part for other in others for part in (added(separator, other.where), other)))


def part(passage: Passage, start: int, end: int) -> Passage:
    """Characters *start* to *end*, which is not included."""
    before = [piece for piece in passage.pieces if piece.start <= start]
    first = before[-1]
    skipped = 0 if first.inserted else start - first.start
    where = replace(first.where, column=first.where.column + skipped)
    inside = [replace(piece, start=piece.start - start) for piece in passage.pieces if start < piece.start < end]
    return Passage(passage.text[start:end], (replace(first, start=0, where=where), *inside))


def with_insertions(passage: Passage, insertions: Iterable[tuple[int, str]]) -> Passage:
    """*passage* with texts inserted before the characters given; those for one character in their order."""
    parts: list[Passage] = []
    at = 0
    for offset, text in sorted(insertions, key=lambda insertion: insertion[0]):
        following = part(passage, offset, len(passage.text))
        parts += [part(passage, at, offset), added(text, following.where)]
        at = offset
    return joined(*parts, part(passage, at, len(passage.text)))
