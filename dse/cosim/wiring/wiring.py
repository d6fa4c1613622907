"""A system as positions in one table of values: where each output lies and where each input takes its value from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from dse.cosim.binding.calls import AccessorType, text_type_of, type_of
from dse.cosim.wiring.clocks import Clocks, clocks_of
from dse.cosim.wiring.links import Link, clock_wires, link_problems, links_of
from dse.domain.fmu import FmiInterface, FmuModel, Special, Variable
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import Problem, raise_if_any


@dataclass(frozen=True, slots=True)
class VariableGroup:
    """Variables of one element that one accessor call reads or writes.

    *positions*, one per value (row by row where variables are arrays), say where outputs lie in the table of values,
    where in it inputs take their values from, and where starts lie in the table of start values. Outputs and starts
    lie one after another, group by group. Strings and binaries have a table of their own. *transforms* is what wires
    do to each value on its way to an input, () for nothing at all. *is_discrete* is set for inputs that an FMU with
    events takes in event mode only, *moves* for those that may follow a slope within a step. *is_clocked* is set
    for one variable that is read or written only while a clock ticks.
    """

    type: AccessorType
    variables: tuple[Variable, ...]
    positions: tuple[int, ...]
    is_discrete: bool = False
    moves: bool = False
    transforms: tuple[Conversion | None, ...] = ()
    is_clocked: bool = False

    @property
    def labels(self) -> tuple[str, ...]:
        """A name for each value, without the element's."""
        return tuple(label for variable in self.variables for label in variable.labels)

    def has_items(self, element: Element) -> bool:
        """Whether values of *element* are looked up on their way: then there is nothing in between."""
        conversions = [element.conversions[v.name] for v in self.variables if v.name in element.conversions]
        return any(conversion is not None and conversion.items for conversion in (*conversions, *self.transforms))


@dataclass(frozen=True, slots=True)
class Wiring:
    """*values* names what lies at each position of the table; *outputs*, *inputs* hold one tuple per element.

    An input array that wires do not reach all values of is read back like an output, so that the values no wire ends
    at stay what they are. *wired* are the positions of outputs that a wire starts at. *texts*, *text_outputs* and
    *text_inputs* are the same for strings and binaries.
    """

    system: SystemStructure
    values: tuple[str, ...]
    outputs: tuple[tuple[VariableGroup, ...], ...]
    inputs: tuple[tuple[VariableGroup, ...], ...]
    wired: tuple[int, ...]
    texts: tuple[str, ...] = ()
    text_outputs: tuple[tuple[VariableGroup, ...], ...] = ()
    text_inputs: tuple[tuple[VariableGroup, ...], ...] = ()
    clocks: Clocks = field(default_factory=Clocks)

    def record(self, names: Sequence[str]) -> tuple[int, ...]:
        """Positions of the outputs called *names*; DseError naming those that are none."""
        positions = {name: position for position, name in enumerate(self.values)}
        raise_if_any(_no_output(name, self) for name in names if name not in positions)
        return tuple(positions[name] for name in names)

    @property
    def owners(self) -> tuple[int, ...]:
        """Index of the element behind each value."""
        return tuple(e for e, part in enumerate(self.outputs) for group in part for _ in group.positions)

    def group_at(self, position: int) -> VariableGroup:
        """The outputs of which one lies at *position*."""
        return next(group for part in self.outputs for group in part if position in group.positions)


def wire_up(system: SystemStructure) -> Wiring:
    """Number all outputs of *system* and find every input's source; DseError for what cannot be simulated."""
    links = links_of(system)
    raise_if_any([*link_problems(system, links), *clock_problems(system)])
    values, outputs = _numbered(system, links, texts=False)
    texts, text_outputs = _numbered(system, links, texts=True)
    at = {name: position for position, name in enumerate(values)}
    text_at = {name: position for position, name in enumerate(texts)}
    sources = {link.source for link in links.values()}
    return Wiring(
        system,
        values,
        outputs,
        tuple(_sources(element, links, at, texts=False) for element in system.elements),
        tuple(position for position, name in enumerate(values) if name in sources),
        texts,
        text_outputs,
        tuple(_sources(element, links, text_at, texts=True) for element in system.elements),
        clocks_of(system, links),
    )


def groups_by_type(element: Element, variables: Iterable[Variable], *, texts: bool = False) -> list[VariableGroup]:
    """Numbers (or texts) among *variables*, as few groups as their accessors, events and slopes allow; no positions."""
    kind_of = text_type_of if texts else type_of
    model = element.model
    parts: dict[tuple[AccessorType, bool, bool, int, bool], list[Variable]] = {}
    tuned = {variable.name for variable in element.inputs if variable.causality == "parameter"}
    for number, variable in enumerate(variables):
        kind = kind_of(variable, model.version)
        if kind is not None and variable.size:
            ticks = model.lets_tick(variable)
            is_discrete = is_discrete_input(variable, model) or variable.name in tuned
            waits = _handles_events(model) and is_discrete and not ticks
            moves = _handles_events(model) and moves_within_steps(variable, model) and not ticks
            # What is set in events is set one by one: only what has changed.
            alone = number if ticks or (waits and model.ticks) else 0
            parts.setdefault((kind, waits, moves, alone, ticks), []).append(variable)
    return [VariableGroup(key[0], tuple(parts[key]), (), *key[1:3], is_clocked=key[4]) for key in sorted(parts)]


def is_discrete_input(variable: Variable, model: FmuModel) -> bool:
    """Whether *variable* is an input that changes at events only."""
    found = type_of(variable, model.version)
    is_real = found is not None and found.is_floating and variable.variability in ("", "continuous")
    return variable.causality == "input" and not is_real


def moves_within_steps(variable: Variable, model: FmuModel) -> bool:
    """Whether *variable* is an input that may follow a slope within a step, if the FMU takes slopes at all."""
    if variable.causality != "input" or is_discrete_input(variable, model):
        return False
    is_co_simulation = model.version > 2 and model.interface is FmiInterface.CO_SIMULATION  # FMI 3
    return variable.is_intermediate or not is_co_simulation


def _handles_events(model: FmuModel) -> bool:
    able = model.capabilities
    return (
        model.interface is FmiInterface.MODEL_EXCHANGE
        or able.has_event_mode
        or able.can_interpolate_inputs
        or able.provides_intermediate_update
    )


def _numbered(
    system: SystemStructure, links: Mapping[str, Link], *, texts: bool
) -> tuple[tuple[str, ...], tuple[tuple[VariableGroup, ...], ...]]:
    names: list[str] = []
    parts = []
    for element in system.elements:
        groups = []
        readable = _texts_out(element, links) if texts else _readable(element, links)
        for group in groups_by_type(element, readable, texts=texts):
            count = len(group.labels)
            groups.append(replace(group, positions=tuple(range(len(names), len(names) + count))))
            names += [f"{element.name}.{label}" for label in group.labels]
        parts.append(tuple(groups))
    return tuple(names), tuple(parts)


def _readable(element: Element, links: Mapping[str, Link]) -> tuple[Variable, ...]:
    return (*element.outputs, *(v for v in element.inputs if _is_partly_wired(element, v, links)))


def _texts_out(element: Element, links: Mapping[str, Link]) -> tuple[Variable, ...]:
    """Those that are wired: strings and binaries are not recorded."""
    sources, inputs = {link.source for link in links.values()}, {variable.name for variable in element.inputs}
    return tuple(
        variable
        for variable in _readable(element, links)
        if variable.name in inputs or any(f"{element.name}.{label}" in sources for label in variable.labels)
    )


def _is_partly_wired(element: Element, variable: Variable, links: Mapping[str, Link]) -> bool:
    return any(f"{element.name}.{label}" not in links for label in variable.labels)


def _sources(
    element: Element, links: Mapping[str, Link], at: Mapping[str, int], *, texts: bool
) -> tuple[VariableGroup, ...]:
    groups = []
    for group in groups_by_type(element, element.inputs, texts=texts):
        labels = [f"{element.name}.{label}" for label in group.labels]
        found = [links.get(label, Link(label)) for label in labels]
        transforms = tuple(link.transform for link in found)
        positions = tuple(at[link.source] for link in found)
        groups.append(replace(group, positions=positions, transforms=transforms if any(transforms) else ()))
    return tuple(groups)


def _no_output(name: str, wiring: Wiring) -> Problem:
    types = {f"{e.name}.{label}": v.fmi_type for e in wiring.system.elements for v in e.outputs for label in v.labels}
    if name in types:
        return Problem(f"{name}: variables of type {types[name]} cannot be recorded")
    return Problem(f"there is no output '{name}' to record", hint="outputs are named element.variable")


# Why clocks of a system, or wires between them, cannot be simulated.


def clock_problems(system: SystemStructure) -> Iterable[Problem]:
    """Why clocks of *system*, or wires between them, cannot be simulated."""
    for element in system.elements:
        for variable in element.model.variables.values():
            if variable.is_timed and not variable.alias_of and (why := _cannot_tick(element)):
                yield Problem(f"{element.name}.{variable.name}: it is a clock that ticks by itself, {why}")
    for wire in clock_wires(system):
        yield from _wrong_ends(system, wire)


def _cannot_tick(element: Element) -> str:
    if element.model.ticks:
        return ""
    if element.model.interface is not FmiInterface.CO_SIMULATION:
        return "which is supported for co-simulation only"
    if Special.NO_EVENT_MODE in element.model.special:
        return "and its component has event_mode: off"
    return "but its FMU has no event mode (hasEventMode) to tick in"


def _wrong_ends(system: SystemStructure, wire: Wire) -> Iterator[Problem]:
    source, target = (
        system.element(name).model.variables.get(variable)
        for name, variable in ((wire.source, wire.source_variable), (wire.target, wire.target_variable))
    )
    names = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
    if source is None or target is None or source.timing is None or target.timing is None:
        yield Problem(f"{names[0]} -> {names[1]}: a clock can be wired to a clock only")
        return
    for name, part in ((names[0], wire.source), (names[1], wire.target)):
        if not system.element(part).model.ticks:
            yield Problem(f"{name}: clocks are supported for co-simulation with event mode only")
    if source.causality != "output" and not source.is_timed:
        yield Problem(f"{names[0]}: a wire starts at a clock that neither is an output nor ticks by itself")
    if target.causality != "input":
        yield Problem(f"{names[1]}: a wire ends at what is not an input")
    elif target.is_timed:
        yield Problem(f"{names[1]}: it ticks by itself ({target.timing.kind}), so no wire can end there")
