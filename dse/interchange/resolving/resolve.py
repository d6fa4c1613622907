"""A package's system and its FMUs → a system that can be simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import prod

from dse.domain.component import Kind
from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.interchange.resolving.carry import ConversionError
from dse.interchange.resolving.matching import connector_problems, interface_problems, of_fmu
from dse.interchange.resolving.network import Endpoint, HopNetwork, Models, Way, network_of
from dse.interchange.resolving.osmp import with_binaries
from dse.interchange.resolving.routes import Route, carried, forms_along, label_of, routes_to
from dse.interchange.resolving.signals import RecordedSignal, signals_of
from dse.interchange.resolving.units import take_declared_units
from dse.interchange.resolving.values import TYPED, Settled, assignments, named, settle
from dse.interchange.structure import Assignment, ParameterValue, SspSystem
from dse.system import along_the_flow, resized


@dataclass(frozen=True, slots=True)
class ResolvedSystem:
    """A package ready to be simulated.

    Values are in the FMUs' own units; wires convert. *signals* is what is recorded; *notes* tell what in the package
    is not used, *ignored* what should not be there. *places* say where in the package a wire's target
    (``element.variable``) is connected, or a start value is given.
    """

    structure: SystemStructure
    signals: tuple[RecordedSignal, ...]
    notes: tuple[Problem, ...] = ()
    ignored: tuple[Problem, ...] = ()
    places: Mapping[str, Location] = field(default_factory=dict)

    @property
    def record(self) -> tuple[str, ...]:
        """The outputs to record, as ``element.variable``, each once."""
        return tuple(dict.fromkeys(signal.label for signal in self.signals))


def system_of(
    ssp: SspSystem,
    models: Models,
    *,
    settings: Mapping[str, str] | None = None,
    record: Sequence[str] = (),
) -> ResolvedSystem:
    """Flatten *ssp*, whose components' FMUs are *models*.

    An element is called by its way (``outer.inner``). *settings* are further values by hierarchical name, as a person
    types them; they count most. *record* names variables to record besides the output connectors, or instead of them if
    it is not empty. Raises DseError with every connection, value and name that does not fit, each where it stands.
    """
    problems: list[Problem] = []
    notes, ignored = list(ssp.notes), list(ssp.ignored)
    network = network_of(ssp.system, models)
    given = assignments(network, notes, problems) | _typed(network, settings or {}, problems)
    notes += take_declared_units(network, given)
    problems += interface_problems(network)
    for way, component in network.components.items():
        ignored += [of_fmu(component, problem) for problem in network.models[way].ignored]
    network.models = _resized(network, given, problems)
    problems += connector_problems(network, given, ignored)
    raise_if_any(problems)
    assembly = _Assembly(network, given, problems, notes)
    assembly.connect()
    assembly.give()
    passed = {(way, name) for way, draft in assembly.drafts.items() for name in draft.outputs}
    signals = signals_of(network, passed, record, problems)
    for signal in signals:
        if not signal.is_counted:
            assembly.drafts[signal.way].outputs.add(signal.variable)
    names = _names(network, problems)
    raise_if_any(problems)
    elements = {names[way]: draft.element(names[way]) for way, draft in assembly.drafts.items()}
    order = along_the_flow(list(elements), assembly.wires)
    structure = SystemStructure(ssp.name, tuple(elements[name] for name in order), tuple(assembly.wires))
    structure = with_binaries(structure)
    places = {
        f"{names[way]}.{label}": at for way, draft in assembly.drafts.items() for label, at in draft.places.items()
    }
    return ResolvedSystem(structure, signals, tuple(dict.fromkeys(notes)), tuple(dict.fromkeys(ignored)), places)


def _names(network: HopNetwork, problems: list[Problem]) -> dict[Way, str]:
    names: dict[Way, str] = {}
    for way, component in network.components.items():
        name = ".".join(way)
        if name in names.values():
            what = f"two components are called '{name}'"
            problems.append(Problem(what, component.where, "rename one, or the system it is in"))
        names[way] = name
    return names


def _typed(network: HopNetwork, settings: Mapping[str, str], problems: list[Problem]) -> dict[Endpoint, Assignment]:
    given: dict[Endpoint, Assignment] = {}
    for name, text in settings.items():
        here = Location(f"--set {name}={text}")
        nodes = list(named(network, name))
        if not nodes:
            known = [connector.name for connector in network.systems[()].connectors]
            known += [f"{'.'.join(way)}.{v}" for way, model in network.models.items() for v in model.variables]
            problems.append(Problem(f"there is no '{name}' to set", here, closest(name, known)))
        assigned = Assignment(name, ParameterValue(TYPED, (text,), here), here)
        given |= dict.fromkeys(nodes, assigned)
    return given


def _resized(network: HopNetwork, given: Mapping[Endpoint, Assignment], problems: list[Problem]) -> dict[Way, FmuModel]:
    """The FMUs with the sizes their arrays have by the structural parameters that are given."""
    found = dict(network.models)
    for way, model in found.items():
        sizes: dict[str, float] = {}
        for variable in model.variables.values():
            node = Endpoint(way, variable.name)
            if variable.is_structural and node in given:
                for value in _settled(network, node, given[node], problems)[:1]:
                    sizes[variable.name] = float(value) if isinstance(value, float) else 0.0
        try:
            found[way] = resized(model, sizes)
        except DseError as error:
            where = network.components[way].where
            problems += [Problem(problem.what, where, problem.hint) for problem in error.problems]
    return found


def _settled(network: HopNetwork, node: Endpoint, assigned: Assignment, problems: list[Problem]) -> tuple[Settled, ...]:
    try:
        form = network.form(node)
        return settle(assigned, form) if form else ()
    except ConversionError as error:
        problems.append(Problem(f"{node}: {error}", assigned.where))
    except DseError as error:
        problems += error.problems
    return ()


@dataclass(slots=True)
class _Draft:
    """What is known of one element while the system is put together.

    *driven* are start values that come over connections, *wired* the values that arrive all the time, by label.
    """

    model: FmuModel
    inputs: set[str] = field(default_factory=set)
    outputs: set[str] = field(default_factory=set)
    start: dict[str, float] = field(default_factory=dict)
    texts: dict[str, str | bytes] = field(default_factory=dict)
    places: dict[str, Location] = field(default_factory=dict)
    driven: set[str] = field(default_factory=set)
    wired: set[str] = field(default_factory=set)

    def store(self, name: str, labels: Sequence[str], values: Sequence[Settled], assigned: Assignment) -> None:
        """Start the values called *labels*, which are of the variable *name*, with *values*: one for each or for all.

        Raises DseError for another number of them.
        """
        if len(values) == 1 < len(labels):
            values = [*values] * len(labels)
        if values and len(values) != len(labels):
            raise fail(f"'{name}' has {len(labels)} values, {len(values)} are given", assigned.where)
        for label, value in zip(labels, values, strict=False):
            if label in self.wired:
                continue
            self.places[label] = assigned.where
            self.start.pop(label, None)
            self.texts.pop(label, None)
            if isinstance(value, float):
                self.start[label] = value
            else:
                self.texts[label] = value

    def element(self, name: str) -> Element:
        """The element, called *name*."""
        variables = self.model.variables.values()
        used = self.inputs | self.outputs | set(self.start)
        return Element(
            name,
            self.model,
            tuple(v for v in variables if v.name in self.inputs),
            tuple(v for v in variables if v.name in self.outputs),
            dict(sorted(self.start.items())),
            dict(sorted(self.texts.items())),
            {v.name: _negated(v) for v in variables if v.is_negated and v.name in used},
        )


def _negated(variable: Variable) -> Conversion:
    """FMI 1.0 calls a variable by a second name that stands for the value with the other sign."""
    if variable.kind is Kind.BOOLEAN:
        return Conversion(items=((0.0, 1.0), (1.0, 0.0)))
    return Conversion(factor=-1.0)


class _Assembly:
    """The wires and elements of a network to which values are *given*; *problems* are gathered, and *notes* of values
    that are not used."""

    def __init__(
        self,
        network: HopNetwork,
        given: Mapping[Endpoint, Assignment],
        problems: list[Problem],
        notes: list[Problem],
    ) -> None:
        self.wires: list[Wire] = []
        self.drafts = {way: _Draft(model) for way, model in network.models.items()}
        self._network, self._given, self._problems, self._notes = network, given, problems, notes
        self._names: dict[tuple[Way, str, int], str] = {}
        """Under which name each value of an FMU is given, by its type and reference: aliases share these."""

    def connect(self) -> None:
        """Follow the connections: from FMU to FMU they are wires, from a system's connector they carry start values."""
        network = self._network
        targets = dict.fromkeys(n for n, _ in network.hops if n.way in self.drafts and not n.dictionary)
        for target in targets:
            for route in routes_to(network, target, self._problems):
                try:
                    if network.variable(route.source) is None:
                        self._give_along(route)
                    else:
                        self.wires.append(self._wire(route))
                except DseError as error:
                    self._problems += error.problems

    def _wire(self, route: Route) -> Wire:
        drafts, last = self.drafts, route.hops[-1].connection
        source = drafts[route.source.way].model.variables[route.source.connector]
        target = drafts[route.target.way].model.variables[route.target.connector]
        source_label = label_of(source, route.source_indices, route.hops[0].connection.where)
        target_label = label_of(target, route.target_indices, last.where)
        ends = (source, route.source_indices), (target, route.target_indices)
        start, end = (() if indices else variable.shape for variable, indices in ends)
        if start != end and prod(start) == prod(end) == 1:
            # Some tools give a single value a dimension of one.
            source_label = source_label if route.source_indices else source.labels[0]
            target_label = target_label if route.target_indices else target.labels[0]
        elif start != end:
            shapes = [" x ".join(map(str, shape)) or "one value" for shape in (start, end)]
            raise fail(f"{last}: shapes differ: {shapes[0]} and {shapes[1]}", last.where)
        way = carried(self._network, route)
        try:
            factor, offset = way.numbers
        except ConversionError as error:
            raise fail(f"{last}: {error}", last.where) from None
        drafts[route.source.way].outputs.add(source.name)
        draft = drafts[route.target.way]
        draft.inputs.add(target.name)
        draft.places[target_label] = last.where
        draft.wired |= {target_label} if route.target_indices else set(target.labels)
        items = tuple((float(a), float(b)) for a, b in sorted(way.table.items())) if way.table else ()
        names = ".".join(route.source.way), ".".join(route.target.way)
        return Wire(names[0], source_label, names[1], target_label, factor, offset, items)

    def _give_along(self, route: Route) -> None:
        """Give an FMU's variable what is given to a system's connector on the way to it, the outermost first.

        If nothing is, the FMU's own start stays.
        """
        nodes = (route.source, *(hop.target for hop in route.hops[:-1]))
        number, assigned = next(
            ((n, self._given[node]) for n, node in enumerate(nodes) if node in self._given), (0, None)
        )
        variable = self._network.variable(route.target)
        if assigned is None or variable is None:
            return
        after = carried(self._network, route, beginning=number)
        form = forms_along(self._network, route)[number]
        try:
            values = settle(assigned, form, after) if form else ()
        except ConversionError as error:
            raise fail(f"{nodes[number]}: {error}", assigned.where) from None
        if variable.is_structural:
            what = f"{route.target}: a structural parameter that is set over a connection is not supported"
            raise fail(what, route.hops[-1].connection.where, f"give {route.target} the value itself")
        if not self._takes(route.target, variable, assigned):
            return
        is_single = bool(route.target_indices)
        labels = (label_of(variable, route.target_indices, assigned.where),) if is_single else variable.labels
        draft = self.drafts[route.target.way]
        draft.driven |= set(labels)
        draft.store(variable.name, labels, values, assigned)

    def give(self) -> None:
        """Start values of the FMUs' own variables; a whole array before single values of it.

        What comes over a connection from a system's connector counts more, but for what a person typed.
        """
        wholes = [node for node in self._given if self._network.variable(node) is not None]
        singles = [n for n in self._given if n.way in self.drafts and self._network.variable(n) is None]
        for node in (*wholes, *singles):
            assigned, draft = self._given[node], self.drafts[node.way]
            variable = draft.model.variable_of(node.connector)
            labels = variable.labels if variable.name == node.connector else (node.connector,)
            if not self._takes(node, variable, assigned):
                continue
            if draft.wired >= set(labels):
                self._unused(node, "is connected", assigned, "set what it is connected to")
                continue
            if {node.connector, *variable.labels} & draft.driven and assigned.value.type != TYPED:
                self._unused(node, "is given another over a connection", assigned)
                continue
            values = _settled(self._network, Endpoint(node.way, variable.name), assigned, self._problems)
            try:
                draft.store(variable.name, labels, values, assigned)
            except DseError as error:
                self._problems += error.problems

    def _takes(self, node: Endpoint, variable: Variable, assigned: Assignment) -> bool:
        """Whether *variable*, which *node* names, takes the value; what a person typed it has to take."""
        if not variable.is_settable:
            what = "constant" if variable.variability == "constant" else variable.causality
            why = f"takes no value: it is {what}" + (", which the FMU computes" if what != "constant" else "")
            self._unused(node, why, assigned, "set what it is computed from")
            return False
        name = self._names.setdefault((node.way, variable.fmi_type, variable.reference), variable.name)
        if name != variable.name:
            self._unused(node, f"is the variable that is given a value as '{name}'", assigned)
        return name == variable.name

    def _unused(self, node: Endpoint, why: str, assigned: Assignment, hint: str = "") -> None:
        if hint and assigned.value.type == TYPED:
            self._problems.append(Problem(f"{node} {why}", assigned.where, hint))
        else:
            self._notes.append(Problem(f"{node} {why}; the value here is not used", assigned.where))
