"""Functions whose boundary is known, and a search on them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from judged_points import classes, predicted
from numpy.typing import NDArray

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, Candidate, DesignVariable, Outcomes
from dse.exploration.samplers.boundary import Boundary
from dse.units import DIMENSIONLESS

Array = NDArray[np.float64]
Margins = Callable[[Array], Mapping[str, Array]]
"""Of points (n, d) of the unit cube, by requirement; NaN where it is not exercised."""

VARIABLES = tuple(DesignVariable(f"part.{name}", 0.0, 1.0, 2, 0.5, DIMENSIONLESS) for name in "xy")
Variables = tuple[DesignVariable, ...]
LINE = (np.arange(100) + 0.5) / 100
FINE = np.stack(np.meshgrid(LINE, LINE), axis=-1).reshape(-1, 2)


def circle(points: Array) -> Mapping[str, Array]:
    return {"R": 0.3**2 - ((points - 0.5) ** 2).sum(axis=1)}


def two(points: Array) -> Mapping[str, Array]:
    x, y = points.T
    return {"A": x * y - 0.2, "B": 0.8 - x**2 - 0.3 * y}


def hole(points: Array) -> Mapping[str, Array]:
    x, y = points.T
    return {"R": np.where(x + 0.3 * y > 0.8, np.nan, y - 0.3 - 0.2 * np.sin(5 * x))}


def branin(points: Array) -> Mapping[str, Array]:
    x, y = 15 * points[:, 0] - 5, 15 * points[:, 1]
    valley = (y - 5.1 * x**2 / (4 * np.pi**2) + 5 * x / np.pi - 6) ** 2
    return {"R": 40 - valley - 10 * (1 - 1 / (8 * np.pi)) * np.cos(x)}


def ball(points: Array) -> Mapping[str, Array]:
    return {"R": 0.4**2 - ((points - 0.5) ** 2).sum(axis=1)}


def creased(points: Array) -> Mapping[str, Array]:
    return {"R": points[:, 1] - 0.3 - 0.6 * np.abs(points[:, 0] - 0.45)}


def diamond(points: Array) -> Mapping[str, Array]:
    return {"R": 0.35 - np.abs(points - 0.5).sum(axis=1)}


def scattered(share: float, margins: Margins) -> Margins:
    """*margins* of runs of which a *share* fails, here and there, always the same."""

    def told(points: Array) -> Mapping[str, Array]:
        # Neighbours differ: a hash of the point's bits.
        fails = np.array([hash(tuple(row)) % 1000 < 1000 * share for row in points.tolist()], dtype=np.bool_)
        return {name: np.where(fails, np.nan, column) for name, column in margins(points).items()}

    return told


def outcomes(candidates: list[Candidate], margins: Margins, variables: Variables = VARIABLES) -> Outcomes:
    points = np.array([candidate.point for candidate in candidates], dtype=np.float64).reshape(-1, len(variables))
    told = margins(points)
    verdicts = {name: tuple(verdict(margin) for margin in column.tolist()) for name, column in told.items()}
    columns = {v.name: points[:, i] for i, v in enumerate(variables)}
    names = tuple(candidate.configuration for candidate in candidates)
    return Outcomes(names, columns, np.ones(len(points), dtype=np.bool_), {}, told, verdicts)


def verdict(margin: float) -> Verdict:
    return Verdict.NOT_EXERCISED if np.isnan(margin) else Verdict.PASS if margin >= 0 else Verdict.FAIL


def brief(margins: Margins, earlier: list[Candidate] | None = None, dimensions: int = 2, seed: int = 1) -> Brief:
    variables = (*VARIABLES, *(replace(VARIABLES[0], name=f"part.{name}") for name in "abcd"))[:dimensions]
    return Brief(variables, ("a",), seed, outcomes(earlier or [], margins, variables))


def searched(
    margins: Margins, samples: int, given: Brief | None = None, noise: float = 0.0, accuracy: float = 0.0
) -> list[Candidate]:
    """What is asked for; margins are told with a relative error of *noise*."""
    given = given or brief(margins)
    search = Boundary(samples=samples, accuracy=accuracy).start(given)
    random = np.random.default_rng(0)

    def disturbed(points: Array) -> Mapping[str, Array]:
        told = margins(points)
        return {name: column * (1 + noise * random.uniform(-1, 1, len(column))) for name, column in told.items()}

    made: list[Candidate] = []
    while asked := list(search.ask()):
        search.tell(outcomes(asked, disturbed, given.variables))
        made += asked
    return made


def wrong(points: Array, margins: Margins) -> float:
    """The share of the square that the runs at *points* misjudge."""
    return float(np.mean(predicted(points, margins(points), FINE) != classes(margins(FINE))))


def wrong_on_a_grid(count: int, margins: Margins) -> float:
    """The same of a grid of *count* by *count* runs, margins and the region's border interpolated linearly."""
    from scipy.interpolate import RegularGridInterpolator

    line = np.linspace(0, 1, count)
    nodes = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1)
    told = {}
    for name, column in margins(nodes.reshape(-1, 2)).items():
        grid = column.reshape(count, count)
        inside = RegularGridInterpolator((line, line), np.where(np.isnan(grid), -1.0, 1.0))(FINE)
        # Cells with a corner that has no margin take the sign of those that have one.
        surface = RegularGridInterpolator((line, line), np.nan_to_num(grid))(FINE)
        told[name] = np.where(inside < 0, np.nan, surface)
    return float(np.mean(classes(told) != classes(margins(FINE))))


def rows(candidates: list[Candidate]) -> Array:
    return np.array([candidate.point for candidate in candidates])
