"""Functions of the unit cube, studies of them by several samplers, and whether what findings say of them is true."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from zlib import crc32

import numpy as np
from known_functions import Floats, even, g_function, ishigami, study
from scipy.stats import qmc

from dse.analysis import (
    Box,
    Importances,
    Interval,
    StudyData,
    Together,
    best_boxes,
    courses,
    importances,
    model_first_order_shares,
    robust_centre,
    share_met,
    study_data,
)
from dse.domain.bench import Verdict
from dse.domain.component import NO_INTERFACE, Component
from dse.domain.definition import DefinedSampler
from dse.domain.design import Compound, DesignSpace, Part
from dse.domain.sampler import Brief, DesignVariable, Objective, Outcomes
from dse.errors import DseError
from dse.loading import SAMPLERS
from dse.space import open_space
from dse.storage import RunTable
from dse.units import DIMENSIONLESS

RUNS = 256
_MANY = 2**16
PLACED: Mapping[str, Mapping[str, int]] = {
    "boundary": {"samples": RUNS // 2},
    "nsga2": {"evaluations": RUNS},
    "mixed_gp": {"evaluations": RUNS // 4},
}


@dataclass(frozen=True)
class Known:
    """*value* is met where it is at most *bound*; points are those of the cube that are *allowed*."""

    value: Callable[[Floats], Floats]
    width: int
    bound: float
    allowed: str = ""
    trend: str = ""
    """What x1 does to the mean, if that is one of the words."""

    def there(self, points: Floats) -> Floats:
        """Those of *points* that are allowed."""
        return points[points[:, 0] + points[:, 1] < float(self.allowed.split()[-1])] if self.allowed else points

    def met(self, points: Floats) -> Floats:
        return self.value(points) <= self.bound


def _noise(points: Floats) -> Floats:
    return np.array([crc32(row.tobytes()) / 2**32 for row in points])


KNOWN = {
    "Ishigami": Known(ishigami, 3, 3.0),
    "g-function": Known(g_function, 4, 0.8, trend="with a valley"),
    "interaction": Known(lambda x: (2 * x[:, 0] - 1) * (2 * x[:, 1] - 1), 3, 0.1),
    "ball": Known(lambda x: ((x - 0.5) ** 2).sum(axis=1), 4, 0.16, trend="with a valley"),
    "ring": Known(lambda x: np.abs(np.hypot(*(x - 0.5).T) - 0.3), 2, 0.1),
    "islands": Known(lambda x: np.minimum(*(np.hypot(*(x - at).T) for at in (0.25, 0.75))), 2, 0.18),
    "half-plane": Known(lambda x: x[:, 0] + x[:, 1] / 2, 3, 0.6, trend="rising"),
    "noise": Known(_noise, 3, 0.5),
    "step": Known(lambda x: 1.0 * (x[:, 0] > 0.4) + 0.5 * (x[:, 1] > 0.7), 3, 0.2, trend="rising"),
    "constrained": Known(lambda x: x[:, 0] + x[:, 1], 2, 0.4, "x1 + x2 < 0.6", "rising"),
}


def made(known: Known, kind: str, seed: int) -> StudyData:
    """A study of *known* by the sampler *kind*."""
    if kind in PLACED:
        table = _searched(known, kind, seed)
    else:
        engine = {"sobol": qmc.Sobol, "latin_hypercube": qmc.LatinHypercube, "halton": qmc.Halton}[kind]
        points = known.there(engine(known.width, seed=np.random.default_rng(seed)).random(RUNS))
        table = _study(known, points, kind)
    constraints = (known.allowed,) if known.allowed else ()
    definition = replace(table.header.definition, constraints=constraints)
    return study_data(replace(table, header=replace(table.header, definition=definition)))


def _study(known: Known, points: Floats, kind: str) -> RunTable:
    return study(points, {"y": known.value(points)}, {"y": known.bound}, sampler=DefinedSampler(kind))


def _searched(known: Known, kind: str, seed: int) -> RunTable:
    variables = tuple(DesignVariable(f"x{k + 1}", 0.0, 1.0, 2, 0.5, DIMENSIONLESS) for k in range(known.width))
    space = open_space(DesignSpace("only", Compound("only", {"part": Part(Component("part", NO_INTERFACE))})))
    (only,) = space.architectures().draw(1, 1)

    def outcomes(points: Floats) -> Outcomes:
        y = known.value(points)
        verdicts = {"R1": tuple(np.where(y <= known.bound, Verdict.PASS, Verdict.FAIL).tolist())}
        columns = {variable.name: points[:, k] for k, variable in enumerate(variables)}
        done = np.ones(len(y), dtype=np.bool_)
        return Outcomes((only.id,) * len(y), columns, done, {"y": y}, {"R1": known.bound - y}, verdicts)

    nothing = outcomes(np.zeros((0, known.width)))
    brief = Brief(variables, (only.id,), seed, nothing, space.architectures(), (Objective("y"),))
    if known.allowed:
        brief = replace(brief, allowed=lambda points: points[:, 0] + points[:, 1] < 0.6)
    search = SAMPLERS.get(kind)(**PLACED[kind]).start(brief)
    asks: list[Floats] = []
    while asked := search.ask():
        asks.append(np.array([candidate.point for candidate in asked]))
        search.tell(outcomes(asks[-1]))
    table = _study(known, np.concatenate(asks), kind)
    return replace(table, header=replace(table.header, first=len(asks[0])))


@cache
def share(name: str) -> float:
    """What share of the space is met."""
    points = KNOWN[name].there(qmc.Sobol(KNOWN[name].width, seed=np.random.default_rng(1)).random(4 * _MANY))
    return float(KNOWN[name].met(points).mean())


@cache
def firsts(name: str) -> dict[str, float]:
    """First-order indices, by the means of 64 bins of each factor."""
    points = KNOWN[name].there(even(2 * _MANY, KNOWN[name].width, 1))
    y = KNOWN[name].value(points)
    found = {}
    for k, bins in enumerate((points * 64).astype(int).T):
        means = np.bincount(bins, y) / np.maximum(np.bincount(bins), 1)
        found[f"x{k + 1}"] = max(1 - float(((y - means[bins]) ** 2).sum()) / (len(y) - 64) / float(y.var()), 0.0)
    return found


@cache
def total(name: str, factors: tuple[str, ...]) -> float:
    """The total index of *factors* together, which are independent of the others (Jansen 1999)."""
    points, others = (even(_MANY, KNOWN[name].width, seed) for seed in (1, 2))
    columns = [int(factor[1:]) - 1 for factor in factors]
    mixed = points.copy()
    mixed[:, columns] = others[:, columns]
    y = KNOWN[name].value(points)
    return float(((y - KNOWN[name].value(mixed)) ** 2).mean() / 2 / y.var())


def judged(name: str, data: StudyData) -> Iterator[tuple[str, bool | None]]:
    """Of each kind of sentence, for each of its numbers whether the truth is in its interval; None where withheld."""
    known, first = KNOWN[name], firsts(name)
    fresh = known.there(even(_MANY, known.width, 3))
    yield from _each("share met", lambda: [_holds(share_met(data).share, share(name))])

    def found() -> Importances:
        return importances(data, "y")

    # A hundredth is what is printed.
    yield from _each(
        "first order",
        lambda: [_holds(each.share, first[each.factor], 0.01) for each in model_first_order_shares(data, "y")],
    )
    yield from _each("total", lambda: [_holds(e.share, total(name, e.factors), 0.01) for e in found().factors])
    yield from _each("pair", lambda: [_holds(e.share, _both(name, e), 0.01) for e in found().pairs])
    yield from _each("box", lambda: _boxes(best_boxes(data), known, fresh))
    yield from _each("robust centre", lambda: [_centre(data, known, fresh)])
    if known.trend:
        yield from _each("trend", lambda: [word == known.trend for n, word in courses(data, "y").items() if n == "x1"])


def _both(name: str, pair: Together) -> float:
    """What of the variance depends on both."""
    return total(name, pair.one) + total(name, pair.other) - total(name, pair.one + pair.other)


def _each(kind: str, found: Callable[[], list[bool]]) -> Iterator[tuple[str, bool | None]]:
    try:
        yield from ((kind, held) for held in found() or [None])
    except DseError:
        yield kind, None


def _holds(interval: Interval, value: float, printed: float = 0.0) -> bool:
    return bool(interval.low - printed <= value <= interval.high + printed)


def _boxes(boxes: Iterable[Box], known: Known, fresh: Floats) -> list[bool]:
    """Each is said of what is in no box before it ("else if")."""
    held = []
    for box in boxes:
        inside = np.ones(len(fresh), dtype=np.bool_)
        for limit in box.limits:
            column = fresh[:, int(limit.factor.name[1:]) - 1]
            inside &= ~(column < limit.low) & ~(column > limit.high)
        held.append(_holds(box.density, float(known.met(fresh[inside]).mean())))
        fresh = fresh[~inside]
    return held


def _centre(data: StudyData, known: Known, fresh: Floats) -> bool:
    found = robust_centre(data)
    at = data.places[data.numbers == found.number][0]
    return _holds(found.share, float(known.met(fresh[np.abs(fresh - at).max(axis=1) <= found.margin]).mean()))


def counts(kind: str, names: Iterable[str], seeds: Iterable[int]) -> dict[str, Counter[bool | None]]:
    """How often what is said after the sampler *kind* is true, by sentence; None counts what is withheld."""
    found: dict[str, Counter[bool | None]] = {}
    for name, seed in product(names, seeds):
        for sentence, held in judged(name, made(KNOWN[name], kind, seed)):
            found.setdefault(sentence, Counter())[held] += 1
    return found
