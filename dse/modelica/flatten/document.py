"""The front-end's JSON as a table of checked nodes: every kind and every key is known here, or the model is refused."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from dse.errors import DseError, Location, fail
from dse.modelica.frontend.result import FrontEndResult

Record = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Subscript:
    """One subscript: ``index`` or ``slice`` with the node that gives it, or ``whole``."""

    kind: str
    node: int = -1


@dataclass(frozen=True, slots=True)
class Node:
    """One expression node: its *kind*, own *data*, the numbers of its operands, its subscripts."""

    kind: str
    data: Any
    operands: tuple[int, ...]
    subscripts: tuple[Subscript, ...]
    place: int
    """Position in the file; differs from the node's number behind a quotient."""


# fmt: off
_NODE_KEYS: Mapping[str, frozenset[str]] = {kind: frozenset(keys.split()) for kind, keys in {
    "unary": "operator operand", "binary": "operator lhs rhs", "conditional": "operand_count",
    "builtin": "builtin operand_count", "array": "operand_count value_type", "record": "operand_count value_type",
    "field": "base field", "range": "start_expression explicit_step_expression stop_expression",
    "comprehension": "domain body", "index": "base subscript_count", "array_update": "base value subscript_count",
    "call": "owner function output operand_count derivative", "function_value": "function value definition_ordinal",
    "runtime_quotient_owner": "kind builtin lhs rhs",
    "string_conversion": "declaration value minimum_length left_justified significant_digits format",
}.items()}
_FREE = frozenset({"literal", "coordinate", "function_fold_parameter", "function_fold_output"})
_EMPTY = {
    "previous_values": "previous() of a clocked partition", "delays": "delay()", "terminals": "terminal()",
}
_LISTS = frozenset({
    "value_types", "variables", "functions", "domains", "continuous_equation_operations", "conditions", "relations",
    "initialization_equation_operations", "initial_discrete_values", "initial_parameter_values", "event_actions",
    "discrete_real_equations", "discrete_value_owners", "clocks", "model_event_transactions",
})
_IGNORED = frozenset({
    "predefined_string_declaration", "flat_type_ids", "value_type_provenance", "roots", "structured_roots",
    "time_events", "clock_ownerships", "expressions",
})
# fmt: on
_PLACES = {"provenance", "declaration"}
_QUOTIENT_NUMBERS = 7
"""A quotient of the model takes this many numbers (itself and what it is made of); only its own is referred to."""


@dataclass(frozen=True, slots=True)
class Document:
    """The checked tables. *nodes* by number; everything else by position, still in the front-end's words."""

    result: FrontEndResult
    nodes: Mapping[int, Node]
    provenance: Sequence[Record]
    lists: Mapping[str, Sequence[Record]]
    flat: Record

    def where(self, provenance: Record | None) -> Location | None:
        """The place *provenance* names, if it names one."""
        span = (provenance or {}).get("span")
        return self.result.location(span["source"], span["start"]) if span else None

    def at(self, node: int) -> Location | None:
        """Where expression number *node* stands."""
        found = self.nodes.get(node)
        return self.where(self.provenance[found.place]) if found else None

    def value_type(self, record: Record) -> Record:
        """The type of the variable in *record*."""
        return self.lists["value_types"][record["value_type"]]

    def refused(self, what: str, node: int, hint: str = "") -> DseError:
        """*what* is not supported, at *node*."""
        return fail(f"{what} is not supported", self.at(node), hint)


def read(result: FrontEndResult) -> Document:
    """*result* as checked tables. Raises DseError for unknown constructs and counts that do not fit."""
    storage = result.dae["storage"]
    unknown = sorted(set(storage) - _LISTS - _IGNORED - set(_EMPTY))
    if unknown:
        raise fail(f"the front-end's system has an unknown part '{unknown[0]}'")
    lists = {name: storage.get(name) or [] for name in sorted(_LISTS)}
    expressions = storage["expressions"]
    nodes = _numbered(expressions)
    document = Document(result, nodes, expressions["provenance"], lists, result.flat)
    for name, what in _EMPTY.items():
        if storage.get(name):
            first = storage[name][0] if isinstance(storage[name][0], dict) else {}
            delayed = first.get("source", -1) if name == "delays" else -1
            raise fail(f"{what} is not supported", document.where(first.get("provenance")) or document.at(delayed))
    _check_references(document)
    return document


def fields(record: Any, keys: str, what: str, where: Location | None = None) -> None:
    """Raise DseError unless *record* has exactly the *keys* (and possibly says where it stands)."""
    expected = set(keys.split())
    found = set(record) - (_PLACES - expected) if isinstance(record, dict) else {str(record)}
    if found != expected:
        odd = ", ".join(sorted(found ^ expected))
        raise fail(f"{what} in an unknown form is not supported (front-end: {odd})", where)


def single(record: Any, what: str, where: Location | None = None) -> tuple[str, Any]:
    """Kind and data of *record*, which is a word or a mapping of one key (besides provenance)."""
    if isinstance(record, str):
        return record, None
    kinds = [key for key in record if key != "provenance"]
    if len(kinds) != 1:
        raise fail(f"{what} in an unknown form is not supported", where)
    return kinds[0], record[kinds[0]]


def _numbered(expressions: Record) -> Mapping[int, Node]:
    operands, subscripts = expressions["operands"], expressions["subscripts"]
    nodes: dict[int, Node] = {}
    number = operand = subscript = 0
    for place, raw in enumerate(expressions["nodes"]):
        kind, data = single(raw, "an expression")
        if kind in _NODE_KEYS:
            fields(data, " ".join(_NODE_KEYS[kind]), f"an expression of kind '{kind}'")
        elif kind not in _FREE:
            raise fail(f"an expression of kind '{kind}' is not supported")
        counts = data if kind in _NODE_KEYS else {}
        last_operand = operand + counts.get("operand_count", 0)
        last_subscript = subscript + counts.get("subscript_count", 0)
        own = tuple(_subscript(record) for record in subscripts[subscript:last_subscript])
        nodes[number] = Node(kind, data, tuple(operands[operand:last_operand]), own, place)
        operand, subscript = last_operand, last_subscript
        number += _QUOTIENT_NUMBERS if kind == "runtime_quotient_owner" and "model" in data["kind"] else 1
    if operand != len(operands) or subscript != len(subscripts) or len(nodes) != len(expressions["provenance"]):
        raise fail("the front-end's expression table does not fit together (operand, subscript or provenance counts)")
    return nodes


def _subscript(record: Record) -> Subscript:
    kind, node = single(record["kind"], "a subscript")
    if kind not in ("index", "slice", "whole"):
        raise fail(f"a subscript of kind '{kind}' is not supported")
    return Subscript(kind, -1 if node is None else node)


def _check_references(document: Document) -> None:
    """Every expression refers to earlier ones that exist; with a wrong numbering this could not hold."""
    for number, node in document.nodes.items():
        refers = [*node.operands, *(item.node for item in node.subscripts if item.kind != "whole")]
        if isinstance(node.data, dict):
            names = ("lhs", "rhs", "operand", "base", "body", "start_expression", "stop_expression")
            refers += [node.data[name] for name in names if isinstance(node.data.get(name), int)]
        for other in refers:
            if other not in document.nodes or other >= number:
                raise document.refused(f"the front-end's numbering of expressions ({number} refers to {other})", number)


def check_calls(document: Document) -> None:
    """Raise DseError if a call means another function than the one that was kept under its name."""
    for record in records(document.flat):
        call = record.get("FunctionCall")
        if isinstance(call, dict):
            called = call.get("name") or call["comp"]
            name, parts = called["name"], called["component_ref"]["parts"]
            kept = document.flat["functions"].get(name)
            if kept is not None and kept["def_id"] != parts[-1]["def_id"]:
                what = f"'{name}', a function with the name of another one used in this model, is not supported"
                raise fail(what, document.where(call), "give the functions different names")


def records(tree: Any) -> Iterator[Record]:
    """Every record in *tree* of the front-end's, each before those in it."""
    stack = [tree]
    while stack:
        item = stack.pop()
        if isinstance(item, dict):
            yield item
            item = list(item.values())
        if isinstance(item, list):
            stack += reversed(item)


_MOST_POINTS = 1_000_000


def points(document: Document, domain: int) -> Iterator[tuple[int, ...]]:
    """Values of the counters of *domain*, the last one fastest."""
    return itertools.product(*ranges(document, domain))


def shape(document: Document, domain: int) -> tuple[int, ...]:
    """How many values each counter of *domain* takes."""
    return tuple(len(counter) for counter in ranges(document, domain))


def ranges(document: Document, domain: int) -> Sequence[range]:
    """The values of each counter of *domain*. Raises DseError for bounds that are no numbers."""
    record = document.lists["domains"][domain]
    where = document.where(record.get("provenance"))
    fields(record, "parent domain", "a loop's domain", where)
    fields(record["domain"], "binders", "a loop's domain", where)
    found = []
    total = 1
    for place, binder in enumerate(record["domain"]["binders"]):
        fields(binder, "id display_name lower upper step", "a loop's counter", where)
        first, last, step = binder["lower"], binder["upper"], binder["step"]
        if not all(isinstance(item, int) for item in (first, last, step)) or step == 0 or binder["id"] != place:
            raise fail(f"a loop over '{binder['display_name']}' without fixed whole bounds is not supported", where)
        found.append(range(first, last + (1 if step > 0 else -1), step))
        total *= len(found[-1])
    if total > _MOST_POINTS:
        raise fail(f"a loop of {total} turns is not supported (at most {_MOST_POINTS})", where)
    return found


def check_counters(document: Document, domain: int, function: int) -> None:
    """Raise DseError if a counter of *domain* has the name of a variable of function number *function*.

    The front-end takes the variable for the counter then. Negative: there is no function.
    """
    if function < 0:
        return
    record, called = document.lists["domains"][domain], document.lists["functions"][function]
    taken = {variable["name"] for variable in (*called["outputs"], *called["locals"])}
    for binder in record["domain"]["binders"]:
        if binder["display_name"] in taken:
            what = f"the loop counter '{binder['display_name']}' with the name of a variable of '{called['name']}'"
            where = document.where(record.get("provenance")) or document.where(called.get("declaration"))
            raise fail(f"{what} is not supported", where, "give it another name")
