"""What is `outer`, in words that the front-end takes.

rumoca 0.10.2 refuses an outer component of a partial class, its records as arguments of functions, and its arrays in
equations. In values of declarations, it takes the parameters of the component as its class has them, not as the inner
one: a value that is no Real is written as the inner component has it, and made `final` there.
"""

from __future__ import annotations

from collections.abc import Iterator

from dse.modelica.frontend.scope import PREDEFINED, Scope
from dse.modelica.frontend.source_text import Change
from dse.modelica.frontend.syntax import KINDS, Element, Forest, Tree

_MADE = ("extends", *KINDS)


def _uses(read: Forest, scope: Scope) -> Iterator[tuple[Tree, int, Element, bool]]:
    """Where a component of an outer one is named: the word, the component, and whether a declaration's value has it."""
    outer = {each.name: each for each in read.elements if each.kind == "component" and "outer" in each.prefixes}
    for tree in read.trees if outer else ():
        given = [each for each in tree.elements if each.kind in ("component", "modifier") and each.is_given]
        values = {at for each in given for at in range(each.named, each.end)}
        for at, word in enumerate(tree.words[:-2]):
            if word in outer and tree.words[at + 1] == "." and tree.words[at - 1] != ".":
                own = scope.type_of(outer[word])
                member = scope.member(own, tree.words[at + 2]) if isinstance(own, Element) else None
                if member:
                    yield tree, at, member, at in values


def outer_values(read: Forest, scope: Scope) -> list[tuple[Tree, int, Element]]:
    """Where values of declarations name components of an outer one that are neither Real nor final, and these."""
    found = []
    for tree, at, member, is_value in _uses(read, scope):
        kind = scope.type_of(member) if is_value and "final" not in member.prefixes else None
        if kind in ("Boolean", "Integer", "String") or (isinstance(kind, Element) and kind.kind == "type"):
            found.append((tree, at, member))
    return found


def outer_changes(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    """The changes of text."""
    yield from _whole(read, scope)
    yield from _aggregates(read, scope)
    made: dict[tuple[str, str], str] = {}
    for tree, at, member in outer_values(read, scope):
        name, of = tree.words[at], member.name
        if (name, of) not in made:
            owners = [each for each in read.elements if each.name == name and "outer" not in each.prefixes]
            owners = [each for each in owners if scope.type_of(each) not in PREDEFINED]  # as an input of a function
            modified = [each for each in read.elements if each.name == of and each.is_argument]
            # What they modify may be the inner component, or what is made from its class.
            given = [one for one in modified if one.parent and (one.parent.name == name or one.parent.kind in _MADE)]
            is_plain = all(each.prefixes & {"inner", "redeclare"} for each in owners)
            is_plain = is_plain and all(each.parent in owners for each in given)
            others = [each for each in owners if all(one.parent is not each for one in given)]
            values = {_value(each, scope) for each in given}
            values |= {_value(member, scope)} if others or not owners else set()
            value = made[name, of] = values.pop() if is_plain and len(values) == 1 else ""
            for each in given if owners else [member]:
                start = each.tree.starts[each.start]
                if value and each.tree.words[each.start] != "final":
                    yield each.tree, (start, start, "final ")
            for each in others if value else ():
                after, new = each.named + 1, f"final {of} = {value}"
                start = each.tree.starts[after]
                is_modified = each.tree.words[after] == "("
                yield each.tree, (start + 1, start + 1, f"{new}, ") if is_modified else (start, start, f"({new})")
        if made[name, of]:
            yield tree, (tree.starts[at], tree.starts[at + 2] + len(of), made[name, of])


def _value(own: Element, scope: Scope) -> str:
    """What an element is given, if it is written as a Boolean, a whole number or an item of an enumeration."""
    words = own.tree.words[own.named : own.end]
    *path, last = words[words.index("=") + 1 :] if "=" in words else [""]
    around: Element | None = own
    while around and around.kind not in KINDS:
        around = around.parent
    if not path:
        return last if last in ("true", "false") or last.isdigit() else ""
    kind = scope.class_of("".join(path[:-1]), around) if around and path[-1] == "." else None
    return f"{kind.full}.{last}" if kind and kind.kind == "type" else ""


def _whole(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    """The partial classes that only outer components have for which there is an inner one, without `partial`."""
    inner = {each.name for each in read.elements if "inner" in each.prefixes}
    kinds: dict[Element, bool] = {}
    for each in read.elements:
        kind = scope.type_of(each) if each.kind == "component" else None
        if isinstance(kind, Element) and "partial" in kind.prefixes:
            kinds[kind] = kinds.get(kind, True) and "outer" in each.prefixes and each.name in inner
    for own in (own for own, is_outer in kinds.items() if is_outer):
        at = own.tree.starts[own.tree.words.index("partial", own.start)]
        yield own.tree, (at, at + len("partial"), "")


def _aggregates(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    """Records that are arguments, made of their fields; arrays in equations, as variables declared for them."""
    declared: set[tuple[Element, str]] = set()
    inside: dict[Tree, dict[int, Element]] = {}
    for tree, at, member, is_value in _uses(read, scope):
        declared_as = scope.class_of(member.type, member.parent) if member.parent else None
        if declared_as and declared_as.kind == "connector":
            continue
        kind, path, new = scope.type_of(member), "".join(tree.words[at : at + 3]), ""
        is_argument = tree.words[at - 1] in ("(", ",") and tree.words[at + 3] in (",", ")")
        if isinstance(kind, Element) and kind.kind == "record" and is_argument:
            new = f"{kind.full}({', '.join(f'{field} = {path}.{field}' for field in scope.members(kind))})"
        elif (written := scope.declaration(member)).endswith("]") and not is_value:
            new = f"dse_{path.replace('.', '_')}"
            if tree not in inside:
                inside[tree] = {k: own for own in tree.elements if own.kind in KINDS for k in range(own.named, own.end)}
            around = inside[tree][at]
            if (around, new) not in declared:
                start = tree.starts[around.named + 1]
                yield tree, (start, start, f"{written} {new} = {path}; ")
            declared.add((around, new))
        if new:
            yield tree, (tree.starts[at], tree.starts[at + 2] + len(member.name), new)
