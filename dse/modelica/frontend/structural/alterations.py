"""Which texts in the sources give a parameter its value, and texts that would give it another."""

from __future__ import annotations

import math
import operator
import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from dse.graphs import joined
from dse.modelica.frontend.literal import literal
from dse.modelica.frontend.result import FrontEndResult


@dataclass(frozen=True, slots=True)
class Patch:
    """Bytes *start* … *end* of source number *source*, and the text that stands there with another value."""

    source: int
    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True)
class Alteration:
    """Parameters that get another value together, because they share a text: by *patches* of the sources.

    Without patches, *texts* are two values for the one parameter there is, as a modification of the model.
    """

    names: frozenset[str]
    patches: frozenset[Patch]
    texts: tuple[str, str] = ("", "")

    def gives(self, value: float) -> bool:
        """Whether its other values include the size of *value*."""
        given = [patch.text for patch in self.patches] or [self.texts[1]]
        return any(_NUMBER.fullmatch(text.strip(" -()")) and float(text.strip(" -()")) == abs(value) for text in given)


def alterations(result: FrontEndResult, own: frozenset[int]) -> tuple[list[Alteration], frozenset[str]]:
    """The alterations of all parameters that have a value of their own; and the names of those that have no alteration.

    A parameter whose value depends on others, is final or is solved for has no value of its own. Only the sources
    numbered *own* can be patched. Of parameters that got one value it cannot be told which gave it to the others, so
    they have no alteration.
    """
    patched: dict[str, frozenset[Patch]] = {}
    modified: list[Alteration] = []
    without: set[str] = set()
    for name, variable in _independent(result):
        patches = _patches(result, name, variable)
        if patches and all(patch.source in own for patch in patches):
            patched[name] = patches
        elif (patches is not None or _has_no_value(variable)) and (texts := _modification(result, name, variable)):
            modified.append(Alteration(frozenset({name}), frozenset(), texts))
        else:
            without.add(name)
    apart = [alteration for alteration in _joined(patched) if _is_own(result, alteration.names)]
    without |= patched.keys() - {name for alteration in apart for name in alteration.names}
    return [*apart, *modified], frozenset(without)


def _is_own(result: FrontEndResult, names: frozenset[str]) -> bool:
    """Whether parameters that share a text are of one declaration, each with a value of its own.

    Others may have been given the value of one of them, of which the front-end keeps the text only.
    """
    if len({re.sub(r"\[[^\]]*\]", "", name) for name in names}) == 1:
        return True
    found = [result.flat["variables"][name] for name in names]
    spans = {tuple(sorted(variable["source_span"].items())) for variable in found}
    return len(spans) == 1 and not any(variable["binding_from_modification"] for variable in found)


def _independent(result: FrontEndResult) -> Iterator[tuple[str, Mapping[str, Any]]]:
    finals = result.flat["variable_final_flags"]
    flat = result.flat["variables"]
    for variable in result.dae["storage"]["variables"]:
        name = variable["name"]
        if variable["role"] != "parameter" or finals.get(name) or name not in flat:
            continue
        fixed = variable["attributes"]["fixed"]
        if fixed and not all(fixed):
            continue
        binding = flat[name]["binding"]
        if binding is None or not any(_refers(result, node) for node in _nodes(binding)):
            yield name, flat[name]


def _nodes(tree: Any) -> Iterator[tuple[str, Any]]:
    """Every expression of the tree the front-end writes, as its kind and contents."""
    stack = [tree]
    while stack:
        node = stack.pop()
        if isinstance(node, list):
            stack.extend(reversed(node))
        elif isinstance(node, dict):
            for key, inside in node.items():
                if key[:1].isupper():
                    yield key, inside
                if key not in ("span", "component_ref", "Literal"):
                    stack.append(inside)


def refers_to(result: FrontEndResult, name: str) -> Iterator[str]:
    """The variables the value of the variable *name* is made of."""
    variable = result.flat["variables"].get(name)
    if variable is not None:
        for kind, inside in _nodes(variable["binding"]):
            if _refers(result, (kind, inside)):
                yield str(inside["name"]["name"])


def _refers(result: FrontEndResult, node: tuple[str, Any]) -> bool:
    kind, inside = node
    return kind == "VarRef" and str(inside["name"]["name"]) not in result.flat["enum_literal_ordinals"]


def _has_no_value(variable: Mapping[str, Any]) -> bool:
    """Whether the model gives no value, so that the declaration has the front-end's own 0."""
    start = variable["start"]
    literal = start.get("Literal") if isinstance(start, dict) else None
    return variable["binding"] is None and (
        start is None or bool(literal and literal["span"] == variable["source_span"])
    )


def _patches(result: FrontEndResult, name: str, variable: Mapping[str, Any]) -> frozenset[Patch] | None:
    """Other texts for the numbers the value is written with; None if it is not written where the front-end says.

    That is so when the front-end put a value in place of a name: then, unless it is the name of a constant, the value
    is another parameter's.
    """
    tree = variable["binding"] if variable["binding"] is not None else variable["start"]
    is_whole = result.flat["variable_type_names"].get(name) == "Integer"
    found = set()
    for kind, inside in _nodes(_changeable(tree)):
        if kind not in ("Literal", "VarRef"):
            continue
        span = inside["span"]
        written = _written(result, span)
        if kind == "Literal":
            new = _other_literal(inside["value"], written, str(span), is_whole)
        else:
            new = _other_item(result, str(inside["name"]["name"]), written)
        if new is None and _is_constant(result, written):
            continue
        if new is None:
            return None
        found.add(Patch(span["source"], span["start"], span["end"], new))
    return frozenset(found)


def _is_constant(result: FrontEndResult, written: str) -> bool:
    """Whether *written* is a name that no variable can have."""
    last = written.rpartition(".")[2]
    is_name = re.fullmatch(r"[A-Za-z_][\w.]*", written) is not None
    return is_name and not any(name.rpartition(".")[2].split("[")[0] == last for name in result.flat["variables"])


def _changeable(tree: Any) -> Any:
    """The tree without the arguments that say how large an array is."""
    call = tree.get("BuiltinCall") if isinstance(tree, dict) else None
    if call is None:
        return tree
    kept = {"Linspace": slice(0, 2), "Fill": slice(0, 1)}.get(str(call["function"]))
    return call["args"][kept] if kept is not None else tree


def _written(result: FrontEndResult, span: Mapping[str, int]) -> str:
    if span["source"] not in result.sources:
        return ""
    content = result.sources[span["source"]].text.encode()
    return content[span["start"] : span["end"]].decode("utf-8", "replace")


def _other_literal(value: Mapping[str, Any], written: str, whose: str, is_whole: bool) -> str | None:
    """Another literal of the same type and sign; None if the text is not that of the literal."""
    (kind, now), *_ = value.items()
    if kind == "Boolean":
        return ("false" if now else "true") if written == ("true" if now else "false") else None
    if kind not in ("Integer", "Real") or not _NUMBER.fullmatch(written) or float(written) != now:
        return None
    if kind == "Integer" and not is_whole:
        # The front-end folds whole numbers, as far as quotients are whole. Seven times as much divides as before.
        return str(int(now) * 7 or 840)
    return other_number(now, whose, is_whole=kind == "Integer")


_NUMBER = re.compile(r"\d+(\.\d*)?([eE][+-]?\d+)?")


def other_number(now: float, whose: str, *, is_whole: bool) -> str:
    """Text of a number near *now* with the same sign and type; a Real is one that tells *whose* it is."""
    if is_whole:
        return str(int(now) + (1 if now >= 0 else -1))
    factor = 1.0625 + zlib.crc32(whose.encode()) / 2.0**37  # up to 1.09375
    other = float(now) * factor or factor * 2.0**-10
    return literal(other if math.isfinite(other) else float(now) / 2)


def _other_item(result: FrontEndResult, name: str, written: str) -> str | None:
    prefix, _, item = name.rpartition(".")
    if not written.endswith(item) or not item:
        return None
    others = [
        other.rpartition(".")[2]
        for other in result.flat["enum_literal_ordinals"]
        if other.rpartition(".")[0] == prefix and "'" not in other and other != name
    ]
    return written[: -len(item)] + others[0] if others else None


def _modification(result: FrontEndResult, name: str, variable: Mapping[str, Any]) -> tuple[str, str] | None:
    if "[" in name or variable["dims"]:
        return None
    type_ = str(result.flat["variable_type_names"].get(name, ""))
    tree = variable["binding"] if variable["binding"] is not None else variable["start"]
    if type_ == "Boolean":
        return "false", "true"
    now = number(tree)
    if now is None or (type_ in ("String", "Integer") and not now.is_integer()):
        return None
    if type_ == "Integer":
        return str(int(now)), other_number(now, name, is_whole=True)
    kinds = {next(iter(inside["value"])) for kind, inside in _nodes(tree) if kind == "Literal"}
    return (repr(now), other_number(now, name, is_whole=False)) if kinds <= {"Integer", "Real"} else None


def number(tree: Any) -> float | None:
    """What a tree of literals, signs and the four operations comes to; None for any other."""
    if not isinstance(tree, dict) or len(tree) != 1:
        return None
    (kind, inside), *_ = tree.items()
    if kind == "Literal":
        value = inside["value"].get("Real", inside["value"].get("Integer"))
        return float(value) if value is not None else None
    if kind == "Unary":
        operand = number(inside["rhs"])
        return -operand if operand is not None and inside["op"] == "Minus" else None
    if kind == "Binary":
        left, right = number(inside["lhs"]), number(inside["rhs"])
        operation = _OPERATIONS.get(str(inside["op"]))
        if left is None or right is None or operation is None or (inside["op"] == "Div" and right == 0):
            return None
        return float(operation(left, right))
    return None


_OPERATIONS = {"Add": operator.add, "Sub": operator.sub, "Mul": operator.mul, "Div": operator.truediv}


def _joined(patched: Mapping[str, frozenset[Patch]]) -> Iterator[Alteration]:
    """Parameters whose patches overlap become one alteration."""
    names = list(patched)
    for group in joined(list(patched.values())):
        own = frozenset(names[number] for number in group)
        yield Alteration(own, frozenset(patch for name in own for patch in patched[name]))
