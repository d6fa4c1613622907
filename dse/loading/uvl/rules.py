"""Writes expressions as constraints of UVL.

An undefined value, that of a property of an absent part, has no like in UVL. It is settled before: a comparison
that needs it holds where it could only make the constraint hold, which is what a constraint whose outcome is
undefined does. Where that cannot be told, as below ``iff``, the constraint is refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from itertools import combinations, pairwise
from math import comb

from dse.domain.expression import (
    ROLLUPS,
    Between,
    Binary,
    Call,
    Chosen,
    Conditional,
    Expression,
    Name,
    Node,
    Number,
    Truth,
    Unary,
)
from dse.errors import DseError
from dse.expression import children, decimal, error_in
from dse.loading.uvl.outline import Outline, Outlined

MOST_COMBINATIONS = 1000
"""Terms a count of conditions may be written out in."""

Text = tuple[str, int]
"""Text and how strongly it holds together: 1 ``<=>`` … 9 a single thing, as in `dse.loading.uvl.constraints`."""

_MOST_FACTORS = 9
_EQUIVALENT, _IMPLIES, _OR, _AND, _NOT, _COMPARE, _SUM, _PRODUCT, _ATOM = range(1, 10)
_STRENGTH = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT}
_COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_WORDS = frozenset({
    "include", "features", "imports", "namespace", "as", "constraint", "constraints", "cardinality", "String",
    "Boolean", "Integer", "Real", "len", "sum", "avg", "floor", "ceil", "Type", "Arithmetic", "or", "alternative",
    "optional", "mandatory", "true", "false",
})  # fmt: skip


def quoted(name: str) -> str:
    """A name as UVL writes it: in quotes if it is one of its words or has other signs than letters, digits and _."""
    return name if _PLAIN.fullmatch(name) and name not in _WORDS else f'"{name}"'


def write_rule(expression: Expression, outlined: Outlined, factors: Mapping[str, Fraction]) -> str:
    """*expression* as a constraint over the features of *outlined*. Raises DseError for what UVL cannot say.

    *factors* is what one stands for in SI, by the name of the property.
    """
    return _Writer(expression, outlined, factors).condition(expression.root, True)[0]


class _Writer:
    """*sense* is the truth an undefined comparison counts as; None where it must not be undefined."""

    def __init__(self, expression: Expression, outlined: Outlined, factors: Mapping[str, Fraction]) -> None:
        self.expression = expression
        self.outlined = outlined
        self.root = outlined.root
        self.factors = factors

    def condition(self, node: Node, sense: bool | None) -> Text:
        opposite = None if sense is None else not sense
        match node:
            case Truth():
                return self.truth(node.value)
            case Chosen():
                return self.chosen(node)
            case Unary("not"):
                return _negated(self.condition(node.operand, opposite))
            case Binary("and" | "or" as operator):
                sides = [self.condition(side, sense) for side in (node.left, node.right)]
                return _joined("&", sides) if operator == "and" else _joined("|", sides)
            case Binary("implies"):
                return _implied(self.condition(node.left, opposite), self.condition(node.right, sense))
            case Binary("iff" | "xor" as operator):
                sides = [self.condition(side, None) for side in (node.left, node.right)]
                same = " <=> ".join(_within(side, _IMPLIES) for side in sides), _EQUIVALENT
                return same if operator == "iff" else _negated(same)
            case Binary(operator) if operator in _COMPARISONS:
                return self.comparison(node, sense)
            case Between(value, low, high, span):
                # One half may fail where the other is undefined.
                halves = Binary("<=", low, value, span), Binary("<=", value, high, span)
                return _joined("&", [self.comparison(half, sense) for half in halves])
            case Conditional():
                condition = self.condition(node.condition, None)
                yes, no = (self.condition(side, sense) for side in (node.yes, node.no))
                return _joined("&", [_implied(condition, yes), _joined("|", [condition, no])])
            case Call("at_least" | "at_most" | "exactly"):
                return self.counted(node)
            case Call("same_choice"):
                return self.same_choice(node)
        raise self.refused(node, "this")

    def comparison(self, node: Binary, sense: bool | None) -> Text:
        values = node.left, node.right
        left, right = (_within(self.number(value), _SUM) for value in values)
        text = f"{left} {node.operator} {right}", _COMPARE
        for there in self.needed(values):
            if there is None:
                continue
            if sense is None:
                raise self.refused(node, "a comparison that can be undefined, below iff, xor or if,")
            text = _implied(there, text) if sense else _joined("&", [there, text])
        return text

    def needed(self, values: Iterable[Node]) -> Iterable[Text | None]:
        """What must be there so that *values* are defined; None is always there."""
        stack = list(values)
        while stack:
            node = stack.pop()
            match node:
                case Name(path) if "." in path:
                    yield self.some(feature for _, feature in self.stating(node))
                case Call("mean", arguments):
                    names = [argument.path for argument in arguments if isinstance(argument, Name)]
                    tops = self.averaged(node, names[1]) if names[1:] else [self.root]
                    yield self.some(f for f in tops[0].below() if f.component and names[0] in f.component.properties)
                case Call() if node.function in ROLLUPS:
                    continue
                case _:
                    stack += children(node)

    def number(self, node: Node) -> Text:
        match node:
            case Number():
                text = decimal(node.si)
                if text is None:
                    return f"{node.si.numerator} / {node.si.denominator}", _PRODUCT
                return text, _SUM if node.si < 0 else _ATOM
            case Unary("-"):
                return f"0 - {_within(self.number(node.operand), _PRODUCT)}", _SUM
            case Binary("+" | "-" | "*" | "/" as operator):
                own = _STRENGTH[operator]
                left, right = self.number(node.left), self.number(node.right)
                return f"{_within(left, own)} {operator} {_within(right, own + 1)}", own
            case Binary("^", base, Number() as exponent) if exponent.si in range(1, _MOST_FACTORS):
                return " * ".join([_within(self.number(base), _ATOM)] * int(exponent.si)), _PRODUCT
            case Name() if "." in node.path:
                name = node.path.rpartition(".")[2]
                return self.scaled(name, [f"{quoted(f.name)}.{quoted(name)}" for _, f in self.stating(node)])
            case Name():
                return self.rolled_up("sum", node, node.path, "")
            case Call("sum" | "mean" as function, (Name(name), *rest)):
                return self.rolled_up(function, node, name, rest[0].path if rest and isinstance(rest[0], Name) else "")
            case Call("floor", (operand,)):
                return f"floor({self.number(operand)[0]})", _ATOM
            case Conditional(Chosen() as chosen, yes, Number() as no) if no.si == 0:
                return self.owned(node, chosen, yes)
        raise self.refused(node, f"'{node.function}'" if isinstance(node, Call) else "this")

    def rolled_up(self, function: str, node: Node, name: str, place: str) -> Text:
        if name not in self.factors:
            raise self.refused(node, f"'{name}', which no component states,")
        word, attribute = ("sum" if function == "sum" else "avg"), quoted(name)
        if not place:
            return self.scaled(name, [f"{word}({attribute})"])
        if place in self.outlined.own:
            return self.scaled(name, [f"{quoted(self.outlined.tops[place][0].name)}.{attribute}"])
        features = self.averaged(node, place) if function == "mean" else self.outlined.tops.get(place, [])
        stating = [feature for feature in features if _states(feature, name)]
        return self.scaled(name, [f"{word}({attribute}, {quoted(feature.name)})" for feature in stating])

    def scaled(self, name: str, terms: list[str]) -> Text:
        """The sum of *terms*, which are values of the property *name*, in SI."""
        if not terms:
            return "0", _ATOM
        total = " + ".join(terms), _SUM if len(terms) > 1 else _ATOM
        factor = self.factors[name]
        if factor == 1:
            return total
        return f"{_within(total, _PRODUCT)} * {factor.numerator} / {factor.denominator}", _PRODUCT

    def averaged(self, node: Node, place: str) -> list[Outline]:
        """The one feature below which all of *place* is, so that UVL can name what is averaged."""
        features = self.outlined.tops.get(place, [])
        if len(features) != 1 or place in self.outlined.own:
            raise self.refused(node, f"an average over '{place}', which several features share,")
        return features

    def stating(self, node: Name) -> list[tuple[str, Outline]]:
        """The features that state ``place.property``."""
        place, _, name = node.path.rpartition(".")
        found = [
            (name, feature)
            for _, feature in self.outlined.standing.get(place, [])
            if feature.component and name in feature.component.properties
        ]
        if not found:
            raise self.refused(node, f"'{node.path}', which is not a property,")
        return found

    def owned(self, node: Node, chosen: Chosen, yes: Node) -> Text:
        """``if place is x then c else 0`` where c is a number that x states."""
        sign = -1 if isinstance(yes, Unary) and yes.operator == "-" else 1
        value = yes.operand if isinstance(yes, Unary) else yes
        features = self.features(chosen)
        if isinstance(value, Number) and len(features) == 1 and features[0].component:
            for name, stated in features[0].component.properties.items():
                if stated.si == sign * value.si and name in self.factors:
                    return self.scaled(name, [f"{quoted(features[0].name)}.{quoted(name)}"])
        raise self.refused(node, "a number that depends on a condition")

    def chosen(self, node: Chosen) -> Text:
        named = self.some(self.features(node))
        if "absent" not in node.options:
            return named or self.truth(True)
        present = self.some(feature for _, feature in self.outlined.standing[node.place])
        absent = _negated(present) if present else self.truth(False)
        return _joined("|", [named or self.truth(True), absent]) if self.features(node) else absent

    def features(self, node: Chosen) -> list[Outline]:
        """The features that stand for one of the options of *node*."""
        if node.place not in self.outlined.standing:
            raise self.refused(node, f"'{node.place}', which is not a place,")
        standing = self.outlined.standing[node.place]
        return [feature for choice, feature in standing if "present" in node.options or choice in node.options]

    def counted(self, node: Call) -> Text:
        number, *conditions = node.arguments
        if not isinstance(number, Number) or number.si.denominator != 1:
            raise self.refused(number, "a count that is not a whole number")
        wanted, texts = int(number.si), [self.condition(condition, None) for condition in conditions]
        sides = []
        if node.function != "at_most":
            sides.append(self.at_least(node, wanted, texts))
        if node.function != "at_least":
            sides.append(_negated(self.at_least(node, wanted + 1, texts)))
        return _joined("&", sides)

    def at_least(self, node: Call, wanted: int, texts: list[Text]) -> Text:
        if wanted <= 0 or wanted > len(texts):
            return self.truth(wanted <= 0)
        if comb(len(texts), wanted) > MOST_COMBINATIONS:
            raise self.refused(node, f"{wanted} of {len(texts)} conditions, which takes too many terms to write out,")
        return _joined("|", [_joined("&", list(some)) for some in combinations(texts, wanted)])

    def same_choice(self, node: Call) -> Text:
        pairs = []
        for left, right in pairwise(node.arguments):
            if not isinstance(left, Name) or not isinstance(right, Name):
                raise self.refused(node, "'same_choice'")
            choices = [*dict.fromkeys(name for name, _ in self.outlined.standing.get(left.path, [])), "absent"]
            sides = [[self.chosen(Chosen(name.path, (each,), name.span)) for each in choices] for name in (left, right)]
            pairs += [_implied(*both) for both in zip(*sides, strict=True) if both[0] != self.truth(False)]
        return _joined("&", pairs)

    def some(self, features: Iterable[Outline]) -> Text | None:
        """One of *features* is there; None if one always is."""
        found = list(features)
        if any(feature.always for feature in found):
            return None
        return _joined("|", [(quoted(feature.name), _ATOM) for feature in found]) if found else self.truth(False)

    def truth(self, value: bool) -> Text:
        text = quoted(self.root.name), _ATOM
        return text if value else _negated(text)

    def refused(self, node: Node, what: str) -> DseError:
        advice = "leave the constraint out of the exported design or write it otherwise"
        return error_in(self.expression, node.span, f"UVL cannot express {what} in a constraint", advice)


def _states(feature: Outline, name: str) -> bool:
    return any(inner.component and name in inner.component.properties for inner in feature.below())


def _joined(operator: str, sides: list[Text]) -> Text:
    if len(sides) == 1:
        return sides[0]
    own = _AND if operator == "&" else _OR
    return f" {operator} ".join(_within(side, own) for side in sides), own


def _implied(left: Text, right: Text) -> Text:
    return f"{_within(left, _OR)} => {_within(right, _OR)}", _IMPLIES


def _negated(text: Text) -> Text:
    # Some readers bind ! more weakly than a comparison, some do not.
    return f"!{_within(text, _ATOM)}", _NOT


def _within(text: Text, least: int) -> str:
    return text[0] if text[1] >= least else f"({text[0]})"
