"""Systems of equations whose coefficients are known and singular."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dse.errors import DseError, Problem
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.solved_model import Block, System
from dse.modelica.structure.blocks.arrange import Stage
from dse.modelica.structure.known import Known
from dse.modelica.structure.rows import listed

SMALLEST_CONDITION = 1e-13
"""Least singular value relative to the largest, after rows and columns were scaled; below it nothing is solved."""


def refuse_singular(stages: Sequence[Stage[Block]], known: Known) -> None:
    """Raise DseError for each linear system that is singular for the parameters' starting values.

    Coefficients that vary are judged at run time, by the solver's pivots.
    """
    problems = []
    for system in (stage.block for stage in stages if isinstance(stage.block, System)):
        entries = [entry for row in system.jacobian for entry in row]
        if not known.of_parameters(*entries):
            continue
        size = len(system.unknowns)
        matrix = np.array(evaluate(entries, known.starts), dtype=float).reshape(size, size)
        if np.isfinite(matrix).all() and _is_singular(matrix):
            what = f"these equations do not determine {listed(system.unknowns)}: they repeat or contradict each other"
            where = system.where[0] if system.where else None
            places = ", ".join(str(place) for place in system.where[1:6])
            problems.append(Problem(what, where, f"together with {places}" if places else ""))
    if problems:
        raise DseError(*problems)


def _is_singular(matrix: np.ndarray) -> bool:
    rows = np.abs(matrix).max(axis=1)
    if not rows.all():
        return True
    scaled = matrix / rows[:, None]
    columns = np.abs(scaled).max(axis=0)
    if not columns.all():
        return True
    values = np.linalg.svd(scaled / columns, compute_uv=False)
    return bool(values[-1] < SMALLEST_CONDITION * values[0])
