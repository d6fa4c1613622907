"""Where the nodes of a design space's tree stand on paper: a tidy tree from left to right.

Every subtree has a band of its own; a node stands in the middle of its children (Reingold and Tilford 1981, with
bands instead of contours). Components to choose from stand together in a block, several columns of them if many.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from itertools import accumulate, groupby

from dse.pictures.svg import Box

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
    """What a node of the tree is."""

    COMPOUND = "compound"
    ALTERNATIVE = "alternative"
    OPTIONAL = "optional"
    COMPONENT = "component"


@dataclass(frozen=True, slots=True, eq=False)
class TreeNode:
    """A container or a component at *path*, and what hangs *below* it.

    *chosen* says whether it is there in a configuration, None where none is shown, *dead* that no valid one has it.
    """

    kind: NodeKind
    label: str
    path: str
    chosen: bool | None
    dead: bool
    below: tuple[TreeNode, ...] = ()

    def all(self) -> Iterator[TreeNode]:
        """Itself and everything below, parents first."""
        yield self
        for node in self.below:
            yield from node.all()


@dataclass(frozen=True, slots=True)
class OptionBlock:
    """Options of node *owner* that stand together."""

    owner: TreeNode
    members: tuple[TreeNode, ...]
    box: Box


@dataclass(frozen=True, slots=True)
class TreeLayout:
    """*boxes* of all nodes, *blocks* of options, and the size of it all; nothing lies left of or above 0.

    The parts of a tall root stand in several columns. Then *gutters* say, for each of them, the x at which the line
    from the root, which runs along the top, turns down to it.
    """

    boxes: dict[TreeNode, Box]
    blocks: tuple[OptionBlock, ...]
    width: float
    height: float
    gutters: dict[TreeNode, float] = field(default_factory=dict)


def lay_out(root: TreeNode) -> TreeLayout:
    """The layout of a tree."""
    return _Work(root).whole()


@dataclass(slots=True)
class _Band:
    """What hangs below a node, one above the other: single nodes, and tuples of options in a block."""

    rows: list[TreeNode | tuple[TreeNode, ...]] = field(default_factory=list)
    height: float = 0.0


class _Work:
    def __init__(self, root: TreeNode) -> None:
        self.root = root
        self.order = tuple(root.all())
        self.bands: dict[TreeNode, _Band] = {}
        self.boxes: dict[TreeNode, Box] = {}
        self.blocks: list[OptionBlock] = []

    def whole(self) -> TreeLayout:
        for node in reversed(self.order):
            self.bands[node] = self._band(node)
        levels = {self.root: 0}
        for node in self.order:
            levels.update((child, levels[node] + 1) for child in node.below)
        starts = self._starts(levels)
        pending = [(self.root, 0.0)]
        while pending:
            node, top = pending.pop()
            band = self.bands[node]
            level = levels[node]
            own = self._height(node)
            self.boxes[node] = Box(starts[level], top + own / 2, _width(node), BOX)
            y = top + (own - band.height) / 2
            for row in band.rows:
                if isinstance(row, TreeNode):
                    pending.append((row, y))
                    y += self._height(row)
                else:
                    self._place_block(node, row, starts[level + 1], y)
                    y += _block_size(row)[1]
        gutters = self._fold(starts[1])
        extents = [*self.boxes.values(), *(block.box for block in self.blocks)]
        return TreeLayout(
            self.boxes,
            tuple(self.blocks),
            max(box.right for box in extents),
            max(box.top + box.height for box in extents),
            gutters,
        )

    def _fold(self, start: float) -> dict[TreeNode, float]:
        """Put what hangs below a tall root into columns, about as wide together as they are high."""
        rows = [row for row in self.bands[self.root].rows if isinstance(row, TreeNode)]
        height = self._height(self.root)
        if height < _TALL or len(rows) < len(self.bands[self.root].rows):
            return {}
        width = max(self.boxes[node].right for node in self.order[1:]) - start + _GAP
        columns = next(k for k in range(1, len(rows) + 2) if height / k <= start + k * width or k > len(rows))
        shifts: dict[TreeNode, tuple[float, float]] = {}
        tops: dict[int, float] = {}
        below = 0.0
        for row in rows:
            column = min(int((below + self._height(row) / 2) * columns / height), columns - 1)
            top = tops.setdefault(column, below)
            shifts.update(dict.fromkeys(row.all(), (column * width, 2 * ROW - top)))
            below += self._height(row)
        self.boxes.update((node, _moved(self.boxes[node], *shift)) for node, shift in shifts.items())
        self.blocks = [replace(block, box=_moved(block.box, *shifts[block.owner])) for block in self.blocks]
        self.boxes[self.root] = replace(self.boxes[self.root], middle=ROW / 2)
        return {row: start + shifts[row][0] - _GAP / 2 for row in rows}

    def _band(self, node: TreeNode) -> _Band:
        """That of a node whose children are measured."""
        band = _Band()
        of_options = node.kind is NodeKind.ALTERNATIVE
        for is_block, members in groupby(node.below, lambda child: of_options and child.kind is NodeKind.COMPONENT):
            together = tuple(members)
            band.rows += [together] if is_block else together
        band.height = sum(self._height(row) if isinstance(row, TreeNode) else _block_size(row)[1] for row in band.rows)
        return band

    def _height(self, node: TreeNode) -> float:
        band = self.bands[node]
        return max(ROW, band.height + (_BAND_GAP if len(band.rows) > 1 else 0.0))

    def _place_block(self, owner: TreeNode, members: tuple[TreeNode, ...], x: float, y: float) -> None:
        _, rows = _grid(members)
        width, height = _block_size(members)
        cell = max(map(_width, members))
        box = Box(x, y + height / 2, width, height - _BAND_GAP)
        for number, member in enumerate(members):
            column, row = divmod(number, rows)
            left = x + _BLOCK_PADDING + column * (cell + _BLOCK_PADDING)
            self.boxes[member] = Box(left, box.top + _BLOCK_PADDING / 2 + (row + 0.5) * ROW, cell, BOX)
        self.blocks.append(OptionBlock(owner, members, box))

    def _starts(self, levels: dict[TreeNode, int]) -> list[float]:
        """The left edge of each level; only nodes with something below them push the next one away."""
        widths = [0.0] * (max(levels.values()) + 2)
        for node in self.order:
            if node.below:
                widths[levels[node]] = max(widths[levels[node]], _width(node))
        return [*accumulate((width + _GAP for width in widths), initial=0.0)]


def _width(node: TreeNode) -> float:
    return len(node.label) * _CHARACTER + _PADDING


def _grid(members: tuple[TreeNode, ...]) -> tuple[int, int]:
    """Columns and rows of a block."""
    columns = 1 if len(members) <= _LONE_COLUMN else -(-len(members) // _ROWS)
    return columns, -(-len(members) // columns)


def _block_size(members: tuple[TreeNode, ...]) -> tuple[float, float]:
    columns, rows = _grid(members)
    width = max(map(_width, members))
    return columns * (width + _BLOCK_PADDING) + _BLOCK_PADDING, rows * ROW + _BLOCK_PADDING + _BAND_GAP


def _moved(box: Box, right: float, down: float) -> Box:
    return replace(box, x=box.x + right, middle=box.middle + down)
