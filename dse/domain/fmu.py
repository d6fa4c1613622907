"""FMUs as the rest of the program sees them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import prod
from pathlib import Path

from dse.domain.component import Kind
from dse.domain.labels import element_names
from dse.errors import Problem


class FmiInterface(StrEnum):
    """How an FMU is simulated, as FMI spells it."""

    CO_SIMULATION = "CoSimulation"
    MODEL_EXCHANGE = "ModelExchange"

    @property
    def word(self) -> str:
        """As files of a workspace spell it: ``model_exchange``."""
        return self.name.lower()


class ClockKind(StrEnum):
    """When a clock ticks, as FMI spells it (intervalVariability)."""

    CONSTANT = "constant"
    FIXED = "fixed"
    TUNABLE = "tunable"
    CHANGING = "changing"
    COUNTDOWN = "countdown"
    TRIGGERED = "triggered"


@dataclass(frozen=True, slots=True)
class Timing:
    """When a clock ticks (FMI 3.0.2, 2.2.8).

    If *is_told*, tick n of a periodic clock is at ``(shift + n*interval)/resolution`` seconds, exactly if these are
    whole numbers; else the FMU is asked. *has_fractions*: it may be asked for whole numbers.
    """

    kind: ClockKind
    is_told: bool = False
    interval: float = 0.0
    shift: float = 0.0
    resolution: float = 1.0
    has_fractions: bool = False


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of an FMU: how it is addressed and typed.

    *fmi_type* names the accessor: ``Real``, ``Integer``, ``Boolean``, ``String`` (FMI 1 and 2; enumerations are
    ``Integer``) or ``Float64``, ``Float32``, ``Int8`` … ``UInt64``, ``Boolean``, ``String``, ``Binary``, ``Clock``
    (FMI 3; enumerations are ``Int64``). *kind* is None for strings, binaries and clocks. *causality* and *variability*
    are FMI's words (input, output, parameter, calculatedParameter, structuralParameter, local, independent; constant,
    fixed, tunable, discrete, continuous), "" for what is not said. *unit* is as the FMU spells it, "" for none.

    *shape* holds the sizes of an array's dimensions, () for a scalar; *sized_by* names the structural parameter behind
    each of them, "" for a fixed one. *items* are an enumeration's items with the values the FMU gives them. *start*
    holds one text per value (Binary: hexadecimal digits), or a single one for all, or none.

    *alias_of* names the variable this is another name of (FMI 1 and 3; FMI 2 does not say, but of inputs it is known).
    *is_negated*: the value is the opposite of that behind the reference (FMI 1). *is_relative*: a difference, to which
    a unit's offset does not apply. *is_intermediate*: it may be used while a step is computed (FMI 3). *clocks* are the
    references of the clocks it belongs to, *timing* is there for a clock. *media* says what is in a binary.

    *integers*: a binary of FMI 2, which has none, as the OSI Sensor Model Packaging (OSMP) passes it: the names and
    references of the integers for the lower and the upper half of its address, and for its size.

    *is_settable*: it takes a value to begin with; what is constant, or computed by the FMU, takes none.
    """

    name: str
    reference: int
    fmi_type: str
    causality: str
    kind: Kind | None
    unit: str = ""
    start: tuple[str, ...] = ()
    variability: str = ""
    shape: tuple[int, ...] = ()
    sized_by: tuple[str, ...] = ()
    items: Mapping[str, int] = field(default_factory=dict)
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    description: str = ""
    alias_of: str = ""
    is_negated: bool = False
    is_relative: bool = False
    is_intermediate: bool = False
    clocks: tuple[int, ...] = ()
    timing: Timing | None = None
    media: str = ""
    integers: tuple[tuple[str, int], ...] = ()
    is_settable: bool = True

    @property
    def references(self) -> tuple[int, ...]:
        """The value references that its accessor is called with."""
        return tuple(reference for _, reference in self.integers) or (self.reference,)

    @property
    def is_timed(self) -> bool:
        """Whether it is a clock that ticks by itself: the FMU says when."""
        return self.timing is not None and self.causality == "input" and self.timing.kind is not ClockKind.TRIGGERED

    @property
    def size(self) -> int:
        """Number of values."""
        return prod(self.shape)

    @property
    def is_structural(self) -> bool:
        """Whether the variable is a parameter that sets sizes of arrays."""
        return self.causality == "structuralParameter"

    @property
    def is_clocked(self) -> bool:
        """Whether it has a value to show or to take only while one of its clocks ticks."""
        return bool(self.clocks)

    @property
    def labels(self) -> tuple[str, ...]:
        """A name for each value, row by row: the variable's own, or ``name[2]``, ``name[1,3]``, counted from 1."""
        return tuple(element_names(self.name, self.shape)) if self.shape else (self.name,)


@dataclass(frozen=True, slots=True)
class UnitDefinition:
    """A unit as an FMU defines it: ``factor * value + offset`` is in the coherent SI unit with these *exponents*.

    *exponents* are those of kg, m, s, A, K, mol, cd and rad, zeros left out.
    """

    factor: float = 1.0
    offset: float = 0.0
    exponents: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Capabilities:
    """What an FMU says it can do, in FMI's words; what its version does not know is False.

    In model exchange every step is possible, as the solver is ours. *can_return_early*: it may end a step before the
    time it was asked for, if that is allowed. *needs_tool*: it cannot do without another program (FMI's
    needsExecutionTool), which may be there or not.
    """

    can_handle_variable_step: bool = False
    can_save_state: bool = False
    can_interpolate_inputs: bool = False
    can_run_asynchronously: bool = False
    has_event_mode: bool = False
    can_return_early: bool = False
    provides_intermediate_update: bool = False
    provides_directional_derivatives: bool = False
    evaluates_discrete_states: bool = False
    once_per_process: bool = False
    needs_tool: bool = False


@dataclass(frozen=True, slots=True)
class Exchange:
    """What a solver has to know of an FMU for model exchange.

    *states* and *derivatives* are value references, one pair per variable (an array counts once), in the order of the
    model structure; *n_states* and *n_event_indicators* count values. *event_indicators* are those of FMI 3 by value
    reference: arrays among them change their size with structural parameters, as states do.
    """

    states: tuple[int, ...]
    derivatives: tuple[int, ...]
    n_states: int
    n_event_indicators: int
    needs_completed_step: bool = True
    event_indicators: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Experiment:
    """The FMU's default experiment; None for what it does not say. Times in seconds.

    *tolerance* is what the FMU is told when it is simulated: relative, of its own solver.
    """

    start: float | None = None
    stop: float | None = None
    step: float | None = None
    tolerance: float | None = None


@dataclass(frozen=True, slots=True)
class Host:
    """The process an FMU's library is in, if that is of another system, or that works for it: how it is started.

    *command* is () if there is none. *settings* are variables of its environment besides those of ours. What *is_wine*
    has a server outside of every sandbox.
    """

    command: tuple[str, ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)
    is_wine: bool = False


class Special(StrEnum):
    """What a component may ask for in the way its FMU is simulated."""

    NO_EVENT_MODE = "no_event_mode"
    """Co-simulation of FMI 3 without event mode, although the FMU says that it has it."""
    ISOLATED = "isolated"
    """A process of its own for each instance."""


@dataclass(frozen=True, slots=True)
class FmuModel:
    """An unpacked FMU for this platform.

    *interface* is the one it is simulated by; *exchange* is there for model exchange. *depends* maps each output to
    the inputs (and, for *initially*, also parameters) it depends on directly, by name; an output that is missing there
    depends on all of them. *units* are the FMU's own definitions by the names its variables use. *fixed_step* is set
    if steps must be whole multiples of it (seconds). *prefix* is what stands before the names of the FMI functions in
    the library (FMI 1.0: the identifier if it is ""). Where there is a *host*, *library* is a bridge to it.
    *special* holds what its component says of how it is simulated, *ignored* what of the archive was passed over. What
    *is_live* was built here of the kind udp: it exchanges datagrams with somebody outside, so that no two runs of it
    need be the same.
    """

    archive: Path
    folder: Path
    library: Path
    version: int
    identifier: str
    token: str
    variables: Mapping[str, Variable]
    capabilities: Capabilities = field(default_factory=Capabilities)
    fixed_step: float | None = None
    content_hash: str = ""
    interface: FmiInterface = FmiInterface.CO_SIMULATION
    exchange: Exchange | None = None
    depends: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    initially_depends: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    units: Mapping[str, UnitDefinition] = field(default_factory=dict)
    experiment: Experiment = field(default_factory=Experiment)
    title: str = ""
    prefix: str = ""
    host: Host = field(default_factory=Host)
    special: frozenset[Special] = frozenset()
    ignored: tuple[Problem, ...] = field(default=(), compare=False)
    is_live: bool = False
    pointers: frozenset[str] = field(default=frozenset(), init=False, compare=False)
    """The integers that are parts of binaries: addresses, which mean nothing to anybody else."""

    def __post_init__(self) -> None:
        names = frozenset(name for variable in self.variables.values() for name, _ in variable.integers)
        object.__setattr__(self, "pointers", names)

    @property
    def manner(self) -> str:
        """How it is simulated: its interface, and what is special."""
        return "-".join([self.interface, *sorted(self.special)])

    @property
    def ticks(self) -> bool:
        """Whether its clocks can be simulated."""
        return self.interface is FmiInterface.CO_SIMULATION and self.capabilities.has_event_mode

    def lets_tick(self, variable: Variable) -> bool:
        """Whether *variable* belongs to clocks of its border that are simulated: those at least that there are."""
        return (
            variable.is_clocked
            and self.ticks
            and any(
                clock.timing and clock.causality in ("input", "output") and clock.reference in variable.clocks
                for clock in self.variables.values()
            )
        )

    def variable_of(self, label: str) -> Variable:
        """The variable called *label*, or the array one of whose values is (``name[2]``); KeyError if there is none."""
        return self.variables.get(label) or self.variables[label.rpartition("[")[0]]
