"""Constraints that stand in a container: their names are relative to it, and they hold only where it is there."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from dse.domain.expression import Binary, Call, Chosen, Conditional, Name, Node, Span, is_rollup
from dse.errors import Problem, closest, raise_if_any
from dse.expression import children
from dse.loading.design.instances import OVER_PLACES
from dse.loading.design.located_text import Passage, added, joined, with_insertions


@dataclass(frozen=True, slots=True)
class Scope:
    """A place in the tree of containers.

    *path* is what expressions call it, *trail* also has the names of the architectures on the way, which makes it
    unique. *guards* are the conditions under which it is there.
    """

    path: str = ""
    trail: str = ""
    guards: tuple[str, ...] = ()

    def part(self, name: str) -> Scope:
        """The part *name* of the compound here."""
        return Scope(_join(self.path, name), _join(self.trail, name), self.guards)

    def option(self, name: str) -> Scope:
        """The alternative *name* here."""
        # That this option is chosen says already that something is.
        outer = self.guards[:-1] if self.guards[-1:] == (f"{self.path} is present",) else self.guards
        return Scope(self.path, _join(self.trail, name), (*outer, f"{self.path} is {name}"))

    def optional(self) -> Scope:
        """What can be left out here."""
        return Scope(self.path, self.trail, (*self.guards, f"{self.path} is present"))


def constraint_name(scope: Scope, name: str) -> str:
    """What the constraint *name* of the container at *scope* is called in the design."""
    return f"{scope.trail}: {name}" if scope.trail else name


def inside(scope: Scope, parts: Collection[str], passage: Passage) -> Passage:
    """The condition *passage* of a container, which has *parts*, as one of the whole design.

    Raises DseError at every name that is none of the container's.
    """
    expression = passage.parse()
    if not scope.path:
        return passage
    insertions: list[tuple[int, str]] = []
    problems: list[Problem] = []
    for mention in _mentions(expression.root, parts):
        match mention:
            case _PartPath(first, span):
                insertions.append((span[0], f"{scope.path}."))
                if first not in parts:
                    what = f"'{first}' is not a part of '{scope.trail}'"
                    problems.append(Problem(what, expression.location(span), closest(first, parts)))
            case _Property(span):
                insertions += [(span[0], "sum("), (span[1], f", {scope.path})")]
            case _Everywhere(end):
                insertions.append((end, f", {scope.path}"))
    raise_if_any(problems)
    scoped = with_insertions(passage, insertions)
    if not scope.guards:
        return scoped
    root = expression.root
    if isinstance(root, Conditional) or (isinstance(root, Binary) and root.operator == "iff"):
        scoped = joined(added("(", scoped.where), scoped, added(")", scoped.where))
    return joined(added(f"{' and '.join(scope.guards)} implies ", scoped.where), scoped)


@dataclass(frozen=True, slots=True)
class _PartPath:
    """A path that starts at the part *first*."""

    first: str
    span: Span


@dataclass(frozen=True, slots=True)
class _Property:
    """A bare property, which is summed up."""

    span: Span


@dataclass(frozen=True, slots=True)
class _Everywhere:
    """A roll-up over all there is, whose closing bracket stands at *end*."""

    end: int


def _mentions(root: Node, parts: Collection[str]) -> Iterator[_PartPath | _Property | _Everywhere]:
    stack = [root]
    while stack:
        node = stack.pop()
        match node:
            case Chosen():
                yield _place(node.place, node.place_span())
            case Name(path, span):
                yield _place(path, span) if "." in path or path in parts else _Property(span)
            case Call(function, arguments) if function in OVER_PLACES:
                stack += [argument for argument in arguments if not isinstance(argument, Name)]
                yield from (_place(name.path, name.span) for name in arguments if isinstance(name, Name))
            case Call(function, (first, *others)) if is_rollup(function, first):
                yield from (_place(name.path, name.span) for name in others if isinstance(name, Name))
                if not others:
                    yield _Everywhere(node.span[1] - 1)
            case _:
                stack += children(node)


def _place(path: str, span: Span) -> _PartPath:
    return _PartPath(path.partition(".")[0], span)


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name
