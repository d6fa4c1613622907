"""Where the parts and ports of a component stand in its picture: inputs left, outputs right, parts in columns between.

The column of a part is its distance from the parts that the first input reaches; within a column parts stand in the
order of what they hang on to (Sugiyama, Tagawa and Toda 1981: layers and barycentres).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from dse.domain.diagram import Diagram
from dse.pictures.svg import Box

ROW = 40.0
"""Height of a part with the space to the next, in pixels."""

PORT_ROW = 20.0
HEAD = 56.0
"""Height of the title above the parts."""

_CHARACTER = 7.4
_TITLE_CHARACTER = 8.9
_PADDING = 22.0
_GAP = 46.0
_SWEEPS = 4


@dataclass(frozen=True, slots=True)
class ComponentLayout:
    """*parts* are boxes; *ports* are the points where their arrows end or begin, on the edges of *frame*."""

    parts: Mapping[str, Box]
    ports: Mapping[str, tuple[float, float]]
    frame: Box
    width: float
    height: float


def lay_out(
    diagram: Diagram,
    inputs: Sequence[str],
    outputs: Sequence[str],
    title: str,
    labels: Mapping[str, str] = MappingProxyType({}),
) -> ComponentLayout:
    """The layout of *diagram* in a frame with the ports *inputs* and *outputs*, which may be called otherwise there.

    *labels* is what stands in parts other than their names.
    """
    columns = _columns(diagram)
    widths = [max(_width(labels.get(name, name)) for name in column) for column in columns]
    inside = sum(widths) + _GAP * (len(widths) + 1) if columns else _GAP
    inside = max(inside, _TITLE_CHARACTER * len(title) + _PADDING)
    tall = max([len(column) * ROW for column in columns] + [len(side) * PORT_ROW for side in (inputs, outputs)])
    left = max((_width(name) for name in inputs), default=0.0) + _PADDING
    right = max((_width(name) for name in outputs), default=0.0) + _PADDING
    height = HEAD + tall + PORT_ROW
    frame = Box(left, height / 2, inside, height)
    middle = HEAD + tall / 2
    parts: dict[str, Box] = {}
    x = left + (inside - sum(widths) - _GAP * (len(widths) - 1)) / 2
    for column, width in zip(columns, widths, strict=True):
        top = middle - len(column) * ROW / 2
        for number, name in enumerate(column):
            parts[name] = Box(x, top + (number + 0.5) * ROW, width, ROW - 14)
        x += width + _GAP
    ports = {}
    for side, edge in ((inputs, frame.x), (outputs, frame.right)):
        top = middle - len(side) * PORT_ROW / 2
        ports.update({name: (edge, top + (number + 0.5) * PORT_ROW) for number, name in enumerate(side)})
    return ComponentLayout(parts, ports, frame, left + inside + right, height)


def _columns(diagram: Diagram) -> list[list[str]]:
    place = {name: number for number, name in enumerate(diagram.parts)}
    near: dict[str, list[str]] = {name: [] for name in diagram.parts}
    # Where shafts and cables run decides; signals only place what hangs on none.
    for is_physical in (True, False):
        joined = {name for name, others in near.items() if others}
        for link in diagram.links:
            a, b = link.ends
            if link.is_physical is is_physical and a in near and b in near and not {a, b} <= joined:
                near[a].append(b)
                near[b].append(a)
    distance = _distances(diagram, near)
    columns: list[list[str]] = [[] for _ in range(max(distance.values(), default=-1) + 1)]
    for name in diagram.parts:
        columns[distance[name]].append(name)
    for _ in range(_SWEEPS):
        for column in columns:
            rank = {name: row - (len(names) - 1) / 2 for names in columns for row, name in enumerate(names)}
            column.sort(key=lambda name: (_mean([rank[other] for other in near[name]] or [rank[name]]), place[name]))
    return columns


def _distances(diagram: Diagram, near: Mapping[str, Sequence[str]]) -> dict[str, int]:
    """How far each part is from where the inputs enter; parts that nothing reaches stand in the first column."""
    entered = dict.fromkeys(diagram.inputs)
    starts = [part for port in entered for part in diagram.parts if _is_tied(diagram, port, part)][:1]
    distance: dict[str, int] = {}
    for start in (*starts, *diagram.parts):
        if start in distance:
            continue
        distance[start] = 0
        front = [start]
        while front:
            following = [other for name in front for other in near[name] if other not in distance]
            for name in following:
                distance.setdefault(name, max(distance[other] for other in near[name] if other in front) + 1)
            front = list(dict.fromkeys(following))
    return distance


def _is_tied(diagram: Diagram, a: str, b: str) -> bool:
    return any(set(link.ends) == {a, b} for link in diagram.links)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _width(name: str) -> float:
    return len(name) * _CHARACTER + _PADDING
