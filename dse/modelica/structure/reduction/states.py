"""The equations with the derivatives that are needed, and the states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from dse.errors import DseError
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import actual, without_rates
from dse.modelica.flat_model import FlatModel, Role
from dse.modelica.solved_model import Explicit, Selection
from dse.modelica.structure.known import Known, Starts
from dse.modelica.structure.preparation import with_initial
from dse.modelica.structure.reduction.dummies import chosen
from dse.modelica.structure.reduction.pantelides import Reduced, reduced
from dse.modelica.structure.reduction.selection import eliminated
from dse.modelica.structure.rows import Row


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
    choice = chosen(found, flat.variables, known)
    dummies, undone = choice.dummies, choice.undone
    selections: tuple[Selection, ...] = ()
    if choice.matrix:
        elimination = eliminated(choice, found, known)
        dummies, undone, selections = frozenset(elimination.dummies), None, tuple(elimination.selections)
        names = [*names, *(name for name in elimination.flat.variables if name not in flat.variables)]
        flat = elimination.flat
        names = [name for name in names if flat.variables[name].role is Role.CONTINUOUS]
        found = _reduced(flat, names)
    if undone is not None:
        raise DseError(undone)
    if flat.graph.uses("prescribed"):
        flat = flat.mapped(without_rates)
    every = [Symbol(name, order) for name in names for order in range(found.highest[name] + 1)]
    states = [one for one in every if one.order < found.highest[one.name] and one.derivative not in dummies]
    selected = {name for one in selections for name in one.states}
    started = [one for one in states if one.name not in selected]
    candidates = [
        Symbol(own.name, own.order + level)
        for one in selections
        for own in one.candidates
        for level in range(one.levels)
    ]
    started += sorted(candidates, key=lambda one: one.derivative in choice.dummies)
    known = Known(flat, Starts(flat, parameters))
    return States(flat, known, found.chains, tuple(every), tuple(states), tuple(started), selections)


def _reduced(flat: FlatModel, names: Sequence[str]) -> Reduced:
    rows = [Row(actual(with_initial(one.residual, 0.0)), one.where) for one in flat.equations]
    found = reduced(rows, names, flat.variables)
    if not flat.graph.uses("prescribed"):
        return found
    cleared = [[replace(row, residual=without_rates(row.residual)) for row in chain] for chain in found.chains]
    return replace(found, chains=tuple(map(tuple, cleared)))
