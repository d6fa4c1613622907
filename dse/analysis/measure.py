"""The measure of a study's space, and shares of it by a model of the verdicts.

A study may ask for whatever its ranges, scales, values, distributions, correlations and constraints allow, at each of
its conditions, on each of its configurations; points that are drawn evenly from that are a sample of the space. Runs
that were placed where verdicts change are none, but they say where the boundary is: a Gaussian process through their
margins gives the probability of each verdict at every point, and the share met is its mean over these points.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import ALL, MET, Floats, StudyData, withheld
from dse.analysis.probability import Interval
from dse.analysis.slack import FAILING
from dse.domain.definition import StudyDefinition
from dse.domain.sampler import Role
from dse.exploration import VerdictModel, allowing, conditions_of, design_variable, scaled, unit_of
from dse.expression import parse_expression
from dse.units import own_units

_POINTS, _MOST_DRAWN = 2**12, 2**16
_MOST_CONFIGURATIONS = 16
_SURE, _WIDEST = 0.95, 0.2


def modelled_share(data: StudyData, requirement: str) -> tuple[Interval, int]:
    """What share of the space meets *requirement* where it is exercised, or all of them, and at how many conditions.

    At the ends of the interval a point counts if that has a probability of 0.95, or of 0.05. A design is at the worst
    of its conditions. DseError if configurations are many or lack runs, or if the ends are more than 0.2 apart.
    """
    names, definition = [*dict.fromkeys(data.configurations.tolist())], data.definition
    placed = f"'{definition.sampler.kind}' did not place its runs evenly over the space"
    hint = "next: a study with 'sobol'"
    explored = {*definition.explored} or {*names[: not definition.design.places]}
    if len(names) > _MOST_CONFIGURATIONS or {*names} != explored:
        raise withheld(requirement, f"{placed}, and there is no model of so many configurations", hint)
    points = points_of(definition)
    passing, failing = np.swapaxes([_chances(data, name, requirement, points) for name in names], 0, 1)
    if requirement == ALL:
        failing = 1 - passing
    value = passing.mean() / (passing + failing).mean()
    surely, hardly = (passing >= _SURE).mean(), (passing > 1 - _SURE).mean()
    low = surely / (surely + (failing > 1 - _SURE).mean()) if surely else 0.0
    high = hardly / (hardly + (failing >= _SURE).mean()) if hardly else 0.0
    if high - low > _WIDEST:
        what = f"{placed}, and by a model of the verdicts it may be anything from {low:.0%} to {high:.0%}"
        raise withheld(requirement, what, hint)
    # What so many random points would be off; these are drawn more evenly.
    error = float(np.sqrt(max(value * (1 - value), 1 / len(points)) / len(points)))
    interval = Interval(float(value), max(float(low) - error, 0.0), min(float(high) + error, 1.0))
    return interval, points.shape[1]


def points_of(definition: StudyDefinition) -> NDArray[np.float64]:
    """Points of the space, (n, conditions, variables), SI: each at all conditions, of which there is one at least.

    DseError if the constraints between variables allow hardly any.
    """
    from scipy.stats import qmc

    variables = tuple(map(design_variable, definition.variables))
    is_free = np.array([variable.role is not Role.CONDITION for variable in variables], dtype=np.bool_)
    free = tuple(variable for variable in variables if variable.role is not Role.CONDITION)
    correlations = {(each.one, each.other): each.value for each in definition.correlations}
    conditions = np.array(conditions_of(variables) or [()], dtype=np.float64)
    with own_units(definition.units):
        allowed = allowing([parse_expression(text) for text in definition.constraints], variables)
    sequence = qmc.Sobol(max(len(free), 1), seed=np.random.default_rng(0))
    found: list[Floats] = []
    while sum(map(len, found)) < _POINTS and sequence.num_generated < _MOST_DRAWN:
        points = np.empty((_POINTS, len(conditions), len(variables)))
        points[:, :, is_free] = scaled(sequence.random(_POINTS)[:, : len(free)], free, correlations)[:, None]
        points[:, :, ~is_free] = conditions
        if allowed:
            points = points[allowed(points.reshape(-1, len(variables))).reshape(_POINTS, -1).all(axis=1)]
        found.append(points)
    if sum(map(len, found)) < _POINTS / 4:
        raise withheld("the space", "the constraints between variables allow less than one point in 60 of the ranges")
    return np.concatenate(found)


def _chances(data: StudyData, configuration: str, requirement: str, points: Floats) -> tuple[Floats, Floats]:
    """How probable it is, (n,), that *requirement* is met over the conditions of *points*, one being enough to exercise
    it; and that it is not met at one of them."""
    mine = data.part(data.configurations == configuration)
    variables = tuple(map(design_variable, data.definition.variables))
    places = {factor.name: column for factor, column in zip(mine.factors, mine.places.T, strict=True)}
    there = [k for k, each in enumerate(variables) if not np.isnan(places.get(each.name, np.array([np.nan]))).any()]
    runs = np.array([places[variables[k].name] for k in there]).reshape(len(there), len(mine)).T
    at = unit_of(points.reshape(-1, len(variables)), variables)[:, there]
    met, kept = np.ones(len(points)), np.ones(len(points))
    for name in data.verdicts if requirement == ALL else [requirement]:
        passing, failing = (each.reshape(points.shape[:2]) for each in chances_at(mine, name, runs, at))
        unfailed = (1 - failing).prod(axis=1)
        met, kept = met * (unfailed - np.maximum(1 - passing - failing, 0).prod(axis=1)), kept * unfailed
    return met, 1 - kept


def chances_at(data: StudyData, requirement: str, runs: Floats, points: Floats) -> tuple[Floats, Floats]:
    """How probable it is at *points* of the unit cube, (m, d), that *requirement* is met, or all are; and that one is
    not although it is exercised: by models through the runs of *data*, which are at *runs*, (n, d)."""
    passing, failing = np.ones(len(points)), np.zeros(len(points))
    for name in data.verdicts if requirement == ALL else [requirement]:
        margins = np.where(np.isin(data.codes(name), [MET, FAILING]), data.margins[name], np.nan)
        chances = VerdictModel(runs, margins).at(points)
        passing, failing = passing * chances.passing, 1 - (1 - failing) * (1 - chances.failing)
    return passing, failing
