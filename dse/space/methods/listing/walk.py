"""Depth-first walk over a diagram in blocks of partial rows, pruned by cuts and wide rules.

Many partial rows of one depth are extended at once. Where a row came from is kept as its position in the block
before; the columns are put together once, when the rows are complete. A layer where no node has a choice costs
next to nothing.

Example: x in {1, 2, 4}, y in {0, 3}, x + y <= 4. The slack is what the bound leaves beyond the least completion.

    block of x: 1, 2, 4 with slack 3, 2, 0
    block of y: 3 more is too much for slack 2 and 0, so the rows are (1, 0), (1, 3), (2, 0), (4, 0)

Cost: partial rows that are extended. With good cuts that is little more than the rows listed: 2.3 million rows a
second on L, 5.3 million rows in 26 s where one combination in 10^21 is valid
(docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import ABSENT, Bools, Ints, Rows, Wide
from dse.space.methods.budget import TooMuchError
from dse.space.methods.listing.bounds import Cut
from dse.space.methods.listing.slack import Slack, slack_of
from dse.space.methods.mdd.diagram import DecisionDiagram
from dse.space.methods.mdd.folds import Rest, added, contributions, interval, judged, rests

BLOCK_ROWS = 1 << 15
"""Most rows of a block."""

_FIRST = 256
"""Candidates that the first blocks are extended to."""

RowPlaces = NDArray[np.int32]


class Rounds:
    """An allowance of pieces of work, of some milliseconds each; walks that share one spend it together."""

    def __init__(self, number: int) -> None:
        self.left = number

    def spend(self) -> None:
        """Take one; raises TooMuchError if there is none."""
        if not self.left:
            raise TooMuchError
        self.left -= 1


@dataclass(frozen=True, slots=True, eq=False)
class _Trail:
    """How the partial rows of one depth continue those of the depth before.

    *parents*: positions there, None if one by one. *taken*: the column of the layer; its node if all are forced.
    """

    before: _Trail | None
    parents: RowPlaces | None
    taken: NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """Partial rows of one depth, in order; *left* has the slack, shape (rows,), of the words that *active* names."""

    depth: int
    trail: _Trail | None
    nodes: RowPlaces
    active: tuple[int, ...]
    left: tuple[Ints, ...]
    folds: tuple[Ints, ...]
    tightened: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Layer:
    """The children by node and column; *values* tells of each column its value."""

    child: RowPlaces
    values: NDArray[np.int16]
    forced: NDArray[np.int16] | None
    """The value at each node, if none has a choice."""
    only: RowPlaces
    """Then also the child."""


class DiagramWalk:
    """All rows of a diagram within *cuts* and *wides*, lazily and in order: iterate for blocks of rows.

    The bounds of the *movable* cuts may be tightened while the walk is under way; it then leaves out what it has
    not yet reached. Wide rules must be `is_bounded`. Memory does not grow with the number of rows. Raises TooMuchError
    when *rounds* are spent, if given.
    """

    def __init__(
        self,
        diagram: DecisionDiagram,
        cuts: Sequence[Cut],
        wides: Sequence[Wide] = (),
        block: int = BLOCK_ROWS,
        movable: frozenset[int] = frozenset(),
        rounds: Rounds | None = None,
    ) -> None:
        self.diagram = diagram
        self.rounds = rounds
        self.cuts = cuts
        self.block = block
        self._wides = tuple(wides)
        self._movable = frozenset(
            place for place, cut in enumerate(cuts) if place in movable or movable & set(cut.multipliers or ())
        )
        self._tightened = [0] * len(cuts)
        self._folds = [fold for wide in wides for fold in wide.folds]
        self._rests: list[list[Rest]] = []
        self._layers: list[_Layer] = []
        self._slack: Slack | None = None
        if not diagram.empty:
            occurring = [np.flatnonzero((layer >= 0).any(axis=0)) for layer in diagram.layers]
            self._layers = [_layer(*both) for both in zip(diagram.layers, occurring, strict=True)]
            self._slack = slack_of(diagram, occurring, cuts, self._movable)
            self._rests = [rests(diagram, fold) for fold in self._folds]

    def tighten(self, number: int, by: int) -> None:
        """Lower the bound of a movable cut, and of the surrogates made with it, for the rest of the walk."""
        self._tightened[number] += by
        for place, cut in enumerate(self.cuts):
            if cut.multipliers is not None and number in cut.multipliers:
                self._tightened[place] += by * cut.multipliers[number]

    def __iter__(self) -> Iterator[Rows]:
        slack = self._slack
        if slack is None or slack.root is None:
            return
        room = min(_FIRST, 2 * self.block)
        stack = [self._start(slack.root)]
        while stack:
            if self.rounds is not None:
                self.rounds.spend()
            piece = self._pruned(slack, stack.pop())
            while len(piece.nodes) and piece.depth < len(self._layers):
                layer = self._layers[piece.depth]
                if layer.forced is not None:
                    piece = self._forced(piece, layer)
                    continue
                size = max(room // len(layer.values), 1)
                if size < len(piece.nodes):
                    stack.append(_sliced(piece, slice(size, None)))
                    piece = _sliced(piece, slice(None, size))
                piece = self._extended(slack, piece, layer)
            if self._wides and self._layers and self._layers[-1].forced is not None and len(piece.nodes):
                # Not looked at since the last choice, and folds may have gained since.
                piece = _selected(piece, np.flatnonzero(self._may_hold(piece)))
            for start in range(0, len(piece.nodes), self.block):
                yield self._rows(_sliced(piece, slice(start, start + self.block)))
            # Small blocks first, for the sake of whoever wants only the first row.
            room = min(2 * room, 2 * self.block)

    def _start(self, root: tuple[np.int64, ...]) -> _Piece:
        return _Piece(
            0,
            None,
            np.zeros(1, np.int32),
            tuple(range(len(root))),
            tuple(np.full(1, word) for word in root),
            tuple(np.full(1, fold.start, np.int64) for fold in self._folds),
            (0,) * len(self.cuts),
        )

    def _pruned(self, slack: Slack, piece: _Piece) -> _Piece:
        """Without the rows that bounds tightened meanwhile forbid, and the words that all completions keep."""
        if piece.tightened != (now := tuple(self._tightened)):
            change = slack.packed([new - old for new, old in zip(now, piece.tightened, strict=True)])
            left = tuple(part - change[word] for word, part in zip(piece.active, piece.left, strict=True))
            keep = np.flatnonzero(_kept(slack, piece.active, left))
            piece = _selected(replace(piece, left=left, tightened=now), keep)
        tight = [place for place, word in enumerate(piece.active) if not self._loose(slack, piece, place, word)]
        if len(tight) == len(piece.active):
            return piece
        active, left = tuple(piece.active[place] for place in tight), tuple(piece.left[place] for place in tight)
        return replace(piece, active=active, left=left)

    def _loose(self, slack: Slack, piece: _Piece, place: int, word: int) -> bool:
        if any(slack.words[number] == word for number in self._movable):
            return False
        rest = piece.left[place] - slack.spreads[piece.depth][word][piece.nodes]
        return bool(_kept(slack, (word,), (rest,)).all())

    def _forced(self, piece: _Piece, layer: _Layer) -> _Piece:
        folds = piece.folds
        if folds and layer.forced is not None:
            folds = self._folded(piece.depth, folds, layer.forced[piece.nodes])
        trail = _Trail(piece.trail, None, piece.nodes)
        return replace(piece, depth=piece.depth + 1, trail=trail, nodes=layer.only[piece.nodes], folds=folds)

    def _extended(self, slack: Slack, piece: _Piece, layer: _Layer) -> _Piece:
        nodes = piece.nodes
        left: list[Ints] = []
        if piece.active:
            word = piece.active[0]
            spent = piece.left[0][:, None] - slack.costs[piece.depth][word].take(nodes, axis=0)
            parents, column = np.nonzero((spent & slack.guards[word]) == slack.guards[word])
            left = [spent[parents, column]]
        else:
            parents, column = np.nonzero(layer.child.take(nodes, axis=0) >= 0)
        for word, before in zip(piece.active[1:], piece.left[1:], strict=True):
            spare = before[parents] - slack.costs[piece.depth][word][nodes[parents], column]
            left.append(spare)
            keep = np.flatnonzero((spare & slack.guards[word]) == slack.guards[word])
            if len(keep) < len(parents):
                parents, column, left = parents[keep], column[keep], [part[keep] for part in left]
        folds = piece.folds
        if folds:
            folds = self._folded(piece.depth, tuple(part[parents] for part in folds), layer.values[column])
        extended = replace(
            piece,
            depth=piece.depth + 1,
            trail=_Trail(piece.trail, parents.astype(np.int32), column.astype(np.int16)),
            nodes=layer.child[nodes[parents], column],
            left=tuple(left),
            folds=folds,
        )
        if not folds or not len(parents):
            return extended
        return _selected(extended, np.flatnonzero(self._may_hold(extended)))

    def _folded(self, depth: int, folds: tuple[Ints, ...], values: NDArray[np.int16]) -> tuple[Ints, ...]:
        variable, length = self.diagram.order[depth], self.diagram.layers[depth].shape[1]
        return tuple(
            added(fold.gather, part, contributions(fold, variable, length)[values]) if variable in fold.values else part
            for fold, part in zip(self._folds, folds, strict=True)
        )

    def _may_hold(self, piece: _Piece) -> Bools:
        answer = np.ones(len(piece.nodes), np.bool_)
        complete = piece.depth == len(self._layers)
        first = 0
        for wide in self._wides:
            part = range(first, first + len(wide.folds))
            first += len(wide.folds)
            if complete:
                answer &= judged(wide, [piece.folds[place] for place in part])
                continue
            ends = [
                interval(self._folds[p].gather, piece.folds[p], self._rests[p][piece.depth], piece.nodes) for p in part
            ]
            answer &= wide.judge.bounds([low for low, _ in ends], [high for _, high in ends])[0]
        return answer

    def _rows(self, piece: _Piece) -> Rows:
        columns = np.empty((len(self.diagram.order), len(piece.nodes)), np.int16)
        trail = piece.trail
        places: Any = slice(None)
        for depth in range(len(self._layers) - 1, -1, -1):
            layer = self._layers[depth]
            assert trail is not None  # noqa: S101 - there is one for each layer
            values = layer.values if layer.forced is None else layer.forced
            columns[self.diagram.order[depth]] = values[trail.taken[places]]
            if trail.parents is not None:
                places = trail.parents[places]
                if isinstance(places, np.ndarray) and places[0] == places[-1]:
                    # Positions ascend: from here on all rows have one and the same past.
                    places = int(places[0])
            trail = trail.before
        return columns.T


def _layer(children: RowPlaces, occurring: Ints) -> _Layer:
    values = np.where(occurring == children.shape[1] - 1, ABSENT, occurring).astype(np.int16)
    child = np.ascontiguousarray(children[:, occurring])
    there = child >= 0
    if (there.sum(axis=1) > 1).any():
        return _Layer(child, values, None, child[:0, 0])
    column = there.argmax(axis=1)
    return _Layer(child, values, values[column], child[np.arange(len(child)), column])


def _kept(slack: Slack, active: Sequence[int], left: Sequence[Ints]) -> Bools:
    kept = np.ones(len(left[0]) if left else 0, np.bool_)
    for word, part in zip(active, left, strict=True):
        kept &= (part & slack.guards[word]) == slack.guards[word]
    return kept


def _sliced(piece: _Piece, part: slice) -> _Piece:
    return _picked(piece, part, np.arange(len(piece.nodes), dtype=np.int32)[part])


def _selected(piece: _Piece, keep: Ints) -> _Piece:
    return piece if len(keep) == len(piece.nodes) else _picked(piece, keep, keep.astype(np.int32))


def _picked(piece: _Piece, part: Any, positions: RowPlaces) -> _Piece:
    trail = piece.trail
    if trail is not None:
        parents = positions if trail.parents is None else trail.parents[part]
        trail = _Trail(trail.before, parents, trail.taken[part])
    return replace(
        piece,
        trail=trail,
        nodes=piece.nodes[part],
        left=tuple(words[part] for words in piece.left),
        folds=tuple(folded[part] for folded in piece.folds),
    )
