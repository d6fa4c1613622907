"""What stands in an SSP package, as it is written there. Every noun knows its place; units are by their definitions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from dse.domain.fmu import UnitDefinition
from dse.errors import Location, Problem


@dataclass(frozen=True, slots=True)
class NamedUnit:
    """A unit as it is called; *definition* is None if the file does not define it."""

    name: str
    definition: UnitDefinition | None = None


@dataclass(frozen=True, slots=True)
class SignalType:
    """Type of a connector or of an entry of a signal dictionary.

    *name* is SSP's word: Real, Integer, Boolean, String, Enumeration, Binary, and those of FMI 3. *items* are those of
    the enumeration it names, if the file defines it.
    """

    name: str
    unit: NamedUnit | None = None
    items: Mapping[str, int] | None = None


@dataclass(frozen=True, slots=True)
class Connector:
    """One connector of a component, system or reference to a signal dictionary.

    *kind* is SSP's word (input, output, parameter, calculatedParameter, structuralParameter, constant, local, inout).
    *sizes* are those of an array's dimensions, None for one that is not said here.
    """

    name: str
    kind: str
    type: SignalType | None
    where: Location
    sizes: tuple[int | None, ...] = ()

    @property
    def gives(self) -> bool | None:
        """Whether values come from it (True) or go to it (False), as seen from beside; None if both may be."""
        if self.kind in ("output", "calculatedParameter", "constant", "local"):
            return True
        return False if self.kind in ("input", "parameter", "structuralParameter") else None


@dataclass(frozen=True, slots=True)
class Transformation:
    """What is done to a value on its way: ``factor * value + offset``, or the *entries* (source, target) of a table.

    *name* is SSP's word: LinearTransformation, BooleanMappingTransformation, IntegerMappingTransformation,
    EnumerationMappingTransformation. Values a table does not list stay as they are.
    """

    name: str
    factor: float = 1.0
    offset: float = 0.0
    entries: tuple[tuple[str, str], ...] = ()
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class End:
    """One end of a connection: a connector of an element, or of the system itself (then *element* is "").

    *indices* pick one value of an array.
    """

    element: str
    connector: str
    indices: tuple[int, ...] = ()

    def __str__(self) -> str:
        return f"{self.element}.{self.connector}" if self.element else self.connector


@dataclass(frozen=True, slots=True)
class SspConnection:
    """A connection of two connectors; which of them is the source is decided by their kinds."""

    start: End
    end: End
    where: Location
    transformation: Transformation | None = None
    suppresses_unit_conversion: bool = False

    def __str__(self) -> str:
        return f"{self.start} - {self.end}"


@dataclass(frozen=True, slots=True)
class ParameterValue:
    """One value of a parameter set; *type* is SSP's word, *values* has one text per value of an array.

    *rival* is where the set gives another value by the same name.
    """

    type: str
    values: tuple[str, ...]
    where: Location
    unit: NamedUnit | None = None
    rival: Location | None = None


@dataclass(frozen=True, slots=True)
class Assignment:
    """A value that goes, transformed, to what is called *target* in the component or system where it is bound."""

    target: str
    value: ParameterValue
    where: Location
    transformation: Transformation | None = None
    suppresses_unit_conversion: bool = False


@dataclass(frozen=True, slots=True)
class SspComponent:
    """An FMU in a system. *fmu* is the file; *implementation* is any, CoSimulation or ModelExchange."""

    name: str
    source: str
    fmu: Path
    connectors: tuple[Connector, ...]
    assignments: tuple[Assignment, ...]
    where: Location
    implementation: str = "any"

    @property
    def key(self) -> tuple[Path, str]:
        """What its FMU is opened by: the archive, and the kind of FMU that is asked for."""
        return self.fmu, self.implementation


@dataclass(frozen=True, slots=True)
class DictionaryReference:
    """A place where a system is connected to a signal dictionary."""

    name: str
    dictionary: str
    connectors: tuple[Connector, ...]
    where: Location


@dataclass(frozen=True, slots=True)
class System:
    """A system: elements, the connections between them, and its own connectors to the outside.

    *dictionaries* holds the entries of each signal dictionary by name.
    """

    name: str
    elements: tuple[SspComponent | DictionaryReference | System, ...]
    connections: tuple[SspConnection, ...]
    connectors: tuple[Connector, ...]
    assignments: tuple[Assignment, ...]
    dictionaries: Mapping[str, Mapping[str, SignalType]] = field(default_factory=dict)

    @property
    def parts(self) -> list[SspComponent | System]:
        """The elements that are no references to signal dictionaries."""
        return [element for element in self.elements if isinstance(element, SspComponent | System)]

    def element(self, name: str) -> SspComponent | DictionaryReference | System | None:
        """The element called *name*, or None."""
        return next((element for element in self.elements if element.name == name), None)


@dataclass(frozen=True, slots=True)
class ExperimentSettings:
    """What a package says of its experiment, in seconds; None for what it does not say.

    *tolerance* is what its FMUs are told in place of their own.
    """

    start: float | None = None
    stop: float | None = None
    step: float | None = None
    record_every: float | None = None
    tolerance: float | None = None


@dataclass(frozen=True, slots=True)
class SspSystem:
    """One system structure description of a package: the one called *variant* (a file name without its suffix).

    *variants* are all there are, by file name without suffix, the default one (``SystemStructure``) first, with the
    names they have inside. *notes* say what was read and is of no use here, *ignored* what should not be there at all.
    """

    name: str
    variant: str
    version: str
    system: System
    experiment: ExperimentSettings
    variants: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[Problem, ...] = ()
    ignored: tuple[Problem, ...] = ()

    @property
    def places(self) -> dict[str, SspComponent]:
        """All components by their way from the top, ``outer.inner``, those of nested systems too, in order."""
        return dict(_places(self.system, ""))


def _places(system: System, prefix: str) -> Iterator[tuple[str, SspComponent]]:
    for part in system.parts:
        if isinstance(part, SspComponent):
            yield f"{prefix}{part.name}", part
        else:
            yield from _places(part, f"{prefix}{part.name}.")
