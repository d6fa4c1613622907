"""Where the nodes of a design space's graph stand on paper: a tidy tree from left to right.

Every subtree has a band of its own; a node stands in the middle of its children (Reingold and Tilford 1981, with
bands instead of contours). Components to choose from stand together in a block, several columns of them if many.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from itertools import groupby
from typing import TYPE_CHECKING

from dse.pictures.svg import Box

if TYPE_CHECKING:
    import networkx as nx

ROW = 24.0
"""Height of a node with the space to the next, in pixels."""

BOX = 20.0
"""Height of a node."""

_CHARACTER = 7.6
_PADDING = 18.0
_GAP = 48.0
_BLOCK_PADDING = 6.0
_BAND_GAP = 8.0
_TALL = 1400.0
_LONE_COLUMN = 5
_ROWS = 4


class NodeKind(StrEnum):
    """What a node of the graph is."""

    COMPOUND = "compound"
    ALTERNATIVE = "alternative"
    OPTIONAL = "optional"
    COMPONENT = "component"


@dataclass(frozen=True, slots=True)
class Block:
    """Options of node *owner* that stand together."""

    owner: int
    members: tuple[int, ...]
    box: Box


@dataclass(frozen=True, slots=True)
class TreeLayout:
    """*boxes* of all nodes, *blocks* of options, and the size of it all; nothing lies left of or above 0.

    The parts of a tall root stand in several columns. Then *gutters* say, for each of them, the x at which the line
    from the root, which runs along the top, turns down to it.
    """

    boxes: dict[int, Box]
    blocks: tuple[Block, ...]
    width: float
    height: float
    gutters: dict[int, float] = field(default_factory=dict)


def lay_out(tree: nx.DiGraph[int]) -> TreeLayout:
    """The layout of a graph of `dse.space.output.graph.graph`."""
    return _Work(tree).whole()


@dataclass(slots=True)
class _Band:
    """What hangs below a node, one above the other: single nodes, and tuples of options in a block."""

    rows: list[int | tuple[int, ...]] = field(default_factory=list)
    height: float = 0.0


class _Work:
    def __init__(self, tree: nx.DiGraph[int]) -> None:
        self.tree = tree
        self.order = sorted(tree.nodes)
        self.bands: dict[int, _Band] = {}
        self.boxes: dict[int, Box] = {}
        self.blocks: list[Block] = []

    def whole(self) -> TreeLayout:
        for node in reversed(self.order):
            self._measure(node)
        levels = self._levels()
        starts = self._starts(levels)
        pending = [(self.order[0], 0.0)]
        while pending:
            node, top = pending.pop()
            band = self.bands[node]
            level = levels[node]
            own = self._height(node)
            self.boxes[node] = Box(starts[level], top + own / 2, self._width(node), BOX)
            y = top + (own - band.height) / 2
            for row in band.rows:
                if isinstance(row, int):
                    pending.append((row, y))
                    y += self._height(row)
                else:
                    self._place_block(node, row, starts[level + 1], y)
                    y += self._block_size(row)[1]
        gutters = self._fold(starts[1], levels)
        extents = [*self.boxes.values(), *(block.box for block in self.blocks)]
        return TreeLayout(
            self.boxes,
            tuple(self.blocks),
            max(box.right for box in extents),
            max(box.top + box.height for box in extents),
            gutters,
        )

    def _fold(self, start: float, levels: dict[int, int]) -> dict[int, float]:
        """Put what hangs below a tall root into columns, about as wide together as they are high."""
        root, *others = self.order
        rows = [row for row in self.bands[root].rows if isinstance(row, int)]
        height = self._height(root)
        if height < _TALL or len(rows) < len(self.bands[root].rows):
            return {}
        width = max(self.boxes[node].right for node in others) - start + _GAP
        columns = next(k for k in range(1, len(rows) + 2) if height / k <= start + k * width or k > len(rows))
        shifts: dict[int, tuple[float, float]] = {}
        tops: dict[int, float] = {}
        below = 0.0
        for row in rows:
            column = min(int((below + self._height(row) / 2) * columns / height), columns - 1)
            top = tops.setdefault(column, below)
            shifts[row] = (column * width, 2 * ROW - top)
            below += self._height(row)
        for node in others:
            if levels[node] > 1:
                shifts[node] = shifts[next(self.tree.predecessors(node))]
            self.boxes[node] = _moved(self.boxes[node], *shifts[node])
        self.blocks = [replace(block, box=_moved(block.box, *shifts[block.owner])) for block in self.blocks]
        self.boxes[root] = replace(self.boxes[root], middle=ROW / 2)
        return {row: start + shifts[row][0] - _GAP / 2 for row in rows}

    def _measure(self, node: int) -> None:
        """The band of a node whose children are measured."""
        band = _Band()
        nodes = self.tree.nodes
        of_options = nodes[node]["kind"] is NodeKind.ALTERNATIVE
        for is_block, members in groupby(
            self.tree.successors(node),
            lambda child: of_options and nodes[child]["kind"] is NodeKind.COMPONENT,
        ):
            together = tuple(members)
            band.rows += [together] if is_block else together
        band.height = sum(self._height(row) if isinstance(row, int) else self._block_size(row)[1] for row in band.rows)
        self.bands[node] = band

    def _height(self, node: int) -> float:
        band = self.bands[node]
        return max(ROW, band.height + (_BAND_GAP if len(band.rows) > 1 else 0.0))

    def _width(self, node: int) -> float:
        return len(self.tree.nodes[node]["label"]) * _CHARACTER + _PADDING

    def _grid(self, members: tuple[int, ...]) -> tuple[int, int]:
        """Columns and rows of a block."""
        columns = 1 if len(members) <= _LONE_COLUMN else -(-len(members) // _ROWS)
        return columns, -(-len(members) // columns)

    def _block_size(self, members: tuple[int, ...]) -> tuple[float, float]:
        columns, rows = self._grid(members)
        width = max(map(self._width, members))
        return (
            columns * (width + _BLOCK_PADDING) + _BLOCK_PADDING,
            rows * ROW + _BLOCK_PADDING + _BAND_GAP,
        )

    def _place_block(self, owner: int, members: tuple[int, ...], x: float, y: float) -> None:
        _, rows = self._grid(members)
        width, height = self._block_size(members)
        cell = max(map(self._width, members))
        box = Box(x, y + height / 2, width, height - _BAND_GAP)
        for number, member in enumerate(members):
            column, row = divmod(number, rows)
            left = x + _BLOCK_PADDING + column * (cell + _BLOCK_PADDING)
            self.boxes[member] = Box(left, box.top + _BLOCK_PADDING / 2 + (row + 0.5) * ROW, cell, BOX)
        self.blocks.append(Block(owner, members, box))

    def _levels(self) -> dict[int, int]:
        levels: dict[int, int] = {}
        for node in self.order:
            above = next(self.tree.predecessors(node), None)
            levels[node] = 0 if above is None else levels[above] + 1
        return levels

    def _starts(self, levels: dict[int, int]) -> list[float]:
        """The left edge of each level; only nodes with something below them push the next one away."""
        widths = [0.0] * (max(levels.values()) + 2)
        for node in self._with_children():
            widths[levels[node]] = max(widths[levels[node]], self._width(node))
        starts = [0.0]
        for width in widths:
            starts.append(starts[-1] + width + _GAP)
        return starts

    def _with_children(self) -> Iterable[int]:
        return (node for node in self.order if self.bands[node].rows)


def _moved(box: Box, right: float, down: float) -> Box:
    return replace(box, x=box.x + right, middle=box.middle + down)
