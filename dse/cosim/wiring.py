"""A system as positions in one table of values: where each output lies and where each input takes its value from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from dse.cosim.calls import Type, type_of
from dse.domain.fmu import Variable
from dse.domain.system import Element, SystemStructure
from dse.errors import Problem, fail, raise_if_any


@dataclass(frozen=True, slots=True)
class Group:
    """Variables of one element that one accessor call reads or writes.

    *positions* say where outputs lie in the table of values, where in it inputs take their values from, and where
    starts lie in the table of start values. Outputs and starts lie one after another, group by group.
    """

    type: Type
    variables: tuple[Variable, ...]
    positions: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Wiring:
    """*values* names what lies at each position of the table; *outputs*, *inputs* hold one tuple per element.

    *wired* are the positions of outputs that a wire starts at. *sweeps* is how many
    sweeps an initialization without algebraic loops needs at most: one for every wired output along the longest
    path, one for outputs that are only recorded, one to see that nothing changes any more.
    """

    system: SystemStructure
    values: tuple[str, ...]
    outputs: tuple[tuple[Group, ...], ...]
    inputs: tuple[tuple[Group, ...], ...]
    wired: tuple[int, ...]

    @property
    def sweeps(self) -> int:
        """Most sweeps over all elements the initialization may take."""
        return len(self.wired) + 2

    def record(self, names: Sequence[str]) -> tuple[int, ...]:
        """Positions of the outputs called *names*; DseError naming those that are none."""
        positions = {name: position for position, name in enumerate(self.values)}
        raise_if_any(_no_output(name, self.system) for name in names if name not in positions)
        return tuple(positions[name] for name in names)


def wire_up(system: SystemStructure) -> Wiring:
    """Number all outputs of *system* and find every input's source; DseError for what cannot be simulated."""
    wired_from = {f"{w.target}.{w.target_variable}": f"{w.source}.{w.source_variable}" for w in system.wires}
    sources = set(wired_from.values())
    raise_if_any([*_unsupported(system, wired_from, sources), *_loose_ends(system, wired_from)])
    position = 0
    outputs = []
    for element in system.elements:
        groups = []
        for kind, variables in _by_type(element, _readable(element)):
            groups.append(Group(kind, variables, tuple(range(position, position + len(variables)))))
            position += len(variables)
        outputs.append(tuple(groups))
    names = tuple(
        f"{element.name}.{variable.name}"
        for element, groups in zip(system.elements, outputs, strict=True)
        for group in groups
        for variable in group.variables
    )
    at = {name: index for index, name in enumerate(names)}
    inputs = tuple(
        tuple(
            Group(kind, variables, tuple(at[wired_from[f"{element.name}.{v.name}"]] for v in variables))
            for kind, variables in _by_type(element, element.inputs)
        )
        for element in system.elements
    )
    return Wiring(
        system,
        names,
        tuple(outputs),
        inputs,
        tuple(index for index, name in enumerate(names) if name in sources),
    )


def start_groups(
    system: SystemStructure, extra: Iterable[str]
) -> tuple[Mapping[str, int], tuple[float, ...], tuple[tuple[Group, ...], ...]]:
    """Start values by ``element.variable``: their positions, the system's own values, and each element's groups.

    *extra* are names that get a position (and no value but 0) besides those the system sets itself.
    """
    wanted = {f"{e.name}.{name}": float(value) for e in system.elements for name, value in e.start.items()}
    wanted |= {name: 0.0 for name in extra if name not in wanted}
    problems = []
    groups = []
    at: dict[str, int] = {}
    for element in system.elements:
        prefix = f"{element.name}."
        named = [v for v in element.model.variables.values() if prefix + v.name in wanted]
        problems += [p for v in named if (p := _unsettable(element, v))]
        part = []
        for kind, variables in _by_type(element, named):
            part.append(Group(kind, variables, tuple(range(len(at), len(at) + len(variables)))))
            at |= {prefix + v.name: len(at) + number for number, v in enumerate(variables)}
        groups.append(tuple(part))
    known = {f"{e.name}.{v.name}" for e in system.elements for v in e.model.variables.values()}
    problems += [Problem(f"there is no variable '{name}' to set") for name in wanted if name not in known]
    raise_if_any(problems)
    return at, tuple(wanted[name] for name in at), tuple(groups)


def _by_type(element: Element, variables: Iterable[Variable]) -> list[tuple[Type, tuple[Variable, ...]]]:
    typed: dict[Type, list[Variable]] = {}
    for variable in variables:
        kind = type_of(variable, element.model.version)
        if kind is not None:
            typed.setdefault(kind, []).append(variable)
    return [(kind, tuple(typed[kind])) for kind in sorted(typed)]


def _readable(element: Element) -> tuple[Variable, ...]:
    return tuple(v for v in element.outputs if type_of(v, element.model.version) is not None)


def _unsupported(system: SystemStructure, wired_from: Mapping[str, str], sources: set[str]) -> Iterable[Problem]:
    for element in system.elements:
        version = element.model.version
        if version not in (2, 3):
            raise fail(f"{element.name}: FMI {version} is not supported", hint="export the FMU as FMI 2.0 or 3.0")
        for variable in (*element.inputs, *element.outputs):
            name = f"{element.name}.{variable.name}"
            if type_of(variable, version) is None and (name in wired_from or name in sources):
                yield Problem(
                    f"{name}: variables of type {variable.fmi_type} cannot be wired",
                    hint="wire real, integer, Boolean or enumeration variables",
                )


def _loose_ends(system: SystemStructure, wired_from: Mapping[str, str]) -> Iterable[Problem]:
    inputs = {f"{e.name}.{v.name}" for e in system.elements for v in e.inputs}
    outputs = {f"{e.name}.{v.name}" for e in system.elements for v in e.outputs}
    counted: dict[str, int] = {}
    for wire in system.wires:
        target = f"{wire.target}.{wire.target_variable}"
        counted[target] = counted.get(target, 0) + 1
    yield from (Problem(f"{target}: {n} wires end at one input") for target, n in counted.items() if n > 1)
    yield from (
        Problem(f"{target}: a wire ends at what is not an input") for target in sorted(wired_from.keys() - inputs)
    )
    yield from (
        Problem(f"{source}: a wire starts at what is not an output")
        for source in sorted(set(wired_from.values()) - outputs)
    )
    yield from (Problem(f"{name}: no wire ends at this connected input") for name in sorted(inputs - set(wired_from)))


def _unsettable(element: Element, variable: Variable) -> Problem | None:
    name = f"{element.name}.{variable.name}"
    if type_of(variable, element.model.version) is None:
        return Problem(f"{name}: variables of type {variable.fmi_type} cannot be given a start value")
    if variable.causality == "structuralParameter":
        return Problem(f"{name}: structural parameters cannot be given a value")
    return None


def _no_output(name: str, system: SystemStructure) -> Problem:
    strings = {f"{e.name}.{v.name}": v.fmi_type for e in system.elements for v in e.outputs}
    if name in strings:
        return Problem(f"{name}: variables of type {strings[name]} cannot be recorded")
    return Problem(f"there is no output '{name}' to record", hint="outputs are named element.variable")
