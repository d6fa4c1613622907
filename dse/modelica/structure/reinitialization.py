"""Reinitializations whose meaning is certain."""

from __future__ import annotations

from collections.abc import Sequence

from dse.errors import Problem, raise_if_any
from dse.modelica.algebra.expression import Expression, Symbol
from dse.modelica.flat import FlatModel
from dse.modelica.structure.dependencies import Reach
from dse.modelica.structure.incidence import occurring


def refuse_uncertain(flat: FlatModel, states: Sequence[Symbol], reach: Reach) -> None:
    """Raise DseError for each ``reinit`` of what is no state, and where old and new values of a state could be mixed.

    ``reinit(x, expression)`` makes x an unknown of the event instant (Modelica 3.6, 8.3.6), so whatever else reads x
    without ``pre`` at that instant means the new value; but values are read before any state is written. Its own state
    may be read plainly: ``reinit(v, -e * v)`` is common and means the value before.
    """
    names = {state.name for state in states if not state.order}
    hint = "prefer it as a state by stateSelect"
    what = "reinit of '{}', which is no state: its value follows from other states"
    problems = [
        Problem(what.format(one.state), one.where, hint) for one in flat.reinitializations if one.state not in names
    ]
    written = {one.state for one in flat.reinitializations}
    written_by = {(one.trigger, one.state) for one in flat.reinitializations}
    for one in flat.reinitializations:
        for name in _read(one.value, reach):
            if name in written and name != one.state:
                what = f"the new value of '{one.state}' is read from '{name}', which is set anew itself"
                problems.append(Problem(what, one.where, f"write pre({name})"))
    for assignment in flat.assignments:
        if assignment.trigger is None:
            continue
        for name in _read(assignment.value, reach):
            if (assignment.trigger, name) in written_by:
                what = f"'{assignment.target}' is read from '{name}', which is set anew at the same instant"
                problems.append(Problem(what, assignment.where, f"write pre({name})"))
    raise_if_any(problems)


def _read(value: Expression, reach: Reach) -> list[str]:
    """States that *value* depends on at the instant."""
    symbols: list[Symbol] = reach.of(*occurring(value))
    return [symbol.name for symbol in symbols if not symbol.order]
