"""A component as an SVG picture: its ports with their units, and for a Modelica model the parts it is made of."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from xml.sax.saxutils import escape

from dse.domain.component import Causality, Component, Port
from dse.domain.diagram import Diagram
from dse.domain.labels import folded
from dse.loading import kind_of
from dse.pictures.svg import Box, curve, labelled, rectangle, sheet

_MARGIN = 20.0
_BEND = 0.5
_FAR = 70.0
_DIVE = 40.0

_STYLE = """
.title { font-size: 15px; font-weight: 600; }
.note, .port { fill: #5b6875; }
.frame { fill: #f7f9fb; stroke: #2f4358; stroke-width: 1.4; }
.part rect { fill: #dfe9f3; stroke: #7d93aa; }
.physical { fill: none; stroke: #2f4358; stroke-width: 2.2; }
.signal { fill: none; stroke: #a9b6c2; stroke-width: 1.1; }
.arrow { fill: #2f4358; }
"""


def pictured(component: Component) -> Diagram:
    """The parts and links to draw *component* with. Raises DseError if its source cannot be read."""
    kind = kind_of(component)
    inside = kind.diagram(component, component.source) if kind is not None else None
    return inside or Diagram(())


def draw_component(component: Component, diagram: Diagram) -> str:
    """The picture as SVG; *diagram* has no parts where nothing is known of them."""
    ports = component.interface.ports
    labels = _labels(ports)
    inputs, outputs = (
        list(dict.fromkeys(labels[port.name] for port in ports if port.causality is causality))
        for causality in (Causality.INPUT, Causality.OUTPUT)
    )
    layout = lay_out(diagram, inputs, outputs, component.title or component.name)
    ends = {component.variable(port.name): Box(*layout.ports[labels[port.name]], 0.0, 0.0) for port in ports}
    width, height = layout.width + 2 * _MARGIN, layout.height + 2 * _MARGIN
    content = [
        f'<g transform="translate({_MARGIN:.0f} {_MARGIN:.0f})">',
        rectangle(layout.frame, 8, ' class="frame"'),
        *_heading(component, layout.frame),
        *_links(diagram, {**ends, **layout.parts}, layout.parts),
        *(labelled("part", box, name) for name, box in layout.parts.items()),
        *_ports(inputs, layout, layout.frame.x),
        *_ports(outputs, layout, layout.frame.right),
        "</g>",
    ]
    return sheet(width, height, component.name, _STYLE, content)


def _labels(ports: Sequence[Port]) -> dict[str, str]:
    """By port; those of an array share one."""
    names = folded(port.name for port in ports)
    units = {port.name: str(port.type) for port in ports}
    return {name: f"{names[name]} [{unit}]" if unit != "1" else names[name] for name, unit in units.items()}


def _heading(component: Component, frame: Box) -> Iterator[str]:
    middle = frame.x + frame.width / 2
    title = component.title or component.name
    yield f'<text class="title" text-anchor="middle" x="{middle:.1f}" y="22">{escape(title)}</text>'
    said = f"{component.name}, a {component.interface.name}" if component.interface.name else component.name
    yield f'<text class="note" text-anchor="middle" x="{middle:.1f}" y="40">{escape(said)}</text>'


def _links(diagram: Diagram, ends: Mapping[str, Box], parts: Collection[str]) -> Iterator[str]:
    # Physical ones last, so that they lie on top.
    for link in sorted(diagram.links, key=lambda link: link.is_physical):
        if all(end in ends for end in link.ends) and any(end in parts for end in link.ends):
            a, b = sorted((ends[end] for end in link.ends), key=lambda box: box.x)
            yield f'<path class="{"physical" if link.is_physical else "signal"}" d="{_path(a, b)}"/>'


def _path(a: Box, b: Box) -> str:
    """From the right edge of *a* to the left edge of *b*; far ones dive below the parts between."""
    if b.x <= a.right:  # in one column: around the right side
        out = max(a.right, b.right) + 18
        return curve((a.right, a.middle), (out, a.middle), (out, b.middle), (b.right, b.middle))
    if b.x - a.right < _FAR:
        bend = (b.x - a.right) * _BEND
        return curve((a.right, a.middle), (a.right + bend, a.middle), (b.x - bend, b.middle), (b.x, b.middle))
    start, end = _below(a), _below(b)
    below = max(start[1], end[1]) + _DIVE
    first = (start[0] + _DIVE, a.middle) if a.width == 0 else (start[0], below)
    last = (end[0] - _DIVE, b.middle) if b.width == 0 else (end[0], below)
    return curve(start, first, last, end)


def _below(box: Box) -> tuple[float, float]:
    """The middle of a part's lower edge; a port's point."""
    return box.x + box.width / 2, box.middle + box.height / 2


def _ports(labels: list[str], layout: ComponentLayout, edge: float) -> Iterator[str]:
    is_left = edge == layout.frame.x
    for label in labels:
        x, middle = layout.ports[label]
        tip = x if is_left else x + 9
        yield f'<path class="arrow" d="M{tip:.1f} {middle:.1f} l-9 -4.5 v9 z"/>'
        anchor, at = ("end", x - 14) if is_left else ("start", x + 14)
        yield f'<text class="port" text-anchor="{anchor}" x="{at:.1f}" y="{middle + 4:.1f}">{escape(label)}</text>'


# Where the parts and ports of a component stand in its picture: inputs left, outputs right, parts in columns between.
#
# The column of a part is its distance from the parts that the first input reaches; within a column parts stand in the
# order of what they hang on to (Sugiyama, Tagawa and Toda 1981: layers and barycentres).


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
