"""Which variables are states: the method of dummy derivatives.

Mattsson and Söderlind, SIAM J. Sci. Comput. 14(3), 1993, 677-692: for every differentiated equation one derivative
among its block's becomes an ordinary unknown; what it would have been the derivative of is no state. Where that depends
on coefficients that vary, the states are selected during the run instead (`selection`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from dse.errors import DseError
from dse.graphs import components
from dse.modelica.algebra.derivative import partial
from dse.modelica.algebra.evaluate import Values, evaluate
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import smooth, symbols
from dse.modelica.flat_model import FlatModel
from dse.modelica.structure.graphs import Matching
from dse.modelica.structure.known import Known
from dse.modelica.structure.reduction.pantelides import Reduced
from dse.modelica.structure.rows import Row, told

ALWAYS = 2
SMALLEST_PIVOT = 1e-9
"""Relative to the largest entry of the row; below it a coefficient counts as 0."""


Line = Mapping[int, Expression]
"""A row's coefficients by the place of the candidate; absent where 0."""


@dataclass(frozen=True, slots=True)
class Choice:
    """*dummies*: derivatives that are ordinary unknowns. *matrix*: coefficients of *candidates* in the differentiated
    equations, if the choice would depend on values at run time; else it is empty."""

    dummies: frozenset[Symbol]
    candidates: tuple[Symbol, ...]
    matrix: tuple[Line, ...]


def chosen(found: Reduced, known: Known) -> Choice:
    """The dummy derivatives of *found*.

    They are taken by stateSelect, then where coefficients are numbers, then parameters, then by the size of the pivot
    at the start. Raises DseError if the differentiated equations are singular there.
    """
    local = _local(found)
    every = candidates = [Symbol(name, order) for name, order in found.highest.items() if order]
    dummies: list[Symbol] = []
    matrix: tuple[Line, ...] = ()
    varies = False
    stage = 1
    while rows := [row for row, chain in enumerate(found.chains) if len(chain) > stage]:
        selection = _Selection(found, rows, candidates, known, local)
        picked = selection.done()
        dummies.extend(picked)
        varies = varies or selection.varies(picked)
        matrix = matrix or selection.matrix
        candidates = [Symbol(one.name, one.order - 1) for one in picked if one.order > 1]
        stage += 1
    return Choice(frozenset(dummies), tuple(every), matrix if varies else ())


def is_wanted(name: str, flat: FlatModel) -> bool:
    """Whether *name* has to be a state: by stateSelect.always, or since it is set anew at events."""
    return flat.variables[name].prefers_state >= ALWAYS or any(one.state == name for one in flat.reinitializations)


def is_fixed(entry: Expression, known: Known) -> bool:
    """Whether *entry* keeps its value during a run, and is not 0."""
    return known.of_parameters(entry) and known.is_never_zero(entry)


def _local(found: Reduced) -> frozenset[str]:
    """Unknowns whose highest derivatives are solved for in the blocks of the differentiated equations.

    Others may become dummies too, if they are to be no states rather than these: the choice need not be made block by
    block, as long as the differentiated equations have independent columns for it.
    """
    row_of = {Symbol(name, found.highest[name]): row for row, name in found.column_of.items()}
    needs = [[row_of[one] for one in symbols(chain[-1].residual) if one in row_of] for chain in found.chains]
    parts = [part for part in components(needs) if any(len(found.chains[row]) > 1 for row in part)]
    return frozenset(found.column_of[row] for part in parts for row in part)


class _Selection:
    """One stage of one block: as many of *candidates* as there are *rows*, with independent columns."""

    def __init__(
        self, found: Reduced, rows: Sequence[int], candidates: Sequence[Symbol], known: Known, local: frozenset[str]
    ) -> None:
        self._rows = [found.chains[row][0] for row in rows]
        self._candidates = list(candidates)
        self._known = known
        self._local = local
        numbers = {symbol.name: column for column, symbol in enumerate(candidates)}
        self.matrix = tuple(_coefficients(found.chains[row], numbers, found.highest) for row in rows)
        self._grades: dict[int, int] = {}
        for line in self.matrix:
            for column, entry in line.items():
                grade = 0 if entry.is_constant else 1 if known.of_parameters(entry) else 2
                self._grades[column] = max(grade, self._grades.get(column, 0))

    def done(self) -> list[Symbol]:
        picked = self._independent(self._known.starts.of)
        if picked is None:
            # The starting values may be all 0, where any constraint is flat: look at a point that is nothing special.
            at = symbols(*(entry for line in self.matrix for entry in line.values()))
            nothing_special = {symbol: 0.5 + (0.6180339887498949 * k) % 1.0 for k, symbol in enumerate(at, 1)}
            picked = self._independent(nothing_special)
        if picked is None:
            raise DseError(*told(self._rows, "equations that were differentiated contradict or repeat each other"))
        return [self._candidates[column] for column in sorted(picked)]

    def varies(self, picked: Sequence[Symbol]) -> bool:
        """Whether the *picked* columns may become dependent during a run: in a block that they have with some rows."""
        columns = list(map(self._candidates.index, picked))
        pattern = [[k for k, column in enumerate(columns) if column in line] for line in self.matrix]
        matching = Matching()
        for row in range(len(pattern)):
            matching.match(row, pattern)
        needs = [sorted(matching.row_of[k] for k in line if k in matching.row_of) for line in pattern]
        for part in components(needs):
            own = [columns[matching.column_of[row]] for row in part]
            entries = [self.matrix[row][column] for row in part for column in own if column in self.matrix[row]]
            if not all(is_fixed(entry, self._known) for entry in entries):
                return True
        return False

    def _independent(self, values: Values) -> list[int] | None:
        """Columns that are independent at *values*, the ones to be preferred as dummies first; by elimination."""
        columns = sorted(self._grades, key=self._key)
        place = {column: k for k, column in enumerate(columns)}
        left = np.zeros((len(self.matrix), len(columns)))
        for row, line in enumerate(self.matrix):
            left[row, [place[column] for column in line]] = evaluate(line.values(), values)
        left[~np.isfinite(left)] = 0.0
        sizes = np.abs(left).max(axis=1, initial=0.0)[:, None]
        left /= np.where(sizes > 0, sizes, 1.0)
        is_free = np.ones(len(left), dtype=bool)
        picked: list[int] = []
        for _, group in groupby(columns, self._key):
            own = [place[column] for column in group]
            while own and is_free.any():
                sizes = np.abs(left[:, own].T) * is_free
                which, pivot = divmod(int(sizes.argmax()), len(left))
                if sizes[which, pivot] <= SMALLEST_PIVOT:
                    break
                column = own.pop(which)
                picked.append(columns[column])
                is_free[pivot] = False
                others = np.flatnonzero(is_free & (left[:, column] != 0))
                left[others] -= np.outer(left[others, column] / left[pivot, column], left[pivot])
        return None if is_free.any() else picked

    def _key(self, column: int) -> tuple[int, ...]:
        """What a dummy should be: first of all what should be no state; columns that vary share a key."""
        symbol = self._candidates[column]
        grade = self._grades[column]
        is_fixed = self._known.flat.variables[symbol.name].is_fixed and symbol.order == 1
        is_foreign = symbol.name not in self._local
        return (self._preference(symbol), grade, is_fixed, is_foreign, -symbol.order, 0 if grade == 2 else column)

    def _preference(self, symbol: Symbol) -> int:
        # For higher orders too: what is no dummy there cannot become one in the stages below. But it is the variable
        # that was asked to be always a state, not its derivative.
        wish = self._known.flat.variables[symbol.name].prefers_state
        if wish < ALWAYS and is_wanted(symbol.name, self._known.flat):
            wish = ALWAYS - 1
        return wish if symbol.order == 1 else min(wish, ALWAYS - 1)


def _coefficients(chain: Sequence[Row], numbers: Mapping[str, int], highest: Mapping[str, int]) -> Line:
    """Coefficients of the highest derivatives in the last row of *chain*.

    An equation differentiated c times holds a highest derivative of order d as order d - c of the original, with the
    same coefficient; the rows between have the same ones again.
    """
    residual, times = chain[0].residual, len(chain) - 1
    found = {}
    for symbol in smooth(residual):
        if not symbol.is_variable or symbol.name not in numbers:
            continue
        entry = partial(residual, symbol)
        if symbol.order + times == highest[symbol.name] and not entry.is_number(0):
            found[numbers[symbol.name]] = entry
    return found
