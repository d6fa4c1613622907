"""Start values of a system: which there are, by whom they are given, and in which order they are set."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from dse.cosim.binding.calls import TRUTHS, text_type_of, type_of
from dse.cosim.wiring.conversion import outside
from dse.cosim.wiring.wiring import Group, groups_by_type
from dse.domain.fmu import Variable
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
    groups: tuple[tuple[Group, ...], ...]
    configuration: tuple[tuple[Group, ...], ...]
    texts: tuple[tuple[Group, ...], ...]
    own_texts: tuple[bytes, ...]
    structural: frozenset[str]


def starts_of(system: SystemStructure, extra: Iterable[str]) -> Starts:
    """The start values of *system* and those with the names *extra*, which have no value but the FMU's own yet.

    Values of an array that nobody gives are those the FMU's description tells. DseError for what cannot be set.
    """
    given = {f"{e.name}.{name}": float(value) for e in system.elements for name, value in e.start.items()}
    asked = dict.fromkeys(extra)
    raise_if_any(_problems(system, given, asked))
    at: dict[str, int] = {}
    own: list[float] = []
    groups: list[tuple[Group, ...]] = []
    configuration: list[tuple[Group, ...]] = []
    problems: list[Problem] = []
    for element in system.elements:
        wanted = [v for v in element.model.variables.values() if _is_wanted(element, v, given.keys() | asked.keys())]
        for is_structural, parts in ((False, groups), (True, configuration)):
            part = []
            for group in groups_by_type(element, (v for v in wanted if v.is_structural is is_structural)):
                labels = [
                    (f"{element.name}.{label}", v, i) for v in group.variables for i, label in enumerate(v.labels)
                ]
                part.append(replace(group, positions=tuple(range(len(at), len(at) + len(labels)))))
                at |= {label: len(at) + number for number, (label, _, _) in enumerate(labels)}
                for label, variable, index in labels:
                    value = given[label] if label in given else _described(element, variable, index, label in asked)
                    if value is None:
                        problems.append(_untold(label, variable))
                    own.append(0.0 if value is None else value)
            parts.append(tuple(part))
    raise_if_any(problems)
    texts, own_texts = _texts(system)
    structural = frozenset(
        f"{element.name}.{label}"
        for element, part in zip(system.elements, configuration, strict=True)
        for group in part
        for label in group.labels
    )
    return Starts(at, tuple(own), tuple(groups), tuple(configuration), texts, own_texts, structural)


def _is_wanted(element: Element, variable: Variable, names: Iterable[str]) -> bool:
    return any(f"{element.name}.{label}" in names for label in variable.labels)


def _described(element: Element, variable: Variable, index: int, asked: bool) -> float | None:
    if not variable.shape and asked:
        return 0.0  # a run gives the value
    texts = variable.start
    if not texts:
        return None
    text = texts[index] if len(texts) > 1 else texts[0]
    kind = type_of(variable, element.model.version)
    value = float(text.strip() in ("true", "1")) if kind in TRUTHS else float(text)
    return outside(element.conversions.get(variable.name), value)


def _untold(label: str, variable: Variable) -> Problem:
    return Problem(
        f"{label}: the FMU does not tell the start values of the array",
        hint=f"give a value to each of {variable.labels[0]} to {variable.labels[-1]}",
    )


def _texts(system: SystemStructure) -> tuple[tuple[tuple[Group, ...], ...], tuple[bytes, ...]]:
    own: list[bytes] = []
    parts = []
    problems: list[Problem] = []
    for element in system.elements:
        named = [v for v in element.model.variables.values() if any(label in element.texts for label in v.labels)]
        part = []
        for group in groups_by_type(element, named, texts=True):
            labels = [(label, v, i) for v in group.variables for i, label in enumerate(v.labels)]
            part.append(replace(group, positions=tuple(range(len(own), len(own) + len(labels)))))
            for label, variable, index in labels:
                text = element.texts[label] if label in element.texts else _described_text(variable, index)
                if text is None:
                    problems.append(_untold(f"{element.name}.{label}", variable))
                own.append(text.encode() if isinstance(text, str) else text or b"")
        parts.append(tuple(part))
    raise_if_any(problems)
    return tuple(parts), tuple(own)


def _described_text(variable: Variable, index: int) -> str | bytes | None:
    if not variable.start:
        return None
    text = variable.start[index] if len(variable.start) > 1 else variable.start[0]
    return bytes.fromhex(text) if variable.fmi_type == "Binary" else text


def _problems(system: SystemStructure, given: Iterable[str], asked: Iterable[str]) -> Iterable[Problem]:
    known: dict[str, tuple[Element, Variable]] = {}
    for element in system.elements:
        for variable in element.model.variables.values():
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
