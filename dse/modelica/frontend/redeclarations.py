"""Redeclarations in words that the front-end takes.

rumoca 0.10.2 takes a class for a subtype of another only if it extends it. By the language (3.6, 6.4), a class is one
that has the same public components. Both are made to extend an empty class, and this one constrains.

In `extends B(redeclare C c)`, it drops the redeclaration if `B` inherits `c`. The redeclaration is moved to the class
that extends the one which declares `c`, if nothing else is made from that class or those between.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping

from dse.modelica.frontend.scope import Scope
from dse.modelica.frontend.source_text import Change, SourceText, code, edited
from dse.modelica.frontend.syntax import Element, Forest, Tree
from dse.modelica.frontend.used_classes import reached

NOT_TAKEN = (", which does not extend '", "inherits, and which the front-end does not see")
"""What refusals of such texts say."""
_EMPTY = "dse_Empty"
_OF_INTERFACES = {"flow", "stream", "input", "output", "parameter", "constant", "discrete", "inner", "outer"}


def with_redeclarations(model: str, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files*, all that *model* is made of, with such redeclarations in these words. Raises DseError."""
    texts = [SourceText(name, files[name].decode("utf-8", "replace")) for name in files if name.endswith(".mo")]
    texts = reached(texts, model)
    read = Forest(SourceText(text.path, code(text.text)) for text in texts)
    scope = Scope(read)
    changes: dict[str, list[Change]] = {text.path: [] for text in texts}
    written = {text.path: text.text for text in texts}
    for tree, change in (*_constrained(read, scope), *_moved(read, scope, written)):
        changes[tree.source.path].append(change)
    new = {text.path: edited(text.text, changes[text.path]).encode() for text in texts}
    return {**files, **new, f"{_EMPTY}.mo": f"partial model {_EMPTY} end {_EMPTY};".encode()}


def _constrained(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    """An empty class as the constraint of components that are redeclared by a class with the same interface."""
    again: dict[str, list[Element]] = {}
    for each in read.elements:
        if "redeclare" in each.prefixes and each.kind == "component":
            again.setdefault(each.name, []).append(each)
    made: set[Element] = set()
    for own in read.elements:
        limit, tree = own.constraint, own.tree
        is_plain = own.kind == "component" and not own.is_argument and not own.written
        if not is_plain or {"replaceable"} != own.prefixes & {"replaceable", "redeclare"} or own.parent is None:
            continue
        base = scope.class_of(limit.type if limit else own.type, own.parent)
        taken = [_class(each, scope) for each in again.get(own.name, ())]
        new = [each for each in taken if base and each and base not in scope.lineage(each)]
        is_whole = tree.words[own.end] in (";", "annotation", "constrainedby") and not (limit and limit.written)
        if base is None or not new or not is_whole or not all(_fits(each, base, scope) for each in new):
            continue
        start = tree.starts[limit.named if limit else own.end]
        yield tree, (start, start + len(limit.type if limit else ""), f"{'' if limit else ' constrainedby '}.{_EMPTY} ")
        made |= {base, *new}
    for each in made:
        if made.isdisjoint(scope.lineage(each)[1:]):
            start = each.tree.starts[each.named + 1]
            yield each.tree, (start, start, f"extends .{_EMPTY}; ")


def _class(own: Element, scope: Scope) -> Element | None:
    """The class of a component that is redeclared."""
    around = own.parent
    while around and (around.is_argument or around.kind in ("extends", "component")):
        around = around.parent
    return scope.class_of(own.type, around) if around else None


def _fits(new: Element, base: Element, scope: Scope) -> bool:
    """Whether the class *new* has all components of *base*, of the same types and prefixes, none of them protected."""

    def kind(own: Element) -> tuple[object, ...]:
        return scope.class_of(own.type, own.parent or own), scope.declaration(own), own.prefixes & _OF_INTERFACES

    members = scope.members(new)
    for name, wanted in scope.members(base).items():
        own = members.get(name)
        if own is None or own.parent is None or not scope.declaration(own) or kind(own) != kind(wanted):
            return False
        if "protected" in own.tree.words[own.parent.start : own.start]:
            return False
    return {new.kind, base.kind} <= {"model", "block"} and bool(new.elements and base.elements)


def _moved(read: Forest, scope: Scope, written: Mapping[str, str]) -> Iterator[tuple[Tree, Change]]:
    """The changed lists of modifications; of several redeclarations, that in the class made from the others holds."""

    def text(own: Element, first: int) -> str:
        last = own.tree.until(own.named, ",") - 1
        return written[own.tree.source.path][own.tree.starts[first] : own.tree.starts[last] + len(own.tree.words[last])]

    words = Counter(word for tree in read.trees for word in tree.words)
    lists: dict[Element, dict[str, str]] = {}
    found = []
    for own in read.elements:
        owner, kind = own.parent, _class(own, scope)
        if "redeclare" in own.prefixes and own.kind == "component" and owner and owner.kind == "extends" and kind:
            names = {word for word in own.tree.words[own.named + 1 : own.end] if word[0].isalpha()}
            target = _extends_of(own.name, owner, words, scope)
            if target and names <= {"true", "false", "final", *(one.name for one in own.arguments)}:
                found.append((len(scope.lineage(owner.parent or owner)), own, owner, target, kind))
    for _, own, owner, target, kind in sorted(found, key=lambda each: each[0]):
        for each in (each for each in (owner, target) if each not in lists):
            lists[each] = {one.name: text(one, one.start) for one in each.arguments}
        lists[owner].pop(own.name)
        lists[target][own.name] = f"redeclare replaceable .{kind.full} {text(own, own.named)}"
    for owner, texts in lists.items():
        tree, start = owner.tree, owner.tree.starts[owner.start]
        end = tree.starts[owner.end]
        new = f"extends {owner.type}({', '.join(texts.values())})"
        yield tree, (start, end, new + "\n" * (written[tree.source.path].count("\n", start, end) - new.count("\n")))


def _extends_of(name: str, owner: Element, words: Mapping[str, int], scope: Scope) -> Element | None:
    """Which `extends` a redeclaration of *name* in *owner*, that inherits it, belongs to, if nothing else changes."""
    found, base = owner, scope.class_of(owner.type, owner.parent or owner)
    while base and getattr(scope.member(base, name), "parent", None) is not base:
        if words[base.name] != 3:  # its start, its end, and this
            return None
        of = [(one, scope.class_of(one.type, base)) for one in base.elements if one.kind == "extends"]
        found, base = next(((one, kind) for one, kind in of if kind and scope.member(kind, name)), (found, None))
        if any(one.name == name and one.kind == "modifier" for one in found.arguments):
            return None
    return found if base and found is not owner else None
