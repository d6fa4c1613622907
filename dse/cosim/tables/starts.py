"""Start values of a system: which there are, by whom they are given, and in which order they are set."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sized
from dataclasses import dataclass, replace

from dse.cosim.binding.calls import text_type_of, type_of
from dse.cosim.wiring.wiring import VariableGroup, groups_by_type
from dse.domain.fmu import FmuModel, Variable
from dse.domain.labels import array_of, wholes
from dse.domain.system import Element, SystemStructure
from dse.errors import Problem, raise_if_any


@dataclass(frozen=True, slots=True)
class Starts:
    """Start values by ``element.label``: their *positions*, the system's own *values*, and each element's *groups*.

    *configuration* are the groups of structural parameters, which are set before all others and only by the system.
    *texts* are the groups of strings and binaries, with what to set in *own_texts*, by position.
    """

    positions: Mapping[str, int]
    values: tuple[float, ...]
    groups: tuple[tuple[VariableGroup, ...], ...]
    configuration: tuple[tuple[VariableGroup, ...], ...]
    texts: tuple[tuple[VariableGroup, ...], ...]
    own_texts: tuple[bytes, ...]
    structural: frozenset[str]


def starts_of(system: SystemStructure, extra: Iterable[str]) -> Starts:
    """The start values of *system* and those with the names *extra*, which have no value but the FMU's own yet.

    Values of an array that nobody gives are those the FMU's description tells. DseError for what cannot be set.
    """
    given = {f"{e.name}.{name}": float(value) for e in system.elements for name, value in e.start.items()}
    asked = dict.fromkeys(extra)
    named = _named(system, [*given, *asked])
    raise_if_any(_problems(system, given, asked, named))
    numbers: dict[str, float] = {}
    texts: dict[str, bytes] = {}
    structural: set[str] = set()
    groups: list[tuple[VariableGroup, ...]] = []
    configuration: list[tuple[VariableGroup, ...]] = []
    text_groups: list[tuple[VariableGroup, ...]] = []
    problems: list[Problem] = []
    for element in system.elements:
        wanted = named[element.name]
        for is_structural, parts in ((False, groups), (True, configuration)):
            part = []
            for group in groups_by_type(element, (v for v in wanted if v.is_structural is is_structural)):
                part.append(_placed(group, numbers))
                for name, variable, index in _values(element, group):
                    value = given[name] if name in given else _described(element, variable, index, name in asked)
                    if value is None:
                        problems.append(_untold(name, variable))
                    if is_structural:
                        structural.add(name)
                    numbers[name] = 0.0 if value is None else value
            parts.append(tuple(part))
        part = []
        for group in groups_by_type(element, _holding(element.model, element.texts), texts=True):
            part.append(_placed(group, texts))
            for name, variable, index in _values(element, group):
                label = variable.labels[index]
                text = element.texts[label] if label in element.texts else _described_text(variable, index)
                if text is None:
                    problems.append(_untold(name, variable))
                texts[name] = text.encode() if isinstance(text, str) else text or b""
        text_groups.append(tuple(part))
    raise_if_any(problems)
    return Starts(
        positions={name: position for position, name in enumerate(numbers)},
        values=tuple(numbers.values()),
        groups=tuple(groups),
        configuration=tuple(configuration),
        texts=tuple(text_groups),
        own_texts=tuple(texts.values()),
        structural=frozenset(structural),
    )


def _placed(group: VariableGroup, values: Sized) -> VariableGroup:
    """*group* with positions behind *values*."""
    return replace(group, positions=tuple(range(len(values), len(values) + len(group.labels))))


def _values(element: Element, group: VariableGroup) -> Iterator[tuple[str, Variable, int]]:
    for variable in group.variables:
        for index, label in enumerate(variable.labels):
            yield f"{element.name}.{label}", variable, index


def _described(element: Element, variable: Variable, index: int, asked: bool) -> float | None:
    if not variable.shape and asked:
        return 0.0  # a run gives the value
    texts = variable.start
    if not texts:
        return None
    text = texts[index] if len(texts) > 1 else texts[0]
    kind = type_of(variable, element.model.version)
    is_boolean = kind is not None and kind.is_boolean
    value = float(text.strip() in ("true", "1")) if is_boolean else float(text)
    conversion = element.conversions.get(variable.name)
    if conversion is None:
        return value
    if conversion.items:
        return next((outside for inside, outside in conversion.items if inside == value), None)
    return conversion.factor * value + conversion.offset


def _untold(label: str, variable: Variable) -> Problem:
    return Problem(
        f"{label}: the FMU does not give the start values of the array",
        hint=f"give a value to each of {variable.labels[0]} to {variable.labels[-1]}",
    )


def _described_text(variable: Variable, index: int) -> str | bytes | None:
    if not variable.start:
        return None
    text = variable.start[index] if len(variable.start) > 1 else variable.start[0]
    return bytes.fromhex(text) if variable.fmi_type == "Binary" else text


def _named(system: SystemStructure, names: Iterable[str]) -> dict[str, list[Variable]]:
    """The variables of each element that have values called one of *names*."""
    labels: dict[str, list[str]] = {element.name: [] for element in system.elements}
    for name in names:
        for whole in wholes(name):  # names of elements may have points, too
            if whole in labels:
                labels[whole].append(name[len(whole) + 1 :])
    return {element.name: _holding(element.model, labels[element.name]) for element in system.elements}


def _holding(model: FmuModel, labels: Iterable[str]) -> list[Variable]:
    """The variables of *model* that have values called one of *labels*, in its order."""
    wanted: dict[str, set[str]] = {}
    for label in labels:
        for name in (label, array_of(label)):
            wanted.setdefault(name, set()).add(label)
    return [v for name, v in model.variables.items() if name in wanted and not wanted[name].isdisjoint(v.labels)]


def _problems(
    system: SystemStructure, given: Iterable[str], asked: Iterable[str], named: Mapping[str, Iterable[Variable]]
) -> Iterable[Problem]:
    known: dict[str, tuple[Element, Variable]] = {}
    for element in system.elements:
        for variable in (*named[element.name], *_holding(element.model, element.texts)):
            known |= {f"{element.name}.{label}": (element, variable) for label in variable.labels}
    for name in dict.fromkeys([*given, *asked]):
        if name not in known:
            yield Problem(f"there is no variable '{name}' to set")
        elif type_of(known[name][1], known[name][0].model.version) is None:
            yield Problem(f"{name}: variables of type {known[name][1].fmi_type} cannot be given a number to start with")
        elif known[name][1].is_structural and name not in given:
            yield Problem(f"{name}: structural parameters cannot be given a value by a run")
    for element in system.elements:
        for label, text in element.texts.items():
            name = f"{element.name}.{label}"
            if name not in known:
                yield Problem(f"there is no variable '{name}' to set")
            elif text_type_of(known[name][1], element.model.version) is None:
                yield Problem(
                    f"{name}: variables of type {known[name][1].fmi_type} cannot be given a text to start with"
                )
            elif isinstance(text, bytes) != (known[name][1].fmi_type == "Binary"):
                yield Problem(f"{name}: a variable of type {known[name][1].fmi_type} cannot start as {text!r}")
            elif isinstance(text, str) and "\0" in text:
                yield Problem(f"{name}: a string cannot hold a zero character")
