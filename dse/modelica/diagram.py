"""What a Modelica model is made of, read from its flattened equations."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

from dse.domain.component import Component, ModelicaSource
from dse.domain.diagram import Diagram, Link
from dse.modelica.flatten.document import records
from dse.modelica.frontend.compile import compile_model
from dse.modelica.frontend.sources import read_sources


def read_diagram(component: Component, source: ModelicaSource) -> Diagram:
    """The diagram of the model behind *component*. Raises DseError with all that the front-end refuses."""
    sources = read_sources(component.name, source.model, source.files, source.roots, component.where)
    return _diagram(compile_model(sources).flat)


def _diagram(flat: Mapping[str, Any]) -> Diagram:
    """The diagram of a flattened model, as the front-end's stage ``flat`` tells it."""
    names = {
        name: variable
        for name, variable in flat["variables"].items()
        if not _is_word(variable["variability"], "Parameter", "Constant")
    }
    parts = tuple(dict.fromkeys(_first(name) for name in names if "." in name))
    inputs = tuple(name for name in names if "." not in name and _is_word(names[name]["causality"], "Input"))
    outputs = tuple(name for name in names if "." not in name and _is_word(names[name]["causality"], "Output"))
    links: dict[tuple[str, str], bool] = {}
    known = set(parts)
    for ends, is_physical in _ties(flat, names):
        # Parts that only contribute to one quantity of the whole do not know of each other.
        is_sum = not is_physical and not known.issuperset(ends)
        for pair in combinations(sorted(ends), 2):
            if not (is_sum and known.issuperset(pair)):
                links[pair] = links.get(pair, False) or is_physical
    shown = {*parts, *inputs, *outputs}
    _bridge(links, {name for pair in links for name in pair} - shown, {*inputs, *outputs})
    kept = sorted((pair, is_physical) for pair, is_physical in links.items() if shown.issuperset(pair))
    return Diagram(parts, inputs, outputs, tuple(Link(pair, is_physical) for pair, is_physical in kept))


def _ties(flat: Mapping[str, Any], names: Mapping[str, Any]) -> Iterator[tuple[set[str], bool]]:
    """Sets of parts, ports and other top-level variables that one equation ties together."""
    for equation in flat["equations"]:
        (origin, said), *_ = equation["origin"].items()
        if origin == "Connection":
            ends = (said["lhs"], said["rhs"])
            yield {_first(end) for end in ends}, any(end.count(".") > 1 for end in ends)
        elif origin != "FlowSum":
            yield {_first(name) for name in _references(equation["residual"]) if name in names}, False
    for name, variable in names.items():
        if variable["binding"] is not None:
            others = {_first(other) for other in _references(variable["binding"]) if other in names}
            yield others | {_first(name)}, False


def _bridge(links: dict[tuple[str, str], bool], hidden: set[str], ports: set[str]) -> None:
    """Tie a port to the parts that it reaches through a variable that is not shown."""
    for name in sorted(hidden):
        around = sorted({end for pair in links if name in pair for end in pair} - {name})
        for pair in combinations(around, 2):
            if len(ports.intersection(pair)) == 1:
                links.setdefault((pair[0], pair[1]), False)


def _references(tree: object) -> Iterator[str]:
    """The names of variables in an expression."""
    return (re.sub(r"\[[^]]*\]$", "", one["VarRef"]["name"]["name"]) for one in records(tree) if "VarRef" in one)


def _first(name: str) -> str:
    return name.split(".", 1)[0]


def _is_word(value: object, *words: str) -> bool:
    """Whether the front-end's tagged *value* is one of *words*."""
    return (isinstance(value, Mapping) and not set(words).isdisjoint(value)) or value in words
