"""From the front-end's system to a flat model of scalars."""

from __future__ import annotations

from collections.abc import Sequence

from dse.errors import fail
from dse.modelica.algebra.expression import Graph
from dse.modelica.algebra.symbol import Referent
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import Check, FlatModel, Role
from dse.modelica.flatten.declarations import bindings, complete, declare, declared
from dse.modelica.flatten.document import check_calls, read
from dse.modelica.flatten.equations import continuous, initial
from dse.modelica.flatten.evaluation.evaluation import Evaluation
from dse.modelica.flatten.events.conditions import Conditions, read_clocks
from dse.modelica.flatten.events.discrete import read_discrete
from dse.modelica.flatten.model import Model
from dse.modelica.frontend.result import FrontEndResult


def flatten(result: FrontEndResult) -> FlatModel:
    """The flat model of *result*: every array a row of scalars, every function call written out.

    Raises DseError, with the place in the Modelica file, for every construct that is not translated with certainty.
    """
    document = read(result)
    check_calls(document)
    items = declared(document)
    inputs = frozenset(name for item in items if item.role == "input" and item.is_discrete for name in item.names)
    model = Model(Graph(), items, inputs)
    evaluation = Evaluation(document, model)
    declare(document, model)
    complete(document, evaluation)
    read_clocks(evaluation)
    equations, asserts = continuous(evaluation)
    equations += bindings(document, evaluation)
    initial_equations = initial(evaluation)
    discrete = read_discrete(evaluation, Conditions(evaluation))
    flat = FlatModel(
        name=result.model,
        graph=model.graph,
        variables=model.variables,
        equations=tuple(equations),
        initial_equations=tuple(initial_equations),
        relations=tuple(model.relations),
        clocks=tuple(model.clocks),
        triggers=tuple(model.triggers),
        assignments=tuple(model.assignments),
        reinitializations=tuple(discrete.reinitializations),
        checks=_distinct([*asserts, *discrete.checks]),
    )
    _check_balance(flat)
    return flat


def _distinct(checks: Sequence[Check]) -> tuple[Check, ...]:
    """*checks*, one for each condition and message: a function called twice with one argument asserts once."""
    seen: dict[tuple[object, ...], Check] = {}
    for check in checks:
        seen.setdefault((check.condition, check.message, check.trigger, check.terminates), check)
    return tuple(seen.values())


def _check_balance(flat: FlatModel) -> None:
    """Raise DseError if equations and unknowns differ in number, or something is used that is not there."""
    unknown = sum(1 for variable in flat.variables.values() if variable.role is Role.CONTINUOUS)
    if len(flat.equations) != unknown:
        raise fail(f"'{flat.name}' has {len(flat.equations)} equations for {unknown} unknowns")
    roots = [item.residual for item in (*flat.equations, *flat.initial_equations)]
    roots += [root for root, _ in flat.at_events()]
    roots += [condition for trigger in flat.triggers for condition in trigger.conditions]
    for root in roots:
        for symbol in symbols(root):
            if symbol.referent in (Referent.VARIABLE, Referent.PRE) and symbol.name not in flat.variables:
                raise fail(f"'{symbol.name}' is used in '{flat.name}' but is not a variable of it")
            if symbol.referent is Referent.HELD and int(symbol.name) >= len(flat.relations):
                raise fail(f"relation {symbol.name} is used in '{flat.name}' but is not there")
