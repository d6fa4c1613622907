"""Goes through the tokens of one line of a UVL file."""

from __future__ import annotations

from fractions import Fraction

from dse.errors import DseError
from dse.loading.uvl.tokens import Source, Token
from dse.units import DIMENSIONLESS, LARGEST, Quantity


class Cursor:
    """The tokens of a line, one after the other; its errors stand at the token they are about."""

    def __init__(self, source: Source, tokens: list[Token]) -> None:
        last = tokens[-1].end
        self.source = source
        self.tokens = [*tokens, Token("end", "the end of the line", last, last)]
        self.index = 0

    def peek(self) -> Token:
        """The next token; one of kind end after the last."""
        return self.tokens[self.index]

    def take(self) -> Token:
        """The next token, and on to the one behind it."""
        token = self.tokens[self.index]
        if token.kind != "end":
            self.index += 1
        return token

    def is_next(self, text: str) -> bool:
        """Whether the next token is the symbol or word *text*."""
        token = self.tokens[self.index]
        return token.text == text and token.kind in ("symbol", "name")

    def expect(self, text: str) -> None:
        """Take the symbol *text*; raises DseError if something else is next."""
        if not self.is_next(text):
            raise self.unexpected(f"'{text}'")
        self.take()

    def name(self, expected: str) -> Token:
        """Take a name, quoted or not; raises DseError if something else is next."""
        token = self.peek()
        if token.kind not in ("name", "quoted"):
            raise self.unexpected(expected)
        return self.take()

    def end(self) -> None:
        """Raise DseError unless all tokens are taken."""
        if self.peek().kind != "end":
            raise self.unexpected("the end of the line")

    def unexpected(self, expected: str, advice: str = "") -> DseError:
        """What stands here is not what was *expected*."""
        token = self.peek()
        found = token.text if token.kind == "end" else token
        if token.kind in ("number", "text") and "name" in expected:
            advice = (
                f'a name with characters other than letters, digits and _ is written in double quotes: "{token.text}"'
            )
        return self.source.error(token.start, f"expected {expected}, found {found}", advice or "look here")


def number(reader: Cursor, *, negative: bool = False) -> Quantity:
    """Take a number, as a plain quantity. Raises DseError if it is beyond the range of numbers."""
    token = reader.take()
    exponent = token.text.lower().partition("e")[2]
    if len(token.text) > 100 or len(exponent) > 4 or abs(value := Fraction(token.text)) > LARGEST:
        raise reader.source.error(token.start, "beyond the range of numbers", "write a smaller number")
    text = f"-{token.text}" if negative else token.text
    return Quantity(-value if negative else value, DIMENSIONLESS, text)
