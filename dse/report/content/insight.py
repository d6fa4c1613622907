"""What was asked of a study and what its runs tell, as the page shows it: plain values in display units.

A *plane* holds positions of variables that were varied while all others were held; () where none was held. Factors are
the variables and the choices in which runs differ. Estimates are ``(value, low, high)``, NaN without an interval.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Plane = tuple[int, ...]
Estimate = tuple[float, float, float]


ALIASED = "effects of single factors"
"""What is withheld of factors that always change together begins with it."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What the study was to find out: *sentences*, and a word on each variable, metric, and requirement, in order.

    *constants* are parameters that have the same value (SI) in every configuration; others are *differing*.
    """

    sentences: tuple[str, ...]
    roles: tuple[str, ...]
    spreads: tuple[str, ...]
    expressions: tuple[str, ...]
    exercised: tuple[str, ...]
    constants: tuple[tuple[str, float], ...] = ()
    differing: int = 0
    unfinished: int = 0


@dataclass(frozen=True, slots=True)
class InsightFinding:
    """A sentence of `dse.analysis`."""

    plane: Plane
    topic: str
    text: str


@dataclass(frozen=True, slots=True)
class Range:
    """Part of the range of the variable at a position."""

    variable: int
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class InsightBox:
    """Limits within which all requirements are met more often than elsewhere; *choices* are those that are no range."""

    plane: Plane
    text: str
    density: Estimate
    coverage: float
    checked: int
    ranges: tuple[Range, ...]
    choices: str


@dataclass(frozen=True, slots=True)
class Centre:
    """The run around which most can change at once: every number by *margin* of its range.

    Of *around* held-out runs that are there, this *share* passes. *limit* is the nearest run that does not, -1 where a
    range ends before.
    """

    plane: Plane
    run: int
    margin: float
    around: int
    limit: int
    share: Estimate
    ranges: tuple[Range, ...]


@dataclass(frozen=True, slots=True)
class FactorAxis:
    """A factor: *values* at even places from 0 to 1, or the *levels* of a choice, which has no *variable* (-1).

    If it *is_condition*, it is no choice.
    """

    title: str
    unit: str
    variable: int
    values: tuple[float, ...]
    levels: tuple[str, ...] = ()
    is_condition: bool = False


@dataclass(frozen=True, slots=True)
class Bar:
    """The share of a metric's variance that the factor at a position explains by itself."""

    factor: int
    share: Estimate


@dataclass(frozen=True, slots=True)
class Effect:
    """Means of a metric along the factor at a position, at *places* (0 … 1)."""

    factor: int
    places: tuple[float, ...]
    means: tuple[Estimate, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """A formula for a metric: ``sum(w_j |f - f_j|^power) + tail . (1, f)`` over the centres *f_j* of the part.

    Features f are ``2 place - 1`` of a number, and of a choice 1 for its level and 0 for all others but the first.
    *error* is the root mean square, *explained* the share of the variance, both of *runs* runs left out in turn.
    """

    power: int
    error: float
    explained: float
    runs: int
    centres: int
    weights: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Pair:
    """The share of a metric's variance that depends on both of the factors at two positions, and perhaps on more."""

    one: int
    other: int
    share: Estimate


@dataclass(frozen=True, slots=True)
class Together:
    """What each factor has to do with of a metric's variance, what it does together with others included.

    *source* says in words how it was found out.
    """

    source: str
    totals: tuple[Bar, ...]
    pairs: tuple[Pair, ...]


@dataclass(frozen=True, slots=True)
class Response:
    """What the metric at a position depends on; *withheld* is what cannot be told, and why."""

    metric: int
    bars: tuple[Bar, ...]
    effects: tuple[Effect, ...]
    profile: Profile | None
    withheld: tuple[str, ...]
    together: Together | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """*runs* runs that may be compared, *apart* others that may not; *centres* are (n, features) each."""

    plane: Plane
    factors: tuple[FactorAxis, ...]
    runs: int
    apart: int
    centres: tuple[NDArray[np.float32], ...]
    responses: tuple[Response, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ChanceMap:
    """How probable it is that the requirement at a position is met, and that its verdict is another than the likeliest.

    On even places in the ranges of two variables, (*size*, *size*) percents each with x fastest, of one configuration;
    *held* are values of the other design variables; of the *conditions* of its runs it is the worst at each place.
    From *used* of *runs* runs. *uncertain* is the share of misjudged places.
    """

    plane: Plane
    configuration: int
    requirement: int
    size: int
    passing: NDArray[np.uint8]
    misjudged: NDArray[np.uint8]
    uncertain: float
    held: tuple[tuple[int, float], ...]
    used: int
    runs: int
    conditions: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Around:
    """The robust centre's plane: *passing* of the *map* is how probable at least all requirements (-1) are met.

    *outline* is the largest ellipse around the *run*, by places (0 … 1), without a place where that is less than 95 %;
    () if that is so beside the run already.
    """

    run: int
    map: ChanceMap
    outline: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Pick:
    """A design that is best, with its *run* (the worst one of its runs) and what its objectives are."""

    run: int
    configuration: int
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Stage:
    """A search after *runs* runs: *best* objective of a feasible design, or the *volume* that the front dominates."""

    runs: int
    feasible: int
    volume: float
    best: float


@dataclass(frozen=True, slots=True)
class SearchCourse:
    """What came of the objectives: the *picks* best first, or along the front, whose *knee* is at that position."""

    objectives: tuple[str, ...]
    units: tuple[str, ...]
    picks: tuple[Pick, ...]
    knee: int
    designs: int
    feasible: int
    unfinished: int
    stages: tuple[Stage, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Insight:
    """All of it; *withheld* is what of it cannot be told, and why. Of many runs it is told of *drawn* ones, else 0."""

    asked: Asked
    told: tuple[InsightFinding, ...] = ()
    boxes: tuple[InsightBox, ...] = ()
    centres: tuple[Centre, ...] = ()
    parts: tuple[Part, ...] = ()
    chances: tuple[ChanceMap, ...] = ()
    around: tuple[Around, ...] = ()
    search: SearchCourse | None = None
    withheld: tuple[str, ...] = ()
    drawn: int = 0
