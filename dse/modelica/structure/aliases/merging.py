"""What an eliminated variable says about the one that is kept: start, fixed, stateSelect, bounds."""

from __future__ import annotations

from dataclasses import replace

from dse.errors import Problem, raise_if_any
from dse.modelica.algebra.expression import Expression, shown
from dse.modelica.flat_model import FlatModel, Variable
from dse.modelica.structure.aliases.elimination import Eliminated


def merged(flat: FlatModel, eliminated: Eliminated) -> tuple[FlatModel, list[str]]:
    """*flat*, rewritten already, with the attributes of aliases joined, and notes on what was passed over.

    A fixed start is never lost: it moves to the kept variable. Raises DseError for two fixed starts of one quantity
    that are not the same expression, and for a fixed start of a quantity that is a number. Of starts that are not
    fixed the kept variable's own is taken, else the first one's; another one is noted.
    """
    variables = dict(flat.variables)
    problems: list[Problem] = []
    notes: list[str] = []
    for name, value in eliminated.numbers.items():
        variable = variables[name]
        start = variable.start
        if variable.is_fixed and start is not None and not start.is_number(value):
            what = f"'{name}' starts fixed at {shown(start)}, but the equations make it {value:g}"
            problems.append(Problem(what, variable.where))
        variables[name] = replace(variable, start=flat.graph.constant(value), is_fixed=False)
    for name, (kept, sign) in eliminated.aliases.items():
        variables[kept] = _joined(variables[kept], variables[name], sign, problems, notes)
    for name, (kept, sign) in eliminated.aliases.items():
        start = variables[kept].start
        variables[name] = replace(variables[name], start=_signed(start, sign), is_fixed=False)
    raise_if_any(problems)
    return replace(flat, variables=variables), notes


def _joined(kept: Variable, other: Variable, sign: int, problems: list[Problem], notes: list[str]) -> Variable:
    start = _signed(other.start, sign)
    minimum, maximum = (_signed(bound, sign) for bound in (other.minimum, other.maximum)[::sign])
    joined = replace(
        kept,
        prefers_state=kept.prefers_state or other.prefers_state,
        minimum=_tighter(kept.minimum, minimum, "maximum"),
        maximum=_tighter(kept.maximum, maximum, "minimum"),
        nominal=kept.nominal or other.nominal,
    )
    if start is None:
        return replace(joined, is_fixed=kept.is_fixed or other.is_fixed)
    is_same = kept.start is start
    if kept.is_fixed and other.is_fixed and not is_same:
        shown_start = "0" if kept.start is None else shown(kept.start)
        what = f"'{kept.name}' and '{other.name}' are one quantity, but both have a fixed start"
        problems.append(Problem(f"{what}: {shown_start} and {shown(start)}", other.where or kept.where))
    if kept.start is None or (other.is_fixed and not kept.is_fixed):
        if kept.start is not None and not is_same:
            notes.append(f"the start of '{kept.name}' is passed over: its alias '{other.name}' has a fixed one")
        return replace(joined, start=start, is_fixed=kept.is_fixed or other.is_fixed)
    if not is_same and not other.is_fixed:
        notes.append(f"the start of '{other.name}' is passed over: its alias '{kept.name}' has another")
    return joined


def _signed(expression: Expression | None, sign: int) -> Expression | None:
    return expression if expression is None or sign > 0 else -expression


def _tighter(one: Expression | None, other: Expression | None, operator: str) -> Expression | None:
    if one is None or other is None:
        return one if other is None else other
    return one.graph.make(operator, one, other)
