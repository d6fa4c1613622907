"""Formulas over instances and places, written out in the rest of the language.

``each``, ``count`` and ``sum`` of a formula that names a repeated place run over its instances, those that are absent
aside: ``each(radar.range >= 50 m)`` is ``radar.n1 is present implies radar.n1.range >= 50 m`` and so on for all.
``all_different`` of places is one ``at_most(1, …)`` for every name that several of them have, which is far easier to
count than a comparison of each pair. ``ordered`` compares the choices at and below neighbours, first choice first, in
the order of the file, absent last. ``same_choice`` of a repeated place compares the instances that are present.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, pairwise

from dse.domain.design import Alternative, Compound, Optional, Part, walk
from dse.domain.expression import Binary, Call, Chosen, Conditional, Expression, Name, Node, Number, Span, Truth, Unary
from dse.errors import closest
from dse.expression import balanced, descend, error_in, rewritten
from dse.units import DIMENSIONLESS

OVER_PLACES = ("same_choice", "all_different", "ordered")
"""Functions whose arguments are places."""

MOST_TERMS = 20_000
"""Terms that one formula may become."""


class Instances:
    """The repeated places below *root*, and what can be chosen at every place."""

    def __init__(self, root: Compound) -> None:
        self.of: dict[str, tuple[str, ...]] = {}
        self.choices: dict[str, dict[str, None]] = {}
        for path, node in walk(root):
            names = self.choices.setdefault(path, {})
            match node:
                case Compound(parts=parts, repeated=True):
                    named = (f"{path}.{name}" if path else name for name in parts)
                    self.of[path] = tuple(dict.fromkeys((*self.of.get(path, ()), *named)))
                case Alternative(options):
                    names |= dict.fromkeys(option.name for option in options)
                case Optional(Part() | Compound() as content):
                    names[content.name] = None

    def repeated_in(self, path: str) -> str | None:
        """The repeated place that *path* names without naming one of its instances."""
        steps = path.split(".")
        starts = (".".join(steps[:length]) for length in range(1, len(steps) + 1))
        return next((at for at in starts if at in self.of and not _below(path, self.of[at])), None)

    def decisions(self, place: str) -> dict[str, tuple[str, ...]]:
        """What can be chosen at and below *place*, by the path from there."""
        below = f"{place}."
        return {
            path.removeprefix(place): tuple(names)
            for path, names in self.choices.items()
            if names and (path == place or path.startswith(below))
        }


def unfold(expression: Expression, known: Instances) -> Expression:
    """*expression* with its formulas over instances written out; itself if there are none. Raises DseError, located."""
    if not any(_is_word(node) for node in descend(expression.root)):
        return expression
    return replace(expression, root=rewritten(expression.root, _Unfolder(expression, known).change))


def _is_word(node: Node) -> bool:
    if not isinstance(node, Call):
        return False
    return node.function in ("each", *OVER_PLACES) or _is_formula(node)


def _is_formula(node: Call) -> bool:
    """Whether it counts or adds up a formula, not a property."""
    bare = node.arguments and isinstance(node.arguments[0], Name) and "." not in node.arguments[0].path
    return node.function in ("count", "sum") and len(node.arguments) == 1 and not bare


def _below(path: str, places: Sequence[str]) -> bool:
    return any(path == place or path.startswith(f"{place}.") for place in places)


class _Unfolder:
    def __init__(self, expression: Expression, known: Instances) -> None:
        self.expression = expression
        self.known = known
        self.terms = 0

    def change(self, node: Node) -> Node:
        match node:
            case Call("all_different", span=span):
                return self.all_different(self.places(node), span)
            case Call("ordered", span=span):
                return self.every([self.in_order(a, b, span) for a, b in pairwise(self.places(node))], span)
            case Call("same_choice", (Name(path),), span=span) if path in self.known.of:
                of = self.known.of[path]  # none in a design that was refined so
                alike = [_guarded((other,), _same([of[0], other], span), span) for other in of[1:]]
                return self.every(alike, span)
            case Call("each", span=span):
                if len(node.arguments) != 1:
                    raise error_in(self.expression, span, "'each' needs one condition", "each(place.property <= 5)")
                return self.every([_guarded(guards, body, span) for guards, body in self.over(node)], span)
            case Call("count" | "sum" as word, (body,)) if _is_formula(node) and self.repeated(body):
                return self.added([self.term(word, *one, node.span) for one in self.over(node)], node.span)
        return node

    def over(self, node: Call) -> list[tuple[tuple[str, ...], Node]]:
        """The formula for every instance, each with the places that must be present."""
        (body,) = node.arguments
        if self.repeated(body) is None:
            some = ", ".join(self.known.of) or "none in this design"
            hint = f"{node.function}(place.property <= 5); repeated places: {some}"
            raise error_in(self.expression, node.span, f"'{node.function}' names no repeated place", hint)
        return list(self.instances(body, node))

    def instances(self, body: Node, call: Call) -> Iterator[tuple[tuple[str, ...], Node]]:
        place = self.repeated(body)
        if place is None:
            self.terms += 1
            if self.terms > MOST_TERMS:
                raise error_in(self.expression, call.span, "too many instances", f"at most {MOST_TERMS:,} terms")
            yield (), body
            return
        for instance in self.known.of[place]:
            one = rewritten(body, _renamed(place, instance, self.known))
            yield from (((instance, *guards), inner) for guards, inner in self.instances(one, call))

    def repeated(self, body: Node) -> str | None:
        mentioned = (
            self.known.repeated_in(node.path if isinstance(node, Name) else node.place)
            for node in descend(body)
            if isinstance(node, Name | Chosen)
        )
        return next((place for place in mentioned if place is not None), None)

    def term(self, word: str, guards: tuple[str, ...], body: Node, span: Span) -> Node:
        if word == "count":
            if isinstance(body, Chosen) and "absent" not in body.options:
                guards = tuple(guard for guard in guards if not _below(body.place, (guard,)))
            condition = self.every([*_present(guards, span), body], span)
            return Conditional(condition, _number(1, span), _number(0, span), span)
        place, _, name = body.path.rpartition(".") if isinstance(body, Name) else ("", "", "")
        if isinstance(body, Name) and place in self.known.choices:
            return Call("sum", (replace(body, path=name), replace(body, path=place)), (), span)
        return Conditional(self.every(_present(guards, span), span), body, _number(0, span), span)

    def all_different(self, places: list[str], span: Span) -> Node:
        if all(set(self.known.decisions(place)) == {""} for place in places):
            at: dict[str, list[Node]] = {}
            for place in places:
                for name in self.known.choices[place]:
                    at.setdefault(name, []).append(Chosen(place, (name,), span))
            one = _number(1, span)
            some = [Call("at_most", (one, *same), (), span) for same in at.values() if len(same) > 1]
            return self.every(some, span)
        differ: list[Node] = []
        for a, b in combinations(places, 2):
            below = dict.fromkeys(("", *self.known.decisions(a), *self.known.decisions(b)))
            same = [_same([a + path, b + path], span) for path in below]
            differ.append(_guarded((a, b), Unary("not", self.every(same, span), span), span))
        return self.every(differ, span)

    def in_order(self, a: str, b: str, span: Span) -> Node:
        """That the choices at and below *a* are not after those of *b*."""
        found: list[Node] = []
        before: list[Node] = []
        theirs = self.known.decisions(b)
        for path, names in self.known.decisions(a).items():
            own = theirs.get(path, ())
            known = tuple(dict.fromkeys((*names, *own)))
            for length in range(1, len(known)):
                later, sooner = (
                    _one_of(place + path, [name for name in known[:length] if name in there], span)
                    for place, there in ((b, own), (a, names))
                )
                found.append(self.implied(before, Binary("implies", later, sooner, span), span))
            later, sooner = _present([b + path, a + path], span)
            found.append(self.implied(before, Binary("implies", later, sooner, span), span))
            before = [*before, _same([a + path, b + path], span)]
        return self.every(found, span)

    def implied(self, conditions: Sequence[Node], node: Node, span: Span) -> Node:
        return Binary("implies", self.every(conditions, span), node, span) if conditions else node

    def places(self, node: Call) -> list[str]:
        """The places that are the arguments of a call; a repeated one stands for its instances."""
        found: list[str] = []
        for argument in node.arguments:
            if not isinstance(argument, Name):
                raise error_in(
                    self.expression, argument.span, f"'{node.function}' compares places", f"{node.function}(a, b)"
                )
            if argument.path not in self.known.choices:
                hint = closest(argument.path, self.known.choices)
                raise error_in(self.expression, argument.span, f"unknown place '{argument.path}'", hint)
            found += self.known.of.get(argument.path, (argument.path,))
        if len(node.arguments) < 2 and not any(isinstance(a, Name) and a.path in self.known.of for a in node.arguments):
            what = f"'{node.function}' needs two places or more, or a repeated one"
            raise error_in(self.expression, node.span, what, f"{node.function}(a, b)")
        return found

    def every(self, nodes: Sequence[Node], span: Span) -> Node:
        return balanced("and", [(node, span) for node in nodes]) if nodes else Truth(True, span)

    def added(self, nodes: Sequence[Node], span: Span) -> Node:
        return balanced("+", [(node, span) for node in nodes]) if nodes else _number(0, span)


def _renamed(place: str, instance: str, known: Instances) -> Callable[[Node], Node]:
    def change(node: Node) -> Node:
        match node:
            case Name(path) if known.repeated_in(path) == place:
                return replace(node, path=instance + path.removeprefix(place))
            case Chosen(path) if known.repeated_in(path) == place:
                return replace(node, place=instance + path.removeprefix(place))
        return node

    return change


def _present(places: Sequence[str], span: Span) -> list[Node]:
    return [Chosen(place, ("present",), span) for place in places]


def _one_of(place: str, names: Sequence[str], span: Span) -> Node:
    return Chosen(place, tuple(names), span) if names else Truth(False, span)


def _guarded(places: Sequence[str], node: Node, span: Span) -> Node:
    return Binary("implies", balanced("and", [(one, span) for one in _present(places, span)]), node, span)


def _same(places: Sequence[str], span: Span) -> Node:
    return Call("same_choice", tuple(Name(place, span) for place in places), (), span)


def _number(value: int, span: Span) -> Node:
    return Number(Fraction(value), DIMENSIONLESS, span)
