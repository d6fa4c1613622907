"""The bench's algorithm, which speaks of parts and ports, for one configuration's elements and variables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TypeVar

from dse.domain.component import Component
from dse.domain.design import split_path
from dse.domain.method import Bond, Method
from dse.errors import Problem
from dse.testbench.wired_bench import WiredBench

V = TypeVar("V")


def method_of(wired: WiredBench, problems: list[Problem]) -> Method:
    """The bench's method with the names of elements and their variables.

    What is said of an architecture holds for all parts in it; what is said of a part of its own goes before. Parts
    and bonds that the configuration does not have are left out. A bond whose ends are there but not wired to each
    other's part is added to *problems*.
    """
    method, parts = wired.bench.simulation.method, wired.parts
    bonds = (_bond(bond, wired, problems) for bond in method.bonds)
    return replace(
        method,
        steps=_of_parts(method.steps, parts),
        extrapolations=_of_parts(method.extrapolations, parts),
        bonds=tuple(bond for bond in bonds if bond is not None),
    )


def signal_name(name: str, parts: Mapping[str, Component]) -> str:
    """``part.port`` as ``element.variable``; KeyError if no part stands there."""
    split = split_path(name, parts)
    if split is None:
        raise KeyError(name)
    return f"{split[0]}.{parts[split[0]].variable(split[1])}"


def _of_parts(values: Mapping[str, V], parts: Iterable[str]) -> dict[str, V]:
    found: dict[str, V] = {}
    for part in parts:
        said = [path for path in values if part == path or part.startswith(f"{path}.")]
        if said:
            found[part] = values[max(said, key=len)]
    return found


def _bond(bond: Bond, wired: WiredBench, problems: list[Problem]) -> Bond | None:
    ends = [wired.faces.get(name, name) for name in (bond.effort, bond.flow)]
    ports = wired.ports
    if not all(end in ports for end in ends):
        return None
    (effort, _), (flow, _) = (ports[end] for end in ends)
    for end, other in zip(ends, (flow, effort), strict=True):
        if not any(c.source == end and c.target.startswith(f"{other}.") for c in wired.connections):
            what = f"bond '{bond.name}': {end} is not connected to {other}"
            hint = "effort and flow of a bond are each an input of the other's part"
            problems.append(Problem(what, wired.bench.simulation.where, hint))
            return None
    return Bond(bond.name, signal_name(ends[0], wired.parts), signal_name(ends[1], wired.parts))
