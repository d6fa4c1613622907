"""From the front-end's system to a flat model of scalars."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from dse.errors import Location, fail
from dse.modelica.algebra.expression import Graph
from dse.modelica.algebra.symbol import Referent
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import Check, Equation, FlatModel, Role, Trigger
from dse.modelica.flatten.declarations import bindings, complete, declare, declared
from dse.modelica.flatten.document import Record, check_calls, fields, points, read, shape, single
from dse.modelica.flatten.evaluation.context import Frame
from dse.modelica.flatten.evaluation.evaluation import Evaluation
from dse.modelica.flatten.events.conditions import Conditions, read_clocks
from dse.modelica.flatten.events.discrete import read_discrete
from dse.modelica.flatten.model import Declared, Model
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
    bound = complete(document, evaluation)
    read_clocks(evaluation)
    equations, asserts = continuous(evaluation)
    equations += bindings(document, evaluation)
    initial_equations, asserts_at_start = initial(evaluation)
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
        checks=_distinct([*bound, *asserts, *asserts_at_start, *discrete.checks]),
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


# Continuous and initial equations: residuals, one by one or as families over a domain.


def continuous(evaluation: Evaluation) -> tuple[list[Equation], list[Check]]:
    """The equations that hold at all times, and the asserts of functions in them."""
    frame = Frame(makes_events=True)
    records = evaluation.document.lists["continuous_equation_operations"]
    return [item for record in records for item in _equations(evaluation, record, frame)], frame.asserts


def initial(evaluation: Evaluation) -> tuple[list[Equation], list[Check]]:
    """The equations that hold at the start only, and the asserts of functions in them.

    Comparisons are taken as they are: nothing is held yet.
    """
    frame = Frame(makes_events=False)
    document, declared = evaluation.document, evaluation.model.declared
    found = []
    for record in document.lists["initialization_equation_operations"]:
        found += list(_equations(evaluation, record, frame))
    for record in document.lists["initial_parameter_values"]:
        where = document.where(record.get("provenance"))
        fields(record, "target value", "an initial value", where)
        item = declared[record["target"]]
        found += _solved_for(evaluation, item, record["value"], frame, f"an initial value of '{item.name}'", where)
    for item, record in zip(declared, document.lists["variables"], strict=True):
        node = record["attributes"]["binding"]
        if item.role == "parameter" and node is not None and (record["attributes"]["fixed"] or [True])[0] is False:
            found += _solved_for(evaluation, item, node, frame, f"a binding of '{item.name}'", item.where)
    if not frame.asserts:
        return found, []
    triggers = evaluation.model.triggers
    triggers.append(Trigger(at_start=True))
    return found, [replace(check, trigger=len(triggers) - 1) for check in frame.asserts]


def _solved_for(
    evaluation: Evaluation, item: Declared, node: int, frame: Frame, what: str, where: Location | None
) -> Iterator[Equation]:
    for name, value in evaluation.scalars(item, node, _fresh(frame), f"{what} of another size", where):
        yield Equation(evaluation.graph.variable(name) - value, where)


def _equations(evaluation: Evaluation, record: Record, frame: Frame) -> Iterator[Equation]:
    document = evaluation.document
    kind, data = single(record, "an equation")
    where = document.where(data.get("provenance"))
    if kind == "residual":
        fields(data, "residual", "an equation", where)
        for element in evaluation.elements(data["residual"], _fresh(frame)).elements:
            yield Equation(element, where)
        return
    if kind != "structured":
        raise fail(f"an equation of kind '{kind}' is not supported", where)
    fields(data, "domain scalar_view bodies", "a family of equations", where)
    view, detail = single(data["scalar_view"], "a family of equations", where)
    domain = data["domain"]
    sizes = shape(document, domain)
    if view == "BinderPrefixProjection":
        fields(detail, "binder_count", "a family of equations", where)
        bound = detail["binder_count"]
    elif view in ("RowMajorProjection", "BinderSubstitution"):
        bound = len(sizes) if view == "BinderSubstitution" else 0
    else:
        raise fail(f"a family of equations of kind '{view}' is not supported", where)
    for body in data["bodies"]:
        place = document.at(body) or where
        seen: set[tuple[int, ...]] = set()
        for point in points(document, domain):
            if point[:bound] in seen:
                continue
            seen.add(point[:bound])
            turn = frame.turn(domain, point[:bound])
            value = evaluation.elements(body, turn)
            if math.prod(value.shape) != math.prod(sizes[bound:]):  # [3, 1] for [3], as of ``[y] = [u]``
                raise document.refused(f"a family of equations of size {list(value.shape)}", body)
            for element in value.elements:
                yield Equation(element, place)


def _fresh(frame: Frame) -> Frame:
    """The same frame that knows nothing yet, so that what one equation found does not stay in memory for all."""
    return Frame(frame.makes_events, frame.asserts)
