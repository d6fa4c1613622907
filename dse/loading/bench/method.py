"""Reads by which co-simulation algorithm a test bench is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import TypeVar

from dse.domain.component import Component, Type
from dse.domain.method import Adaptive, Algorithm, Bond, Coupling, Extrapolation, Method
from dse.errors import DseError, Location, Problem, closest
from dse.formats.yaml import Document, Path_
from dse.loading.documents import AdaptiveSection, BondSection, SimulationSection
from dse.loading.names import check_name
from dse.loading.places import is_output, split_name, types_of
from dse.loading.values import Raw, read_number, read_unit
from dse.units import DIMENSIONLESS, describe, multiply

_AT: Path_ = ("simulation",)

E = TypeVar("E", bound=StrEnum)


def read_method(
    document: Document,
    section: SimulationSection,
    step: float,
    components: Mapping[str, tuple[Component, ...]],
    problems: list[Problem],
) -> Method:
    """The keys of ``simulation`` that choose the algorithm; *step* is the bench's, in seconds.

    *components* are what can stand at each place. What is wrong is added to *problems*; the result is then of no use.
    """
    places = _places(components)
    own: dict[str, Extrapolation] = {}
    everywhere = Extrapolation.HOLD
    if isinstance(section.extrapolation, str):
        everywhere = _one_of(Extrapolation, section.extrapolation, document.place((*_AT, "extrapolation")), problems)
    else:
        for part, word in section.extrapolation.items():
            at: Path_ = (*_AT, "extrapolation", part)
            _check_place(part, places, document.key(at), problems)
            own[part] = _one_of(Extrapolation, word, document.place(at), problems)
    return Method(
        algorithm=_one_of(Algorithm, section.algorithm, document.place((*_AT, "algorithm")), problems),
        coupling=_one_of(Coupling, section.coupling, document.place((*_AT, "coupling")), problems),
        extrapolation=everywhere,
        extrapolations=own,
        steps=_steps(document, section, step, places, problems),
        adaptive=_adaptive(document, section.adaptive, step, problems) if section.adaptive else None,
        bonds=tuple(_bond(document, name, bond, components, problems) for name, bond in section.bonds.items()),
    )


def _places(components: Mapping[str, tuple[Component, ...]]) -> set[str]:
    """Every path at which a part or an architecture with parts can stand."""
    steps = (path.split(".") for path in components)
    return {".".join(step[:length]) for step in steps for length in range(1, len(step) + 1)}


def _check_place(part: str, places: set[str], where: Location, problems: list[Problem]) -> None:
    if part not in places:
        problems.append(Problem(f"'{part}' names no part", where, closest(part, places)))


def _one_of(words: type[E], word: str, where: Location, problems: list[Problem]) -> E:
    known = {str(entry): entry for entry in words}
    if word not in known:
        problems.append(Problem(f"'{word}' is none of {', '.join(known)}", where, closest(word, known)))
    return known.get(word, next(iter(words)))


def _steps(
    document: Document, section: SimulationSection, step: float, places: set[str], problems: list[Problem]
) -> dict[str, float]:
    found: dict[str, float] = {}
    for part, raw in section.steps.items():
        at: Path_ = (*_AT, "steps", part)
        _check_place(part, places, document.key(at), problems)
        own = _positive(document, at, raw, "s", problems)
        if own is None:
            continue
        if not (_is_multiple(own, step) or _is_multiple(step, own)):
            what = f"the step of '{part}' ({raw}) is neither a multiple nor a fraction of 'step' ({section.step})"
            problems.append(Problem(what, document.place(at), "parts exchange values on one grid of time"))
        elif own > step and section.adaptive:
            what = f"'{part}' cannot have a longer step than the others where steps are adaptive"
            problems.append(Problem(what, document.place(at), "leave out 'adaptive' or this step"))
        found[part] = own
    return found


def _is_multiple(long: float, short: float) -> bool:
    ratio = long / short
    return ratio < 1e9 and round(ratio) >= 1 and abs(ratio - round(ratio)) <= 1e-9 * ratio


def _adaptive(document: Document, section: AdaptiveSection, step: float, problems: list[Problem]) -> Adaptive:
    at: Path_ = (*_AT, "adaptive")
    tolerance = _positive(document, (*at, "tolerance"), section.tolerance, "", problems)
    absolute = _positive(document, (*at, "absolute"), section.absolute, "", problems)
    smallest = _positive(document, (*at, "smallest"), section.smallest, "s", problems)
    if smallest is not None and smallest > step:
        what = f"'smallest' ({section.smallest}) is longer than the step"
        problems.append(Problem(what, document.place((*at, "smallest")), "the step is what adaptive steps begin with"))
    if tolerance is not None and tolerance >= 1.0:
        problems.append(Problem("'tolerance' must be below 1", document.place((*at, "tolerance")), "as 1e-4"))
    return Adaptive(tolerance or 1.0, absolute or 1.0, smallest or 1.0)


def _positive(document: Document, at: Path_, raw: Raw, unit: str, problems: list[Problem]) -> float | None:
    where = document.place(at) if document.has(at) else document.key(at[:-1])
    try:
        value = read_number(raw, read_unit(unit, where), where)
    except DseError as error:
        problems += error.problems
        return None
    if value > 0:
        return value
    problems.append(Problem(f"'{at[-1]}' must be positive, not {raw}", where))
    return None


def _bond(
    document: Document,
    name: str,
    section: BondSection,
    components: Mapping[str, tuple[Component, ...]],
    problems: list[Problem],
) -> Bond:
    at: Path_ = (*_AT, "bonds", name)
    check_name(name, document.key(at), problems)
    dimensions = []
    for key, signal in (("effort", section.effort), ("flow", section.flow)):
        where = document.place((*at, key))
        try:
            dimensions.append(_output(signal, components, where).unit.dimension)
        except DseError as error:
            problems += error.problems
    if len(dimensions) == 2 and multiply(*dimensions) != read_unit("W", document.key(at)).dimension:
        found = describe(multiply(*dimensions)) if multiply(*dimensions) != DIMENSIONLESS.dimension else "no unit"
        what = f"'{section.effort}' times '{section.flow}' is no power: it is {found}"
        problems.append(Problem(what, document.key(at), "name an effort and the flow that goes with it"))
    return Bond(name, section.effort, section.flow)


def _output(signal: str, components: Mapping[str, tuple[Component, ...]], where: Location) -> Type:
    place, port = split_name(signal, components, where)
    found = [type_ for component, type_ in types_of(signal, components, where) if is_output(component, port)]
    if not found:
        outputs = {p.name for c in components[place] for p in c.interface.ports if is_output(c, p.name)}
        raise DseError(Problem(f"'{signal}' is no output", where, closest(port, outputs)))
    return found[0]
