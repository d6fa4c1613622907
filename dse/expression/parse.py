"""Reads the expressions of constraints, metrics and conditions. Nothing is evaluated here.

From weakest to strongest::

    if c then a else b            the else reaches as far as it can
    iff
    implies                       from the right
    or
    xor
    and
    not
    < <= > >= == !=   x between a and b   place is component   place in [a, b]      do not chain
    + -
    * /
    -x
    ^                             from the right

``is``, ``in`` and ``between`` take a ``not``: ``place is not x``, ``place not in [x, y]``. ``place is absent``
and ``place is present`` ask for an optional part; they are Chosen with the option ``absent`` or ``present``.
How a unit is told from what follows: `dse.expression.tokens`.
"""

from __future__ import annotations

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
    Origin,
    Span,
    Truth,
    Unary,
)
from dse.errors import DseError
from dse.expression.tokens import ASSOCIATIVE, FROM_THE_RIGHT, STRENGTH, Token, TokenKind, error_at, tokenize
from dse.expression.tree import DEEPEST, balanced, too_deep


def parse_expression(text: str, where: Origin = None) -> Expression:
    """The expression written in *text*, which stands at *where*.

    Raises DseError at the exact character, with the line and a caret in its hint; at the start of a text of several
    lines of which no more is known.
    """
    parser = _Parser(text, where)
    root = parser.whole()
    deep = too_deep(root)
    if deep is not None:
        raise error_at(text, deep.span, f"more than {DEEPEST} levels deep", where, "group with brackets, or split it")
    if isinstance(where, tuple):
        return Expression(text, root, where[0].where, where)
    return Expression(text, root, where)


_NESTING = 100
_INFIX = {**STRENGTH, "not": STRENGTH["in"]}
"""Between two values ``not`` belongs to the ``in`` or ``between`` behind it."""
_LONG = DEEPEST // 2
"""Terms beyond which a chain of an associative operator is read as a tree of few levels, not from the left."""


class _Parser:
    """Precedence climbing over the tokens (V. Pratt, Top down operator precedence, 1973)."""

    def __init__(self, text: str, where: Origin) -> None:
        self.text = text
        self.where = where
        self.tokens = tokenize(text, where)
        self.index = 0
        self.nesting = 0

    def whole(self) -> Node:
        if self.peek().kind is TokenKind.END:
            raise self.error("the expression is empty", self.peek().span, "write a condition or a value")
        node = self.expression(0)
        if self.peek().kind is not TokenKind.END:
            raise self.unexpected("an operator or the end")
        return node

    def expression(self, weakest: int) -> Node:
        self.nesting += 1
        if self.nesting > _NESTING:
            raise self.error(f"more than {_NESTING} levels deep", self.peek().span, "split it")
        start = self.peek().span[0]
        left = self.operand()
        compared = False
        while self.peek().kind in (TokenKind.SYMBOL, TokenKind.KEYWORD):
            binding = _INFIX.get(self.peek().text, -1)
            if binding < max(weakest, 1):
                break
            if binding == STRENGTH["=="]:
                if compared:
                    raise self.error("comparisons do not chain", self.peek().span, "write a < b and b < c")
                compared = True
                left = self.comparison(left, start)
                continue
            end = self.since(start)[1]
            operator = self.take().text
            if operator in ASSOCIATIVE:
                left = self.chain(operator, (left, (start, end)), binding)
                continue
            right = self.expression(binding if operator in FROM_THE_RIGHT else binding + 1)
            left = Binary(operator, left, right, self.since(start))
        self.nesting -= 1
        return left

    def chain(self, operator: str, first: tuple[Node, Span], binding: int) -> Node:
        """*first* and what follows with the same associative operator, of which one is taken already."""
        terms = [first]
        while True:
            start = self.peek().span[0]
            terms.append((self.expression(binding + 1), self.since(start)))
            if not self.is_next(operator):
                break
            self.take()
        if len(terms) > _LONG:
            return balanced(operator, terms)
        node, span = terms[0]
        for right, (_, end) in terms[1:]:
            node = Binary(operator, node, right, (span[0], end))
        return node

    def operand(self) -> Node:
        token = self.take()
        start = token.span[0]
        match token.kind, token.text:
            case TokenKind.NUMBER, _:
                return _number(token, 1, token.span)
            case TokenKind.KEYWORD, "true" | "false":
                return Truth(token.text == "true", token.span)
            case TokenKind.NAME, _:
                return self.call(token) if self.is_next("(") else Name(token.text, token.span)
            case TokenKind.SYMBOL, "(":
                node = self.expression(0)
                self.close(")", token)
                return node
            case TokenKind.SYMBOL, "-":
                if self.peek().kind is TokenKind.NUMBER and self.peek().unit.offset:
                    # -5 °C is a temperature below zero, not the opposite of one above.
                    number = self.take()
                    return _number(number, -1, (start, number.span[1]))
                return Unary("-", self.expression(STRENGTH["negative"]), self.since(start))
            case TokenKind.KEYWORD, "not":
                return Unary("not", self.expression(STRENGTH["not"]), self.since(start))
            case TokenKind.KEYWORD, "if":
                condition = self.expression(0)
                self.expect("then", "if condition then a else b")
                yes = self.expression(0)
                self.expect("else", "if condition then a else b")
                return Conditional(condition, yes, self.expression(0), self.since(start))
        self.index -= 1
        raise self.unexpected("a value")

    def call(self, name: Token) -> Node:
        if "." in name.text:
            raise self.error(f"'{name.text}' is not a function", name.span, "functions have no dot in their name")
        bracket = self.take()
        arguments: list[Node] = []
        options: dict[str, Node] = {}
        while not self.is_next(")"):
            if arguments or options:
                if not self.is_next(","):
                    self.close(")", bracket)
                self.take()
            option = self.peek()
            if option.kind is TokenKind.NAME and self.tokens[self.index + 1].text == "=":
                if option.text in options:
                    raise self.error(f"'{option.text}' is given twice", option.span, "remove one")
                self.index += 2
                options[option.text] = self.expression(0)
            elif options:
                raise self.error("a plain argument after a named one", option.span, "put it first")
            else:
                arguments.append(self.expression(0))
        self.take()
        return Call(name.text, tuple(arguments), tuple(options.items()), self.since(name.span[0]))

    def comparison(self, left: Node, start: int) -> Node:
        operator = self.take()
        negative = False
        match operator.text:
            case "=":
                advice = "write == to compare"
                if isinstance(left, Name) and self.peek().kind is TokenKind.NAME:
                    advice = f"write {left.path} is {self.peek().text} for what is chosen, == to compare values"
                raise self.error("'=' gives an option of a function", operator.span, advice)
            case "not":
                if self.peek().text not in ("in", "between"):
                    raise self.error("'not' is between two values", operator.span, "write and not, or not in")
                positive = self.comparison(left, start)
                return Unary("not", positive, positive.span)
            case "between":
                low = self.expression(STRENGTH["+"])
                self.expect("and", "x between low and high")
                return Between(left, low, self.expression(STRENGTH["+"]), self.since(start))
            case "is":
                negative = self.is_next("not") and bool(self.take())
                options: tuple[Token, ...] = (self.option(),)
            case "in":
                options = self.options()
            case _:
                return Binary(operator.text, left, self.expression(STRENGTH["+"]), self.since(start))
        if not isinstance(left, Name):
            raise self.error(f"'{operator.text}' needs a place on its left", left.span, "write place is component")
        spans = (left.span, *(option.span for option in options))
        chosen = Chosen(left.path, tuple(option.text for option in options), self.since(start), spans)
        return Unary("not", chosen, chosen.span) if negative else chosen

    def options(self) -> tuple[Token, ...]:
        bracket = self.peek()
        self.expect("[", "place in [a, b]")
        options = [self.option()]
        while self.is_next(","):
            self.take()
            options.append(self.option())
        self.close("]", bracket)
        return tuple(options)

    def option(self) -> Token:
        token = self.peek()
        if token.kind is not TokenKind.NAME or "." in token.text:
            raise self.error(f"expected a component's name, found {token}", token.span, "write place is component")
        return self.take()

    def peek(self) -> Token:
        return self.tokens[self.index]

    def take(self) -> Token:
        token = self.tokens[self.index]
        # The end stays, so that a step back from an unexpected token is always one step.
        self.index += 1
        if token.kind is TokenKind.END:
            self.tokens.append(token)
        return token

    def is_next(self, text: str) -> bool:
        return self.peek().text == text and self.peek().kind in (TokenKind.SYMBOL, TokenKind.KEYWORD)

    def expect(self, text: str, form: str) -> None:
        if not self.is_next(text):
            raise self.error(f"expected '{text}', found {self.peek()}", self.peek().span, f"the form is: {form}")
        self.take()

    def close(self, text: str, opening: Token) -> None:
        if self.is_next(text):
            self.take()
        elif self.peek().kind is TokenKind.END:
            raise self.error(f"'{opening.text}' is never closed", opening.span, f"add '{text}'")
        else:
            raise self.unexpected(f"an operator or '{text}'")

    def since(self, start: int) -> Span:
        return start, self.tokens[self.index - 1].span[1]

    def unexpected(self, expected: str) -> DseError:
        found = self.peek()
        before, after = self.tokens[self.index - 1 : self.index], self.tokens[self.index + 1 : self.index + 2]
        if found.text == "," and [token.kind for token in (*before, *after)] == [TokenKind.NUMBER] * 2:
            number = f"{self.text[before[0].span[0] : found.span[0]]}.{self.text[after[0].span[0] : after[0].span[1]]}"
            return self.error("a number has a decimal point, no comma", found.span, f"write {number}")
        return self.error(
            f"expected {expected}, found {self.peek()}", self.peek().span, "something is missing before it"
        )

    def error(self, what: str, span: Span, advice: str) -> DseError:
        return error_at(self.text, span, what, self.where, advice)


def _number(token: Token, sign: int, span: Span) -> Number:
    return Number(sign * token.value * token.unit.factor + token.unit.offset, token.unit, span)
