"""A component as an SVG picture: its ports with their units, and for a Modelica model the parts it is made of."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from xml.sax.saxutils import escape

from dse.domain.component import Causality, Component, Port
from dse.domain.diagram import Diagram
from dse.domain.labels import folded
from dse.loading import kind_of
from dse.pictures.component_layout import ComponentLayout, lay_out
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
