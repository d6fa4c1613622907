"""What each metric depends on, part by part: shares of its variance, means along factors, and a formula for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TypeVar

import numpy as np

from dse.analysis import (
    Factor,
    Formula,
    IndexEstimates,
    Interval,
    StudyData,
    alias_sentences,
    centres_of,
    drawn,
    features,
    formulas,
    importances,
    main_effects,
    model_first_order_shares,
    sobol_indices,
)
from dse.errors import DseError, fail
from dse.report.content.data import Floats
from dse.report.content.insight import (
    ALIASED,
    Bar,
    Effect,
    Estimate,
    FactorAxis,
    Pair,
    Part,
    Profile,
    Response,
    Together,
)
from dse.report.insight.naming import Naming
from dse.units import Unit, parse_unit

MOST_METRICS = 16
"""Those behind requirements and objectives first."""

MOST_RUNS = 2000
"""Of which formulas are made."""

_STEPS = 33
_LEAST = 12
_DESIGN = "sobol_indices"
_TOGETHER = "total effects"

T = TypeVar("T")


def part_of(data: StudyData, naming: Naming) -> Part:
    """Of the runs *data*, which may be compared with each other; formulas of 2,000 drawn at most."""
    definition = data.definition
    wanted = [entry.metric for entry in definition.requirements]
    wanted += [each.name for each in definition.objectives if each.name in data.metrics]
    names = [*dict.fromkeys([*wanted, *data.metrics])][:MOST_METRICS]
    fits = _Fits(data)
    fits.make(names)
    return Part(
        naming.plane(data.plane),
        tuple(_axis(factor, naming) for factor in data.factors),
        len(data),
        data.apart,
        tuple(centres.astype(np.float32) for centres in fits.centres),
        tuple(_response(data, name, fits, naming) for name in names),
    )


@dataclass(slots=True)
class _Fits:
    """Formulas by metric; metrics that are defined in the same runs share their centres."""

    data: StudyData
    centres: list[Floats] = field(default_factory=list)
    found: dict[str, tuple[int, Formula, int]] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)

    def make(self, names: list[str]) -> None:
        """For as many of the metrics *names* as there can be one."""
        groups: dict[bytes, list[str]] = {}
        for name in names:
            try:
                self._refuse(name)
            except DseError as error:
                self.reasons[name] = _reason(error, name)
            else:
                groups.setdefault(np.isfinite(self.data.metrics[name]).tobytes(), []).append(name)
        for those in groups.values():
            self._fit(those)

    def _refuse(self, name: str) -> None:
        self.data.response(name, _LEAST)
        data = self.data
        if not data.factors:
            raise fail("runs do not differ in anything")
        absent = [f.name for f, column in zip(data.factors, data.places.T, strict=True) if np.isnan(column).any()]
        if absent:
            raise fail(f"some runs lack {absent[0]}, and a formula needs all factors in every run")

    def _fit(self, names: list[str]) -> None:
        rows = np.flatnonzero(np.isfinite(self.data.metrics[names[0]]))
        rows = drawn(rows, MOST_RUNS)
        points = features(self.data.places[rows], self.data.factors)
        if len(rows) < max(_LEAST, 2 * (points.shape[1] + 1)):
            self.reasons |= dict.fromkeys(names, f"{len(rows)} runs are too few for {points.shape[1]} factors")
            return
        values = np.stack([self.data.metrics[name][rows] for name in names], axis=1)
        centres = centres_of(points)
        spread = values.std(axis=0)
        spread[spread == 0] = 1.0
        scaled = (values - values.mean(axis=0)) / spread
        made = formulas(points, scaled, centres, self.data.points[rows])
        self.centres.append(centres)
        for name, formula, middle, scale in zip(names, made, values.mean(axis=0), spread, strict=True):
            weights = formula.weights * scale
            weights[len(centres)] += middle
            self.found[name] = (
                len(self.centres) - 1,
                replace(formula, weights=weights, error=formula.error * scale),
                len(rows),
            )


def _response(data: StudyData, name: str, fits: _Fits, naming: Naming) -> Response:
    unit = parse_unit(next(metric.unit for metric in data.definition.metrics if metric.name == name))
    withheld: list[str] = []
    shares = _or_reason(lambda: model_first_order_shares(data, name), "what explains it", name, withheld)
    effects = _or_reason(lambda: main_effects(data, name), "means along factors", name, withheld)
    if effects is not None:
        withheld += [f"{ALIASED}: {each}" for each in alias_sentences(data.evenly(name, 1), name)]
    profile = None
    if name in fits.found:
        profile = _profile(fits, name, unit)
    else:
        withheld.append(f"a formula: {fits.reasons[name]}")
    is_several = len(data.factors) > 1
    together = _or_reason(lambda: _together(data, name, withheld), _TOGETHER, name, withheld) if is_several else None
    return Response(
        naming.metrics[name],
        tuple(_bar(data, share.factor, share.share) for share in shares or ()),
        tuple(
            Effect(
                data.factor(each.factor),
                each.at,
                tuple(_estimate(mean.value, mean.low, mean.high, unit) for mean in each.means),
            )
            for each in effects or ()
        ),
        profile,
        tuple(dict.fromkeys(map(naming.spoken, withheld))),
        together,
    )


def _together(data: StudyData, name: str, told: list[str]) -> Together:
    """By the design, if the study is made for it, else by a model. DseError says why it cannot be stated; *told* is
    given what is left out."""
    if data.definition.sampler.kind == _DESIGN:
        designed = sobol_indices(data, name)
        indices = [(each.factor, each.total) for each in designed.factors if isinstance(each, IndexEstimates)]
        return Together(f"Sobol' indices of {designed.blocks} blocks", tuple(_bar(data, *each) for each in indices), ())
    if name not in data.judged_metrics:
        raise fail("no requirement or objective is about it")
    found = importances(data, name)
    # Factors that depend on each other have one total; the same bar for each of them would count it several times.
    totals = [_bar(data, each.factors[0], each.share) for each in found.factors if len(each.factors) == 1]
    told += [f"{_TOGETHER} of single factors: {each}" for each in found.joint]
    pairs = [
        Pair(data.factor(one), data.factor(other), _shown(pair.share))
        for pair in found.pairs
        for one, other in product(pair.one, pair.other)
        if len(pair.one) == len(pair.other) == 1
    ]
    return Together(found.source, tuple(sorted(totals, key=lambda bar: bar.factor)), tuple(pairs))


def _profile(fits: _Fits, name: str, unit: Unit) -> Profile:
    at, formula, runs = fits.found[name]
    factor, offset = float(unit.factor), float(unit.offset)
    weights = formula.weights / factor
    weights[len(fits.centres[at])] -= offset / factor
    return Profile(formula.power, formula.error / factor, formula.explained, runs, at, weights.astype(np.float32))


def _bar(data: StudyData, factor: str, share: Interval) -> Bar:
    return Bar(data.factor(factor), _shown(share))


def _shown(share: Interval) -> Estimate:
    """A share as it can be: an estimate may lie outside of 0 … 1."""
    first, second, third = (min(max(each, 0.0), 1.0) for each in (share.value, share.low, share.high))
    return first, second, third


def _estimate(value: float, low: float, high: float, unit: Unit) -> Estimate:
    first, second, third = (unit.from_si(each) for each in (value, low, high))
    return first, second, third


def _axis(factor: Factor, naming: Naming) -> FactorAxis:
    if factor.is_choice:
        return FactorAxis(naming.titled(factor.name), "", -1, (), factor.levels, factor.is_condition)
    unit = parse_unit(factor.unit)
    values = tuple(unit.from_si(factor.value(place)) for place in np.linspace(0, 1, _STEPS).tolist())
    place = naming.variables[factor.name]
    return FactorAxis(naming.titled(factor.name), str(unit), place, values, is_condition=factor.is_condition)


def _or_reason(make: Callable[[], T], what: str, about: str, withheld: list[str]) -> T | None:
    try:
        return make()
    except DseError as error:
        withheld.append(f"{what}: {_reason(error, about)}")
        return None


def _reason(error: DseError, about: str) -> str:
    return error.problems[0].what.removeprefix(f"{about}: ")
