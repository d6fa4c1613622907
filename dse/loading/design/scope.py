"""Constraints that stand in a container: their names are relative to it, and they hold only where it is there."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from dse.domain.expression import ROLLUPS, Binary, Call, Chosen, Conditional, Name, Node, Span
from dse.errors import Problem, closest, raise_if_any
from dse.expression.parse import children
from dse.loading.passages import Passage, added, joined, with_insertions


@dataclass(frozen=True, slots=True)
class Spot:
    """A place in the tree of containers.

    *path* is what expressions call it, *trail* also has the names of the architectures on the way, which makes it
    unique. *guards* are the conditions under which it is there.
    """

    path: str = ""
    trail: str = ""
    guards: tuple[str, ...] = ()

    def part(self, name: str) -> Spot:
        """The part *name* of the compound here."""
        return Spot(_join(self.path, name), _join(self.trail, name), self.guards)

    def option(self, name: str) -> Spot:
        """The alternative *name* here."""
        # That this option is chosen says already that something is.
        outer = self.guards[:-1] if self.guards[-1:] == (f"{self.path} is present",) else self.guards
        return Spot(self.path, _join(self.trail, name), (*outer, f"{self.path} is {name}"))

    def optional(self) -> Spot:
        """What can be left out here."""
        return Spot(self.path, self.trail, (*self.guards, f"{self.path} is present"))


def constraint_name(spot: Spot, name: str) -> str:
    """What the constraint *name* of the container at *spot* is called in the design."""
    return f"{spot.trail}: {name}" if spot.trail else name


def inside(spot: Spot, parts: Collection[str], passage: Passage) -> Passage:
    """The condition *passage* of a container, which has *parts*, as one of the whole design.

    Raises DseError at every name that is none of the container's.
    """
    expression = passage.parse()
    if not spot.path:
        return passage
    insertions: list[tuple[int, str]] = []
    problems: list[Problem] = []
    for mention in _mentions(expression.root, parts):
        match mention:
            case _Place(first, span):
                insertions.append((span[0], f"{spot.path}."))
                if first not in parts:
                    what = f"'{first}' is no part of '{spot.trail}'"
                    problems.append(Problem(what, expression.location(span), closest(first, parts)))
            case _Property(span):
                insertions += [(span[0], "sum("), (span[1], f", {spot.path})")]
            case _Everywhere(end):
                insertions.append((end, f", {spot.path}"))
    raise_if_any(problems)
    scoped = with_insertions(passage, insertions)
    if not spot.guards:
        return scoped
    root = expression.root
    if isinstance(root, Conditional) or (isinstance(root, Binary) and root.operator == "iff"):
        scoped = joined(added("(", scoped.where), scoped, added(")", scoped.where))
    return joined(added(f"{' and '.join(spot.guards)} implies ", scoped.where), scoped)


@dataclass(frozen=True, slots=True)
class _Place:
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


def _mentions(root: Node, parts: Collection[str]) -> Iterator[_Place | _Property | _Everywhere]:
    stack = [root]
    while stack:
        node = stack.pop()
        match node:
            case Chosen():
                yield _place(node.place, node.place_span())
            case Name(path, span):
                yield _place(path, span) if "." in path or path in parts else _Property(span)
            case Call("same_choice", arguments):
                stack += [argument for argument in arguments if not isinstance(argument, Name)]
                yield from (_place(name.path, name.span) for name in arguments if isinstance(name, Name))
            case Call(function, (first, *others)) if is_rollup(function, first):
                yield from (_place(name.path, name.span) for name in others if isinstance(name, Name))
                if not others:
                    yield _Everywhere(node.span[1] - 1)
            case _:
                stack += children(node)


def _place(path: str, span: Span) -> _Place:
    return _Place(path.partition(".")[0], span)


def is_rollup(function: str, first: Node) -> bool:
    """Whether a call with that first argument rolls up a property; ``min`` and ``max`` also compare values."""
    return function in ROLLUPS and (
        function not in ("min", "max") or (isinstance(first, Name) and "." not in first.path)
    )


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name
