"""Members of expandable connectors that are not declared, in words that the front-end takes.

rumoca 0.10.2 refuses `connect(bus.speed, sensor.w)` unless the class of `bus` declares `speed`. By the language, it has
all members that any connection gives it; here they are declared in the class, with the type of what is connected. The
front-end removes members without connection, so it does not matter that other instances of the class have them too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from dse.errors import Problem, raise_if_any
from dse.modelica.frontend.outer import outer_changes
from dse.modelica.frontend.scope import Scope
from dse.modelica.frontend.source_text import Change, SourceText, code, edited
from dse.modelica.frontend.syntax import KINDS, Element, Forest, Tree

REFUSED = (
    "requires unsupported member augmentation",
    "instantiates partial model",
    "of an outer component",
    "missing resolved class metadata",
    "unresolved Flat reference",
)
"""What refusals of such texts say, those of what is `outer` too."""


def with_members(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files*, all that a model is made of, in such words, and with those of `outer_changes`. Raises DseError."""
    names = [name for name in files if name.endswith(".mo")]
    texts = [SourceText(name, files[name].decode("utf-8", "replace")) for name in names]
    read = Forest(SourceText(text.path, code(text.text)) for text in texts)
    scope = Scope(read)
    _add_members(read, scope)
    changes: dict[str, list[Change]] = {text.path: [] for text in texts}
    for tree, change in (*_declared(read, scope), *outer_changes(read, scope)):
        changes[tree.source.path].append(change)
    return {**files, **{text.path: edited(text.text, changes[text.path]).encode() for text in texts}}


def _connections(own: Element) -> Iterator[tuple[list[str], list[str]]]:
    """The two paths of each connection that a class makes itself, without indices."""
    tree, at = own.tree, own.named
    inner = {each.start: each.end for each in own.elements}
    while at < own.end:
        if at in inner:
            at = inner[at]
        elif tree.words[at] == "connect" and tree.words[at + 1] == "(":
            one, other = (_path(tree, part) for part in tree.parts(at + 1))
            yield one, other
            at = tree.closing[at + 1]
        at += 1


def _path(tree: Tree, words: list[str]) -> list[str]:
    return "".join(words).split(".") if "[" not in words else [*_path(tree, words[: words.index("[")]), "[]"]


def _add_members(read: Forest, scope: Scope) -> None:
    """Give classes of expandable connectors the members that connections give them, until there are no more."""
    classes = [own for own in read.elements if own.kind in KINDS and own.elements and not own.is_argument]
    pending = [(own, *sides) for own in classes for sides in _connections(own)]
    is_new = True
    while is_new:
        is_new = False
        for own, one, other in pending:
            (bus, end), (other_bus, other_end) = scope.follow(one, own), scope.follow(other, own)
            pairs = [(bus, one[-1], other_end), (other_bus, other[-1], end)]
            if end is not None and other_end is not None:
                types = scope.type_of(end), scope.type_of(other_end)
                pairs = [(a, *each) for a, b in (types, types[::-1]) for each in _shared(a, b, scope)]
            for around, name, member in pairs:
                is_bus = isinstance(around, Element) and is_expandable(around) and not scope.member(around, name)
                if is_bus and isinstance(around, Element) and member and name != "[]" and scope.declaration(member):
                    scope.added.setdefault(around.full, {})[name] = member
                    is_new = True
                    raise_if_any(flows(member, name, scope))


def _shared(to: Element | str | None, of: Element | str | None, scope: Scope) -> list[tuple[str, Element]]:
    """The members that a bus has from one it is connected to; without the buses in that if one would contain it."""
    if not (isinstance(to, Element) and isinstance(of, Element)) or not is_expandable(to) or not is_expandable(of):
        return []
    members = scope.members(of)
    inner = {name for name, member in members.items() if is_expandable(scope.type_of(member))}
    pending = [scope.type_of(members[name]) for name in inner]
    for kind in pending:
        if isinstance(kind, Element):
            found = [scope.type_of(member) for member in scope.members(kind).values()]
            pending += [each for each in found if is_expandable(each) and each not in pending]
    return [each for each in members.items() if to is not of and (to not in pending or each[0] not in inner)]


def flows(member: Element, name: str, scope: Scope) -> Iterator[Problem]:
    """That a member of an expandable connector has a flow, which the front-end counts wrongly."""
    kind = scope.type_of(member)
    if isinstance(kind, Element) and any("flow" in inner.prefixes for inner in scope.members(kind).values()):
        what = f"'{name}', a member of an expandable connector that has a flow, is not supported"
        yield Problem(what, member.where, "connect it by a connector of its own")


def is_expandable(own: Element | str | None) -> bool:
    """Whether something is the class of an expandable connector."""
    return isinstance(own, Element) and "expandable" in own.prefixes


def _declared(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    for own in read.elements:
        if own.kind in KINDS and own.full in scope.added:
            at = own.tree.starts[own.named + 1]
            members = scope.added[own.full].items()
            text = "".join(f"{scope.declaration(member)} {name}; " for name, member in members)
            yield own.tree, (at, at, text)
