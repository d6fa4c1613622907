"""Function calls: arguments in, statements carried out while the model is built, values out."""

from __future__ import annotations

import math
import zlib
from collections.abc import Generator, Mapping, Sequence
from typing import Any

from dse.errors import DseError, Location, fail
from dse.modelica.algebra.derivative import NO_RATE, derived
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flatten.document import Document, Record, check_counters, fields, points, shape, single
from dse.modelica.flatten.evaluation import externals
from dse.modelica.flatten.evaluation.context import Frame, Request, Visit, requested
from dse.modelica.flatten.values import Array, MismatchError, Structure, Text, Value, array, mapped, only

_DEEPEST = 200
"""Calls inside one another."""
_MOST_NODES = 50_000
"""Graph nodes one outermost call may add."""

_TRIALS = 5
_ROUNDING = 1e-6
"""Relative, and absolute below 1: far above the rounding of an algorithm, far below another formula's difference."""

Outputs = Generator[Request, Value, tuple[Value, ...]]
Steps = Generator[Request, Value, None]
_FUNCTION = "name parameters outputs locals statements external derivatives inline"


def call(visit: Visit) -> Outputs:
    """All outputs of the call that the visited node belongs to; carried out once a frame for all of them."""
    document, frame, number, node = visit.document, visit.frame, visit.number, visit.node
    owner = node.data["owner"]
    first = document.nodes.get(owner)
    if first is None or first.kind != "call" or first.data["function"] != node.data["function"]:
        raise document.refused("the front-end's numbering of calls", number)
    if node.data["derivative"] is not None or first.data["derivative"] is not None:
        raise document.refused("the derivative of a function by its annotation", number)
    found = frame.calls.get(owner)
    if found is not None:
        return found
    function = document.lists["functions"][node.data["function"]]
    name = function["name"]
    fields(function, _FUNCTION, f"the function '{name}'", document.at(number))
    arguments = yield from requested(frame, first.operands)
    if len(arguments) != len(function["parameters"]):
        raise document.refused(f"a call of '{name}' with {len(arguments)} arguments", number)
    for parameter, argument in zip(function["parameters"], arguments, strict=True):
        _check_type(document, parameter, argument, f"argument '{parameter['name']}' of '{name}'")
    if frame.depth >= _DEEPEST:
        what = f"a call of '{name}' nested more than {_DEEPEST} times"
        raise document.refused(what, number, "does the recursion end?")
    if node.data["function"] not in visit.model.compared:
        for stated in function["derivatives"]:
            yield from _refuse_contradiction(visit, node.data["function"], stated, arguments)
    inside = frame.call(node.data["function"], tuple(arguments))
    before = len(visit.graph)
    if _assignments(document, function["statements"]) > _MOST_NODES:
        what = f"the call of '{name}', whose loops unroll to more than {_MOST_NODES} assignments,"
        raise document.refused(what, number, "fewer turns, or an equation in place of the loop")
    if function["external"] is not None:
        outputs = yield from externals.called(document, visit.model, inside, function, number)
    else:
        outputs = yield from _carried_out(document, inside, function)
    if node.data["function"] in visit.model.prescribed:
        outputs = yield from _prescribed(visit, node.data["function"], inside.arguments, outputs)
    if len(visit.graph) - before > _MOST_NODES:
        what = f"the call of '{name}', which unrolls to more than {_MOST_NODES} operations,"
        raise document.refused(what, number)
    frame.calls[owner] = outputs
    return outputs


def definition(visit: Visit) -> Value:
    """What the assignment that the visited node names gave to its variable; it must be the last one up to here."""
    frame, data = visit.frame, visit.node.data
    count = data["definition_ordinal"]
    value = frame.definitions.get(count)
    if data["function"] != frame.function or value is None or frame.latest.get(data["value"]) != count:
        raise visit.document.refused("a value that no statement before has given", visit.number)
    return value


def _refuse_contradiction(
    visit: Visit, number: int, stated: Record, arguments: Sequence[Value]
) -> Generator[Request, Value, None]:
    """Refuse a derivative annotation that is not the derivative of the function's own algorithm, which is used.

    With `noDerivative`, another derivative is what the annotation is for: it is noted and used. Both are compared at a
    few points. What is external or has records, and second derivatives, are not compared.
    """
    document, graph = visit.document, visit.graph
    where = document.where(stated.get("provenance"))
    fields(stated, "target inputs previous priority", "a derivative annotation", where)
    function, other = (document.lists["functions"][one] for one in (number, stated["target"]))
    arrays = [argument for argument in arguments if isinstance(argument, Array)]
    if stated["previous"] is not None or function["external"] or other["external"] or len(arrays) < len(arguments):
        return
    has_rate = [
        how == "Differentiate" and document.value_type(parameter)["scalar"] == "real"
        for how, parameter in zip(stated["inputs"], function["parameters"], strict=True)
    ]
    is_moving = [
        has and not all(item.is_constant for item in argument.elements)
        for has, argument in zip(has_rate, arrays, strict=True)
    ]
    if not any(is_moving):
        return
    visit.model.compared.add(number)

    def fresh(word: str, place: int) -> Array:
        symbols = (Symbol(f"{word}{place}.{k}", referent=Referent.PRE) for k in range(len(arrays[place].elements)))
        return Array(tuple(map(graph.symbol, symbols)), arrays[place].shape)

    inputs = [fresh("%", place) if moves else arrays[place] for place, moves in enumerate(is_moving)]
    zero = graph.constant(0.0)
    rates = {
        place: fresh("%der", place) if is_moving[place] else mapped(arrays[place], lambda _: zero)
        for place, has in enumerate(has_rate)
        if has
    }
    rate_of = {
        item.symbol: rate
        for place, moving in rates.items()
        if is_moving[place]
        for item, rate in zip(inputs[place].elements, moving.elements, strict=True)
    }
    depth = visit.frame.depth + 1
    own = yield from _carried_out(document, Frame(False, [], number, depth, tuple(inputs)), function)
    given = (*inputs, *rates.values())
    other_own = yield from _carried_out(document, Frame(False, [], stated["target"], depth, given), other)
    reals = [document.value_type(output)["scalar"] == "real" for output in function["outputs"]]
    roots = [item for value, real in zip(own, reals, strict=True) if real for item in array(value).elements]
    wanted = derived(roots, lambda leaf: rate_of.get(leaf, zero))
    found = [item for value in other_own for item in array(value).elements]
    if len(found) != len(wanted) or not all(_agree(wanted, found, trial) for trial in range(_TRIALS)):
        if "NoDerivative" not in stated["inputs"] or len(function["derivatives"]) > 1:
            raise _contradiction(document, number, stated)
        visit.model.prescribed.add(number)


def _contradiction(document: Document, number: int, stated: Record) -> DseError:
    own, other = (document.lists["functions"][one]["name"] for one in (number, stated["target"]))
    what = f"the annotation derivative of '{own}': '{other}' is not its derivative"
    hint = "the derivative of the algorithm is used: correct the annotation or leave it out"
    return fail(what, document.where(stated.get("provenance")), hint)


def _prescribed(
    visit: Visit, number: int, arguments: tuple[Value, ...], outputs: tuple[Value, ...]
) -> Generator[Request, Value, tuple[Value, ...]]:
    """*outputs* of function *number* with the time derivatives that its annotation states.

    They have none where an input to differentiate is neither the time nor constant, whose rates are known here.
    """
    document, graph = visit.document, visit.graph
    functions, time = document.lists["functions"], graph.symbol(Symbol(referent=Referent.TIME))
    if not functions[number]["derivatives"]:
        return outputs
    (stated,) = functions[number]["derivatives"]
    done = len(functions[stated["previous"][0]]["parameters"]) if stated["previous"] else 0
    rates = []
    for how, argument in list(zip(stated["inputs"], arguments, strict=True))[done:]:
        if how == "Differentiate" and isinstance(argument, Array):
            if not all(item is time or item.is_constant for item in argument.elements):
                none = Array((graph.call(NO_RATE, ()),))
                return tuple(_with_rate(graph, array(value), none) for value in outputs)
            rates.append(Array(tuple(graph.of(float(item is time)) for item in argument.elements), argument.shape))
    target, given = stated["target"], (*arguments, *rates)
    inside = visit.frame.call(target, given)
    found = yield from _carried_out(document, inside, functions[target])
    if [array(value).shape for value in found] != [array(value).shape for value in outputs]:
        raise _contradiction(document, number, stated)
    if rates:
        found = yield from _prescribed(visit, target, given, found)
    return tuple(_with_rate(graph, array(value), array(rate)) for value, rate in zip(outputs, found, strict=True))


def _with_rate(graph: Graph, value: Array, rate: Array) -> Array:
    pairs = zip(value.elements, rate.elements * (len(value.elements) // len(rate.elements)), strict=True)
    return Array(tuple(graph.make("prescribed", one, other) for one, other in pairs), value.shape)


def _agree(wanted: Sequence[Expression], found: Sequence[Expression], trial: int) -> bool:
    """Whether both have the same values where they have any, as far as rounding lets them."""

    def of(symbol: Symbol) -> float:
        return 0.1 + ((zlib.crc32(str(symbol).encode()) + 0.618 * trial * 2**32) / 2**31) % 2.0

    try:
        values = evaluate([*wanted, *found], of)
    except DseError:
        return True
    pairs = zip(values[: len(wanted)], values[len(wanted) :], strict=True)
    return all(math.isclose(a, b, rel_tol=_ROUNDING, abs_tol=_ROUNDING) for a, b in pairs if math.isfinite(a + b))


def _carried_out(document: Document, frame: Frame, function: Record) -> Outputs:
    run = _Run(document, frame, function)
    yield from run.statements(function["statements"], frame, 0)
    outputs = []
    for place, output in enumerate(function["outputs"]):
        value = run.current(place)
        if value is None:
            raise fail(f"output '{output['name']}' of function '{function['name']}' is never assigned", run.where)
        outputs.append(value)
    return tuple(outputs)


class _Run:
    """One call while its statements are carried out; variables count outputs first, then locals.

    Assignments count through the whole function: one for each, in a group one for each target, and for a loop one for
    each of its targets at its beginning (the value a turn starts with) and one at its end.
    """

    def __init__(self, document: Document, frame: Frame, function: Record) -> None:
        self.document, self.function = document, function
        self.variables = [*function["outputs"], *function["locals"]]
        self.definitions, self.latest = frame.definitions, frame.latest
        self.where = document.where(function.get("declaration"))

    def current(self, variable: int) -> Value | None:
        """The value *variable* has now, if it has one."""
        return self.definitions.get(self.latest.get(variable, -1))

    def statements(self, statements: Sequence[Record], frame: Frame, count: int) -> Generator[Request, Value, int]:
        """Carry out *statements*; *count* assignments stand before them, the returned number at their end."""
        for statement in statements:
            kind, data = single(statement, f"a statement of function '{self.function['name']}'", self.where)
            where = self.document.where(data.get("provenance")) or self.where
            if kind == "assignment":
                fields(data, "target rhs", "an assignment", where)
                value = yield Request(frame, data["rhs"])
                count = self._define(data["target"], value, count)
            elif kind == "assignment_group":
                count = yield from self._group(data, frame, count, where)
            elif kind == "for":
                count = yield from self._loop(data, frame, count)
            elif kind == "assertion":
                yield from self._assert(data, frame, where)
            else:
                raise fail(f"a statement of kind '{kind}' in '{self.function['name']}' is not supported", where)
        return count

    def _group(self, data: Record, frame: Frame, count: int, where: Location | None) -> Generator[Request, Value, int]:
        fields(data, "assignments conditional", "a group of assignments", self.where)
        self._check_conditional(data)
        for assignment in data["assignments"]:
            fields(assignment, "target rhs", "an assignment", self.where)
        targets = [assignment["target"] for assignment in data["assignments"]]
        twice = next((target for target in targets if targets.count(target) > 1), None)
        if twice is not None:
            what = f"several results of a function in elements of one array, '{self.variables[twice]['name']}',"
            raise fail(f"{what} are not supported", where, "give them to variables first")
        values = yield from requested(frame, [assignment["rhs"] for assignment in data["assignments"]])
        for assignment, value in zip(data["assignments"], values, strict=True):
            count = self._define(assignment["target"], value, count)
        return count

    def _check_conditional(self, data: Record) -> None:
        """The group's if-statement says again what its right sides say; believe neither if they differ."""
        conditional = data["conditional"]
        if conditional is None:
            return
        fields(conditional, "conditions branches fallback", "an if-statement", self.where)
        for place, assignment in enumerate(data["assignments"]):
            node = self.document.nodes[assignment["rhs"]]
            said = [
                item
                for condition, branch in zip(conditional["conditions"], conditional["branches"], strict=True)
                for item in (condition, branch[place])
            ]
            if node.kind != "conditional" or list(node.operands) != [*said, conditional["fallback"][place]]:
                raise self.document.refused("an if-statement in an unknown form", assignment["rhs"])

    def _loop(self, data: Record, frame: Frame, count: int) -> Generator[Request, Value, int]:
        keys = "domain targets iteration_locals statements begin_provenance finish_provenance"
        fields(data, keys, "a for-loop", self.where)
        check_counters(self.document, data["domain"], frame.function)
        targets = data["targets"]
        end = count + len(targets) + _count(data["statements"])
        for point in points(self.document, data["domain"]):
            for place, target in enumerate(targets):
                self._start(target, count + place)
            turn = frame.turn(data["domain"], point)
            yield from self.statements(data["statements"], turn, count + len(targets))
        for place, target in enumerate(targets):
            self._start(target, end + place)
        return end + len(targets)

    def _start(self, target: int, count: int) -> None:
        value = self.current(target)
        if value is not None:
            self.definitions[count] = value
            self.latest[target] = count

    def _assert(self, data: Record, frame: Frame, where: Location | None) -> Steps:
        fields(data, "condition message level", "an assert", where)
        if data["level"] not in ("error", "warning"):
            raise fail(f"an assert of level '{data['level']}' is not supported", where)
        condition = only((yield Request(frame, data["condition"])))
        message: Any = data["message"]
        if isinstance(message, int):
            text = yield Request(frame, message)
            message = text.text if isinstance(text, Text) else f"assert in function '{self.function['name']}'"
        is_own = (data.get("provenance") or {}).get("origin") == "source"
        if not is_own and not condition.is_number(1):
            # The front-end's own: a path on which a variable is read that nothing has assigned.
            raise fail(f"function '{self.function['name']}': {message}", where, "give it a value on every path")
        frame.demand(condition, str(message), where, data["level"] == "warning")

    def _define(self, target: int, value: Value, count: int) -> int:
        _check_type(self.document, self.variables[target], value, f"'{self.variables[target]['name']}'")
        self.definitions[count] = value
        self.latest[target] = count
        return count + 1


def _count(statements: Sequence[Mapping[str, Any]]) -> int:
    """How many assignments *statements* count for."""
    total = 0
    for statement in statements:
        kind, data = single(statement, "a statement")
        if kind == "assignment":
            total += 1
        elif kind == "assignment_group":
            total += len(data["assignments"])
        elif kind == "for":
            total += 2 * len(data["targets"]) + _count(data["statements"])
    return total


def _assignments(document: Document, statements: Sequence[Record]) -> int:
    """How many assignments and asserts are carried out, loops within loops counted turn by turn."""
    total = 0
    for statement in statements:
        kind, data = single(statement, "a statement")
        if kind == "for":
            total += math.prod(shape(document, data["domain"])) * _assignments(document, data["statements"])
        else:
            total += len(data["assignments"]) if kind == "assignment_group" else 1
    return total


def _check_type(document: Document, declared: Record, value: Value, what: str) -> None:
    """Raise MismatchError unless *value* has the size that *declared* asks for."""
    fields(declared, "name value_type", what)
    kind = document.value_type(declared)
    if isinstance(value, Structure):
        fits = kind["scalar"] == "record" or bool(kind["record_fields"])
    elif isinstance(value, Array):
        fits = tuple(kind["dimensions"]) == value.shape and not kind["record_fields"]
    else:
        fits = kind["scalar"] == "string"
    if not fits:
        raise MismatchError(f"{what} of another size or type")
