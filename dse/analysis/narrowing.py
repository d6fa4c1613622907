"""Where to look next: the part of a study's ranges and configurations that something learnt from it points to."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from dse.analysis.boxes import Box
from dse.analysis.design_ranking import Standing
from dse.analysis.limits import Limit
from dse.analysis.phrases import outwards
from dse.domain.definition import DefinedVariable, StudyDefinition
from dse.domain.sampler import DesignVariable, Role
from dse.errors import fail
from dse.exploration import Band, design_variable, scaled, unit_of
from dse.storage import RunTable

_WIDER = 0.05
"""Of a variable's range, added at either end of what is found."""

_DOUBTFUL = 0.05
"""A verdict is in doubt where another one is at least so probable."""

_LOOKS = 2048


@dataclass(frozen=True, slots=True)
class Narrowing:
    """*ranges* of design variables by name, low and high (SI); *ids* of configurations, () for all of the study's;
    *where* is what is chosen, as choices by place, of which a configuration has one each."""

    ranges: Mapping[str, tuple[float, float]]
    ids: tuple[str, ...] = ()
    where: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def is_whole(self, definition: StudyDefinition) -> bool:
        """Whether it leaves out nothing of what the study's sampler is over."""
        whole = {variable.name: (variable.low, variable.high) for variable in definition.variables}
        ranges = all(whole[name] == ends for name, ends in self.ranges.items())
        return ranges and not self.where and (not self.ids or {*self.ids} == {*definition.explored})


def around(table: RunTable, number: int, share: float) -> Narrowing:
    """*share* of each range, around run *number*, and its configuration. DseError if there is no such run."""
    rows = np.flatnonzero(table.numbers == number)
    if not len(rows):
        raise fail(f"there is no run {number}", hint="'dse results' lists them")
    place = _places(table)[rows[0]]
    ranges = _ranges(table.header.definition, place - share / 2, place + share / 2)
    return Narrowing(ranges, (table.configurations[rows[0]],))


def around_designs(table: RunTable, designs: Sequence[Standing]) -> Narrowing:
    """What holds all of *designs*, and a little more. DseError if there are none."""
    if not designs:
        raise fail("no design meets all requirements", hint="'dse best' lists what would have to change")
    rows = np.searchsorted(table.numbers, [each.runs[0] for each in designs])
    return Narrowing(
        _spanned(table, _places(table)[rows]), tuple(dict.fromkeys(each.configuration for each in designs))
    )


def of_box(definition: StudyDefinition, box: Box) -> Narrowing:
    """What the designer can decide of *box*."""
    limits = {limit.factor.name: limit for limit in box.limits if limit.factor.is_decided}
    ranges = {}
    for defined in _decided(definition):
        limit = limits.get(defined.name)
        if limit is not None and not limit.factor.is_choice:
            low, high = (_value(limit, place, end) for place, end in ((limit.low, 0.0), (limit.high, 1.0)))
            ranges[defined.name] = _rounded(design_variable(defined), low, high)
    places = definition.design.places
    return Narrowing(ranges, where={name: limit.levels for name, limit in limits.items() if name in places})


def of_band(table: RunTable) -> Narrowing:
    """Where a verdict on some requirement is in doubt, by what the runs of each configuration tell of the others.

    DseError if that is nowhere.
    """
    from scipy.stats import qmc

    definition = table.header.definition
    variables = tuple(map(design_variable, definition.variables))
    points = scaled(qmc.Sobol(len(variables), seed=np.random.default_rng(0)).random(_LOOKS), variables)
    found: dict[str, list[np.ndarray]] = {}
    for name in dict.fromkeys(table.configurations):
        for requirement in table.header.requirements:
            doubtful = Band(table, requirement, name).at(points).misjudged > _DOUBTFUL
            if doubtful.any():
                found.setdefault(name, []).append(points[doubtful])
    if not found:
        raise fail("no verdict is in doubt anywhere in the ranges", hint="'dse refine --front', or '--around RUN'")
    places = unit_of(np.concatenate([part for parts in found.values() for part in parts]), variables)
    return Narrowing(_spanned(table, places), tuple(found))


def _spanned(table: RunTable, places: np.ndarray) -> dict[str, tuple[float, float]]:
    return _ranges(table.header.definition, places.min(axis=0) - _WIDER, places.max(axis=0) + _WIDER)


def _places(table: RunTable) -> np.ndarray:
    return unit_of(table.coordinates(), tuple(map(design_variable, table.header.definition.variables)))


def _ranges(definition: StudyDefinition, low: np.ndarray, high: np.ndarray) -> dict[str, tuple[float, float]]:
    ranges = {}
    for column, defined in enumerate(definition.variables):
        if defined.role == Role.DESIGN and not defined.labels:  # items have no order
            variable = design_variable(defined)
            ends = scaled(np.clip(np.array([[low[column]], [high[column]]]), 0.0, 1.0), (variable,))[:, 0]
            ranges[defined.name] = _rounded(variable, *ends.tolist())
    return ranges


def _decided(definition: StudyDefinition) -> Iterable[DefinedVariable]:
    return (defined for defined in definition.variables if defined.role == Role.DESIGN)


def _value(limit: Limit, place: float, end: float) -> float:
    return limit.factor.value(end if math.isnan(place) else min(max(place, 0.0), 1.0))


def _rounded(variable: DesignVariable, low: float, high: float) -> tuple[float, float]:
    """Outwards to a few digits of the variable's unit, within its range."""
    if variable.values:
        return low, high
    unit = variable.unit
    first = unit.to_si(outwards(unit.from_si(low), math.floor))
    last = unit.to_si(outwards(unit.from_si(high), math.ceil))
    return max(first, variable.low), min(last, variable.high)
