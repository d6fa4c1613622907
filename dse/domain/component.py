"""Interfaces, ports, parameters and components."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

from dse.domain.labels import is_part, wholes
from dse.errors import Location
from dse.units import DIMENSIONLESS, Quantity, Unit, coherent, counts_otherwise

Value = float | int | bool | str
"""A value of a port or parameter: SI number, truth value, an enumeration item's name, a text, or hexadecimal digits."""


class Causality(StrEnum):
    """Direction of a port, seen from the component."""

    INPUT = "input"
    OUTPUT = "output"


class Kind(StrEnum):
    """What values a port or parameter takes."""

    REAL = "real"
    INTEGER = "int"
    BOOLEAN = "bool"
    ENUMERATION = "enum"
    TEXT = "string"
    """Of a parameter it is the same for all runs of a study."""
    BINARY = "binary"
    """Bytes; of ports only."""

    @property
    def is_number(self) -> bool:
        """Whether values are numbers to the master: these can be recorded and measured."""
        return self not in (Kind.TEXT, Kind.BINARY)


@dataclass(frozen=True, slots=True)
class Type:
    """Type of a port or parameter; *items* name an enumeration's values 0, 1, …; *media* says what is in a binary."""

    kind: Kind
    unit: Unit = DIMENSIONLESS
    items: tuple[str, ...] = ()
    media: str = ""

    def __str__(self) -> str:
        if self.kind is Kind.ENUMERATION:
            return f"enum[{', '.join(self.items)}]"
        if self.kind is Kind.REAL:
            return str(self.unit) or "1"
        return f"{self.kind}[{self.media}]" if self.media else str(self.kind)

    @property
    def in_si(self) -> Type:
        """The same in the coherent unit of its dimension."""
        return replace(self, unit=coherent(self.unit))


def same_signal(source: Type, target: Type) -> str:
    """Why a connection between the two types is wrong, or "" if it is right."""
    if source.kind is not target.kind:
        return f"types differ: {source} and {target}"
    if source.kind is Kind.ENUMERATION and source.items != target.items:
        return f"types differ: {source} and {target}"
    if source.kind is Kind.REAL and source.unit.dimension != target.unit.dimension:
        return f"units differ: {source} and {target}"
    if source.kind is Kind.REAL and counts_otherwise(source.unit.symbol, target.unit.symbol):
        return f"units differ by 2 pi: {source} and {target}"
    if not same_media(source.media, target.media):
        return f"the binaries differ in what they hold: {source.media} and {target.media}"
    return ""


def same_media(one: str, other: str) -> bool:
    """Whether two media types (RFC 2045) do not contradict each other; what only one of them says is free."""
    if not one or not other or OCTETS in (one, other):
        return True
    (first, mine), (second, theirs) = (_media(text) for text in (one, other))
    return first == second and all(theirs.get(name, value) == value for name, value in mine.items())


OCTETS = "application/octet-stream"
"""The media type that says nothing."""


def _media(text: str) -> tuple[str, dict[str, str]]:
    word, *parameters = (part.strip() for part in text.split(";"))
    pairs = (parameter.partition("=") for parameter in parameters)
    return word.lower(), {name.strip().lower(): value.strip() for name, _, value in pairs}


def as_number(value: Value, type_: Type) -> float:
    """*value* as an FMU is given it: 0/1 for truth values, an item's number for items. Not for texts."""
    if type_.kind is Kind.ENUMERATION and isinstance(value, str):
        return float(type_.items.index(value))
    return float(value)


@dataclass(frozen=True, slots=True)
class Port:
    """One signal. A dotted name belongs to a group of ports, one with indices to an array: ``targets[2].gap``."""

    name: str
    causality: Causality
    type: Type


@dataclass(frozen=True, slots=True)
class Interface:
    """A named set of ports that alternatives share.

    *optional* are inputs that need no source, or groups and arrays of them: they stay as a component starts them.
    """

    name: str
    ports: tuple[Port, ...]
    where: Location | None = None
    optional: tuple[str, ...] = ()
    _by_name: Mapping[str, Port] = field(default_factory=dict, init=False, repr=False, compare=False)
    _parts: Mapping[str, tuple[Port, ...]] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_by_name", {port.name: port for port in reversed(self.ports)})
        parts: dict[str, list[Port]] = {}
        for port in self.ports:
            for whole in wholes(port.name):
                parts.setdefault(whole, []).append(port)
        object.__setattr__(self, "_parts", {whole: tuple(ports) for whole, ports in parts.items()})

    def port(self, name: str) -> Port | None:
        """The port called *name*, or None."""
        return self._by_name.get(name)

    def group(self, prefix: str) -> tuple[Port, ...]:
        """The port called *prefix* or, if it names a group or an array, all ports in it, in order."""
        port, parts = self._by_name.get(prefix), self._parts.get(prefix, ())
        return (port, *parts) if port else parts

    def needs(self, port: str) -> bool:
        """Whether the input *port* must have a source."""
        return not any(is_part(port, whole) for whole in self.optional)


NO_INTERFACE = Interface("", ())
"""What a component that implements no interface has: no ports, so that nothing can be connected to it."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value a simulation can be given. *start*, *minimum* and *maximum* are SI numbers (or bool, or item).

    A *random* one is a seed: each run gives it a value of its own (`dse.domain.noise`) where nobody else does.
    """

    name: str
    type: Type
    start: Value
    minimum: float | None = None
    maximum: float | None = None
    tunable: bool = True
    title: str = ""
    where: Location | None = None
    random: bool = False


class Source:
    """Where a component's behaviour comes from. Each kind of component has a noun of its own that derives from this.

    Other rooms ask it what they have to know; what is done with it, its `ComponentKind` knows.
    """

    __slots__ = ()

    is_finished: bool = False
    """Whether it is an FMU already, made elsewhere: nothing is built, and nothing is known of what is inside."""

    takes_texts: bool = False
    """Whether parameters may be texts."""

    @property
    def kind(self) -> str:
        """The word that selects its kind, as in ``source: {kind: …}``."""
        raise NotImplementedError

    @property
    def label(self) -> str:
        """The kind as people call it."""
        return self.kind

    @property
    def sample_time(self) -> float | None:
        """Seconds from one step of sampled code to the next; None for what is not sampled."""
        return None

    @property
    def is_exact(self) -> bool:
        """Whether somebody vouches for its results having no error of their own."""
        return False

    @property
    def interface(self) -> tuple[str, Location | None] | None:
        """How its FMU is to be simulated, as FMI spells it, and where that is said; None for the usual way."""
        return None

    @property
    def special(self) -> Mapping[str, Location]:
        """What else is asked for in the way its FMU is simulated (`dse.domain.fmu.Special`), and where that is said."""
        return {}


@dataclass(frozen=True, slots=True)
class CSource(Source):
    """A component written in C99: a struct, ``init`` and ``step``; it knows nothing of FMI.

    Ports live in the struct as ``in.<port>`` and ``out.<port>``, parameters as ``par.<parameter>`` (dots
    are nested structs). With *step* the code is sampled: ``void step(T *)`` runs every *step* seconds.
    Without it the code is a plant: ``void step(T *, double h)`` runs once per communication step.
    With a *partner*, a module of dse, a process of its own does the work (dse/fmu/runtime/partner.h), with *resources*
    by name: ``init`` and ``step`` fill the array ``ask``, and ``void <struct>_take(T *)`` empties ``answer``. What is
    asked goes out as a datagram if the component *is_live* (dse/fmu/runtime/udp.h), or to a library that the component
    holds as bytes if it *is_coded* (dse/fmu/runtime/coded.h).
    """

    kind = "c"
    label = "C"

    files: tuple[Path, ...]
    header: Path
    struct: str
    init: str
    step_function: str
    step: float | None
    partner: str = ""
    resources: tuple[tuple[str, bytes], ...] = field(default=(), repr=False)
    is_live: bool = False
    is_coded: bool = False

    @property
    def sample_time(self) -> float | None:
        """The *step*."""
        return self.step


class ModelicaCompiler(StrEnum):
    """What turns a Modelica model into an FMU."""

    AUTO = "auto"
    """dse's own back-end, and OpenModelica for what it refuses, if this machine has it."""
    RUMOCA = "rumoca"
    OMC = "omc"


class Solver(StrEnum):
    """How the differential equations inside a component are integrated."""

    AUTO = "auto"
    EXPLICIT = "explicit"
    STIFF = "stiff"


@dataclass(frozen=True, slots=True)
class ModelicaSource(Source):
    """A Modelica model by its full name, in *files*: Modelica files or folders that hold a ``package.mo``.

    *roots* are folders of libraries outside of the workspace. *tolerance* is relative; None is the model's default.
    """

    kind = "modelica"
    label = "Modelica"

    model: str
    files: tuple[Path, ...] = ()
    roots: tuple[Path, ...] = ()
    compiler: ModelicaCompiler = ModelicaCompiler.AUTO
    solver: Solver = Solver.AUTO
    tolerance: float | None = None


@dataclass(frozen=True, slots=True)
class Component:
    """One part that can be chosen. *names* maps a port, group, array or parameter to what its FMU calls it.

    Without a *source* it can be counted and listed, not simulated; only then its interface may be `NO_INTERFACE`.
    """

    name: str
    interface: Interface
    title: str = ""
    source: Source | None = None
    parameters: tuple[Parameter, ...] = ()
    properties: Mapping[str, Quantity] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)
    where: Location | None = None

    def parameter(self, name: str) -> Parameter | None:
        """The parameter called *name*, or None."""
        return next((p for p in self.parameters if p.name == name), None)

    def variable(self, name: str) -> str:
        """Name of the FMU variable behind the port or parameter *name*."""
        if name in self.names or not self.names:
            return self.names.get(name, name)
        whole = next((whole for whole in wholes(name) if whole in self.names), "")
        return self.names[whole] + name[len(whole) :] if whole else name
