"""Whether systems of equations can be solved in doubles: singular ones, and eliminations that magnify rounding."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from dse.errors import Problem, raise_if_any
from dse.modelica.algebra.derivative import partial
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import smooth, symbols
from dse.modelica.solved_model import Block, Explicit, System
from dse.modelica.structure.known import Known
from dse.modelica.structure.rows import listed

SMALLEST_CONDITION = 1e-13
"""Least singular value relative to the largest, after rows and columns were scaled; below it nothing is solved."""


def refuse_singular(blocks: Iterable[Block], known: Known) -> None:
    """Raise DseError for each linear system that is singular for the parameters' starting values.

    Coefficients that vary are judged at run time, by the solver's pivots.
    """
    problems = []
    for system in (block for block in blocks if isinstance(block, System)):
        entries = [entry for row in system.jacobian for entry in row]
        if not known.of_parameters(*entries):
            continue
        size = len(system.unknowns)
        matrix = np.array(evaluate(entries, known.starts.of), dtype=float).reshape(size, size)
        if np.isfinite(matrix).all() and _is_singular(matrix):
            what = f"these equations do not determine {listed(system.unknowns)}: they repeat or contradict each other"
            where = system.where[0] if system.where else None
            places = ", ".join(str(place) for place in system.where[1:6])
            problems.append(Problem(what, where, f"together with {places}" if places else ""))
    raise_if_any(problems)


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


LARGEST_ERROR = 1e-11
"""Error of any unknown of a trial, relative to its size; a full factorization that is as bad is no better choice."""

LARGEST_FULL = 1500
"""Larger systems are not compared with a full factorization: it would take too long."""

SPREADS = (0.0, 1.0, -1.0)
"""Trials: parameters as they start, and each multiplied by a factor of its own between 1/10 and 10, two ways."""

Value = Callable[[Symbol], float]


def is_stable(
    torn: Sequence[Symbol],
    inner: Sequence[Explicit],
    residuals: Sequence[Expression],
    known: Known,
) -> bool:
    """Whether the torn system, linearised at the start, gives back a known solution as well as a full one does."""
    unknowns = [*torn, *(one.unknown for one in inner)]
    rows = [one.value for one in inner] + list(residuals)
    number = {symbol: place for place, symbol in enumerate(unknowns)}
    entries = [
        (row, number[symbol], partial(expression, symbol))
        for row, expression in enumerate(rows)
        for symbol in smooth(expression)
        if symbol in number
    ]
    refers = symbols(*(entry for *_, entry in entries))
    parameters = [symbol for symbol in refers if known.is_parameter(symbol)]
    for spread in SPREADS:
        if spread and not parameters:
            break
        factors = {
            symbol: 10.0 ** (spread * (2 * ((0.7548776662466927 * place) % 1.0) - 1))
            for place, symbol in enumerate(parameters, 1)
        }
        point = {symbol: known.starts.of(symbol) * factors.get(symbol, 1.0) for symbol in refers}
        values = evaluate([entry for *_, entry in entries], point)
        if not all(map(math.isfinite, values)):
            continue
        if not _gives_back(entries, values, len(torn), len(unknowns)):
            return False
    return True


def _gives_back(entries: Sequence[tuple[int, int, Expression]], values: Sequence[float], torn: int, size: int) -> bool:
    """Solve for a vector known beforehand, torn as the code will do, and in full if that is bad, and compare."""
    count = size - torn
    # The inner rows give their unknown: value - unknown.
    rows = np.array([row for row, *_ in entries] + list(range(count)), dtype=int)
    columns = np.array([column for _, column, _ in entries] + list(range(torn, size)), dtype=int)
    factors = np.array([*values, *[-1.0] * count])
    scale = _column_scale(rows, columns, factors, size)
    wanted = scale * (0.5 + (0.6180339887498949 * np.arange(1, size + 1)) % 1.0 / 2) * (-1.0) ** np.arange(size)
    right = np.zeros(size)
    np.add.at(right, rows, factors * wanted[columns])
    try:
        with np.errstate(all="ignore"):
            found = _torn_solution(rows, columns, factors, right, torn)
            error = float(np.max(np.abs(found - wanted) / scale))
        if error <= LARGEST_ERROR:
            return True
        if size > LARGEST_FULL:
            return False
        full = np.zeros((size, size))
        np.add.at(full, (rows, columns), factors)
        reference = np.linalg.solve(full * scale, right) * scale
    except np.linalg.LinAlgError:
        # Singular here and now, in whatever form: that is for the code to tell when it happens.
        return True
    return error <= 10 * float(np.max(np.abs(reference - wanted) / scale))


def _torn_solution(
    rows: np.ndarray, columns: np.ndarray, factors: np.ndarray, right: np.ndarray, torn: int
) -> np.ndarray:
    size = len(right)
    count = size - torn
    order = np.argsort(rows, kind="stable")
    begins = np.searchsorted(rows[order], np.arange(size + 1))
    # Columns: the solution for the right side, then the effect of each torn unknown.
    table = np.zeros((size, torn + 1))
    table[:torn, 1:] = np.eye(torn)
    left = np.zeros((torn, torn + 1))
    for row in range(size):
        own = order[begins[row] : begins[row + 1]]
        if row < count:
            own = own[columns[own] != torn + row]
            table[torn + row] = factors[own] @ table[columns[own]]
            table[torn + row, 0] -= right[row]
        else:
            left[row - count] = factors[own] @ table[columns[own]]
    if not np.isfinite(left).all():
        return np.full(size, np.inf)
    trial = np.linalg.solve(left[:, 1:], right[count:] - left[:, 0])
    found: np.ndarray = table[:, 0] + table[:, 1:] @ trial
    return found


def _column_scale(rows: np.ndarray, columns: np.ndarray, factors: np.ndarray, size: int) -> np.ndarray:
    """Sizes of the unknowns that make the matrix's entries alike (Ruiz, RAL-TR-2001-034)."""
    left, right = np.ones(size), np.ones(size)
    for _ in range(8):
        sizes = np.abs(factors) * left[rows] * right[columns]
        row, column = np.zeros(size), np.zeros(size)
        np.maximum.at(row, rows, sizes)
        np.maximum.at(column, columns, sizes)
        row[row == 0] = 1.0
        column[column == 0] = 1.0
        left /= np.sqrt(row)
        right /= np.sqrt(column)
    return right
