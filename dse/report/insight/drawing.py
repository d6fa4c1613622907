"""Fewer runs of many: what is told of them is as good, and takes no minutes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dse.storage import NO_CHECKS, RunTable

_SEED = 0


def drawn(rows: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """All of *rows*, or so many of them, each as likely as any other; sorted, the same ones every time."""
    # Every so-manieth would keep one column of a grid only.
    return np.sort(np.random.default_rng(_SEED).permutation(rows)[:most])


def part_of_table(table: RunTable, rows: NDArray[np.intp]) -> RunTable:
    """Only these *rows*, without checks."""
    return replace(
        table,
        block=table.block.part(rows),
        configurations=tuple(table.configurations[row] for row in rows.tolist()),
        points={name: column[rows] for name, column in table.points.items()},
        checks=NO_CHECKS,
    )
