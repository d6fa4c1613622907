"""The discrete part: assignments at events, reinit, assert and terminate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import cast

from dse.errors import Location, fail
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import replaced, symbols
from dse.modelica.flat_model import Check, Reinitialization, Role
from dse.modelica.flatten.document import Record, fields, shape, single
from dse.modelica.flatten.evaluation.context import Frame, implies
from dse.modelica.flatten.evaluation.evaluation import Evaluation
from dse.modelica.flatten.events.chains import Chains, Span, read_chains, span
from dse.modelica.flatten.events.clauses import Clauses, Item
from dse.modelica.flatten.events.conditions import Conditions
from dse.modelica.flatten.values import Text
from dse.modelica.frontend.library_functions import IMPURE_SEED


@dataclass(slots=True)
class Discrete:
    """Collects what happens at events. *checking*: conditions of when-clauses with an assert or a terminate."""

    evaluation: Evaluation
    conditions: Conditions
    chains: Chains
    items: dict[str, list[Item]] = field(default_factory=dict)
    checking: list[int] = field(default_factory=list)
    reinitialized: dict[str, list[Item]] = field(default_factory=dict)
    checks: list[Check] = field(default_factory=list)
    reinitializations: list[Reinitialization] = field(default_factory=list)


def read_discrete(evaluation: Evaluation, conditions: Conditions) -> Discrete:
    """Everything discrete of the document; triggers and assignments are entered into the model."""
    discrete = Discrete(evaluation, conditions, read_chains(evaluation.document))
    lists = evaluation.document.lists
    for record in lists["discrete_real_equations"]:
        _real_equation(discrete, record)
    for record in lists["discrete_value_owners"]:
        _value_owner(discrete, record)
    for record in lists["event_actions"]:
        _action(discrete, record)
    for record in lists["model_event_transactions"]:
        _check_transaction(discrete, record)
    values: dict[Symbol, tuple[Expression, Location | None]] = {}
    for record in lists["initial_discrete_values"]:
        values |= _initial_values(discrete, record)
    _enter_initial_values(evaluation, values)
    _finish(discrete)
    return discrete


def _activation(discrete: Discrete, record: object, where: Location | None) -> tuple[int | None, Expression]:
    """Trigger condition and guard of an activation: ``always`` or when."""
    kind, data = single(record, "an activation", where)
    if kind == "always":
        return None, discrete.evaluation.graph.constant(1.0)
    if kind != "when":
        raise fail(f"an equation that is active at '{kind}' is not supported", where)
    fields(data, "trigger guard", "a when-clause", where)
    return data["trigger"], discrete.conditions.guard(data["guard"], data["trigger"])


def _real_equation(discrete: Discrete, record: Record) -> None:
    evaluation, document = discrete.evaluation, discrete.evaluation.document
    where = document.where(record.get("provenance"))
    fields(record, "residual activation", "a discrete equation", where)
    trigger, guard = _activation(discrete, record["activation"], where)
    node = document.nodes.get(record["residual"])
    if node is None or node.kind != "binary" or node.data["operator"] != "subtract":
        raise fail("a discrete equation that is not an assignment is not supported", where)
    frame = Frame(makes_events=trigger is None)
    left = evaluation.elements(node.data["lhs"], frame)
    right = evaluation.elements(node.data["rhs"], frame)
    owners = {name: item.name for item in evaluation.model.declared for name in item.names}
    for target, value in ((left, right), (right, left)):
        names = [name for name in (_target(discrete, element) for element in target.elements) if name]
        if target.shape == value.shape and len(names) == len(target.elements):
            for name, element in zip(names, value.elements, strict=True):
                _enter(discrete, Item(name, owners[name], element, trigger, guard, where))
            _inside(discrete, frame.asserts, trigger, guard)
            return
    raise fail(
        "a discrete equation that is not solved for its variable is not supported", where, "write it as d = expression"
    )


def _target(discrete: Discrete, element: Expression) -> str | None:
    """The name of the discrete variable that *element* is; None if it is none."""
    symbol = element.symbol
    if symbol is None or not symbol.is_variable or symbol.order:
        return None
    return symbol.name if discrete.evaluation.model.variables[symbol.name].role is Role.DISCRETE else None


def _value_owner(discrete: Discrete, record: Record) -> None:
    evaluation = discrete.evaluation
    where = evaluation.document.where(record.get("provenance"))
    fields(record, "targets branches structure observed", "a discrete equation", where)
    if record["structure"] is not None:
        fields(record["structure"], "domain scalar_view", "a family of discrete equations", where)
        sizes = shape(evaluation.document, record["structure"]["domain"])
        whole = all(evaluation.model.declared[target].shape == sizes for target in record["targets"])
        if record["structure"]["scalar_view"] != "RowMajorProjection" or not whole:
            raise fail("this family of discrete equations is not supported", where, "write them one by one")
    for branch in record["branches"]:
        fields(branch, "activation values", "a discrete equation", where)
        trigger, guard = _activation(discrete, branch["activation"], where)
        frame = Frame(makes_events=trigger is None)
        for target, item in zip(record["targets"], branch["values"], strict=True):
            place = evaluation.document.where(item.get("provenance")) or where
            fields(item, "value", "a discrete value", place)
            declared = evaluation.model.declared[target]
            misfit = f"a value of '{declared.name}' of another size"
            for name, element in evaluation.scalars(declared, item["value"], frame, misfit, place):
                _enter(discrete, Item(name, declared.name, element, trigger, guard, place))
        _inside(discrete, frame.asserts, trigger, guard)


def _check_transaction(discrete: Discrete, record: Record) -> None:
    """A clocked algorithm, once more as a whole; what it assigns must be among the equations read before."""
    fields(record, "targets steps", "an algorithm at a sample", None)
    known = {item.owner for items in discrete.items.values() for item in items}
    for target in record["targets"]:
        fields(target, "kind variable", "an algorithm at a sample")
        declared = discrete.evaluation.model.declared[target["variable"]]
        if target["kind"] not in ("discrete_real", "discrete_value") or declared.name not in known:
            raise fail(f"the algorithm that assigns '{declared.name}' is not supported", declared.where)


def _enter(discrete: Discrete, item: Item) -> None:
    if item.trigger is None and not discrete.evaluation.model.is_discrete(item.value):
        raise fail(
            f"'{item.target}', a discrete variable whose value changes without an event, is not supported",
            item.where,
            "let a comparison, integer() or a when-clause make the event",
        )
    discrete.items.setdefault(item.target, []).append(item)


def _inside(discrete: Discrete, asserts: Sequence[Check], trigger: int | None, guard: Expression) -> None:
    """What functions called in a discrete equation assert."""
    number = None if trigger is None else discrete.conditions.trigger(trigger)
    for item in asserts:
        discrete.checks.append(replace(item, condition=implies(guard, item.condition), trigger=number))


def _action(discrete: Discrete, record: Record) -> None:
    evaluation, conditions = discrete.evaluation, discrete.conditions
    document, graph = evaluation.document, evaluation.graph
    where = document.where(record.get("provenance"))
    fields(record, "trigger guard kind", "an action at an event", where)
    trigger = None if conditions.is_always(record["trigger"]) else record["trigger"]
    guard = conditions.guard(record["guard"], trigger)
    kind, data = single(record["kind"], "an action at an event", where)
    frame = Frame(makes_events=False)
    if kind == "reinitialize":
        fields(data, "state value", "a reinit", where)
        if trigger is None:
            raise fail("a reinit outside a when-clause is not supported", where)
        declared = evaluation.model.declared[data["state"]]
        misfit = f"a reinit of '{declared.name}' with another size"
        for name, element in evaluation.scalars(declared, data["value"], frame, misfit, where):
            item = Item(name, declared.name, element, trigger, guard, where)
            discrete.reinitialized.setdefault(name, []).append(item)
        _inside(discrete, frame.asserts, trigger, guard)
        return
    condition = graph.make("not", guard)
    if kind == "warning":
        fields(data, "message condition", "an assert", where)
        condition = implies(guard, evaluation.expression(data["condition"], frame))
    elif kind in ("assert", "terminate"):
        fields(data, "message", f"a {kind}", where)
    else:
        raise fail(f"the action '{kind}' at an event is not supported", where)
    message = evaluation.value(data["message"], frame)
    if not isinstance(message, Text):
        raise fail("a message that is not text is not supported", where)
    if frame.asserts:
        raise fail("a function with an assert inside an assert is not supported", where)
    number = None if trigger is None else conditions.trigger(trigger)
    if trigger is not None:
        _check_first(discrete, trigger, kind, where)
    if not condition.is_number(1):
        check = Check(condition, message.text, kind == "warning", number, kind == "terminate", where)
        discrete.checks.append(check)


def _check_first(discrete: Discrete, trigger: int, kind: str, where: Location | None) -> None:
    """An assert or terminate may stand in a when-clause's first branch only: see `chains`."""
    chains, place = discrete.chains, _span(discrete, trigger)
    discrete.checking.append(trigger)
    found = chains.find(place, frozenset())
    if chains.may_follow(place) and (found is None or found.branch > 0):
        raise fail(f"a {kind} in an elsewhen is not supported", where, "write a when-clause of its own")


def _initial_values(discrete: Discrete, record: Record) -> dict[Symbol, tuple[Expression, Location | None]]:
    """Values of a discrete variable before the first event, from an initial equation, by element."""
    evaluation = discrete.evaluation
    where = evaluation.document.where(record.get("provenance"))
    fields(record, "target value", "an initial value", where)
    declared = evaluation.model.declared[record["target"]]
    frame, refusal = Frame(makes_events=False), f"this initial value of '{declared.name}' is not supported"
    values = list(evaluation.scalars(declared, record["value"], frame, refusal, where))
    if frame.asserts:
        raise fail(refusal, where)
    return {Symbol(name): (element, where) for name, element in values}


def _enter_initial_values(evaluation: Evaluation, values: Mapping[Symbol, tuple[Expression, Location | None]]) -> None:
    """Initial *values* become fixed starts. They may depend on each other, on parameters and on the time."""
    variables = evaluation.model.variables
    pending, known = dict(values), dict[Symbol, Expression]()
    while pending:
        ready = {
            symbol: element
            for symbol, (element, _) in pending.items()
            if not any(replace(other, referent=Referent.VARIABLE) in pending for other in symbols(element))
        }
        if not ready:
            symbol, (_, where) = next(iter(pending.items()))
            raise fail(f"an initial value of '{symbol}' that depends on itself is not supported", where)
        for symbol, element in ready.items():
            start = replaced((element,), lambda node: known.get(now) if (now := _now(node)) else None)[0]
            if not evaluation.model.is_known_at_start(start):
                what = f"an initial value of '{symbol}' that depends on more than parameters and time is not supported"
                raise fail(what, pending[symbol][1])
            known[symbol] = start
            variables[symbol.name] = replace(variables[symbol.name], start=start, is_fixed=True)
            del pending[symbol]
    hidden = [symbol for symbol, start in known.items() if _is_hidden_state(start)]
    if len(hidden) > 1:
        what = "impureRandom in several blocks, whose order is not defined, is not supported"
        raise fail(what, values[hidden[1]][1], "draw from a generator of Random.Generators, with a state of its own")


def _is_hidden_state(start: Expression) -> bool:
    """Whether *start* is the first number of the state of a block that draws from the impure generator."""
    return (
        start.name == "random_start"
        and start.operands[0].is_number(1)
        and (start.operands[1].operands[0].is_number(IMPURE_SEED))
    )


def _now(node: Expression) -> Symbol | None:
    """The variable that *node* is, or is the value before of."""
    symbol = node.symbol
    is_value = symbol is not None and symbol.referent in (Referent.VARIABLE, Referent.PRE)
    return replace(symbol, referent=Referent.VARIABLE) if symbol is not None and is_value else None


def _finish(discrete: Discrete) -> None:
    """Put everything in order and into the model."""
    evaluation, conditions = discrete.evaluation, discrete.conditions
    graph, model = evaluation.graph, evaluation.model
    clauses = _clauses(discrete)
    for name, items in discrete.items.items():
        for step in clauses.ordered(graph, items, graph.symbol(Symbol(name, referent=Referent.PRE))):
            number = None if step.trigger is None else conditions.trigger(step.trigger)
            model.assignments.append(replace(step, trigger=number))
    for name, items in discrete.reinitialized.items():
        for step in clauses.ordered(graph, items, graph.variable(name)):
            number = conditions.trigger(cast("int", step.trigger))
            discrete.reinitializations.append(Reinitialization(name, step.value, number, step.where))


def _clauses(discrete: Discrete) -> Clauses:
    """The when-clauses, and which trigger belongs to which of their branches."""
    every = [item for items in (*discrete.items.values(), *discrete.reinitialized.values()) for item in items]
    owners = [(item.trigger, frozenset({item.owner})) for item in every if item.trigger is not None]
    owners += [(trigger, frozenset[str]()) for trigger in discrete.checking]
    triggers = {}
    for trigger, targets in owners:
        place = discrete.chains.find(_span(discrete, trigger), targets)
        if place is not None:
            triggers[place] = trigger
    return Clauses(discrete.chains, {trigger: _span(discrete, trigger) for trigger, _ in owners}, triggers)


def _span(discrete: Discrete, trigger: int) -> Span | None:
    return span(discrete.evaluation.document.lists["conditions"][trigger].get("provenance"))
