"""Systems of reference FMUs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Element, SystemStructure, Wire
from dse.system.assembly import resized

T = TypeVar("T")


def system_of(
    models: Mapping[str, FmuModel],
    wires: Sequence[str] = (),
    record: Sequence[str] = (),
    start: Mapping[str, float] | None = None,
    texts: Mapping[str, str | bytes] | None = None,
) -> SystemStructure:
    """Elements by name; wires as "a.y -> b.u" between labels or whole arrays; starts, texts and records by
    ``element.label``. Variables that are wired from or recorded become outputs."""
    ends = [wire.split(" -> ") for wire in wires]
    sources, targets = {source for source, _ in ends} | set(record), {target for _, target in ends}
    elements = []
    for name, given in models.items():
        own = _of(name, start or {})
        model = resized(given, own)
        elements.append(
            Element(
                name,
                model,
                tuple(v for v in model.variables.values() if _is_among(name, v, targets)),
                tuple(v for v in model.variables.values() if _is_among(name, v, sources)),
                own,
                _of(name, texts or {}),
            )
        )
    joined = tuple(Wire(*source.split(".", 1), *target.split(".", 1)) for source, target in ends)
    return SystemStructure("test", tuple(elements), joined)


def _of(name: str, values: Mapping[str, T]) -> dict[str, T]:
    return {key.split(".", 1)[1]: value for key, value in values.items() if key.split(".", 1)[0] == name}


def _is_among(name: str, variable: Variable, ends: set[str]) -> bool:
    return any(f"{name}.{label}" in ends for label in (variable.name, *variable.labels))
