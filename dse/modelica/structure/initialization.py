"""The equations that hold at the start: how many conditions there are, and which are missing or too many."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from dse.errors import DseError, Problem, raise_if_any
from dse.modelica.algebra.expression import Expression, shown
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import actual, replaced, smooth, symbols
from dse.modelica.flat_model import Check, FlatModel, Role, Trigger
from dse.modelica.solved_model import EventBlock, Explicit
from dse.modelica.structure.blocks.arrange import Stage
from dse.modelica.structure.events import by_target
from dse.modelica.structure.graphs import Matching
from dse.modelica.structure.known import default, is_dependent, is_free
from dse.modelica.structure.rows import Row, told

CONSISTENT = 1e-8
"""How far a superfluous condition may be from holding, relative to the larger side, or absolute below 1."""


@dataclass(frozen=True, slots=True)
class Start:
    """*rows* determine *unknowns*. *discretes*: discrete variables among them. *superfluous*: to be checked only."""

    rows: tuple[Row, ...]
    unknowns: tuple[Symbol, ...]
    discretes: frozenset[str]
    superfluous: tuple[Row, ...]
    notes: tuple[str, ...]


def start(flat: FlatModel, rows: Sequence[Row], unknowns: Sequence[Symbol], states: Sequence[Symbol]) -> Start:
    """Complete the model's equations *rows* to a system for all *unknowns* (states included) at the start.

    In this order: the model's equations, its initial equations, fixed starts; what is missing then is taken from the
    starts of *states* and of parameters that are not fixed, with a note. Conditions for which there is no room any
    more are superfluous: they follow from the others or contradict them. Raises DseError if conditions are missing for
    anything else.
    """
    all_rows = list(rows)
    all_unknowns = list(unknowns)
    all_unknowns.extend(_free_parameters(flat, all_rows))
    discretes = _free_discretes(flat)
    all_unknowns.extend(Symbol(name) for name in discretes)
    filling = _Filling(all_rows, all_unknowns)
    filling.enter(_given(flat, unknowns))
    is_state = set(states)
    others = [one for one in unknowns if one not in is_state and not one.order and _has_start(flat, one)]
    free = [one for one in all_unknowns[len(unknowns) :] if one.name not in discretes]
    kept = sorted(map(Symbol, discretes), key=lambda one: not flat.variables[one.name].is_fixed)
    notes = filling.complete(flat, kept, [*states, *free, *others])
    hint = "give an initial equation or a fixed start"
    raise_if_any(
        Problem(f"nothing determines {symbol} at the start", flat.variables[symbol.name].where, hint)
        for symbol in filling.missing()[:12]
    )
    return Start(
        tuple(filling.rows), tuple(all_unknowns), frozenset(discretes), tuple(filling.superfluous), tuple(notes)
    )


class _Filling:
    """Rows entered one by one, as long as there is an unknown for them."""

    def __init__(self, rows: list[Row], unknowns: list[Symbol]) -> None:
        self.rows: list[Row] = []
        self.superfluous: list[Row] = []
        self._unknowns = unknowns
        self._number = {symbol: place for place, symbol in enumerate(unknowns)}
        self._columns: list[list[int]] = []
        self._matching = Matching()
        for row in rows:
            if not self._try(row):
                raise DseError(*told([row], "this equation cannot hold at the start together with the others"))

    def _try(self, row: Row) -> bool:
        self._columns.append([self._number[symbol] for symbol in smooth(row.residual) if symbol in self._number])
        if self._matching.match(len(self._columns) - 1, self._columns):
            self._columns.pop()
            return False
        self.rows.append(row)
        return True

    def enter(self, rows: Iterable[Row]) -> None:
        self.superfluous += [row for row in rows if not self._try(row)]

    def missing(self) -> list[Symbol]:
        return [symbol for symbol in self._unknowns if self._number[symbol] not in self._matching.row_of]

    def complete(self, flat: FlatModel, discretes: Sequence[Symbol], others: Sequence[Symbol]) -> list[str]:
        def rank(symbol: Symbol) -> tuple[bool, int]:
            return not _has_start(flat, symbol), -flat.variables[symbol.name].prefers_state

        notes = []
        # Discrete variables keep their starts. Then what has a start value of its own, the model's favourites first.
        for symbol in [*discretes, *sorted(others, key=rank)]:
            if len(self.rows) == len(self._unknowns):
                break
            if self._try(_started(flat, symbol)) and symbol not in discretes:
                value = shown(_start_of(flat, symbol))
                notes.append(f"{symbol} starts at {value}: nothing else determines it at the start")
        return notes


def _has_start(flat: FlatModel, symbol: Symbol) -> bool:
    return not symbol.order and flat.variables[symbol.name].start is not None


def _start_of(flat: FlatModel, symbol: Symbol) -> Expression:
    variable = flat.variables[symbol.name]
    if symbol.order == 0 and variable.start is not None:
        return variable.start
    return flat.graph.constant(0.0 if symbol.order else default(variable))


def _started(flat: FlatModel, symbol: Symbol) -> Row:
    return Row(flat.graph.symbol(symbol) - _start_of(flat, symbol), flat.variables[symbol.name].where)


def _given(flat: FlatModel, unknowns: Sequence[Symbol]) -> Iterator[Row]:
    yield from (Row(one.residual, one.where) for one in flat.initial_equations)
    for symbol in unknowns:
        if not symbol.order and flat.variables[symbol.name].is_fixed:
            yield _started(flat, symbol)


def _free_parameters(flat: FlatModel, rows: list[Row]) -> list[Symbol]:
    """Parameters to be found at the start, and those that depend on them; the latter's bindings join *rows*."""
    names = {name: None for name, variable in flat.variables.items() if is_free(variable)}
    if not names:
        return []
    is_grown = True
    while is_grown:
        is_grown = False
        for name, variable in flat.variables.items():
            if name in names or not is_dependent(variable) or variable.binding is None:
                continue
            if any(symbol.name in names for symbol in symbols(variable.binding)):
                names[name] = None
                rows.append(Row(flat.graph.variable(name) - variable.binding, variable.where))
                is_grown = True
    return [Symbol(name) for name in names]


def _free_discretes(flat: FlatModel) -> list[str]:
    """Discrete variables that initial equations speak of and no equation determines at the start."""
    always = _assigned(flat)
    found: dict[str, None] = {}
    for equation in flat.initial_equations:
        for symbol in symbols(equation.residual):
            if symbol.referent is Referent.PRE:
                what = f"an initial equation refers to pre({symbol.name})"
                raise DseError(Problem(what, equation.where, "give the variable a start value"))
            if not symbol.is_variable or flat.variables[symbol.name].role is not Role.DISCRETE:
                continue
            if symbol.name not in always:
                found[symbol.name] = None
    return list(found)


def _assigned(flat: FlatModel) -> set[str]:
    """Discrete variables that have another value than the one before at the start."""
    return {one.target for one in flat.assignments if one.trigger is None or flat.triggers[one.trigger].at_start}


def without_values_before(flat: FlatModel) -> FlatModel:
    """*flat* whose initial equations say ``d`` for ``pre(d)``: the same, where nothing assigns d at the start."""
    assigned = _assigned(flat)

    def now(node: Expression) -> Expression | None:
        symbol = node.symbol
        if symbol is None or symbol.referent is not Referent.PRE or symbol.name in assigned:
            return None
        return flat.graph.variable(symbol.name) if flat.variables[symbol.name].role is Role.DISCRETE else None

    found = (replace(one, residual=replaced((one.residual,), now)[0]) for one in flat.initial_equations)
    return replace(flat, initial_equations=tuple(found))


def values_before(flat: FlatModel, found: Start) -> Iterator[Stage[EventBlock]]:
    """Values just before the start of discrete variables that are known only when *found* is solved."""
    unknown = set(found.unknowns)
    for name in by_target(flat):
        value, where = flat.variables[name].start, flat.variables[name].where
        value = flat.graph.variable(name) if name in found.discretes else value
        if value is not None and not unknown.isdisjoint(needs := symbols(value)):
            before = Symbol(name, referent=Referent.PRE)
            yield Stage(Explicit(before, value), (before,), tuple(needs), where, f"pre({name})")


def checked(flat: FlatModel, superfluous: Sequence[Row]) -> FlatModel:
    """*flat* with a check at the start for each superfluous condition that may not hold.

    Raises DseError for one that cannot hold.
    """
    checks = []
    trigger = len(flat.triggers)
    graph = flat.graph
    for row in superfluous:
        residual = actual(row.residual)
        if residual.is_number(0):
            continue
        if residual.is_constant:
            raise DseError(*told([row], "this condition contradicts others at the start"))
        left, right = residual.operands if residual.operator == "subtract" else (residual, graph.constant(0.0))
        size = graph.make("maximum", graph.make("abs", left), graph.make("abs", right))
        size = graph.make("maximum", graph.constant(1.0), size)
        condition = graph.make("less_equal", graph.make("abs", residual), CONSISTENT * size)
        message = f"at the start there is one condition too many, and it does not hold: {row}"
        checks.append(Check(condition, message, trigger=trigger, where=row.where))
    if not checks:
        return flat
    return replace(flat, triggers=(*flat.triggers, Trigger(at_start=True)), checks=(*flat.checks, *checks))
