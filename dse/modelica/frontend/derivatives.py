"""Derivatives of expressions, ``der(a - b)``, as derivatives of variables that are declared for them.

rumoca 0.10.2 refuses the first. A variable for the expression is differentiated by index reduction, as in any model.
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
    words, at, loops, number = tree.words, own.named, 0, 0
    inner = {each.start: each.end for each in own.elements if each.elements}
    opened: list[int] = []
    while at < own.end:
        at = inner.get(at, at)
        loops += (words[at] == "loop") - (words[at - 1] == "end" and words[at] in ("for", "while"))
        if words[at] in ("(", "[", "{"):
            opened.append(at)
        elif words[at] in (")", "]", "}"):
            opened.pop()
        if words[at] == "der" and words[at + 1] == "(" and not loops:
            end = tree.closing[at + 1]
            is_each = any("for" in words[start : tree.closing[start]] for start in opened)
            if (
                not is_each
                and not {"+", "-", "*", "/", "^", "("}.isdisjoint(words[at + 2 : end])
                and "[" not in words[at + 2 : end]
            ):
                first, last, head = tree.starts[at + 2], tree.starts[end], tree.starts[own.named + 1]
                number += 1
                name = f"dse_{own.name}_{number}"
                yield head, head, f"Real {name} = {' '.join(tree.source.text[first:last].split())}; "
                yield first, last, name
                at = end
        at += 1
