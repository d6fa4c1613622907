"""The border of every element: its connected inputs and readable outputs as a graph of dependencies knows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from dse.cosim.wiring.wiring import VariableGroup, Wiring
from dse.domain.fmu import Variable


class ElementPort(NamedTuple):
    """One variable at the border of an element: *number* counts its connected inputs or its readable outputs."""

    element: int
    is_output: bool
    number: int


class _Signal(NamedTuple):
    """What stands behind a port; *positions* are in the table of texts if it *is_text*."""

    variable: Variable
    group: VariableGroup
    positions: tuple[int, ...]
    is_text: bool


class Border:
    """Every element's connected inputs and readable outputs, numbered as in *wiring*.

    Strings and binaries that belong to clocks are not among them: they are messages of an instant.
    """

    def __init__(self, wiring: Wiring) -> None:
        self._elements = wiring.system.elements
        outputs = dict(_numbered((wiring.outputs, wiring.text_outputs), is_output=True))
        inputs = dict(_numbered((wiring.inputs, wiring.text_inputs), is_output=False))
        self._signals = outputs | inputs
        self.inputs: list[list[ElementPort]] = [[] for _ in self._elements]
        self.outputs: list[list[ElementPort]] = [[] for _ in self._elements]
        for port in self._signals:
            (self.outputs if port.is_output else self.inputs)[port.element].append(port)
        self.values = {port: () if signal.is_text else signal.positions for port, signal in self._signals.items()}
        """Where each output lies in the table of values, and where each input is taken from; nowhere for texts."""
        self._owner = {(signal.is_text, at): port for port, signal in outputs.items() for at in signal.positions}
        self.sources = {
            port: tuple(
                dict.fromkeys(self._owner[at] for n in signal.positions if (at := (signal.is_text, n)) in self._owner)
            )
            for port, signal in inputs.items()
        }
        """For each input, the outputs it is taken from."""

    def variable(self, port: ElementPort) -> Variable:
        """The variable behind *port*."""
        return self._signals[port].variable

    def label(self, port: ElementPort) -> str:
        """``element.variable``."""
        return f"{self._elements[port.element].name}.{self.variable(port).name}"

    def is_clocked(self, port: ElementPort) -> bool:
        """Whether the variable is read or written only while a clock ticks, after the initialization."""
        return self._signals[port].group.is_clocked

    @property
    def floating_outputs(self) -> list[ElementPort]:
        """Outputs that are floating-point numbers, in order."""
        return [port for part in self.outputs for port in part if self._signals[port].group.type.is_floating]

    @property
    def real_outputs(self) -> list[ElementPort]:
        """Outputs that are numbers that change continuously, in order."""
        return [port for part in self.outputs for port in part if self.is_real(port)]

    def is_real(self, port: ElementPort) -> bool:
        """Whether the variable is a number that changes continuously."""
        signal = self._signals[port]
        return signal.group.type.is_floating and signal.variable.variability in ("", "continuous")

    def moves(self, port: ElementPort) -> tuple[bool, ...]:
        """For each value of an input, whether it and its source change continuously: only then it has a slope."""
        group = self._signals[port].group
        # What is looked up among items has nothing in between.
        is_real = self.is_real(port) and not group.has_items(self._elements[port.element])
        return tuple(is_real and self.is_real(self._owner[False, position]) for position in self.values[port])


def _numbered(
    tables: Sequence[Sequence[Sequence[VariableGroup]]], *, is_output: bool
) -> Iterator[tuple[ElementPort, _Signal]]:
    """*tables* are groups of numbers and of texts, element by element."""
    for e, parts in enumerate(zip(*tables, strict=True)):
        number = 0
        for is_text, part in zip((False, True), parts, strict=True):
            for group in part:
                first = 0
                for variable in group.variables:
                    positions = group.positions[first : first + variable.size]
                    if not (is_text and group.is_clocked):
                        yield ElementPort(e, is_output, number), _Signal(variable, group, positions, is_text)
                    number, first = number + 1, first + variable.size
