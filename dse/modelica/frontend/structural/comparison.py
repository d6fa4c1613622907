"""Whether two flat systems differ in nothing but the values of some parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

# Where something stands, and what is derived from the rest with the parameters' present values.
_IGNORED = frozenset({"provenance", "span", "declaration", "component_ref", "value_type_provenance"})
_DERIVED = frozenset({"roots", "structured_roots", "time_events"})
_QUOTIENT_OPERANDS = 7


def changed_parameters(one: Mapping[str, Any], other: Mapping[str, Any], names: Iterable[str]) -> frozenset[str] | None:
    """Those of the parameters *names* whose own values differ; None if anything else differs.

    *one* and *other* are flat systems as the front-end writes them.
    """
    first, second = one["storage"], other["storage"]
    for key in first.keys() | second.keys():
        if key in _DERIVED or key in _IGNORED or key == "expressions":
            continue
        if _bare(first.get(key)) != _bare(second.get(key)):
            return None
    for key in ("operands", "subscripts"):
        if _bare(first["expressions"][key]) != _bare(second["expressions"][key]):
            return None
    nodes, others = first["expressions"]["nodes"], second["expressions"]["nodes"]
    if len(nodes) != len(others):
        return None
    differing = {
        number for number, (a, b) in enumerate(zip(nodes, others, strict=True)) if a != b and _bare(a) != _bare(b)
    }
    return (
        _owners(first, differing, frozenset(names)) if all(map(_is_literal, (others[n] for n in differing))) else None
    )


def _owners(storage: Mapping[str, Any], differing: set[int], names: frozenset[str]) -> frozenset[str] | None:
    """The parameters to whose values the nodes *differing* belong; None if one is something else's, too."""
    below = _operands(storage["expressions"])
    if below is None:
        return None
    owner: dict[int, str] = {}
    for variable in storage["variables"]:
        if variable["role"] not in ("parameter", "constant"):
            continue
        attributes = variable["attributes"]
        for key in ("binding", "start"):
            if attributes[key] is None:
                continue
            # A start that stands beside a binding is derived from it; whose it is does not matter.
            is_derived = key == "start" and attributes["binding"] is not None
            if variable["name"] in names or is_derived:
                stack = [attributes[key]]
                while stack:
                    number = stack.pop()
                    owner[number] = "" if is_derived else variable["name"]
                    stack.extend(below[number])
    if any(number not in owner or not _is_literal(storage["expressions"]["nodes"][number]) for number in differing):
        return None
    for number, operands in enumerate(below):
        if number not in owner and any(operand in differing for operand in operands):
            return None
    return frozenset(owner[number] for number in differing) - {""}


def _operands(expressions: Mapping[str, Any]) -> list[list[int]] | None:
    """The operands of every node; None if they do not add up."""
    operands = expressions["operands"]
    found: list[list[int]] = []
    taken = 0
    for node in expressions["nodes"]:
        (kind, inside), *_ = node.items() if isinstance(node, dict) else ((node, None),)
        count = 0
        below: list[int] = []
        if isinstance(inside, dict):
            count = _QUOTIENT_OPERANDS if kind == "runtime_quotient_owner" else int(inside.get("operand_count") or 0)
            below = [inside[key] for key in ("operand", "lhs", "rhs", "base") if isinstance(inside.get(key), int)]
        found.append([*below, *operands[taken : taken + count]])
        taken += count
    return found if taken == len(operands) else None


def _is_literal(node: Any) -> bool:
    return isinstance(node, dict) and "literal" in node


def _bare(tree: Any) -> Any:
    """*tree* without what says where it stands. As deep as the front-end nests, which JSON could be read to."""
    if isinstance(tree, dict):
        return {key: _bare(inside) for key, inside in tree.items() if key not in _IGNORED}
    if isinstance(tree, list):
        return [_bare(inside) for inside in tree]
    return tree
