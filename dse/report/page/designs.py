"""What the page needs beside the runs to compare designs: properties, objectives, and what each is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dse.analysis import is_price
from dse.domain.diagram import Diagram, Link
from dse.pictures import ComponentLayout, lay_out
from dse.report.content.data import ConfigurationEntry, Floats, ReportContent
from dse.report.page.encoding import Block
from dse.units import parse_unit, short_symbol

Json = dict[str, object]

MOST_PICTURES = 300
"""Ways in which parts hang together that are laid out; a design that hangs together otherwise has no picture."""


def designs_of(content: ReportContent, columns: Block) -> Json:
    """The entries of the document; one number per configuration and property go into *columns*."""
    units = _units(content.configurations)
    for index, (name, unit) in enumerate(units.items()):
        columns.add(f"property.{index}", "f8", _values(content.configurations, name, unit))
    for index, composite in enumerate(content.composites):
        columns.add(f"composite.{index}", "f8", composite.values)
    metrics = [metric.name for metric in content.metrics]
    composites = [composite.name for composite in content.composites]
    places = {
        **{(name, False): f"composite.{index}" for index, name in enumerate(composites)},
        **{(name, False): f"metric.{index}" for index, name in enumerate(metrics)},
        **{(name, True): f"property.{index}" for index, name in enumerate(units)},
    }
    known = [entry for entry in content.objectives if (entry.name, entry.is_property) in places]
    return {
        "properties": [
            {"name": name, "title": name.replace("_", " "), "unit": short_symbol(unit), "isPrice": is_price(unit)}
            for name, unit in units.items()
        ],
        "composites": [{"name": c.name, "title": c.title, "unit": c.unit_symbol} for c in content.composites],
        "objectives": [{"column": places[o.name, o.is_property], "maximize": o.maximize} for o in known],
        **_architectures(content.configurations),
    }


def _units(configurations: Sequence[ConfigurationEntry]) -> dict[str, str]:
    """Each property in the unit that the first configuration gives it in."""
    units: dict[str, str] = {}
    for configuration in configurations:
        for name, given in configuration.properties.items():
            units.setdefault(name, given.unit_symbol)
    return units


def _values(configurations: Sequence[ConfigurationEntry], name: str, unit: str) -> Floats:
    """One number per configuration in *unit*, NaN where it has no such property."""
    found = [configuration.properties.get(name) for configuration in configurations]
    values = [
        np.nan
        if each is None
        else each.value
        if each.unit_symbol == unit
        else _converted(each.value, each.unit_symbol, unit)
        for each in found
    ]
    return np.array(values, dtype=np.float64)


def _converted(value: float, given: str, wanted: str) -> float:
    return parse_unit(wanted).from_si(parse_unit(given).to_si(value))


def _architectures(configurations: Sequence[ConfigurationEntry]) -> Json:
    """Layouts, which configurations of the same parts and links share, and the parts' components by configuration."""
    shapes: dict[object, list[int]] = {}
    for index, configuration in enumerate(configurations):
        if configuration.parts:
            shapes.setdefault((tuple(configuration.parts), configuration.links), []).append(index)
    pictures: list[Json] = []
    of = [-1] * len(configurations)
    for members in list(shapes.values())[:MOST_PICTURES]:
        for index in members:
            of[index] = len(pictures)
        pictures.append(_picture([configurations[index] for index in members]))
    components = sorted({name for entry in configurations for name in entry.parts.values()})
    code = {name: index for index, name in enumerate(components)}
    return {
        "pictures": pictures,
        "pictureOf": of,
        "components": components,
        "partsOf": [[code[name] for name in entry.parts.values()] for entry in configurations],
    }


def _picture(members: Sequence[ConfigurationEntry]) -> Json:
    first = members[0]
    links = tuple(Link(ends, is_physical=False) for ends in first.links)
    layout = lay_out(Diagram(tuple(first.parts), links=links), (), (), "", _labels(first.parts, members))
    return {
        "parts": _boxes(first.parts, layout),
        "links": _links(first),
        "width": layout.width,
        "height": layout.height,
    }


def _labels(parts: Mapping[str, str], members: Sequence[ConfigurationEntry]) -> dict[str, str]:
    """The longest text that any of *members* has in a part: they share its box."""
    return {path: max((path, *(each.parts[path] for each in members)), key=len)[:_LONGEST] for path in parts}


_LONGEST = 26


def _boxes(parts: Mapping[str, str], layout: ComponentLayout) -> list[list[object]]:
    boxes = ((path, layout.parts[path]) for path in parts)
    return [[path, round(box.x), round(box.middle), round(box.width)] for path, box in boxes]


def _links(entry: ConfigurationEntry) -> list[list[int]]:
    place = {path: index for index, path in enumerate(entry.parts)}
    return [[place[a], place[b]] for a, b in entry.links]
