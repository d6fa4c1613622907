"""The operators of the language, and the text of an expression as tokens: where a number's unit ends is decided here.

A unit follows its number at once or after blanks and has no blanks inside: words joined by ``.``, ``*`` or
``/``, each with an optional exponent (``m/s2``, ``m^-3``, ``kg.m^2``, ``%``), or ``1/`` and such words. So an
operator that calculates stands apart from a unit: ``3 m * x`` multiplies and ``3 m*x`` asks for a unit
called ``m*x``. A joint that no word follows is an operator: ``2 m/(x)`` divides, ``5 m-3 m`` subtracts.
Keywords are never units: an inch is written ``inch``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

from dse.domain.expression import Origin, Span, locate
from dse.errors import DseError, fail
from dse.units import DIMENSIONLESS, LARGEST, Unit, UnitError, parse_unit

LOGIC = ("iff", "implies", "or", "xor", "and")
COMPARISON_OPERATORS = ("<", "<=", ">", ">=", "==", "!=")
ASSOCIATIVE = ("and", "or", "+", "*")
FROM_THE_RIGHT = ("implies", "^")
"""``a ^ b ^ c`` is ``a ^ (b ^ c)``."""

_LEVELS = (*LOGIC, "not", f"{' '.join(COMPARISON_OPERATORS)} between is in =", "+ -", "* /", "negative", "^", "atom")
STRENGTH: Mapping[str, int] = {word: level for level, words in enumerate(_LEVELS, 1) for word in words.split()}
"""How strongly each operator binds; ``negative`` is the minus before a value, ``atom`` is a value."""

KEYWORDS = frozenset({*LOGIC, "not", "if", "then", "else", "between", "is", "in", "true", "false"})
"""Words that cannot be names."""


class TokenKind(StrEnum):
    """What a token is."""

    NUMBER = "number"
    NAME = "name"
    KEYWORD = "keyword"
    SYMBOL = "symbol"
    END = "end"


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of the text; a number carries its exact *value* in *unit*."""

    kind: TokenKind
    text: str
    span: Span
    value: Fraction = Fraction(0)
    unit: Unit = DIMENSIONLESS

    def __str__(self) -> str:
        return "the end" if self.kind is TokenKind.END else f"'{self.text}'"


def tokenize(text: str, where: Origin) -> list[Token]:
    """The tokens of *text*, the last one of kind END. Raises DseError at the first piece that is none."""
    tokens: list[Token] = []
    position = 0
    while True:
        position = _skip_blanks(text, position)
        if position == len(text):
            tokens.append(Token(TokenKind.END, "", (position, position)))
            return tokens
        token = _token(text, position, where)
        tokens.append(token)
        position = token.span[1]


def error_at(text: str, span: Span, what: str, where: Origin, advice: str = "look here") -> DseError:
    """A DseError at *span* whose hint shows the line of the text with a caret under it."""
    start = min(span[0], len(text))
    line_start = text.rfind("\n", 0, start) + 1
    line = text[line_start:].partition("\n")[0].expandtabs(1)
    caret = start - line_start
    first = max(0, caret - _SHOWN // 2)
    shown = line[first : first + _SHOWN].rstrip()
    return fail(what, locate(text, where, start), f"{advice}\n        {shown}\n        {' ' * (caret - first)}^")


_SHOWN = 100
_LONGEST_NUMBER = 100
_BEYOND = "beyond the range of numbers"
_NUMBER = re.compile(r"(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][+-]?\d{1,3}(?!\d))?", re.ASCII)
_WORD = r"(?:%|°?[^\W\d_]+)(?:\^-?[0-9]+(?:\.[0-9]+)?|[0-9]+)?"
_UNIT = re.compile(rf"(?:1/)?{_WORD}(?:[.*/]{_WORD})*")
_STEP = r"[^\W\d]\w*(?:\[ *[0-9]+(?: *, *[0-9]+)* *\])?"
_NAME = re.compile(rf"{_STEP}(?:\.{_STEP})*")
_WHOLE_WORD = re.compile(r"[\w./]*")
_SYMBOL = re.compile(r"<=|>=|==|!=|[-+*/^<>()\[\],=]")
_UNIT_ADVICE = "a word after a number is its unit; to calculate, write 2 * x with blanks around the operator"
_FOREIGN_ADVICE = {
    "**": "a power is written ^",
    "&&": "write and",
    "||": "write or",
    "&": "write and",
    "|": "write or",
    "!": "write not",
    "<>": "write !=",
    "=<": "write <=",
    "=>": "write >= to compare, implies to conclude",
    "->": "write implies",
    "≤": "write <=",
    "≥": "write >=",
    "≠": "write !=",
    "·": "write *",
    "×": "write *",
    "{": "use round brackets",
    "'": "names are written without quotes",
    '"': "names are written without quotes",
}
_FOREIGN = re.compile("|".join(re.escape(text) + ("(?!=)" if text == "!" else "") for text in _FOREIGN_ADVICE))


def _skip_blanks(text: str, position: int) -> int:
    while position < len(text) and text[position].isspace():
        position += 1
    return position


def _token(text: str, position: int, where: Origin) -> Token:
    if match := _FOREIGN.match(text, position):
        raise error_at(text, match.span(), f"'{match[0]}' is not known here", where, _FOREIGN_ADVICE[match[0]])
    if match := _NUMBER.match(text, position):
        return _number(text, match, where)
    if match := _NAME.match(text, position):
        kind = TokenKind.KEYWORD if match[0] in KEYWORDS else TokenKind.NAME
        return Token(kind, match[0].replace(" ", ""), match.span())
    if match := _SYMBOL.match(text, position):
        return Token(TokenKind.SYMBOL, match[0], match.span())
    sign = text[position]
    what = f"'{sign}' is not known here" if sign.isprintable() else "a character that cannot be read"
    raise error_at(text, (position, position), what, where, "an expression has names, numbers with units and operators")


def _number(text: str, number: re.Match[str], where: Origin) -> Token:
    if len(number[0]) > _LONGEST_NUMBER:
        raise error_at(text, number.span(), "a number of more than 100 characters", where, "write it as 1.5e6")
    value = Fraction(number[0])
    start = _skip_blanks(text, number.end())
    word, found = _NAME.match(text, start), _UNIT.match(text, start)
    if value > LARGEST:
        raise error_at(text, number.span(), _BEYOND, where, "write a smaller number")
    if (word and word[0] in KEYWORDS) or not (word or found):
        return Token(TokenKind.NUMBER, number[0], number.span(), value, DIMENSIONLESS)
    end = found.end() if found else start
    if found is None or text[end : end + 1].isalnum() or text[end : end + 1] == "_":
        whole = _WHOLE_WORD.match(text, start)
        raise error_at(text, (start, end), f"unknown unit '{whole[0] if whole else ''}'", where, _UNIT_ADVICE)
    try:
        unit = parse_unit(found[0])
    except UnitError as error:
        raise error_at(text, (start, end), str(error), where, _UNIT_ADVICE) from error
    if abs(value * unit.factor + unit.offset) > LARGEST:
        raise error_at(text, (number.start(), end), _BEYOND, where, "write a smaller number")
    return Token(TokenKind.NUMBER, text[number.start() : end], (number.start(), end), value, unit)
