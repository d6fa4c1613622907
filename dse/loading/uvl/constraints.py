"""Reads the constraints of a UVL file into expressions over the places of the design space.

From weakest to strongest, as in the reference grammar; operators of one strength go from the left::

    <=>
    =>
    |
    &
    !
    == != < > <= >=      do not chain
    + -
    * /

A feature is a condition: it is there. ``Feature.attribute`` is a number: 0 when the feature is not there, as in
``sum(attribute)`` and ``sum(attribute, Feature)``, which run over the features that are there. ``avg`` of nothing
at all is undefined, and a constraint that needs it holds.
"""

from __future__ import annotations

from fractions import Fraction

from dse.domain.expression import Binary, Call, Chosen, Conditional, Expression, Name, Node, Number, Span, Truth, Unary
from dse.errors import closest
from dse.expression import DEEPEST, balanced, too_deep
from dse.loading.uvl.cursor import Cursor, number
from dse.loading.uvl.space import Spot, Translation
from dse.loading.uvl.tokens import Source, Token
from dse.units import DIMENSIONLESS

_NESTING = 50
_BINDING = {"<=>": 1, "=>": 2, "|": 3, "&": 4, "+": 7, "-": 7, "*": 8, "/": 8}
_BINDING |= dict.fromkeys(("==", "!=", "<", ">", "<=", ">="), 6)
_COMPARE, _SIGN = 6, 9
_LOGIC = {"<=>": "iff", "=>": "implies", "|": "or", "&": "and"}
_FUNCTIONS = ("sum", "avg", "floor", "ceil", "len")


def read_constraint(source: Source, tokens: list[Token], model: Translation) -> Expression:
    """The constraint that *tokens* spell. Raises DseError at the token that is not understood."""
    start, end = tokens[0].start, tokens[-1].end
    reader = _Reader(source, tokens, model)
    root = reader.condition(0)
    if reader.peek().kind != "end":
        raise reader.unexpected("an operator or the end of the line")
    if too_deep(root):
        raise source.error(start, f"more than {DEEPEST} levels deep", "split the constraint")
    return Expression(source.text[start:end], root, source.location(start))


def presence(spot: Spot, span: Span) -> Node:
    """The condition that a feature is there."""
    if not spot.path:
        return Truth(True, span)
    return Chosen(spot.path, (spot.choice or "present",), span)


def chained(operator: str, operands: list[Node], span: Span) -> Node:
    """``a and b and c …`` of an associative *operator*, all of which stands at *span*, as a tree of few levels."""
    return balanced(operator, [(operand, span) for operand in operands])


class _Reader(Cursor):
    """Precedence climbing over the tokens (V. Pratt, Top down operator precedence, 1973)."""

    def __init__(self, source: Source, tokens: list[Token], model: Translation) -> None:
        super().__init__(source, tokens)
        self.model = model
        self.base = tokens[0].start
        self.nesting = 0

    def condition(self, weakest: int) -> Node:
        token = self.peek()
        node = self.expression(weakest)
        if not _is_truth(node):
            raise self.source.error(token.start, "expected a condition, found a number", "compare it: … <= 10")
        return node

    def expression(self, weakest: int) -> Node:
        self.nesting += 1
        if self.nesting > _NESTING:
            raise self.source.error(self.peek().start, f"more than {_NESTING} levels deep", "split the constraint")
        first = self.peek()
        left = self.operand()
        compared = False
        while self.peek().kind == "symbol":
            operator = self.peek()
            binding = _BINDING.get(operator.text, -1)
            if binding < max(weakest, 1):
                break
            if binding == _COMPARE and compared:
                raise self.source.error(operator.start, "comparisons do not chain", "write a < b & b < c")
            compared = binding == _COMPARE
            operands, operators = [left], []
            self.require(left, operator, first)
            while self.peek().kind == "symbol" and _BINDING.get(self.peek().text) == binding:
                operators.append(self.take().text)
                first = self.peek()
                operands.append(self.expression(binding + 1))
                self.require(operands[-1], operator, first)
                if binding == _COMPARE:
                    break
            left = _joined(operators, operands, self.since(left))
        self.nesting -= 1
        return left

    def operand(self) -> Node:
        token = self.peek()
        span = self.span(token)
        if token.kind == "number":
            value = number(self)
            return Number(value.si, DIMENSIONLESS, span)
        if token.kind == "name" and token.text in _FUNCTIONS and self.tokens[self.index + 1].text == "(":
            return self.function()
        if token.kind == "name" and token.text in ("true", "false"):
            self.take()
            return Truth(token.text == "true", span)
        if token.kind in ("name", "quoted"):
            return self.reference()
        if token.kind == "text":
            raise self.source.error(token.start, "constraints on texts are not supported", "compare numbers")
        if self.is_next("("):
            self.take()
            node = self.expression(0)
            if not self.is_next(")"):
                raise self.unexpected("an operator or ')'")
            self.take()
            return node
        if self.is_next("!"):
            self.take()
            return Unary("not", self.condition(_COMPARE), (span[0], self.last()))
        if self.is_next("-"):
            self.take()
            first = self.peek()
            node = self.expression(_SIGN)
            self.require(node, token, first)
            return Unary("-", node, (span[0], self.last()))
        raise self.unexpected("a feature, a number or '('")

    def reference(self) -> Node:
        first = self.take()
        spot = self.spot(first)
        if not self.is_next("."):
            return presence(spot, self.span(first))
        words = []
        while self.is_next("."):
            self.take()
            words.append(self.name("an attribute's name").text)
        key = ".".join(words)
        feature = spot.feature
        if key not in feature.numbers:
            if key in feature.others:
                what = f"'{feature.name}.{key}' is {feature.others[key]}, and constraints take numbers"
                raise self.source.error(first.start, what, "compare numbers")
            advice = closest(key, feature.numbers) or f"add it: {feature.name} {{{key} 1}}"
            raise self.source.error(first.start, f"feature '{feature.name}' has no attribute '{key}'", advice)
        return self.value(spot, self.model.properties[key], (first.start - self.base, self.last()))

    def value(self, spot: Spot, name: str, span: Span) -> Node:
        """The feature's own number, 0 when it is not there."""
        if spot.choice and spot.itself == spot.path:
            # Other features of the group stand at the same place, so that a sum there would count them, too.
            stated = spot.numbers[name].si
            size = Number(abs(stated), DIMENSIONLESS, span)
            own = size if stated >= 0 else Unary("-", size, span)
            return Conditional(presence(spot, span), own, Number(Fraction(0), DIMENSIONLESS, span), span)
        return _rollup("sum", name, spot.itself, span)

    def function(self) -> Node:
        word = self.take()
        self.take()
        if word.text == "len":
            raise self.source.error(word.start, "'len' is not supported: constraints take numbers", "compare numbers")
        if word.text in ("floor", "ceil"):
            first = self.peek()
            inner = self.expression(0)
            self.require(inner, word, first)
            self.expect(")")
            span = (word.start - self.base, self.last())
            if word.text == "floor":
                return Call("floor", (inner,), (), span)
            return Unary("-", Call("floor", (Unary("-", inner, span),), (), span), span)
        attribute = self.name("an attribute's name")
        key = attribute.text
        while self.is_next("."):
            self.take()
            key += "." + self.name("an attribute's name").text
        spot: Spot | None = None
        if self.is_next(","):
            self.take()
            spot = self.spot(self.name("a feature's name"))
            if not spot.path:
                spot = None
        self.expect(")")
        if key not in self.model.properties:
            advice = closest(key, self.model.properties) or f"write {word.text}(attribute) or give features numbers"
            raise self.source.error(attribute.start, f"no feature has a number called '{key}'", advice)
        name, span = self.model.properties[key], (word.start - self.base, self.last())
        if spot is None:
            return _rollup("sum" if word.text == "sum" else "mean", name, "", span)
        return self.below(word, key, spot, name, span)

    def below(self, word: Token, key: str, spot: Spot, name: str, span: Span) -> Node:
        """The roll-up *word* of a property over the feature *spot* and what is below it."""
        if name not in spot.inside:
            if word.text == "sum":
                return Number(Fraction(0), DIMENSIONLESS, span)
            what = f"neither '{spot.feature.name}' nor a feature below it has a number called '{key}'"
            raise self.source.error(word.start, what, "take another feature")
        if not spot.choice:
            return _rollup("sum" if word.text == "sum" else "mean", name, spot.path, span)
        if word.text == "avg":
            what = f"the average over '{spot.feature.name}', one feature of an alternative, is not supported"
            raise self.source.error(word.start, what, "take a feature above or below it")
        terms = [self.value(spot, name, span)] if name in spot.numbers else []
        paths = dict.fromkeys(child.path for child in spot.children if name in child.inside)
        terms += [_rollup("sum", name, path, span) for path in paths]
        return chained("+", terms, span)

    def spot(self, token: Token) -> Spot:
        spot = self.model.spots.get(token.text)
        if spot is None:
            advice = closest(token.text, self.model.spots)
            raise self.source.error(token.start, f"unknown feature '{token.text}'", advice)
        return spot

    def require(self, node: Node, operator: Token, first: Token) -> None:
        """Raise DseError unless *node*, which starts at *first*, is what *operator* takes."""
        wants_truth = operator.text in _LOGIC
        if _is_truth(node) == wants_truth:
            return
        if wants_truth:
            what, advice = f"'{operator.text}' joins conditions, and this is a number", "compare it: … <= 10"
        elif isinstance(node, Chosen) and first.kind in ("name", "quoted"):
            what = f"'{operator.text}' takes numbers, and '{first.text}' is a feature"
            advice = f"write {first.text}.attribute, or join features with & | => <=>"
        else:
            what, advice = (
                f"'{operator.text}' takes numbers, and this is a condition",
                "join conditions with & | => <=>",
            )
        raise self.source.error(first.start, what, advice)

    def span(self, token: Token) -> Span:
        return token.start - self.base, token.end - self.base

    def last(self) -> int:
        return self.tokens[self.index - 1].end - self.base

    def since(self, node: Node) -> Span:
        return node.span[0], self.last()


def _joined(operators: list[str], operands: list[Node], span: Span) -> Node:
    if operators[0] in ("&", "|"):
        return chained(_LOGIC[operators[0]], operands, span)
    if operators[0] in ("+", "-"):
        # Exact numbers may be added in any order.
        signs = ["+", *operators]
        more = [operand for sign, operand in zip(signs, operands, strict=True) if sign == "+"]
        less = [operand for sign, operand in zip(signs, operands, strict=True) if sign == "-"]
        total = chained("+", more, span)
        return Binary("-", total, chained("+", less, span), span) if less else total
    node = operands[0]
    for operator, operand in zip(operators, operands[1:], strict=True):
        node = Binary(_LOGIC.get(operator, operator), node, operand, span)
    return node


def _rollup(function: str, name: str, place: str, span: Span) -> Node:
    arguments: tuple[Node, ...] = (Name(name, span), Name(place, span)) if place else (Name(name, span),)
    return Call(function, arguments, (), span)


def _is_truth(node: Node) -> bool:
    match node:
        case Truth() | Chosen():
            return True
        case Unary():
            return node.operator == "not"
        case Binary():
            return node.operator in ("and", "or", "implies", "iff", "==", "!=", "<", ">", "<=", ">=")
    return False
