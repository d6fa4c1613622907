"""Members of expandable connectors that are not declared, and what is `outer`, in words that the front-end takes.

rumoca 0.10.2 refuses `connect(bus.speed, sensor.w)` unless the class of `bus` declares `speed`. By the language, it has
all members that any connection gives it; here they are declared in the class, with the type of what is connected. The
front-end removes members without connection, so it does not matter that other instances of the class have them too.

It refuses an outer component of a partial class, so `partial` is left out. In values of declarations, it takes the
parameters of an outer component as its class has them, not as the inner one: so a Boolean or Integer is written as the
number that the inner component has, and made `final` there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from dse.modelica.frontend.scope import Scope
from dse.modelica.frontend.source_text import Change, SourceText, code, edited
from dse.modelica.frontend.syntax import KINDS, Element, Forest, Tree

NEEDED = (
    "requires unsupported member augmentation",
    "instantiates partial model",
    "of an outer component",
    "missing resolved class metadata",
    "unresolved Flat reference",
)
"""What refusals of such texts say, those of `outer_values` too."""


def with_members(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """*files*, all that a model is made of, in such words."""
    names = [name for name in files if name.endswith(".mo")]
    texts = [SourceText(name, files[name].decode("utf-8", "replace")) for name in names]
    read = Forest(SourceText(text.path, code(text.text)) for text in texts)
    scope = Scope(read)
    _add_members(read, scope)
    changes: dict[str, list[Change]] = {text.path: [] for text in texts}
    for tree, change in (
        *_declared(read, scope),
        *_whole(read, scope),
        *_values(read, scope),
        *_aggregates(read, scope),
    ):
        changes[tree.source.path].append(change)
    return {**files, **{text.path: edited(text.text, changes[text.path]).encode() for text in texts}}


def _classes(read: Forest) -> Iterator[Element]:
    return (own for own in read.elements if own.kind in KINDS and own.elements and not own.is_argument)


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
    pending = [(own, *sides) for own in _classes(read) for sides in _connections(own)]
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
                if isinstance(around, Element) and is_expandable(around) and member and name != "[]":
                    known = scope.members(around).get(name)
                    if known is None and _written(member, scope):
                        scope.added.setdefault(around.full, {})[name] = member
                        is_new = True


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


def is_expandable(own: Element | str | None) -> bool:
    """Whether something is the class of an expandable connector."""
    return isinstance(own, Element) and "expandable" in own.prefixes


def _written(member: Element, scope: Scope) -> str:
    """The type and the sizes of a member as they can be declared in any class; nothing if they cannot."""
    kind = scope.type_of(member)
    path = f".{kind.full}" if isinstance(kind, Element) else kind
    tree = member.tree
    sizes = [
        "".join(tree.words[start : tree.closing[start] + 1])
        for start in (member.named - 1, member.named + 1)
        for start in ([tree.closing[start]] if tree.words[start] == "]" else [start])
        if tree.words[start] == "["
    ]
    is_fixed = len(sizes) < 2 and all(size[1:-1].replace(",", "").isdigit() for size in sizes)
    return f"{path}{''.join(sizes)}" if path and is_fixed else ""


def _declared(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    for own in read.elements:
        if own.kind in KINDS and own.full in scope.added:
            at = own.tree.starts[own.named + 1]
            members = scope.added[own.full].items()
            text = "".join(f"{_written(member, scope)} {name}; " for name, member in members)
            yield own.tree, (at, at, text)


def _whole(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    """The partial classes that only outer components have for which there is an inner one, without `partial`."""
    kinds: dict[bool, set[Element]] = {True: set(), False: set()}
    inner = {element.name for element in read.elements if "inner" in element.prefixes}
    for element in read.elements:
        if element.kind == "component" and element.parent is not None:
            kind = scope.type_of(element)
            if isinstance(kind, Element) and "partial" in kind.prefixes:
                kinds["outer" in element.prefixes and element.name in inner].add(kind)
    for own in kinds[True] - kinds[False]:
        at = own.tree.starts[own.tree.words.index("partial", own.start)]
        yield own.tree, (at, at + len("partial"), "")


def outer_values(read: Forest, scope: Scope) -> Iterator[tuple[Tree, int, Element]]:
    """Where values of declarations name a Boolean or Integer of an outer component that is not final: the word."""
    outer: dict[str, Element] = {
        element.name: element
        for element in read.elements
        if element.kind == "component" and "outer" in element.prefixes
    }
    if not outer:
        return
    for tree in read.trees:
        seen = -1
        for element in tree.elements:
            if element.kind not in ("component", "modifier") or not element.is_given or element.arguments:
                continue
            for at in range(max(element.named, seen), element.end):
                seen = at + 1
                if tree.words[at] in outer and tree.words[at + 1] == "." and tree.words[at - 1] != ".":
                    own = scope.type_of(outer[tree.words[at]])
                    member = scope.members(own).get(tree.words[at + 2]) if isinstance(own, Element) else None
                    if member and "final" not in member.prefixes and scope.type_of(member) in ("Boolean", "Integer"):
                        yield tree, at, member


def _values(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    """Such values in place of their names, and `final` where the inner component has them, if that is one value."""
    made: dict[tuple[str, str], str] = {}
    for tree, at, member in list(outer_values(read, scope)):
        name, of = tree.words[at], member.name
        if (name, of) not in made:
            inner = [each for each in read.elements if each.name == name and each.prefixes & {"inner", "redeclare"}]
            given = {each: [one for one in each.arguments if one.name == of] for each in inner}
            values = {_value(one) for own in inner for one in given[own] or [member]}
            values |= {
                ""
                for each in read.elements
                if each.name == of
                and each.parent
                and each.is_argument
                and (each.parent.name == name or each.parent.kind in ("extends", *KINDS))
                and each.parent not in inner
            }
            made[name, of] = value = values.pop() if len(values) == 1 else ""
            for own in inner if value else ():
                yield own.tree, _final(own, given[own], f"{of}={value}")
        if made[name, of]:
            yield tree, (tree.starts[at], tree.starts[at + 2] + len(of), made[name, of])


def _value(own: Element) -> str:
    """What an element is given, if it is written as a Boolean or a whole number."""
    text = "".join(own.tree.words[own.end - 1 : own.end]) if own.is_given else ""
    is_alone = own.tree.words[own.end - 2] == "="
    return text if is_alone and (text in ("true", "false") or text.isdigit()) else ""


def _final(own: Element, given: list[Element], modification: str) -> Change:
    """The change of text that makes a modification of an inner component final."""
    tree = own.tree
    if given:
        start = tree.starts[given[0].start]
        return start, start, "" if tree.words[given[0].start] == "final" else "final "
    after = own.named + 1
    after = tree.closing[after] + 1 if tree.words[after] == "[" else after
    start = tree.starts[after] + (tree.words[after] == "(")
    text = f"final {modification}"
    return start, start, f"{text}, " if tree.words[after] == "(" else f"({text})"


def _aggregates(read: Forest, scope: Scope) -> Iterator[tuple[Tree, Change]]:
    """Records of outer components that are arguments, made of their fields; arrays in equations, as other variables."""
    outer = {each.name: each for each in read.elements if each.kind == "component" and "outer" in each.prefixes}
    declared: set[tuple[Element, str]] = set()
    for tree in read.trees:
        classes = [own for own in tree.elements if own.kind in KINDS]
        values = {at for own in tree.elements if own.kind not in KINDS for at in range(own.start, own.end)}
        for at, word in enumerate(tree.words[:-4]):
            if word not in outer or tree.words[at - 1] == "." or tree.words[at + 1] != ".":
                continue
            own, name = scope.type_of(outer[word]), tree.words[at + 2]
            member = scope.members(own).get(name) if isinstance(own, Element) else None
            kind, new = scope.type_of(member) if member else None, ""
            is_argument = tree.words[at - 1] in ("(", ",") and tree.words[at + 3] in (",", ")")
            if isinstance(kind, Element) and kind.kind == "record" and is_argument:
                new = ", ".join(f"{field} = {word}.{name}.{field}" for field in scope.members(kind))
                new = f"{kind.full}({new})"
            elif member and (written := _written(member, scope)).endswith("]") and at not in values:
                new = f"dse_{word}_{name}"
                around = [each for each in classes if each.named < at < each.end][-1]
                if (around, new) not in declared:
                    start = tree.starts[around.named + 1]
                    yield tree, (start, start, f"{written} {new} = {word}.{name}; ")
                declared.add((around, new))
            if new:
                yield tree, (tree.starts[at], tree.starts[at + 2] + len(name), new)
