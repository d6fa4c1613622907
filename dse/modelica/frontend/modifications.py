"""Modifications and redeclarations that rumoca 0.10.2 drops or keeps against the language: found, and refused.

It applies a redeclaration in the modifications of a component (`Car a(redeclare Fast engine)`). It drops one

- two modifications deep: `Car a(chassis(redeclare Soft spring))`, of a class, too;
- of a component that the class in `extends` or behind `=` inherits: `extends Car(redeclare Fast engine)`, where `Car`
  has `engine` from a class that it extends itself, or is only another name of one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from dse.errors import Problem
from dse.modelica.frontend.syntax import KINDS, Element, Forest


def misread_modifications(read: Forest, called: Iterable[str]) -> Iterator[Problem]:
    """Each modification in what is used that the front-end takes for something else; *called* are all functions."""
    last = {name.rpartition(".")[2] for name in called}
    for element in read.elements:
        is_used = element.kind != "function" or not last.isdisjoint((element.name, element.last))
        if "redeclare" in element.prefixes and element.kind in KINDS and element.written and is_used:
            what = (
                f"the redeclaration of class '{element.name}' modifies what it takes, which the front-end does not see"
            )
            hint = "declare a class that extends it with these modifications, and redeclare to that"
            yield Problem(what, element.where, hint)
        limit = element.constraint
        if limit and limit.written and (element.kind in KINDS or element.written != limit.written):
            what = "'constrainedby' with modifications, which the front-end does not see, is not supported"
            yield Problem(what, limit.where, "constrain by a class that extends it with these modifications")
        if element.kind == "modifier" and "." in element.name and (element.is_given or element.written):
            what = f"the modification of '{element.name}', which the front-end does not see, is not supported"
            yield Problem(what, element.where, "nest it: a(b = 1) in place of a.b = 1")
        if "redeclare" in element.prefixes and element.is_argument and element.parent:
            yield from _lost(read, element, element.parent)
    yield from _redeclared_components(read)


def _redeclared_components(read: Forest) -> Iterator[Problem]:
    """A component redeclared in a modification keeps the modifications of the declaration before, even where a class
    constrains it; one redeclared as an element loses them."""
    again: dict[str, list[Element]] = {}
    for element in read.elements:
        if element.kind == "component" and "redeclare" in element.prefixes:
            again.setdefault(element.name, []).append(element)
    for element in read.elements:
        is_replaceable = element.kind == "component" and "replaceable" in element.prefixes
        if not element.written or not (is_replaceable or element.kind == "modifier"):
            continue
        is_kept = is_replaceable and element.constraint is not None
        for new in again.get(element.name, ()):
            missing = sorted(_names(element) - _names(new))
            if missing and is_kept == new.is_argument and new is not element:
                how = "keeps" if is_kept else "drops"
                what = (
                    f"the redeclaration of '{new.name}', for which the front-end {how} the modifications made before,"
                )
                yield Problem(
                    f"{what} is not supported", new.where, f"modify the same again here: {', '.join(missing)}"
                )


def _names(element: Element) -> set[str]:
    """What its modifications give values to; of nested ones the text."""
    return {
        one.name if one.is_given and not one.written else "".join(one.tree.words[one.named : one.end])
        for one in element.arguments
    }


def _lost(read: Forest, element: Element, owner: Element) -> Iterator[Problem]:
    """Redeclarations in modifications that are dropped."""
    what = "the redeclaration of " + ("a class" if element.kind in KINDS else f"'{element.name}'")
    if owner.is_argument:
        what += " inside another modification, which the front-end does not see, is not supported"
        yield Problem(
            what, element.tree.place(element.start), "declare a class that has the redeclaration, and use that class"
        )
        return
    is_used = owner.kind == "extends" or (owner.kind in KINDS and read.words[owner.name] > 1)
    if is_used and element.kind == "component" and element.name not in read.own.get(owner.last, ()):
        what += f", which '{owner.last}' inherits, and which the front-end does not see, is not supported"
        hint = "redeclare it in `extends` of the class that declares it, or in the declaration of a component"
        yield Problem(what, element.tree.place(element.start), hint)
