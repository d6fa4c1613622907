"""Classes of libraries under names that the front-end can distinguish; nothing else is changed.

rumoca 0.10.2 takes the variables of a class for those of the class around it, if that one extends it; and functions of
one name in several classes for one function. So a base that is encapsulated, and thus needs nothing of what is around
it, gets a file of its own; and a function of a model gets the model's name added to its own. Where the text leaves any
doubt about what a name is, nothing is done, and the guards of `misreadings` apply.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from dse.modelica.frontend.source_text import Change, SourceText, edited
from dse.modelica.frontend.syntax import Element, Tree, read_tree

_MODELS = ("model", "block")


def distinct(texts: Sequence[SourceText], own: Sequence[SourceText]) -> Iterator[tuple[SourceText, str]]:
    """*texts* of libraries with such classes renamed, and one more text for each that was taken out of its file.

    With each the path of the file it is from. What the model's *own* texts name keeps its name. Lines stay where they
    are; a new text has its class in the lines where it was, and is called after both classes.
    """
    trees = [read_tree(text.text) for text in (*texts, *own)]
    read = [tree for tree in trees if tree]
    renamed = list(_functions(read))
    for text, tree in zip(texts, trees, strict=False):
        changes = [change for of, change in renamed if of is tree]
        for base, name in _bases(tree, read) if tree else ():
            start, end = base.tree.starts[base.start], base.tree.starts[base.end] + 1
            content = re.sub(rf"\b{re.escape(base.name)}\b", name, text.text[start:end])
            before = "\n" * text.text.count("\n", 0, start)
            path = f"{text.path.rpartition('/')[0]}/{name}.mo"
            yield SourceText(path, f"within {base.tree.within};{before}{content}\n"), text.path
            changes.append((start, end, "\n" * content.count("\n")))
            changes += [_change(base.tree, at, name) for at in _uses(base)]
        yield replace(text, text=edited(text.text, changes)), text.path


def _change(tree: Tree, at: int, new: str) -> Change:
    return tree.starts[at], tree.starts[at] + len(tree.words[at]), new


def _is_short(own: Element) -> bool:
    return own.tree.words[own.named + 1] == "="


def _bases(tree: Tree, read: Sequence[Tree]) -> Iterator[tuple[Element, str]]:
    """The encapsulated classes that the one class of a file declares and extends, and new names for them."""
    outermost = [own for own in tree.elements if own.parent is None]
    if len(outermost) != 1 or outermost[0].kind not in _MODELS:
        return
    for own in outermost[0].elements:
        is_apart = own.kind in _MODELS and "encapsulated" in own.prefixes and not _is_short(own)
        elsewhere = any(own.name in other.words for other in read if other is not tree)
        if is_apart and _uses(own) and not elsewhere:
            yield own, f"{outermost[0].name}_{own.name}"


def _uses(base: Element) -> list[int]:
    """Where the text of *base* extends it."""
    words = base.tree.words
    return [at + 1 for at, word in enumerate(words) if word == "extends" and words[at + 1] == base.name]


def _functions(read: Sequence[Tree]) -> Iterator[tuple[Tree, Change]]:
    """The changes of text that rename functions of models that have the names of others."""
    named: dict[str, list[Element]] = {}
    for own in (own for tree in read for own in tree.elements):
        if own.kind == "function" and not own.is_argument and not _is_short(own):
            named.setdefault(own.name, []).append(own)
    used = {name for tree in read for name in _used_elsewhere(tree)}
    for name, functions in named.items():
        owners = {own.parent or own for own in functions}
        is_redeclared = any(own.prefixes & {"redeclare", "replaceable"} or own.type for own in functions)
        if len(functions) == 1 or len(owners) < len(functions) or is_redeclared:
            continue
        for owner in owners:
            if owner.kind in _MODELS and owner.name not in used:
                places = [at for at in range(owner.start, owner.end) if owner.tree.words[at] == name]
                if all(_is_function(owner.tree, at) for at in places):
                    yield from ((owner.tree, _change(owner.tree, at, f"{name}_of_{owner.name}")) for at in places)


def _used_elsewhere(tree: Tree) -> Iterator[str]:
    """The last names of what is extended, or given in a redeclaration, and all names before a dot."""
    for at, word in enumerate(tree.words[:-1]):
        start = at
        while tree.words[start - 1] == ".":
            start -= 2
        before = tree.words[start - 1]
        if tree.words[at + 1] == "." or before == "extends" or before.endswith("="):
            yield word


def _is_function(tree: Tree, at: int) -> bool:
    """Whether a name can be nothing but a function's: declared, called, or given as a derivative."""
    words, before = tree.words, tree.words[at - 1]
    if before == "=":
        what = at - 2 if words[at - 2] != ")" else tree.closing[at - 2] - 1
        if words[what] == "derivative":
            return True
    is_operand = before[-1] in "-+*/^=(,{[" or before in ("then", "else", "and", "or", "not")
    return before in ("function", "end") or (is_operand and words[at + 1] == "(")
