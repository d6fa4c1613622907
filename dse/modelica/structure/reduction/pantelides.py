"""Index reduction: which equations have to be differentiated, and how often.

Pantelides, SIAM J. Sci. Stat. Comput. 9(2), 1988, 213-231.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dse.errors import DseError, Location, Problem, fail, raise_if_any
from dse.modelica.algebra.derivative import derived
from dse.modelica.algebra.expression import Expression, shown
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import smooth, symbols
from dse.modelica.flat_model import Role, Variable
from dse.modelica.structure.graphs import Matching, alternating
from dse.modelica.structure.rows import Row, listed, matched, told

LARGEST_ORDER = 12
"""More differentiations of one equation are taken for a model that is wrong."""


@dataclass(frozen=True, slots=True)
class Reduced:
    """*chains*: each equation followed by its derivatives. *highest*: the order of the highest derivative of each
    unknown. *column_of*: the name of the unknown whose highest derivative the last row of each chain gives."""

    chains: tuple[tuple[Row, ...], ...]
    highest: Mapping[str, int]
    column_of: Mapping[int, str]


def reduced(rows: Sequence[Row], names: Sequence[str], variables: Mapping[str, Variable]) -> Reduced:
    """Differentiate what of *rows* has to be, so that the highest derivatives of *names* can be solved for.

    Raises DseError, with the equations' places, if there are too many or too few equations for *names* or a part of
    them, or if an input would have to be differentiated.
    """
    _refuse_singular(rows, names, variables)
    return _Reduction(rows, names, variables).done()


class _Reduction:
    def __init__(self, rows: Sequence[Row], names: Sequence[str], variables: Mapping[str, Variable]) -> None:
        self._variables = variables
        self._names = list(names)
        self._chains = [[row] for row in rows]
        self._highest = dict.fromkeys(names, 0)
        for symbol in symbols(*(row.residual for row in rows)):
            if symbol.is_variable and symbol.name in self._highest:
                self._highest[symbol.name] = max(self._highest[symbol.name], symbol.order)
        self._number = {name: number for number, name in enumerate(names)}
        self._columns = [self._columns_of(row) for row in rows]
        self._rows_of: list[dict[int, None]] = [{} for _ in names]
        for number, columns in enumerate(self._columns):
            for column in columns:
                self._rows_of[column][number] = None

    def _columns_of(self, row: Row) -> list[int]:
        return [
            self._number[symbol.name]
            for symbol in smooth(row.residual)
            if symbol.is_variable and symbol.name in self._highest and symbol.order == self._highest[symbol.name]
        ]

    def done(self) -> Reduced:
        matching = Matching()
        for number in range(len(self._chains)):
            while seen := matching.match(number, self._columns):
                self._differentiate(sorted(seen), matching)
        found = {row: self._names[column] for row, column in matching.column_of.items()}
        return Reduced(tuple(tuple(chain) for chain in self._chains), self._highest, found)

    def _differentiate(self, seen: list[int], matching: Matching) -> None:
        # The columns seen are those of the rows seen; all but the row to be matched are matched to one of them.
        columns = sorted({column for row in seen for column in self._columns[row]})
        for column in columns:
            self._highest[self._names[column]] += 1
        for row in seen:
            last = self._chains[row][-1]
            if last.order >= LARGEST_ORDER:
                raise DseError(*told([last], "an equation would have to be differentiated without end"))
            derivative = total(last.residual, self._variables, last.where)
            self._chains[row].append(Row(derivative, last.where, last.order + 1))
        # Rows that are not differentiated lose the columns that are no longer the highest, matched ones among them.
        stale = {row for column in columns for row in self._rows_of[column]}.union(seen)
        for row in sorted(stale):
            self._columns[row] = self._columns_of(self._chains[row][-1])
            for column in self._columns[row]:
                self._rows_of[column][row] = None
            if row in matching.column_of and matching.column_of[row] not in self._columns[row]:
                raise DseError(*told([self._chains[row][-1]], "an equation became singular when differentiated"))


def _refuse_singular(rows: Sequence[Row], names: Sequence[str], variables: Mapping[str, Variable]) -> None:
    """Pantelides' algorithm ends if the equations can be matched to the unknowns whatever the derivatives' orders."""
    numbers = {name: number for number, name in enumerate(names)}
    solvable = ((symbol.name for symbol in smooth(row.residual) if symbol.is_variable) for row in rows)
    columns = [list(dict.fromkeys(numbers[name] for name in own if name in numbers)) for own in solvable]
    unknowns = [Symbol(name) for name in names]
    matching, problems = matched(rows, columns, unknowns)
    missing = [number for number in range(len(names)) if number not in matching.row_of]
    if missing:
        rows_of: list[list[int]] = [[] for _ in names]
        for row, listed_columns in enumerate(columns):
            for column in listed_columns:
                rows_of[column].append(row)
        for number in missing[:12]:
            together = [unknowns[k] for k in alternating(matching, number, rows_of)]
            what = f"there is no equation for '{names[number]}'"
            if len(together) > 1:
                what = f"there is one equation too few for {listed(together)}"
            problems.append(Problem(what, variables[names[number]].where))
    raise_if_any(problems)


def total(expression: Expression, variables: Mapping[str, Variable], where: Location | None = None) -> Expression:
    """Time derivative of *expression*: a continuous variable's derivative has the next order; what changes at events
    only is constant.

    Raises DseError, by name and with *where*, if the derivative of an input would be needed.
    """
    graph = expression.graph
    zero = graph.constant(0.0)

    def rate(leaf: Symbol) -> Expression:
        if leaf.referent is Referent.TIME:
            return graph.constant(1.0)
        if not leaf.is_variable:
            return zero
        role = variables[leaf.name].role
        if role is Role.INPUT and variables[leaf.name].kind == "Real":
            raise fail(
                f"the derivative of the input '{leaf.name}' is needed to solve {shown(expression)} = 0",
                where,
                "let the input act through a lag, or give its derivative as an input too",
            )
        return graph.variable(leaf.name, leaf.order + 1) if role is Role.CONTINUOUS else zero

    return derived((expression,), rate)[0]
