"""The states, some of them selected during the run: where no choice of dummy derivatives is good for all of it.

Mattsson, Olsson and Elmqvist, Dynamic selection of states in Dymola, Modelica Workshop 2000, 61-67. Of a pendulum in
Cartesian coordinates, ``x^2 + y^2 = L^2``, neither x nor y is a good state all the way round. The model gets a variable
``z = s1*x + s2*y`` with discrete s1 and s2, one of which is 0, and z and its derivative become the states. After each
step the runtime looks at the coefficients of the differentiated constraint, here (x, y). If those of what is no state
are far from the best ones, it sets s1 and s2 and then z and its derivative anew; x and y keep their values.

What is eliminated by a coefficient that is never 0 needs no selection. This is done first, symbolically, so that of a
mechanism with one loop two equations are left, with the angles of its joints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from dse.errors import DseError, Problem, some_of
from dse.graphs import joined
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import actual, without_rates
from dse.modelica.flat_model import Equation, FlatModel, Role, ScalarType, Variable
from dse.modelica.solved_model import Explicit, Selection
from dse.modelica.structure.known import Known, Starts
from dse.modelica.structure.preparation import with_initial
from dse.modelica.structure.reduction.dummies import ALWAYS, Choice, chosen, is_fixed, is_wanted
from dse.modelica.structure.reduction.pantelides import Reduced, reduced
from dse.modelica.structure.rows import Row, listed, told

SELECTED = ALWAYS + 1
"""What is selected is a state before all others."""
NEVER = -2
PREFERENCE = 4.0
"""How many times larger the coefficient of a variable has to be than that of one with the next lower stateSelect,
until the former becomes no state rather than the latter."""


@dataclass(frozen=True, slots=True)
class States:
    """*flat*, whose equations each begin one of *chains*, followed by its derivatives.

    *symbols*: all variables and derivatives that are computed. *states*: those that are integrated. *started*: those
    whose starts count where nothing else determines the start: the states, and the candidates of *selections*, those
    first that are independent at the start.
    """

    flat: FlatModel
    known: Known
    chains: tuple[tuple[Row, ...], ...]
    symbols: tuple[Symbol, ...]
    states: tuple[Symbol, ...]
    started: tuple[Symbol, ...]
    selections: tuple[Selection, ...]


def with_states(flat: FlatModel, names: Sequence[str], parameters: list[Explicit]) -> States:
    """*flat*, with its equations differentiated and the states of *names* chosen; *parameters* are dependent ones.

    Raises DseError for what `reduced` and `chosen` refuse, and for states that cannot be selected.
    """
    found = _reduced(flat, names)
    known = Known(flat, Starts(flat, parameters))
    choice = chosen(found, known)
    dummies, selections = choice.dummies, list[Selection]()
    if choice.matrix:
        elimination = Elimination(choice, found, known)
        while elimination.lacking:
            elimination = Elimination(choice, found, known, elimination.wanted | elimination.lacking)
        dummies, selections = frozenset(elimination.dummies), elimination.selections
        added = [one for name, one in elimination.flat.variables.items() if name not in flat.variables]
        names = [*names, *(one.name for one in added if one.role is Role.CONTINUOUS)]
        flat = elimination.flat
        found = _reduced(flat, names)
    elif wrong := [one for one in dummies if one.order == 1 and flat.variables[one.name].prefers_state == ALWAYS]:
        names = sorted(one.name for one in wrong)
        what = f"not all variables with stateSelect.always can be states: {some_of(names, 8)}"
        raise DseError(Problem(what, flat.variables[names[0]].where))
    if flat.graph.uses("prescribed"):
        flat = flat.mapped(without_rates)
    every = [Symbol(name, order) for name in names for order in range(found.highest[name] + 1)]
    states = [one for one in every if one.order < found.highest[one.name] and one.derivative not in dummies]
    selected = {name for one in selections for name in one.states}
    started = [one for one in states if one.name not in selected]
    candidates = [own for one in selections for own in one.every]
    started += sorted(candidates, key=lambda one: one.derivative in choice.dummies)
    known = Known(flat, Starts(flat, parameters))
    return States(flat, known, found.chains, tuple(every), tuple(states), tuple(started), tuple(selections))


def _reduced(flat: FlatModel, names: Sequence[str]) -> Reduced:
    rows = [Row(actual(with_initial(one.residual, 0.0)), one.where) for one in flat.equations]
    found = reduced(rows, names, flat.variables)
    if not flat.graph.uses("prescribed"):
        return found
    cleared = [[replace(row, residual=without_rates(row.residual)) for row in chain] for chain in found.chains]
    return replace(found, chains=tuple(map(tuple, cleared)))


class Elimination:
    """The differentiated equations of *found* with the coefficients of *choice*.

    *dummies*: derivatives that are ordinary unknowns. *flat*: with the variables and equations for what does not follow
    from coefficients that are never 0, by independent parts; these are *selections*. *lacking*: what has to be a state,
    besides *wanted*, so that the others that have to be can.
    """

    def __init__(self, choice: Choice, found: Reduced, known: Known, wanted: frozenset[str] = frozenset()) -> None:
        chains = [chain for chain in found.chains if len(chain) > 1]
        self._known = known
        self._columns = choice.candidates
        self._variables = [known.flat.variables[one.name] for one in choice.candidates]
        self._rows = [chain[0] for chain in chains]
        self._times = [len(chain) - 1 for chain in chains]
        self._lines = [dict(line) for line in choice.matrix]
        self._open = dict.fromkeys(range(len(chains)))
        self.wanted = wanted
        self._taken: set[int] = set()
        self.flat = known.flat
        self.dummies: set[Symbol] = set()
        self.lacking: set[str] = set()
        self.selections: list[Selection] = []
        for times in sorted(set(self._times), reverse=True):
            while (pivot := self._constant_pivot(times)) is not None:
                self._eliminate(*pivot)
            self._select(times)

    def _constant_pivot(self, times: int) -> tuple[int, int] | None:
        found = [
            (self._key(column), row, column)
            for row in self._open
            if self._times[row] == times
            for column, entry in self._lines[row].items()
            if self._may_be_dummy(column, times) and column not in self._taken
            if is_fixed(entry, self._known)
        ]
        return min(found)[1:] if found else None

    def _key(self, column: int) -> tuple[int, bool, int]:
        variable = self._variables[column]
        return variable.prefers_state, variable.is_fixed, -self._columns[column].order

    def _may_be_dummy(self, column: int, times: int) -> bool:
        name = self._columns[column].name
        return self._columns[column].order > times or not (name in self.wanted or is_wanted(name, self._known.flat))

    def _derivatives(self, column: int, times: int) -> list[Symbol]:
        """What becomes dummies if *column* is eliminated by an equation differentiated *times* times."""
        name, order = self._columns[column].name, self._columns[column].order
        return [Symbol(name, order - k) for k in range(times)]

    def _eliminate(self, row: int, column: int) -> None:
        del self._open[row]
        self.dummies.update(self._derivatives(column, self._times[row]))
        line = self._lines[row]
        for other in self._open:
            own = self._lines[other]
            if column not in own:
                continue
            factor = own.pop(column) / line[column]
            for place, entry in line.items():
                if place != column:
                    zero = entry.graph.constant(0.0)
                    own[place] = own.get(place, zero) - factor * entry
                    if own[place].is_number(0):
                        del own[place]

    def _select(self, times: int) -> None:
        """The parts of the equations that are left, with those differentiated *times* times."""
        rows = [row for row in self._open if self._times[row] == times]
        for part in joined([self._lines[row] for row in rows]):
            self._add([rows[place] for place in part], times)
        columns = {column for row in rows for column in self._lines[row]}
        self._taken.update(column for column in columns if self._may_be_dummy(column, times))

    def _add(self, rows: Sequence[int], times: int) -> None:
        every = sorted({column for row in rows for column in self._lines[row]}, key=lambda one: (self._key(one), one))
        free = [column for column in every if self._may_be_dummy(column, times) and column not in self._taken]
        if len(free) < len(rows):
            taken = {self._columns[column].name for column in every if column in self._taken} - self.wanted
            self.lacking |= taken
            if taken:
                return
            what = f"there are no states that could be selected among {listed(self._columns[one] for one in every)}"
            raise DseError(*told((self._rows[row] for row in rows), what))
        for column in free:
            self.dummies.update(self._derivatives(column, times))
        never = sum(self._variables[column].prefers_state == NEVER for column in free)
        number = len(self.selections) + 1
        while any(name.startswith(f"stateSelect.set{number}.") for name in self.flat.variables):
            number += 1
        columns = [*free, *(column for column in every if column not in free)]
        zero = self.flat.graph.constant(0.0)
        entries = [[self._lines[row].get(column, zero) for column in columns] for row in rows]
        nominals = [self._variables[column].nominal for column in columns]
        units = [abs(one.value) if one is not None and one.is_constant and one.value else 1.0 for one in nominals]
        wishes = [self._variables[column].prefers_state for column in free]
        wishes += [max(wishes)] * (len(columns) - len(free))
        found = Selection(
            number=number,
            candidates=tuple(self._derivatives(column, times + 1)[-1] for column in free),
            levels=times,
            rows=len(rows),
            never=never if never <= len(rows) else 0,
            units=tuple(units),
            weights=tuple(unit * PREFERENCE**-wish for unit, wish in zip(units, wishes, strict=True)),
            subject=some_of([str(self._rows[row]) for row in rows], 4),
            where=tuple(where for row in rows if (where := self._rows[row].where) is not None),
        )
        self.selections.append(found)
        self.flat = _extended(self.flat, found, entries)


def _extended(flat: FlatModel, selection: Selection, entries: Sequence[Sequence[Expression]]) -> FlatModel:
    """*flat* with the states of *selection*, the shares of the candidates in them, and the coefficients."""
    graph = flat.graph
    variables, equations = dict(flat.variables), list(flat.equations)
    where = selection.where[0] if selection.where else None

    def add(name: str, role: Role, **more: object) -> Expression:
        own = Variable(name, ScalarType.REAL, role, is_protected=True, where=where)
        variables[name] = replace(own, **more)  # type: ignore[arg-type]  # fields of Variable
        return graph.variable(name)

    for name, entry in zip(selection.matrix, (one for line in entries for one in line), strict=True):
        equations.append(Equation(add(name, Role.CONTINUOUS) - entry, where))
    names = ", ".join(map(str, selection.candidates))
    for row, name in enumerate(selection.states):
        state = add(name, Role.CONTINUOUS, prefers_state=SELECTED, description=f"selected among {names}")
        total = graph.constant(0.0)
        for column, share in enumerate(selection.shares[row]):
            candidate = selection.candidates[selection.never + column]
            start = graph.constant(1.0 / selection.units[selection.never + column] if row == column else 0.0)
            total = total + add(share, Role.DISCRETE, start=start) * graph.symbol(candidate)
        equations.append(Equation(state - total, where))
        highest = graph.variable(name, selection.levels)
        equations.append(Equation(add(f"${name}", Role.CONTINUOUS) - highest, where))
    return replace(flat, variables=variables, equations=tuple(equations))
