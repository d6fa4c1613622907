"""A configuration's parts, their wiring and their FMUs → a system that can be simulated."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property
from graphlib import TopologicalSorter
from heapq import heappop, heappush
from math import isfinite

from dse.domain.component import Causality, Component, Kind, Parameter, Port, Type, Value, as_number, same_signal
from dse.domain.design import Connection
from dse.domain.fmu import FmuModel, Variable
from dse.domain.labels import array_of
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import DseError, Location, Problem, fail, raise_if_any, some_of
from dse.graphs import components
from dse.system.binding import IDENTITY, Binding, bind


@dataclass(frozen=True)
class WiredParts:
    """Components by where they stand, what connects them, and what they are given.

    *connections* join single ports (``sensor.target.gap -> controller.target.gap``): an output that is there to an
    input or tunable parameter that is there, one to each, as `dse.space.wire` gives them. *values* are those of
    parameters and inputs that are not connected, as ``part.port``; *where* is the bench that may give them. *order* is
    the one they step in, () for along the flow of signals.
    """

    parts: Mapping[str, Component]
    connections: tuple[Connection, ...] = ()
    values: Mapping[str, Value] = field(default_factory=dict)
    where: Location | None = None
    order: tuple[str, ...] = ()

    @cached_property
    def connected(self) -> frozenset[str]:
        """The inputs and parameters that are connected."""
        return frozenset(connection.target for connection in self.connections)

    @cached_property
    def ports(self) -> dict[str, tuple[str, Port]]:
        """Every port, with the part that has it, by ``part.port``."""
        return {f"{part}.{p.name}": (part, p) for part, c in self.parts.items() for p in c.interface.ports}

    @property
    def ends(self) -> dict[str, tuple[str, Port]]:
        """What connections join: every port, and the connected parameters as inputs, with the part that has it."""
        connected = self.connected
        parameters = (
            (part, p) for part, c in self.parts.items() for p in c.parameters if f"{part}.{p.name}" in connected
        )
        tuned = {f"{part}.{p.name}": (part, Port(p.name, Causality.INPUT, p.type)) for part, p in parameters}
        return self.ports | tuned


class Elements:
    """Makes the elements of many systems: one that is used alike in several of them is made once."""

    def __init__(self) -> None:
        self._made: dict[Hashable, tuple[Element, Component, FmuModel]] = {}

    def of(
        self,
        part: str,
        component: Component,
        model: FmuModel,
        used: Set[str],
        values: Mapping[str, Value],
        problems: list[Problem],
    ) -> Element:
        """The element *part*; its ends among *used* are wired or read. What is wrong with it comes to *problems*."""
        names = [*(port.name for port in component.interface.ports), *(each.name for each in component.parameters)]
        ends = [f"{part}.{name}" for name in names]
        given = tuple((end, repr(values[end])) for end in ends if end in values)
        key = part, id(component), id(model), used & {*ends}, given
        if key not in self._made:
            before = len(problems)
            made = _element(part, component, model, used, values, problems)
            if len(problems) > before:
                return made
            self._made[key] = made, component, model  # whose numbers nothing else can have as long as they are here
        return self._made[key][0]


def assemble(
    name: str,
    wired: WiredParts,
    models: Mapping[str, FmuModel],
    outputs: Collection[str],
    made: Elements | None = None,
) -> SystemStructure:
    """Connect the FMUs of the parts; *models* holds that of each component by its name.

    *outputs* names the output ports that shall be readable besides those that are wired; *made* are the elements of
    other systems. Raises DseError with every mismatch of unit, type, causality or FMU.
    """
    made = made or Elements()
    problems = list(wiring_problems(wired))
    ends_used = (end for connection in wired.connections for end in (connection.source, connection.target))
    used = frozenset((*ends_used, *outputs))
    elements = {
        part: made.of(part, component, models[component.name], used, wired.values, problems)
        for part, component in wired.parts.items()
    }
    raise_if_any(problems)
    ports = wired.ends
    wires = []
    for connection in wired.connections:
        ends = (ports[end] for end in (connection.source, connection.target))
        (source, given), (target, taken) = ((part, wired.parts[part].variable(port.name)) for part, port in ends)
        wires.append(Wire(source, given, target, taken))
    wires = _with_arrays(wires, elements)
    order = wired.order or along_the_flow(tuple(elements), wires)
    return SystemStructure(name, tuple(elements[part] for part in order), tuple(wires))


def _with_arrays(wires: list[Wire], elements: Mapping[str, Element]) -> list[Wire]:
    """*wires* with one in place of those between all values of two arrays, each to its like."""
    found: dict[tuple[str, str, str, str], list[Wire]] = {}
    for wire in wires:
        arrays = array_of(wire.source_variable), array_of(wire.target_variable)
        ends = arrays if all(arrays) else (wire.source_variable, wire.target_variable)
        found.setdefault((wire.source, ends[0], wire.target, ends[1]), []).append(wire)
    for (source, given, target, taken), group in found.items():
        start, end = (elements[e].model.variables.get(array) for e, array in ((source, given), (target, taken)))
        if start is None or end is None or not start.shape or start.shape != end.shape:
            continue
        if [(w.source_variable, w.target_variable) for w in group] == list(zip(start.labels, end.labels, strict=True)):
            group[:] = [Wire(source, given, target, taken)]
    return [wire for group in found.values() for wire in group]


def wiring_problems(wired: WiredParts) -> Iterator[Problem]:
    """Connections of what does not fit, and inputs without or with two sources of their values; needs no FMU."""
    ports = wired.ends
    sources = {connection.target: connection for connection in wired.connections}
    for connection in wired.connections:
        (part, source), (_, target) = ports[connection.source], ports[connection.target]
        difference = same_signal(source.type, target.type)
        if difference:
            fitting = [
                f"{part}.{port.name}"
                for port in wired.parts[part].interface.ports
                if port.causality is Causality.OUTPUT and not same_signal(port.type, target.type)
            ]
            hint = f"connect {' or '.join(fitting[:3])}" if fitting else "both ends must carry the same unit and type"
            yield Problem(f"{connection}: {difference}", connection.where, hint)
    for part, component in wired.parts.items():
        needed = (p for p in component.interface.ports if p.causality is Causality.INPUT)
        ends = [f"{part}.{p.name}" for p in needed if component.interface.needs(p.name)]
        loose = [end for end in ends if end not in sources and end not in wired.values]
        if loose:
            yield _loose(part, component, loose, wired.where)
    # A value for what is connected in some configurations only is that of the others.
    for end in (end for end in wired.values if end in sources and sources[end].when is None):
        what = f"{end} is given a value and connected to {sources[end].source}"
        yield Problem(what, sources[end].where, "remove one")


def check_fmu(component: Component, model: FmuModel) -> None:
    """Raise DseError unless *model* has all ports and parameters of *component*, of their types and units."""
    problems: list[Problem] = []
    _element(component.name, component, model, set(), {}, problems)
    raise_if_any(problems)


def _loose(part: str, component: Component, ends: list[str], where: Location | None) -> Problem:
    hint = f"add a connection '… -> {ends[0]}' or a value under 'parameters' in the test bench"
    if len(ends) == 1:
        what = f"input {ends[0]} ({component.name}) is neither connected nor given a value"
    else:
        names = some_of([end.removeprefix(f"{part}.") for end in ends])
        what = f"{len(ends)} inputs of {part} ({component.name}) are neither connected nor given a value: {names}"
        hint = f"for each, {hint}"
    return Problem(what, where or component.where, hint)


def _element(
    part: str,
    component: Component,
    model: FmuModel,
    used: Set[str],
    values: Mapping[str, Value],
    problems: list[Problem],
) -> Element:
    try:
        model = resized(model, _sizes(part, component, model, values))
    except DseError as error:
        problems += error.problems
    element = _Gathered(component, model, problems)
    for port in component.interface.ports:
        end = f"{part}.{port.name}"
        bound = element.bind(port.name, port.type, str(port.causality))
        if bound is None:
            continue
        if port.causality is Causality.INPUT:
            element.take(bound, port.name)
        if end in used:
            ends = element.outputs if port.causality is Causality.OUTPUT else element.inputs
            ends[bound.variable.name] = bound.variable
        elif end in values and port.causality is Causality.INPUT:
            element.give(bound, port.type, values[end])
    for parameter in component.parameters:
        given = values.get(f"{part}.{parameter.name}", parameter.start)
        if _is_built_in(component, parameter, model):
            if f"{part}.{parameter.name}" in used:
                what = (
                    f"'{parameter.name}' of {component.name} went into its FMU when that was built: no wire ends there"
                )
                problems.append(Problem(what, parameter.where or component.where, "give it a value"))
            elif given != parameter.start:
                what = (
                    f"'{parameter.name}' of {component.name} is {parameter.start} by the way it is built, not {given}"
                )
                problems.append(Problem(what, parameter.where or component.where, "change it in the component's file"))
            continue
        bound = element.bind(parameter.name, parameter.type, "parameter", "structuralParameter", "input")
        if bound is not None:
            element.take(bound, parameter.name)
            element.give(bound, parameter.type, given)
            if f"{part}.{parameter.name}" in used:
                element.tune(bound, parameter)
    inputs, outputs = tuple(element.inputs.values()), tuple(element.outputs.values())
    return Element(part, model, inputs, outputs, element.start, element.texts, element.conversions)


class _Gathered:
    """What an element is made of, gathered port by port and parameter by parameter."""

    def __init__(self, component: Component, model: FmuModel, problems: list[Problem]) -> None:
        self._component, self._model, self._problems = component, model, problems
        self.inputs: dict[str, Variable] = {}
        self.outputs: dict[str, Variable] = {}
        self.start: dict[str, float] = {}
        self.texts: dict[str, str | bytes] = {}
        self.conversions: dict[str, Conversion] = {}
        self._taken: dict[tuple[str, int, str], str] = {}

    def take(self, bound: Binding, name: str) -> None:
        """Note that the input or parameter *name* gives the value; two may not give one."""
        variable = bound.variable
        at = variable.fmi_type, variable.reference, bound.label.removeprefix(variable.name)
        other = self._taken.setdefault(at, name)
        if other != name:
            what = f"'{other}' and '{name}' of {self._component.name} are one value of its FMU, '{bound.label}'"
            self._problems.append(Problem(what, self._component.where, "map one of them to another variable"))

    def bind(self, name: str, type_: Type, *causalities: str) -> Binding | None:
        """The value behind *name*, its conversion noted; None if there is a problem with it."""
        try:
            bound = bind(self._component, name, type_, self._model, causalities)
        except DseError as error:
            self._problems += error.problems
            return None
        if bound.conversion != IDENTITY:
            known = self.conversions.setdefault(bound.variable.name, bound.conversion)
            if known != bound.conversion:
                what = (
                    f"the values of '{bound.variable.name}' in the FMU of {self._component.name} have different items"
                )
                self._problems.append(Problem(what, self._component.where, "give their ports the same type"))
        return bound

    def give(self, bound: Binding, type_: Type, value: Value) -> None:
        """Note the start *value*."""
        if not type_.kind.is_number:
            self.texts[bound.label] = str(value) if type_.kind is Kind.TEXT else bytes.fromhex(str(value))
            return
        number = as_number(value, type_)
        items = bound.variable.items
        is_own = str(value) in bound.variable.start  # what the FMU begins with by itself is its own affair
        if type_.kind is Kind.INTEGER and items and number not in items.values() and not is_own:
            what = f"'{bound.label}' in the FMU of {self._component.name} cannot be {value}: it is an enumeration"
            known = ", ".join(f"{item_number} ({item})" for item, item_number in items.items())
            self._problems.append(Problem(what, self._component.where, f"its items: {known}"))
        self.start[bound.label] = number

    def tune(self, bound: Binding, parameter: Parameter) -> None:
        """Note that a wire ends at the *parameter*."""
        variable = bound.variable
        if variable.causality != "input" and variable.variability != "tunable":
            found = variable.variability if variable.causality == "parameter" else variable.causality
            what = f"'{bound.label}' in the FMU of {self._component.name} is {found}, not tunable"
            hint = "a connection can end at a tunable parameter only; give it a value"
            self._problems.append(Problem(what, parameter.where or self._component.where, hint))
        self.inputs[variable.name] = variable


def _sizes(part: str, component: Component, model: FmuModel, values: Mapping[str, Value]) -> dict[str, float]:
    """The values of structural parameters that size arrays, by variable."""
    found = {}
    for parameter in component.parameters:
        variable = model.variables.get(component.variable(parameter.name))
        if variable is not None and variable.is_structural and parameter.type.kind is Kind.INTEGER:
            found[variable.name] = float(values.get(f"{part}.{parameter.name}", parameter.start))
    return found


def _is_built_in(component: Component, parameter: Parameter, model: FmuModel) -> bool:
    """Whether the parameter's value went into the FMU when it was built, as that of a structural one does."""
    variable = model.variables.get(component.variable(parameter.name))
    is_built = component.source is not None and not component.source.is_finished
    return is_built and not parameter.tunable and variable is not None and variable.causality == "local"


# The order in which elements stand in a system.


def along_the_flow(names: Sequence[str], wires: Iterable[Wire]) -> list[str]:
    """*names* along the flow of signals; what that leaves open, as where a loop is cut, is as in *names*."""
    rank = {name: number for number, name in enumerate(names)}
    needs: list[list[int]] = [[] for _ in names]
    for wire in wires:
        needs[rank[wire.target]].append(rank[wire.source])
    loops = {loop[0]: loop for loop in components(needs)}
    loop_of = {number: first for first, loop in loops.items() for number in loop}
    sources = {first: {loop_of[n] for number in loop for n in needs[number]} for first, loop in loops.items()}
    sorter = TopologicalSorter({first: found - {first} for first, found in sources.items()})
    sorter.prepare()
    ready: list[int] = []
    order: list[str] = []
    while sorter.is_active():
        for each in sorter.get_ready():
            heappush(ready, each)
        first = heappop(ready)
        order += (names[number] for number in loops[first])
        sorter.done(first)
    return order


# Arrays whose size a structural parameter sets.


MOST_VALUES = 1_000_000
"""An array whose size is set has no more than that: each of its values has a name."""


def resized(model: FmuModel, values: Mapping[str, float]) -> FmuModel:
    """*model* with the shapes its arrays have if its structural parameters take these *values*.

    Raises DseError for a size that is no whole number, or less than none, or makes an array beyond all measure.
    """
    sizes = {name: values[name] for name, v in model.variables.items() if v.is_structural and name in values}
    if not sizes:
        return model
    for name, size in sizes.items():
        if not isfinite(size) or size != int(size) or size < 0:
            raise fail(f"{model.identifier}: the structural parameter '{name}' cannot be {size:g}")
    variables = {name: _resized(v, sizes) for name, v in model.variables.items()}
    for variable in variables.values():
        if variable.size > MOST_VALUES:
            said = ", ".join(
                f"{name} = {int(sizes[name])}" for name in dict.fromkeys(variable.sized_by) if name in sizes
            )
            what = f"{model.identifier}: with {said} the array '{variable.name}' has {variable.size:,} values"
            raise fail(what, hint=f"at most {MOST_VALUES:,} are supported")
    return replace(model, variables=variables)


def _resized(variable: Variable, sizes: Mapping[str, float]) -> Variable:
    shape = tuple(int(sizes.get(name, size)) for size, name in zip(variable.shape, variable.sized_by, strict=True))
    if shape == variable.shape:
        return variable
    # Starts of another size would be those of other elements.
    return replace(variable, shape=shape, start=variable.start if len(variable.start) == 1 else ())
