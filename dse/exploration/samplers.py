"""Samplers: which points of the design variables' box a study simulates, in a fixed order."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product

from dse.domain.run import RunRequest
from dse.domain.study import DesignVariable, FullFactorial, LatinHypercube, Study
from dse.errors import fail

Point = Mapping[str, float]

MOST_RUNS = 5_000_000
"""Larger studies are refused: no sampler here is a sensible way to spend them."""


def points(study: Study) -> list[Point]:
    """The study's points in SI by variable name, always in the same order; one empty point if nothing is varied."""
    if not study.variables:
        return [{}]
    match study.sampler:
        case FullFactorial():
            rows = full_factorial(study, study.sampler)
        case LatinHypercube():
            rows = latin_hypercube(study, study.sampler)
    names = [variable.name for variable in study.variables]
    return [dict(zip(names, row, strict=True)) for row in rows]


def requests(study: Study, configurations: Sequence[str]) -> tuple[RunRequest, ...]:
    """Every run of the study, numbered from 0: the points in order for the first configuration, then the next."""
    sample = points(study)
    _refuse_too_many(study, len(sample) * len(configurations))
    return tuple(
        RunRequest(number, configuration, point)
        for number, (configuration, point) in enumerate(product(configurations, sample))
    )


def full_factorial(study: Study, sampler: FullFactorial) -> list[tuple[float, ...]]:
    """Every combination of levels, the last variable fastest; with slices the union of the slices' factorials.

    A point that several slices share is listed once, where it comes first.
    """
    free = [set(names) for names in sampler.slices] or [{variable.name for variable in study.variables}]
    axes = [
        [levels(variable) if variable.name in names else (variable.nominal,) for variable in study.variables]
        for names in free
    ]
    _refuse_too_many(study, sum(math.prod(map(len, axis)) for axis in axes))
    return list(dict.fromkeys(point for axis in axes for point in product(*axis)))


def latin_hypercube(study: Study, sampler: LatinHypercube) -> list[tuple[float, ...]]:
    """Points of which every variable has exactly one in each of *samples* equal strata, placed by the study's seed."""
    _refuse_too_many(study, sampler.samples)
    import numpy as np
    from scipy.stats.qmc import LatinHypercube as Hypercube

    unit = Hypercube(len(study.variables), seed=np.random.default_rng(study.seed)).random(sampler.samples)
    low = np.array([variable.low for variable in study.variables])
    high = np.array([variable.high for variable in study.variables])
    # Rounding may carry a point past the end of its range.
    scaled = np.clip(low + unit * (high - low), low, high)
    return [tuple(row) for row in scaled.tolist()]


def levels(variable: DesignVariable) -> tuple[float, ...]:
    """The variable's equidistant levels from low to high, both included; its nominal value if it has only one.

    Each is the float nearest to the level computed from the decimal numbers the bounds are written as, so
    that 25 levels of 0.1 … 3 hold 1.55 and not its neighbour.
    """
    if variable.levels == 1:
        return (variable.nominal,)
    low, high, last = Fraction(str(variable.low)), Fraction(str(variable.high)), variable.levels - 1
    return tuple(float((low * (last - i) + high * i) / last) for i in range(variable.levels))


def _refuse_too_many(study: Study, runs: int) -> None:
    if runs > MOST_RUNS:
        raise fail(
            f"study {study.name} has {runs:,} runs, more than {MOST_RUNS:,}",
            study.where,
            "take fewer levels, slices of two variables, or sampler: latin_hypercube",
        )
