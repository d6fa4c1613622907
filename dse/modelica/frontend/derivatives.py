"""Derivatives of expressions, ``der(a - b)``, as derivatives of variables that are declared for them.

rumoca 0.10.2 refuses the first, and takes ``{der(a), der(b)}`` for ``der({a, b})``. A variable for the expression is
differentiated by index reduction, as in any model.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from dse.modelica.frontend.source_text import Change, SourceText, changed, code, edited
from dse.modelica.frontend.syntax import UNREADABLE, Element, Tree

OF_EXPRESSION = "der(...) must have exactly one resolved variable-reference operand"
"""What the front-end's refusal says."""


def with_variables(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files* with such variables. Derivatives in loops and comprehensions stay as they are."""
    return changed(files, _changed)


def _changed(text: str) -> str:
    try:
        tree = Tree(SourceText("", code(text)))
    except UNREADABLE:
        return text
    models = (own for own in tree.elements if own.kind in ("model", "block", "class") and own.elements)
    return edited(text, [change for own in models for change in _variables(tree, own)])


def _variables(tree: Tree, own: Element) -> Iterator[Change]:
    words, starts, at, loops, number = tree.words, tree.starts, own.named, 0, 0
    inner = {each.start: each.end for each in own.elements if each.elements}
    while at < own.end:
        at = inner.get(at, at)
        loops += (words[at] == "loop") - (words[at - 1] == "end" and words[at] in ("for", "while"))
        if words[at] in ("(", "[", "{") and "for" in words[at : tree.closing[at]]:
            at = tree.closing[at]
        elif words[at] == "der" and words[at + 1] == "(" and not loops:
            start, end = at + 2, tree.closing[at + 1]
            if words[start] == "{" and tree.closing[start] == end - 1:
                parts = (f"der({' '.join(part)})" for part in tree.parts(start))
                yield starts[at], starts[end] + 1, f"{{{', '.join(parts)}}}"
            elif not {*"+-*/^("}.isdisjoint(words[start:end]) and "[" not in words[start:end]:
                number += 1
                name, head = f"dse_{own.name}_{number}", starts[own.named + 1]
                yield head, head, f"Real {name} = {' '.join(words[start:end])}; "
                yield starts[start], starts[end], name
            at = end
        at += 1
