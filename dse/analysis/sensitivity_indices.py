"""Indices from designs that were made for them: Sobol' indices from blocks, Morris's effects from trajectories.

SALib computes them. A block or trajectory in which one run has no result is of no use. As results are lacking where a
design is at its limits, and not by chance, leaving many out would distort what is told of the rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import Factor, Floats, StudyData, withheld
from dse.analysis.memoize import memoized
from dse.analysis.probability import Interval
from dse.domain.sampler import Brief, Outcomes
from dse.errors import fail

_MOST_LACKING = 0.01
_LEAST_BLOCKS = 16
_DIGITS = 9
_SEED = 1


@dataclass(frozen=True, slots=True)
class IndexEstimates:
    """Of a *factor*: the part of the variance that is due to it alone, and *total*, with all others together."""

    factor: str
    first: Interval
    total: Interval


@dataclass(frozen=True, slots=True)
class Effects:
    """Of a *factor*: how much the metric (SI) changes over its range on average, whatever the sign (Campolongo's mu*).

    *spread* is the deviation of the effects: large where the factor acts with others, or not in a straight line.
    """

    factor: str
    size: Interval
    spread: float


@dataclass(frozen=True, slots=True)
class Designed:
    """Of every factor, from so many *blocks* or trajectories, *lacking* of which were left out."""

    factors: tuple[IndexEstimates, ...] | tuple[Effects, ...]
    blocks: int
    lacking: int


@memoized
def sobol_indices(data: StudyData, metric: str) -> Designed:
    """Sobol' indices of the runs of a study with the sampler ``sobol_indices``, with SALib's intervals.

    DseError for another sampler or runs of several configurations; if more than one block in 100 lacks a run in which
    *metric* is defined, fewer than 16 are left, or the metric never changes.
    """
    factors, rows, options = _design(data, metric, "sobol_indices")
    second = bool(options["second_order"])
    blocks = rows.reshape(-1, (2 * len(factors) + 2) if second else (len(factors) + 2))
    values, lacking = _complete(data, metric, blocks)
    analysis = _salib("sobol")
    found = analysis.analyze(_problem(factors), values.ravel(), calc_second_order=second, seed=_SEED)
    indices = zip(factors, *(found[key] for key in ("S1", "S1_conf", "ST", "ST_conf")), strict=True)
    told = tuple(IndexEstimates(f.name, _around(s, s_half), _around(t, t_half)) for f, s, s_half, t, t_half in indices)
    return Designed(told, len(values), lacking)


def morris_effects(data: StudyData, metric: str) -> Designed:
    """Elementary effects of the runs of a study with the sampler ``morris``. DseError as `sobol_indices`."""
    factors, rows, options = _design(data, metric, "morris")
    blocks = rows.reshape(-1, len(factors) + 1)
    values, lacking = _complete(data, metric, blocks, least=2)
    there = np.isfinite(data.metrics[metric][blocks]).all(axis=1)
    columns = [data.factor(factor.name) for factor in factors]
    analysis = _salib("morris")
    places = data.places[blocks[there].ravel()][:, columns]
    found = analysis.analyze(_problem(factors), places, values.ravel(), num_levels=options["levels"], seed=_SEED)
    effects = zip(factors, *(found[key] for key in ("mu_star", "mu_star_conf", "sigma")), strict=True)
    told = tuple(Effects(f.name, _around(size, half), float(spread)) for f, size, half, spread in effects)
    return Designed(told, len(values), lacking)


def _design(data: StudyData, metric: str, kind: str) -> tuple[list[Factor], NDArray[np.intp], Mapping[str, Any]]:
    """The factors of the design, and for each of its points the row of data.

    The points are those that the sampler asks for: it is asked again.
    """
    from dse.loading import SAMPLERS

    sampler = data.definition.sampler
    if sampler.kind != kind:
        raise withheld(metric, f"the study's sampler is '{sampler.kind}'", f"make a study with the sampler '{kind}'")
    if any(factor.is_choice or not factor.is_decided for factor in data.factors) or len(set(data.configurations)) > 1:
        what = "runs of several configurations or conditions have a design each"
        raise withheld(metric, what, "look at one configuration")
    factors = [factor for factor in data.factors if factor.variable is not None]
    variables = tuple(factor.variable for factor in factors if factor.variable is not None)
    if len(variables) != len(data.definition.variables):
        raise withheld(metric, "a variable of the design is the same in every run")
    section: Any = SAMPLERS.get(kind).model_validate(sampler.options)
    nothing = Outcomes((), {v.name: np.zeros(0) for v in variables}, np.zeros(0, dtype=np.bool_), {}, {}, {})
    brief = Brief(variables, (), data.definition.seed, nothing)
    design = section.design(brief)
    from dse.exploration import unit_of

    known = {tuple(key): row for row, key in enumerate(np.round(data.places, _DIGITS).tolist())}
    rows = [known.get(tuple(key), -1) for key in np.round(unit_of(design, variables), _DIGITS).tolist()]
    if missing := rows.count(-1):
        what = f"{missing} of {len(rows)} runs of the design are not there"
        raise withheld(metric, what, "explore the study to its end; constraints between variables leave out runs")
    return factors, np.array(rows, dtype=np.intp), section.options()


def _complete(data: StudyData, metric: str, blocks: NDArray[np.intp], least: int = _LEAST_BLOCKS) -> tuple[Floats, int]:
    """The metric in the blocks, (blocks, runs), in which it is defined in every run; and how many there are besides."""
    data.response(metric, 2)
    values = data.metrics[metric][blocks]
    there = np.isfinite(values).all(axis=1)
    lacking = int((~there).sum())
    if lacking > _MOST_LACKING * len(blocks):
        failed = int((~data.done).sum())
        what = (
            f"{lacking} of {len(blocks)} blocks of the design lack a run in which it is defined ({failed} runs failed)"
        )
        raise withheld(
            metric, f"{what}: without them, indices would be distorted", "shares of variance are given instead"
        )
    if there.sum() < least:
        raise withheld(metric, f"{int(there.sum())} blocks are too few: {least} are needed")
    return values[there], lacking


def _salib(method: str) -> Any:
    try:
        return import_module(f"SALib.analyze.{method}")
    except ImportError as error:
        hint = 'pip install "dse-workbench[analysis]"'
        raise fail("SALib is needed for this, and is not installed", None, hint) from error


def _problem(factors: list[Factor]) -> dict[str, Any]:
    names = [factor.name for factor in factors]
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def _around(value: Any, half: Any) -> Interval:
    return Interval(float(value), float(value - half), float(value + half))
