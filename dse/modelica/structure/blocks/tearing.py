"""One block of equations that need each other, made ready to be computed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

from dse.modelica.algebra.derivative import derived, partial
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import actual, replaced, stepping, symbols
from dse.modelica.solved_model import Explicit, System
from dse.modelica.structure.blocks.conditioning import is_stable
from dse.modelica.structure.known import Known
from dse.modelica.structure.rows import Row

DEPTHS = (10_000, 12, 6, 3, 1, 0)
"""How many inner assignments may follow one another; the next is tried while rounding is magnified too much."""


def block(rows: Sequence[Row], unknowns: Sequence[Symbol], known: Known) -> Explicit | System:
    """*rows* solved for *unknowns*: explicitly if one closed form always holds, else torn.

    Tearing: whatever equation has one unknown left and can be solved for it in closed form becomes an inner
    assignment; if there is none, the unknown in most of the remaining equations is iterated, of several one that has
    a start value (Elmqvist and Otter, Methods for tearing systems of equations, ESM'94; the choice is the greedy one
    of Cellier and Kofman, Continuous System Simulation, 2006, 7.4). Chains of inner assignments are cut where they
    would magnify rounding.

    Rows with ``homotopy`` are continued where they must be iterated.
    """
    plain = [replace(row, residual=actual(row.residual)) for row in rows]
    made = _solved(plain, unknowns, known)
    if isinstance(made, Explicit) or made.is_linear or plain == list(rows):
        return made
    continued = _solved(rows, unknowns, known)
    return replace(continued, is_continued=True) if isinstance(continued, System) else made


def _solved(rows: Sequence[Row], unknowns: Sequence[Symbol], known: Known) -> Explicit | System:
    if len(rows) == 1:
        value = solved_for(rows[0].residual, unknowns[0], known)
        return _system(unknowns, [], rows) if value is None else Explicit(unknowns[0], value)
    form = cache(lambda row, symbol: solved_for(rows[row].residual, symbol, known))
    for depth in DEPTHS:
        torn, inner, left = _Tearing(rows, unknowns, known, depth, form).done()
        if not inner or is_stable(torn, inner, [row.residual for row in left], known):
            break
    return _system(torn, inner, left)


class _Tearing:
    def __init__(
        self,
        rows: Sequence[Row],
        unknowns: Sequence[Symbol],
        known: Known,
        depth: int,
        form: Callable[[int, Symbol], Expression | None],
    ) -> None:
        self._rows = rows
        self._known = known
        self._deepest = depth
        self._form = form
        self._left = dict.fromkeys(unknowns)
        wanted = frozenset(unknowns)
        self._all_of = [[symbol for symbol in symbols(row.residual) if symbol in wanted] for row in rows]
        self._unknowns_of = [dict.fromkeys(found) for found in self._all_of]
        self._rows_of: dict[Symbol, list[int]] = {symbol: [] for symbol in unknowns}
        for row, found in enumerate(self._all_of):
            for symbol in found:
                self._rows_of[symbol].append(row)
        self._depths: dict[Symbol, int] = {}

    def done(self) -> tuple[list[Symbol], list[Explicit], list[Row]]:
        torn: list[Symbol] = []
        inner: list[Explicit] = []
        is_open = dict.fromkeys(range(len(self._rows)))
        counts = {symbol: len(rows) for symbol, rows in self._rows_of.items()}
        ready = [row for row in is_open if len(self._unknowns_of[row]) == 1]
        while self._left:
            assigned = self._assigned(ready, is_open, counts)
            if assigned is None:
                symbol = max(self._left, key=lambda one: (counts[one], self._known.has_start(one)))
                torn.append(symbol)
                self._depths[symbol] = 0
            else:
                inner.append(assigned)
                symbol = assigned.unknown
            del self._left[symbol]
            for row in self._rows_of[symbol]:
                self._unknowns_of[row].pop(symbol, None)
                if row in is_open and len(self._unknowns_of[row]) == 1:
                    ready.append(row)
        return torn, inner, [self._rows[row] for row in is_open]

    def _assigned(self, ready: list[int], is_open: dict[int, None], counts: dict[Symbol, int]) -> Explicit | None:
        while ready:
            row = ready.pop(0)
            if row not in is_open or len(self._unknowns_of[row]) != 1:
                continue
            (symbol,) = self._unknowns_of[row]
            depth = 1 + max((self._depths[other] for other in self._all_of[row] if other != symbol), default=0)
            value = self._form(row, symbol) if depth <= self._deepest else None
            if value is not None:
                del is_open[row]
                for other in self._all_of[row]:
                    counts[other] -= 1
                self._depths[symbol] = depth
                return Explicit(symbol, value)
        return None


def _system(torn: Sequence[Symbol], inner: Sequence[Explicit], rows: Sequence[Row]) -> System:
    residuals = [row.residual for row in rows]
    values = [assigned.value for assigned in inner]
    jacobian = _jacobian(torn, inner, residuals)
    moving = {*torn, *(assigned.unknown for assigned in inner)}
    entries = [entry for row in jacobian for entry in row]
    is_linear = moving.isdisjoint(symbols(*entries)) and moving.isdisjoint(stepping(*residuals, *values))
    where = tuple(dict.fromkeys(row.where for row in rows if row.where is not None))
    return System(tuple(torn), tuple(inner), tuple(residuals), jacobian, is_linear, where)


def _jacobian(
    torn: Sequence[Symbol], inner: Sequence[Explicit], residuals: Sequence[Expression]
) -> tuple[tuple[Expression, ...], ...]:
    """Derivatives of *residuals* by *torn*, the *inner* assignments differentiated through where they are reached."""
    zero = residuals[0].graph.constant(0.0)
    expressions = [*(assigned.value for assigned in inner), *residuals]
    leaves = [symbols(expression) for expression in expressions]
    matrix = [[zero] * len(torn) for _ in residuals]
    for column, unknown in enumerate(torn):
        rates: dict[Symbol, Expression] = {unknown: zero.graph.constant(1.0)}

        def rate_of(leaf: Symbol, rates: Mapping[Symbol, Expression] = rates) -> Expression:
            return rates.get(leaf, zero)

        for place, expression in enumerate(expressions):
            if rates.keys().isdisjoint(leaves[place]):
                continue
            rate = derived((expression,), rate_of)[0]
            if place < len(inner):
                rates[inner[place].unknown] = rate
            else:
                matrix[place - len(inner)][column] = rate
    return tuple(map(tuple, matrix))


def solved_for(residual: Expression, symbol: Symbol, known: Known) -> Expression | None:
    """What *symbol* equals where *residual* vanishes, or None if there is no closed form that always holds.

    Divides only by what is never 0 as far as *known* can tell.
    """
    graph = residual.graph
    node, target = residual, graph.constant(0.0)
    while node.symbol != symbol:
        inside = [symbol in symbols(operand) for operand in node.operands]
        if sum(inside) != 1 or node.operator not in ("add", "subtract", "negate", "multiply", "divide"):
            return _by_coefficient(node, target, symbol, known)
        if node.operator == "negate":
            node, target = node.operands[0], -target
            continue
        left, right = node.operands
        match node.operator, inside[0]:
            case "add", is_left:
                node, target = (left, target - right) if is_left else (right, target - left)
            case "subtract", True:
                node, target = left, target + right
            case "subtract", False:
                node, target = right, left - target
            case "multiply", is_left:
                factor = right if is_left else left
                if not known.is_never_zero(factor):
                    return None
                node, target = (left if is_left else right), target / factor
            case "divide", True:
                node, target = left, target * right
            case _:
                return None
    return target


def _by_coefficient(node: Expression, target: Expression, symbol: Symbol, known: Known) -> Expression | None:
    """By a and b, where *node* is a * symbol + b and neither refers to *symbol*; None if it is not linear in it."""
    if symbol in stepping(node):
        return None
    factor = partial(node, symbol)
    if symbol in symbols(factor) or not known.is_never_zero(factor):
        return None
    zero = node.graph.constant(0.0)
    (rest,) = replaced((node,), lambda one: zero if one.symbol == symbol else None)
    return (target - rest) / factor
