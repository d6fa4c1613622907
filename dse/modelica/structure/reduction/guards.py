"""Conditions under which a choice of states stays good, put into the equations that need them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from dse.errors import DseError
from dse.graphs import components
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.structure.graphs import Matching
from dse.modelica.structure.reduction.dummies import Guard
from dse.modelica.structure.rows import Row, listed, told

SMALLEST_RATIO = 0.1
"""Least size of a dummy's coefficient, relative to the largest of its row; below it another choice would be due."""
LARGEST_DETERMINANT = 4


def guarded(chains: Sequence[Sequence[Row]], guards: Sequence[Guard]) -> list[list[Row]]:
    """*chains* where the first derivative of each guarded equation is ``1 = 0`` as soon as its guard does not hold.

    That equation's row of the Jacobian is then 0, so the system it belongs to fails, by name, in the middle of a step
    already; a solver cannot step over the singularity unless it is narrower than the distance of its stages. Raises
    DseError if more than four equations vary together.
    """
    found = [list(chain) for chain in chains]
    for guard in guards:
        for rows, condition in _conditions(guard, chains):
            for number in rows:
                row = found[number][1]
                graph = row.residual.graph
                impossible = graph.make("if", condition, row.residual, graph.constant(1.0))
                found[number][1] = replace(row, residual=impossible)
    return found


def _conditions(guard: Guard, chains: Sequence[Sequence[Row]]) -> list[tuple[list[int], Expression]]:
    """Per independent part of the guarded rows that varies: the rows' numbers and the condition."""
    places = [guard.candidates.index(symbol) for symbol in guard.dummies]
    pattern = [[k for k, place in enumerate(places) if place in line] for line in guard.matrix]
    matching = Matching()
    for row in range(len(pattern)):
        matching.match(row, pattern)
    needs = [sorted(matching.row_of[k] for k in line if k in matching.row_of) for line in pattern]
    found = []
    for part in components(needs):
        columns = [places[matching.column_of[row]] for row in part]
        graph = chains[0][0].residual.graph
        zero = graph.constant(0.0)
        own = [[guard.matrix[row].get(column, zero) for column in columns] for row in part]
        if all(entry.is_constant for line in own for entry in line):
            continue
        numbers = [guard.rows[row] for row in part]
        if len(part) > LARGEST_DETERMINANT:
            dummies: list[Symbol] = [guard.candidates[column] for column in columns]
            what = f"the states among {listed(dummies)} would have to be chosen anew during the run"
            raise DseError(*told((chains[number][0] for number in numbers), what))
        product = graph.constant(SMALLEST_RATIO ** len(part))
        for row in part:
            product = product * _largest(graph, guard.matrix[row].values())
        size = graph.make("abs", _determinant(graph, own))
        found.append((numbers, graph.make("greater", size, product)))
    return found


def _largest(graph: Graph, line: Iterable[Expression]) -> Expression:
    largest = graph.constant(0.0)
    for entry in line:
        largest = graph.make("maximum", largest, graph.make("abs", entry))
    return largest


def _determinant(graph: Graph, matrix: list[list[Expression]]) -> Expression:
    """By the first row; of four rows and columns at most."""
    if len(matrix) == 1:
        return matrix[0][0]
    total = graph.constant(0.0)
    for column, entry in enumerate(matrix[0]):
        if not entry.is_number(0):
            minor = [line[:column] + line[column + 1 :] for line in matrix[1:]]
            term = entry * _determinant(graph, minor)
            total = total - term if column % 2 else total + term
    return total
