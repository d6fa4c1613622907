"""Some of the runs that were stored, as if there were no others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dse.storage import NO_CHECKS, RunTable


def part_of_table(table: RunTable, rows: NDArray[np.intp]) -> RunTable:
    """Only these *rows*, without checks."""
    return replace(
        table,
        block=table.block.part(rows),
        configurations=tuple(table.configurations[row] for row in rows.tolist()),
        points={name: column[rows] for name, column in table.points.items()},
        checks=NO_CHECKS,
        rates=table.rates and table.rates.part(rows),
    )
