"""Where every input takes its value from, and what is wrong with the wires."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from dse.cosim.binding.calls import AccessorType, text_type_of, type_of
from dse.domain.fmu import Variable
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import Problem, fail


@dataclass(frozen=True, slots=True)
class Link:
    """Where one value of an input comes from, as ``element.label``, and what the wire does to it."""

    source: str
    transform: Conversion | None = None


def links_of(system: SystemStructure) -> Mapping[str, Link]:
    """The source of every wired value by ``element.label`` of the input; wires between arrays count for each value."""
    outputs, inputs = _variables(system, of_inputs=False), _variables(system, of_inputs=True)
    of_clocks = frozenset(clock_wires(system))
    return {
        target: Link(source, _transform_of(wire))
        for wire in system.wires
        if wire not in of_clocks
        for source, target in _ends(wire, outputs, inputs)
    }


def clock_wires(system: SystemStructure) -> tuple[Wire, ...]:
    """The wires with a clock at either end: they carry no value."""
    clocks = {
        (element.name, variable.name)
        for element in system.elements
        for variable in element.model.variables.values()
        if variable.timing
    }
    return tuple(
        wire
        for wire in system.wires
        if {(wire.source, wire.source_variable), (wire.target, wire.target_variable)} & clocks
    )


def link_problems(system: SystemStructure, links: Mapping[str, Link]) -> list[Problem]:
    """Why *system* cannot be wired up by its *links*; DseError at once for a version of FMI nobody knows."""
    return [*_unsupported(system, links), *_loose_ends(system, links)]


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
                yield Problem(f"{name}: {why}")
        for variable in element.inputs:
            if variable.causality != "input" and variable.variability != "tunable":
                what = f"a wire ends at a {variable.causality} that is {variable.variability}, not tunable"
                yield Problem(f"{element.name}.{variable.name}: {what}")


def _unwireable(element: Element, variable: Variable) -> str:
    if type_of(variable, element.model.version) is None and text_type_of(variable, element.model.version) is None:
        return f"variables of type {variable.fmi_type} cannot be wired, only numbers, truth values and texts"
    if variable.is_clocked and not element.model.ticks:
        return "a variable that belongs to a clock is supported for co-simulation with event mode only"
    return ""


def _loose_ends(system: SystemStructure, links: Mapping[str, Link]) -> Iterable[Problem]:
    outputs, inputs = _variables(system, of_inputs=False), _variables(system, of_inputs=True)
    counted = Counter(target for wire in system.wires for _, target in _ends(wire, outputs, inputs))
    for wire in system.wires:
        yield from _unequal(wire, outputs, inputs)
    yield from (Problem(f"{target}: {n} wires end at one input") for target, n in counted.items() if n > 1)
    yield from _twice_by_other_names(system)
    labels = _text_types(system, of_inputs=True)
    yield from (
        Problem(f"{target}: a wire ends at what is not an input") for target in sorted(links.keys() - labels.keys())
    )
    known = _text_types(system, of_inputs=False)
    sources = {link.source for link in links.values()}
    yield from (
        Problem(f"{source}: a wire starts at what is not an output") for source in sorted(sources - known.keys())
    )
    for target, link in links.items():
        if target in labels and link.source in known:
            yield from _unlike(target, labels[target], link, known[link.source])
    for name, variable in sorted(inputs.items()):
        element = name[: -len(variable.name) - 1]
        if (
            variable.size
            and not variable.timing
            and not any(f"{element}.{label}" in links for label in variable.labels)
        ):
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


def _variables(system: SystemStructure, *, of_inputs: bool) -> Mapping[str, Variable]:
    return {f"{e.name}.{v.name}": v for e in system.elements for v in (e.inputs if of_inputs else e.outputs)}


def _text_types(system: SystemStructure, *, of_inputs: bool) -> Mapping[str, AccessorType | None]:
    return {
        f"{element.name}.{label}": text_type_of(variable, element.model.version)
        for element in system.elements
        for variable in (element.inputs if of_inputs else element.outputs)
        for label in variable.labels
    }


def _unlike(target: str, kind: AccessorType | None, link: Link, source_kind: AccessorType | None) -> Iterable[Problem]:
    if kind is not source_kind and not (kind and source_kind and kind.is_binary and source_kind.is_binary):
        words = ["a number" if k is None else _word(k) for k in (source_kind, kind)]
        yield Problem(f"{link.source} -> {target}: {words[0]} cannot be wired to {words[1]}")
    elif kind is not None and link.transform is not None:
        yield Problem(f"{link.source} -> {target}: {_word(kind)} takes no factor, offset or items")


def _word(kind: AccessorType) -> str:
    return "a binary" if kind.is_binary else "a string"


def _transform_of(wire: Wire) -> Conversion | None:
    """What *wire* does to a value, None if it passes on what it is given."""
    if wire.factor == 1.0 and wire.offset == 0.0 and not wire.items:
        return None
    return Conversion(wire.factor, wire.offset, wire.items)


def _ends(wire: Wire, outputs: Mapping[str, Variable], inputs: Mapping[str, Variable]) -> Iterable[tuple[str, str]]:
    source, target = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
    if source not in outputs or target not in inputs or not (outputs[source].shape or inputs[target].shape):
        return [(source, target)]
    return [
        (f"{wire.source}.{a}", f"{wire.target}.{b}")
        for a, b in zip(outputs[source].labels, inputs[target].labels, strict=False)
    ]
