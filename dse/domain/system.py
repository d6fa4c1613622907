"""A configuration on a test bench, ready to be simulated: FMUs and the wires between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from dse.domain.fmu import FmuModel, Variable


@dataclass(frozen=True, slots=True)
class Element:
    """One FMU instance in a system.

    *inputs* are the connected inputs, *outputs* those that are wired or recorded. *start* sets unconnected
    inputs and parameters before initialization, by FMU variable name: SI numbers, 0/1 for Booleans, the
    number of an enumeration's item.
    """

    name: str
    model: FmuModel
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    start: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Wire:
    """From FMU variable *source_variable* of element *source* to *target_variable* of element *target*."""

    source: str
    source_variable: str
    target: str
    target_variable: str


@dataclass(frozen=True, slots=True)
class SystemStructure:
    """Elements in stepping order and the wires between them; names are unique, every wire is type-checked."""

    name: str
    elements: tuple[Element, ...]
    wires: tuple[Wire, ...]

    def element(self, name: str) -> Element:
        """The element called *name*; KeyError if there is none."""
        for element in self.elements:
            if element.name == name:
                return element
        raise KeyError(name)
