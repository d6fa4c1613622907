"""The border of every element: its connected inputs and readable outputs as a graph of dependencies knows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from dse.cosim.binding.calls import FLOATING
from dse.cosim.wiring.wiring import Group, Wiring
from dse.domain.fmu import Variable
from dse.domain.system import Element


class Port(NamedTuple):
    """One variable at the border of an element: *place* counts its connected inputs or its readable outputs."""

    element: int
    is_output: bool
    place: int


class Border:
    """Every element's connected inputs and readable outputs, numbered as in *wiring*."""

    def __init__(self, wiring: Wiring) -> None:
        inputs, outputs = (wiring.inputs, wiring.text_inputs), (wiring.outputs, wiring.text_outputs)
        self.inputs, self.outputs = _variables(inputs), _variables(outputs)
        self.names = tuple(element.name for element in wiring.system.elements)
        self._floating: set[Port] = set()
        self.values: dict[Port, tuple[int, ...]] = {}
        """Where each output lies in the table of values, and where each input is taken from; nowhere for texts."""
        self._owner: dict[int, Port] = {}
        self._with_items: set[Port] = set()
        text_owner: dict[int, Port] = {}
        self.sources: dict[Port, tuple[Port, ...]] = {}
        """For each input, the outputs it is taken from."""
        for port, group, positions, is_text in _numbered(outputs, is_output=True):
            self.values[port] = () if is_text else positions
            (text_owner if is_text else self._owner).update(dict.fromkeys(positions, port))
            if group.type in FLOATING:
                self._floating.add(port)
        for port, group, positions, is_text in _numbered(inputs, is_output=False):
            self.values[port] = () if is_text else positions
            owner = text_owner if is_text else self._owner
            self.sources[port] = tuple(dict.fromkeys(owner[at] for at in positions))
            if group.type in FLOATING:
                self._floating.add(port)
            if _has_items(wiring.system.elements[port.element], group):
                self._with_items.add(port)

    def variable(self, port: Port) -> Variable:
        """The variable behind *port*."""
        return (self.outputs if port.is_output else self.inputs)[port.element][port.place]

    def label(self, port: Port) -> str:
        """``element.variable``."""
        return f"{self.names[port.element]}.{self.variable(port).name}"

    def is_floating(self, port: Port) -> bool:
        """Whether the variable is a floating-point number."""
        return port in self._floating

    def is_real(self, port: Port) -> bool:
        """Whether the variable is a number that changes continuously."""
        return port in self._floating and self.variable(port).variability in ("", "continuous")

    def moves(self, port: Port) -> tuple[bool, ...]:
        """For each value of an input, whether it and its source change continuously: only then it has a slope."""
        is_real = self.is_real(port) and port not in self._with_items
        return tuple(is_real and self.is_real(self._owner[position]) for position in self.values[port])


_Tables = Sequence[tuple[tuple[Group, ...], ...]]
"""Groups of numbers and of texts, element by element."""


def _variables(tables: _Tables) -> tuple[tuple[Variable, ...], ...]:
    return tuple(
        tuple(v for part in parts for group in part for v in group.variables) for parts in zip(*tables, strict=True)
    )


def _has_items(element: Element, group: Group) -> bool:
    """Whether values of inputs that are set together are looked up somewhere: then there is nothing in between."""
    conversions = [element.conversions[v.name] for v in group.variables if v.name in element.conversions]
    return any(conversion is not None and conversion.items for conversion in (*conversions, *group.transforms))


def _numbered(tables: _Tables, *, is_output: bool) -> Iterator[tuple[Port, Group, tuple[int, ...], bool]]:
    for e, parts in enumerate(zip(*tables, strict=True)):
        place = 0
        for number, part in enumerate(parts):
            for group in part:
                first = 0
                for variable in group.variables:
                    positions = group.positions[first : first + variable.size]
                    yield Port(e, is_output, place), group, positions, number == 1
                    place, first = place + 1, first + variable.size
