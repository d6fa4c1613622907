"""A system as positions in one table of values: where each output lies and where each input takes its value from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from dse.cosim.binding.calls import FLOATING, Type, text_type_of, type_of
from dse.cosim.wiring.conversion import transform_of
from dse.domain.fmu import FmiInterface, FmuModel, Variable
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import Problem, fail, raise_if_any


@dataclass(frozen=True, slots=True)
class Group:
    """Variables of one element that one accessor call reads or writes.

    *positions*, one per value (row by row where variables are arrays), say where outputs lie in the table of values,
    where in it inputs take their values from, and where starts lie in the table of start values. Outputs and starts
    lie one after another, group by group. Strings and binaries have a table of their own. *transforms* is what wires
    do to each value on its way to an input, () for nothing at all. *is_discrete* is set for inputs that an FMU with
    events takes in event mode only, *moves* for those that may follow a slope within a step.
    """

    type: Type
    variables: tuple[Variable, ...]
    positions: tuple[int, ...]
    is_discrete: bool = False
    moves: bool = False
    transforms: tuple[Conversion | None, ...] = ()

    @property
    def labels(self) -> tuple[str, ...]:
        """A name for each value, without the element's."""
        return tuple(label for variable in self.variables for label in variable.labels)


@dataclass(frozen=True, slots=True)
class Wiring:
    """*values* names what lies at each position of the table; *outputs*, *inputs* hold one tuple per element.

    An input array that wires do not reach all values of is read back like an output, so that the values no wire ends
    at stay what they are. *wired* are the positions of outputs that a wire starts at. *texts*, *text_outputs* and
    *text_inputs* are the same for strings and binaries.
    """

    system: SystemStructure
    values: tuple[str, ...]
    outputs: tuple[tuple[Group, ...], ...]
    inputs: tuple[tuple[Group, ...], ...]
    wired: tuple[int, ...]
    texts: tuple[str, ...] = ()
    text_outputs: tuple[tuple[Group, ...], ...] = ()
    text_inputs: tuple[tuple[Group, ...], ...] = ()

    def record(self, names: Sequence[str]) -> tuple[int, ...]:
        """Positions of the outputs called *names*; DseError naming those that are none."""
        positions = {name: position for position, name in enumerate(self.values)}
        raise_if_any(_no_output(name, self) for name in names if name not in positions)
        return tuple(positions[name] for name in names)


def wire_up(system: SystemStructure) -> Wiring:
    """Number all outputs of *system* and find every input's source; DseError for what cannot be simulated."""
    links = links_of(system)
    raise_if_any([*_unsupported(system, links), *_loose_ends(system, links)])
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
    )


@dataclass(frozen=True, slots=True)
class Link:
    """Where one value of an input comes from, as ``element.label``, and what the wire does to it."""

    source: str
    transform: Conversion | None = field(default=None)


def links_of(system: SystemStructure) -> Mapping[str, Link]:
    """The source of every wired value by ``element.label`` of the input; wires between arrays count for each value."""
    outputs = {f"{e.name}.{v.name}": v for e in system.elements for v in e.outputs}
    inputs = {f"{e.name}.{v.name}": v for e in system.elements for v in e.inputs}
    links = {}
    for wire in system.wires:
        for source, target in _ends(wire, outputs, inputs):
            links[target] = Link(source, transform_of(wire))
    return links


def groups_by_type(element: Element, variables: Iterable[Variable], *, texts: bool = False) -> list[Group]:
    """Numbers (or texts) among *variables*, as few groups as their accessors, events and slopes allow; no positions."""
    kind_of = text_type_of if texts else type_of
    model = element.model
    parts: dict[tuple[Type, bool, bool, int], list[Variable]] = {}
    for number, variable in enumerate(variables):
        kind = kind_of(variable, model.version)
        if kind is not None and variable.size:
            waits = _knows_events(model) and is_discrete_input(variable, model)
            moves = _knows_events(model) and moves_within_steps(variable, model)
            # What is set in events is set one by one: only what has changed.
            alone = number if waits and has_event_mode(model) else 0
            parts.setdefault((kind, waits, moves, alone), []).append(variable)
    return [Group(key[0], tuple(parts[key]), (), *key[1:3]) for key in sorted(parts)]


def is_discrete_input(variable: Variable, model: FmuModel) -> bool:
    """Whether *variable* is an input that changes at events only."""
    is_real = type_of(variable, model.version) in FLOATING
    return variable.causality == "input" and not (is_real and variable.variability in ("", "continuous"))


def moves_within_steps(variable: Variable, model: FmuModel) -> bool:
    """Whether *variable* is an input that may follow a slope within a step, if the FMU takes slopes at all."""
    if variable.causality != "input" or is_discrete_input(variable, model):
        return False
    is_co_simulation = model.version > 2 and model.interface is FmiInterface.CO_SIMULATION  # FMI 3
    return variable.is_intermediate or not is_co_simulation


def has_event_mode(model: FmuModel) -> bool:
    """Whether *model* is simulated with the event mode of FMI 3 co-simulation."""
    return model.capabilities.has_event_mode and model.interface is FmiInterface.CO_SIMULATION


def _knows_events(model: FmuModel) -> bool:
    able = model.capabilities
    return (
        model.interface is FmiInterface.MODEL_EXCHANGE
        or able.has_event_mode
        or able.can_interpolate_inputs
        or able.provides_intermediate_update
    )


def _ends(wire: Wire, outputs: Mapping[str, Variable], inputs: Mapping[str, Variable]) -> Iterable[tuple[str, str]]:
    source, target = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
    if source not in outputs or target not in inputs or not (outputs[source].shape or inputs[target].shape):
        return [(source, target)]
    return [
        (f"{wire.source}.{a}", f"{wire.target}.{b}")
        for a, b in zip(outputs[source].labels, inputs[target].labels, strict=False)
    ]


def _numbered(
    system: SystemStructure, links: Mapping[str, Link], *, texts: bool
) -> tuple[tuple[str, ...], tuple[tuple[Group, ...], ...]]:
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
    sources = {link.source for link in links.values()}
    return tuple(
        variable
        for variable in _readable(element, links)
        if variable in element.inputs or any(f"{element.name}.{label}" in sources for label in variable.labels)
    )


def _is_partly_wired(element: Element, variable: Variable, links: Mapping[str, Link]) -> bool:
    return any(f"{element.name}.{label}" not in links for label in variable.labels)


def _sources(element: Element, links: Mapping[str, Link], at: Mapping[str, int], *, texts: bool) -> tuple[Group, ...]:
    groups = []
    for group in groups_by_type(element, element.inputs, texts=texts):
        labels = [f"{element.name}.{label}" for label in group.labels]
        found = [links.get(label, Link(label)) for label in labels]
        transforms = tuple(link.transform for link in found)
        positions = tuple(at[link.source] for link in found)
        groups.append(replace(group, positions=positions, transforms=transforms if any(transforms) else ()))
    return tuple(groups)


def _unsupported(system: SystemStructure, links: Mapping[str, Link]) -> Iterable[Problem]:
    ends = set(links) | {link.source for link in links.values()}
    for element in system.elements:
        version = element.model.version
        if version not in (1, 2, 3):
            raise fail(f"{element.name}: FMI {version} is not supported", hint="export the FMU as FMI 2.0 or 3.0")
        for variable in (*element.inputs, *element.outputs):
            name = f"{element.name}.{variable.name}"
            if any(f"{element.name}.{label}" in ends for label in variable.labels) and (
                why := _unwireable(element, variable)
            ):
                yield Problem(
                    f"{name}: {why}", hint="wire real, integer, Boolean, enumeration, string or binary variables"
                )


def _unwireable(element: Element, variable: Variable) -> str:
    if type_of(variable, element.model.version) is None and text_type_of(variable, element.model.version) is None:
        return f"variables of type {variable.fmi_type} cannot be wired"
    if variable.is_clocked:
        return "a variable that belongs to a clock cannot be wired"
    return ""


def _loose_ends(system: SystemStructure, links: Mapping[str, Link]) -> Iterable[Problem]:
    inputs = {f"{e.name}.{v.name}": v for e in system.elements for v in e.inputs}
    outputs = {f"{e.name}.{v.name}": v for e in system.elements for v in e.outputs}
    counted: dict[str, int] = {}
    for wire in system.wires:
        ends = list(_ends(wire, outputs, inputs))
        for _, target in ends:
            counted[target] = counted.get(target, 0) + 1
        yield from _unequal(wire, outputs, inputs)
    yield from (Problem(f"{target}: {n} wires end at one input") for target, n in counted.items() if n > 1)
    yield from _twice_by_other_names(system)
    labels = _labels(system, of_inputs=True)
    yield from (
        Problem(f"{target}: a wire ends at what is not an input") for target in sorted(links.keys() - labels.keys())
    )
    known = _labels(system, of_inputs=False)
    sources = {link.source for link in links.values()}
    yield from (
        Problem(f"{source}: a wire starts at what is not an output") for source in sorted(sources - known.keys())
    )
    for target, link in links.items():
        if target in labels and link.source in known:
            yield from _unlike(target, labels[target], link, known[link.source])
    for name, variable in sorted(inputs.items()):
        element = name[: -len(variable.name) - 1]
        if variable.size and not any(f"{element}.{label}" in links for label in variable.labels):
            yield Problem(f"{name}: no wire ends at this connected input")


def _twice_by_other_names(system: SystemStructure) -> Iterable[Problem]:
    """Connected inputs that are other names (aliases) of each other."""
    for element in system.elements:
        names: dict[str, str] = {}
        for variable in element.inputs:
            first = names.setdefault(variable.alias_of or variable.name, variable.name)
            if first != variable.name:
                both = f"{element.name}.{first} and {element.name}.{variable.name}"
                yield Problem(f"wires end at {both}, which are two names of one input")


def _unequal(wire: Wire, outputs: Mapping[str, Variable], inputs: Mapping[str, Variable]) -> Iterable[Problem]:
    source, target = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
    if source in outputs and target in inputs and outputs[source].shape != inputs[target].shape:
        shapes = [_shape(variable) for variable in (outputs[source], inputs[target])]
        yield Problem(
            f"{source} -> {target}: {shapes[0]} cannot be wired to {shapes[1]}",
            hint="wire single values of an array as name[2] or name[1,3], counted from 1",
        )


def _shape(variable: Variable) -> str:
    return f"an array of {' x '.join(map(str, variable.shape))}" if variable.shape else "a single value"


def _labels(system: SystemStructure, *, of_inputs: bool) -> Mapping[str, Type | None]:
    return {
        f"{element.name}.{label}": text_type_of(variable, element.model.version)
        for element in system.elements
        for variable in (element.inputs if of_inputs else element.outputs)
        for label in variable.labels
    }


def _unlike(target: str, kind: Type | None, link: Link, source_kind: Type | None) -> Iterable[Problem]:
    if kind is not source_kind:
        words = ["a number" if k is None else f"a {k.name.lower()}" for k in (source_kind, kind)]
        yield Problem(f"{link.source} -> {target}: {words[0]} cannot be wired to {words[1]}")
    elif kind is not None and link.transform is not None:
        yield Problem(f"{link.source} -> {target}: a {kind.name.lower()} takes no factor, offset or items")


def _no_output(name: str, wiring: Wiring) -> Problem:
    types = {f"{e.name}.{label}": v.fmi_type for e in wiring.system.elements for v in e.outputs for label in v.labels}
    if name in types:
        return Problem(f"{name}: variables of type {types[name]} cannot be recorded")
    return Problem(f"there is no output '{name}' to record", hint="outputs are named element.variable")
