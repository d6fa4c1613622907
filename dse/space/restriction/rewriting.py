"""Constraints of a design space from which choices were taken, rewritten to say the same without them.

Where a place is gone its properties are undefined for good. A constraint whose outcome is undefined holds, so an
undefined condition may be replaced: by true where its being true can only make the constraint hold, by false where
its being false can. Every condition can be brought into one of these senses, as ``a iff b`` is
``(a implies b) and (b implies a)`` in Kleene's logic too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product

from dse.domain.component import Component
from dse.domain.design import Constraint, DesignSpace, split_path
from dse.domain.expression import (
    Between,
    Binary,
    Call,
    Chosen,
    Conditional,
    Expression,
    Name,
    Node,
    Number,
    Piece,
    Truth,
    Unary,
    is_rollup,
)
from dse.expression import children, descend, parse_expression, show_expression
from dse.space.decisions import sites
from dse.units import DIMENSIONLESS, Unit, own_units

_Components = dict[str, dict[str, Component | None]]
"""What can stand at every place, by name."""

_Guards = tuple[tuple[Node, bool], ...]
"""Conditions, each with the truth it must have."""


def rewritten_constraints(before: DesignSpace, after: DesignSpace) -> tuple[Constraint, ...]:
    """All constraints of *before* for *after*, which has some of its choices; without those that always hold now."""
    rewriter = _Rewriter(_standing(before), _standing(after))
    found = []
    for constraint in before.all_constraints:
        if not rewriter.is_touched(constraint.rule.root):
            found.append(constraint)
            continue
        root = rewriter.condition(constraint.rule.root, True)
        if not (isinstance(root, Truth) and root.value):
            with own_units(after.units):
                found.append(replace(constraint, rule=_expression(root, constraint), form=None))
    return tuple(found)


def _expression(root: Node, constraint: Constraint) -> Expression:
    where = constraint.rule.where or constraint.where
    # None of it stands in the file, so all that could be wrong with it is told at the start of what does.
    return parse_expression(show_expression(root), (Piece(0, where, inserted=True),) if where else None)


def _standing(space: DesignSpace) -> _Components:
    found: _Components = {}
    for site in sites(space):
        found.setdefault(site.path, {})[site.name] = site.component
    return found


class _Rewriter:
    def __init__(self, before: _Components, after: _Components) -> None:
        self.before = before
        self.after = after
        self.units = _units(before)
        self.stated = frozenset(_units(after))

    def is_touched(self, node: Node) -> bool:
        """Whether something in *node* may be gone."""
        for inner in descend(node):
            match inner:
                case Chosen() if inner.place not in self.after:
                    return True
                case Chosen():
                    known = self.after[inner.place]
                    if any(option not in known and option not in ("present", "absent") for option in inner.options):
                        return True
                case Name(path) if "." in path or path in self.before:
                    place = path if path in self.before else (split_path(path, self.before) or ("", ""))[0]
                    if place not in self.after:
                        return True
                case Call(function, (first, *_)) if is_rollup(function, first):
                    if self.is_empty(inner):
                        return True
                case Name(path) if path in self.units and path not in self.stated:
                    return True
        return False

    def is_empty(self, node: Call) -> bool:
        """Whether a roll-up has nothing left to run over."""
        names = [argument.path for argument in node.arguments if isinstance(argument, Name)]
        place = names[1] if len(names) > 1 else ""
        return not any(
            component and names[0] in component.properties
            for path, named in self.after.items()
            if not place or path == place or path.startswith(f"{place}.")
            for component in named.values()
        )

    def condition(self, node: Node, sense: bool) -> Node:
        """*node* without what is gone, where an undefined value counts as *sense*."""
        if not self.is_touched(node):
            return node
        match node:
            case Chosen():
                return self.chosen(node)
            case Unary("not"):
                return _negated(self.condition(node.operand, not sense))
            case Binary("and" | "or" as operator):
                return _joined(operator, self.condition(node.left, sense), self.condition(node.right, sense))
            case Binary("implies"):
                return _implied(self.condition(node.left, not sense), self.condition(node.right, sense))
            case Binary("iff", left, right, span):
                sides = Binary("implies", left, right, span), Binary("implies", right, left, span)
                return self.condition(Binary("and", *sides, span), sense)
            case Binary("xor", left, right, span):
                return self.condition(Unary("not", Binary("iff", left, right, span), span), sense)
            case Conditional():
                yes, no = self.condition(node.yes, sense), self.condition(node.no, sense)
                return self.cases([(((node.condition, True),), yes), (((node.condition, False),), no)], sense)
            case Binary(operator, left, right, span):
                cases = [
                    (guards, Binary(operator, pair[0], pair[1], span) if pair else Truth(sense, span))
                    for guards, pair in self.together((left, right))
                ]
                return self.cases(cases, sense)
            case Between(value, low, high, span):
                # As told in `dse.space.language.evaluate`, one half may fail where the other is undefined.
                halves = Binary("<=", low, value, span), Binary("<=", value, high, span)
                return self.condition(Binary("and", *halves, span), sense)
            case Call("same_choice"):
                # One of its places is gone, so that all of them have to be absent.
                found: Node = Truth(True, node.span)
                for name in node.arguments:
                    if isinstance(name, Name) and name.path in self.after:
                        found = _joined("and", found, Chosen(name.path, ("absent",), node.span))
                return found
            case Call(function, (Number() as number, *conditions)):
                return self.counted(function, int(number.si), conditions, sense, node)
        return node

    def chosen(self, node: Chosen) -> Node:
        known = self.after.get(node.place)
        if known is None:
            return Truth("absent" in node.options, node.span)
        left = tuple(option for option in node.options if option in known or option in ("present", "absent"))
        return replace(node, options=left, spans=()) if left else Truth(False, node.span)

    def cases(self, cases: Sequence[tuple[_Guards, Node]], sense: bool) -> Node:
        """That the condition of the case holds whose guards do."""
        found: Node | None = None
        for guards, value in cases:
            here = value
            for guard, wanted in reversed(guards):
                # A guard that is undefined must not decide: in either sense, it is as false as it can be.
                test = self.condition(guard, False) if wanted else _negated(self.condition(guard, True))
                here = _implied(test, here) if sense else _joined("and", test, here)
            found = here if found is None else _joined("and" if sense else "or", found, here)
        assert found is not None  # noqa: S101  # a value has one case at least
        return found

    def together(self, values: tuple[Node, ...]) -> Iterator[tuple[_Guards, tuple[Node, ...]]]:
        """The cases of several numbers; empty where one of them is undefined."""
        for combination in product(*(list(self.number(value)) for value in values)):
            numbers = tuple(number for _, number in combination if number is not None)
            guards = tuple(guard for some, _ in combination for guard in some)
            yield guards, numbers if len(numbers) == len(values) else ()

    def number(self, node: Node) -> Iterator[tuple[_Guards, Node | None]]:
        """The cases of a number; None where it is undefined."""
        if not self.is_touched(node):
            yield (), node
            return
        match node:
            case Name(path) if "." not in path:
                yield (), Number(Fraction(0), self.units[path], node.span)
            case Name():
                yield (), None
            case Call(function, (first, *_)) if is_rollup(function, first):
                yield (), self.of_nothing(node)
            case Conditional():
                for truth, branch in ((True, node.yes), (False, node.no)):
                    yield from ((((node.condition, truth), *guards), value) for guards, value in self.number(branch))
            case _:
                for guards, values in self.together(children(node)):
                    yield guards, _with(node, values) if values else None

    def of_nothing(self, node: Call) -> Node | None:
        if not self.is_empty(node):
            return node
        first = node.arguments[0]
        if node.function == "sum" and isinstance(first, Name):
            return Number(Fraction(0), self.units[first.path], node.span)
        if node.function in ("count", "product"):
            return Number(Fraction(int(node.function == "product")), DIMENSIONLESS, node.span)
        return None

    def counted(self, function: str, wanted: int, conditions: list[Node], sense: bool, node: Call) -> Node:
        if function == "exactly":
            low = self.counted("at_least", wanted, conditions, sense, node)
            return _joined("and", low, self.counted("at_most", wanted, conditions, sense, node))
        own = sense if function == "at_least" else not sense
        open_: list[Node] = []
        for condition in conditions:
            left = self.condition(condition, own)
            if isinstance(left, Truth):
                wanted -= left.value
            else:
                open_.append(left)
        if function == "at_least" and not 0 < wanted <= len(open_):
            return Truth(wanted <= 0, node.span)
        if function == "at_most" and not 0 <= wanted < len(open_):
            return Truth(wanted >= 0, node.span)
        number = Number(Fraction(wanted), DIMENSIONLESS, node.span)
        return Call(function, (number, *open_), (), node.span)


def _units(standing: _Components) -> dict[str, Unit]:
    return {
        name: quantity.unit
        for named in standing.values()
        for component in named.values()
        if component
        for name, quantity in component.properties.items()
    }


def _with(node: Node, values: tuple[Node, ...]) -> Node:
    match node:
        case Unary():
            return replace(node, operand=values[0])
        case Binary():
            return replace(node, left=values[0], right=values[1])
        case Call():
            return replace(node, arguments=values)
    return node


def _negated(node: Node) -> Node:
    match node:
        case Truth():
            return Truth(not node.value, node.span)
        case Unary("not"):
            return node.operand
    return Unary("not", node, node.span)


def _implied(left: Node, right: Node) -> Node:
    if isinstance(left, Truth) or isinstance(right, Truth):
        return _joined("or", _negated(left), right)
    return Binary("implies", left, right, left.span)


def _joined(operator: str, left: Node, right: Node) -> Node:
    """``left and right`` or ``left or right``, without what is plainly true or false."""
    for side, other in ((left, right), (right, left)):
        if isinstance(side, Truth):
            return side if side.value is (operator == "or") else other
    return Binary(operator, left, right, left.span)
