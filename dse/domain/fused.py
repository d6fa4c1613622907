"""A system whose components are one library with the connections compiled in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from dse.domain.method import Algorithm
from dse.domain.system import Element, SystemStructure


@dataclass(frozen=True, slots=True)
class FusedLibrary:
    """The library at *path* simulates *system* by *algorithm* and records *record*, in this order.

    *prefixes* says for each element, by name, what stands before the names of its FMI functions there. Start values
    are not compiled in: a system that differs in nothing else is simulated by the same library.
    """

    path: Path
    system: SystemStructure
    record: tuple[str, ...]
    prefixes: Mapping[str, str]
    algorithm: Algorithm = Algorithm.JACOBI

    def difference(self, system: SystemStructure, record: Sequence[str]) -> str:
        """What *system* and *record* have that was not fused, in words; "" if the library simulates them."""
        if [e.name for e in system.elements] != [e.name for e in self.system.elements]:
            return "other elements"
        for element, fused in zip(system.elements, self.system.elements, strict=True):
            if _compiled_in(element) != _compiled_in(fused):
                return f"another '{element.name}'"
        if system.wires != self.system.wires:
            return "other wires"
        return "other outputs to record" if tuple(record) != self.record else ""

    def applied(self, system: SystemStructure) -> SystemStructure:
        """*system* with the FMI functions of this library. The library must be one that simulates it."""
        elements = (
            replace(element, model=replace(element.model, library=self.path, prefix=self.prefixes[element.name]))
            for element in system.elements
        )
        return replace(system, elements=tuple(elements))


def _compiled_in(element: Element) -> tuple[object, ...]:
    model = element.model
    return model.content_hash, model.version, model.token, element.inputs, element.outputs
