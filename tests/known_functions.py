"""Functions of the unit cube of which indices are known, and studies of them as they come out of a study folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from definitions import metrics as defined_metrics, stored_definition
from numpy.typing import NDArray

from dse.domain.definition import (
    DefinedConfiguration,
    DefinedDesign,
    DefinedRequirement,
    DefinedSampler,
    DefinedVariable,
)
from dse.metrics import verdict_codes
from dse.storage import RowBlock, RunTable, StudyHeader

Floats = NDArray[np.float64]

ISHIGAMI = {"x1": (0.3139, 0.5576), "x2": (0.4424, 0.4424), "x3": (0.0, 0.2437)}
"""First-order and total indices for a = 7, b = 0.1: Ishigami and Homma 1990; closed form."""

G_CONSTANTS = (0.0, 1.0, 4.5, 9.0)


def ishigami(unit: Floats) -> Floats:
    """Of three variables in -pi … pi."""
    x = np.pi * (2 * unit - 1)
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def g_function(unit: Floats) -> Floats:
    """Sobol's, of four variables with the first of Saltelli's constants."""
    a = np.array(G_CONSTANTS)
    return np.prod((np.abs(4 * unit - 2) + a) / (1 + a), axis=1)


def g_indices() -> list[tuple[float, float]]:
    """First-order and total indices (Saltelli and Sobol 1995): partial variances are 1/3 (1 + a)^-2."""
    parts = np.array([1 / (3 * (1 + a) ** 2) for a in G_CONSTANTS])
    whole = np.prod(1 + parts) - 1
    return [(part / whole, part * np.prod(1 + np.delete(parts, i)) / whole) for i, part in enumerate(parts)]


def variable(name: str, **facts: Any) -> DefinedVariable:
    """One from 0 to 1."""
    return replace(DefinedVariable(name, "", "", 0.0, 1.0, 0, 0.5), **facts)


def study(
    points: Floats,
    metrics: Mapping[str, Floats],
    at_most: Mapping[str, float] | None = None,
    *,
    done: Sequence[bool] | NDArray[np.bool_] | None = None,
    exercised: NDArray[np.bool_] | None = None,
    variables: Sequence[DefinedVariable] | None = None,
    choices: Sequence[Mapping[str, str]] | None = None,
    sampler: DefinedSampler | None = None,
    seed: int = 1,
) -> RunTable:
    """A study folder's table of n runs at *points*, (n, k), SI; run i has *choices* i at the places of its design.

    A requirement for each metric in *at_most*, named R1, R2, …; *metrics* of runs that are not *done* are undefined.
    """
    count, width = points.shape
    ran = np.ones(count, dtype=np.bool_) if done is None else np.array(done, dtype=np.bool_)
    values = np.array([np.where(ran, column, np.nan) for column in metrics.values()]).reshape(len(metrics), count).T
    given = [*variables] if variables is not None else [variable(f"x{number + 1}") for number in range(width)]
    different = sorted({tuple(sorted(each.items())) for each in choices or [{}]})
    configurations = [DefinedConfiguration(f"c{number}", dict(each)) for number, each in enumerate(different)]
    bounds = {f"R{number + 1}": entry for number, entry in enumerate((at_most or {}).items())}
    margins = np.array([bound - values[:, [*metrics].index(name)] for name, bound in bounds.values()])
    margins = margins.reshape(len(bounds), count).T
    tried = np.ones(count, dtype=np.bool_) if exercised is None else exercised
    codes = verdict_codes(margins, tried[:, None] & ~np.isnan(margins), ran[:, None]).astype(np.uint8)
    definition = stored_definition(
        configurations,
        design=DefinedDesign("design", "", tuple(sorted({place for each in choices or [] for place in each}))),
        variables=tuple(given),
        sampler=sampler or DefinedSampler("sobol", {"samples": count}),
        metrics=defined_metrics(*metrics),
        requirements=tuple(
            DefinedRequirement(name, "", metric, "", at_most=bound) for name, (metric, bound) in bounds.items()
        ),
        seed=seed,
    )
    names = [f"c{different.index(tuple(sorted(each.items())))}" for each in choices or [{}] * count]
    block = RowBlock(np.arange(count), ran, values, codes, margins, np.full(count, np.nan), {})
    columns = {entry.name: points[:, column] for column, entry in enumerate(given)}
    return RunTable(StudyHeader(definition, count, count, numbers=count), block, tuple(names), columns)


def even(count: int, width: int, seed: int = 0) -> Floats:
    """Random points of the unit cube."""
    return np.random.default_rng(seed).random((count, width))
