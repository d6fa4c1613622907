"""What a reference FMU is made of, said once: its description and its C tables are both generated from this."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from math import prod

FMI2_TYPES = {"Float64": "Real", "Int32": "Integer", "Enumeration": "Enumeration", "Boolean": "Boolean"} | {
    "String": "String"
}


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit in terms of the base units; *exponents* by the attribute names of FMI's BaseUnit."""

    name: str
    exponents: Mapping[str, int]
    factor: float = 1.0


@dataclass(frozen=True, slots=True)
class Declared:
    """A variable in the words of FMI 3; FMI 1 and 2 take what they know of it.

    *shape* holds numbers and names of structural parameters. *depends* names what the variable depends on, None for
    everything. *initial* is exact (settable, has a start), calculated, or "" where FMI gives no choice.
    """

    name: str
    type: str
    causality: str = "local"
    variability: str = "continuous"
    initial: str = ""
    start: tuple[str, ...] = ()
    shape: tuple[int | str, ...] = ()
    derivative_of: str = ""
    depends: tuple[str, ...] | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    unit: str = ""
    nominal: float | None = None
    minimum: float | None = None
    description: str = ""

    @property
    def has_start(self) -> bool:
        return self.initial == "exact" or self.causality in {"input", "parameter", "structuralParameter"}

    @property
    def symbol(self) -> str:
        """The field that holds it in C."""
        return self.name.replace("(", "_").replace(")", "")


@dataclass(frozen=True, slots=True)
class ReferenceModel:
    """A model: variables in the order of their references (from 0), its solver's step and what the FMU contains."""

    name: str
    variables: tuple[Declared, ...]
    stop: float
    step: float
    indicators: tuple[str, ...] = ()
    event_mode: bool = False
    partial_derivatives: bool = False
    resources: Mapping[str, bytes] = field(default_factory=dict)
    units: tuple[Unit, ...] = ()
    description: str = ""

    def variable(self, name: str) -> Declared:
        return next(v for v in self.variables if v.name == name)

    def sizes(self, variable: Declared) -> tuple[int, ...]:
        """The sizes of *variable*'s dimensions as they are before any structural parameter is set."""
        return tuple(s if isinstance(s, int) else int(self.variable(s).start[0]) for s in variable.shape)


@dataclass(frozen=True, slots=True)
class Numbered:
    """A variable of one version of an FMU: where it is found and, for a single value of an array, which one it is."""

    declared: Declared
    reference: int
    index: int = 0


def numbered(model: ReferenceModel, version: int) -> tuple[Numbered, ...]:
    """The variables as *version* knows them: FMI 1 and 2 have no arrays (one variable per value) and fewer types."""
    if version == 3:
        return tuple(Numbered(v, reference) for reference, v in enumerate(model.variables))
    found: list[Numbered] = []
    for variable in model.variables:
        unknown = variable.causality == "structuralParameter" or (version == 1 and variable.causality == "independent")
        if unknown or variable.type not in FMI2_TYPES:
            continue
        found += [Numbered(v, len(found) + i, i) for i, v in enumerate(_scalars(model, variable))]
    return tuple(found)


def _scalars(model: ReferenceModel, variable: Declared) -> tuple[Declared, ...]:
    if not variable.shape:
        return (variable,)
    sizes = model.sizes(variable)
    starts = variable.start if len(variable.start) > 1 else variable.start * prod(sizes)
    # der(x)[1] would not be a name of a derivative: FMI's structured names have the index inside.
    stem, end = (variable.name[:-1], ")") if variable.name.startswith("der(") else (variable.name, "")
    return tuple(
        replace(
            variable,
            name=f"{stem}[{','.join(str(i + 1) for i in index)}]{end}",
            shape=(),
            start=(starts[k],) if starts else (),
        )
        for k, index in enumerate(product(*map(range, sizes)))
    )
