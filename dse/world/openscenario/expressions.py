"""Values in OpenSCENARIO attributes: literals, ``$name``, and expressions ``${…}`` over parameters.

An expression is folded as it is read: what depends on no tunable parameter becomes a number. What is left is C.
Example: with ``v`` tunable and ``k`` = 3.6, ``${$v / $k}`` is the C text ``(par->v / 3.6)``.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from dse.errors import Location, closest, fail
from dse.formats import shortened

_PART = re.compile(
    r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|(\$?[A-Za-z_][\w.]*)|(<=|>=|==|!=|&&|\|\||\S))"
)
_MOST_LEVELS = 100
_MOST_CHARACTERS = 10_000
_MOST_C = 100_000


@dataclass(frozen=True, slots=True)
class Number:
    """A number: *value* if it is constant, and else with the default values of the tunable *names*; *c* is its C."""

    value: float
    c: str
    names: frozenset[str] = frozenset()


Value = Number | str

_OPERATORS: dict[str, tuple[int, Callable[[float, float], float]]] = {
    "+": (1, operator.add), "-": (1, operator.sub), "*": (2, operator.mul),
    "/": (2, operator.truediv), "%": (2, math.fmod),
}  # fmt: skip
_FUNCTIONS: dict[str, tuple[str, int, Callable[..., float]]] = {
    "round": ("rint", 1, lambda x: float(round(x))), "floor": ("floor", 1, lambda x: float(math.floor(x))),
    "ceil": ("ceil", 1, lambda x: float(math.ceil(x))), "sqrt": ("sqrt", 1, math.sqrt), "pow": ("pow", 2, math.pow),
    "abs": ("fabs", 1, abs), "sin": ("sin", 1, math.sin), "cos": ("cos", 1, math.cos), "tan": ("tan", 1, math.tan),
    "asin": ("asin", 1, math.asin), "acos": ("acos", 1, math.acos), "atan": ("atan", 1, math.atan),
    "exp": ("exp", 1, math.exp), "log": ("log", 1, math.log), "min": ("fmin", 2, min), "max": ("fmax", 2, max),
    "sign": ("sign_of", 1, lambda x: float((x > 0) - (x < 0))), "atan2": ("atan2", 2, math.atan2),
}  # fmt: skip
_CONSTANTS = {"pi": math.pi, "e": math.e, "PI": math.pi}
_WORDS = {"true": 1.0, "false": 0.0}


def constant(value: float) -> Number:
    """A number that depends on nothing."""
    return Number(value, repr(float(value)))


def tunable(name: str, value: float) -> Number:
    """The number that the parameter *name* of the FMU has; *value* is its default."""
    return Number(value, f"par->{name}", frozenset({name}))


def read_value(text: str, scope: Mapping[str, Value], where: Location) -> Value:
    """The value of an attribute: a number where *text* is one, ``$name`` as *scope* has it, else a text.

    Raises DseError located at *where*: an unknown parameter, a wrong expression, a result that is no finite number.
    """
    text = text.strip()
    if text.startswith("${"):
        if not text.endswith("}"):
            raise fail(f"the expression '{shortened(text)}' has no closing brace", where)
        return _Parser(text[2:-1], scope, where).whole()
    if text.startswith("$"):
        return _parameter(text[1:], scope, where)
    return _literal(text) or text


def _literal(text: str) -> Number | None:
    if text in _WORDS:
        return constant(_WORDS[text])
    if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?INF|[+-]?inf", text):
        return None
    value = float(text)
    return Number(value, "HUGE_VAL" if value > 0 else "-HUGE_VAL") if math.isinf(value) else constant(value)


def _parameter(name: str, scope: Mapping[str, Value], where: Location) -> Value:
    if name not in scope:
        raise fail(f"there is no parameter '{shortened(name)}'", where, closest(name, scope))
    return scope[name]


class _Parser:
    """Precedence climbing over the tokens of one expression."""

    def __init__(self, text: str, scope: Mapping[str, Value], where: Location) -> None:
        self._text, self._scope, self._where = text, scope, where
        if len(text) > _MOST_CHARACTERS:
            raise fail(f"an expression has at most {_MOST_CHARACTERS} characters, not {len(text)}", where)
        self._tokens = [match.group().strip() for match in _PART.finditer(text)]
        self._at = 0

    def whole(self) -> Value:
        """The value of all of it."""
        if len(self._tokens) == 1 and self._tokens[0].startswith("$"):
            return _parameter(self._tokens[0][1:], self._scope, self._where)
        found = self._sum(1, 0)
        if self._at < len(self._tokens):
            raise self._wrong(f"'{self._tokens[self._at]}' is not expected")
        return found

    def _wrong(self, what: str) -> Exception:
        return fail(f"the expression '{shortened(self._text)}': {what}", self._where)

    def _next(self) -> str:
        part = self._tokens[self._at] if self._at < len(self._tokens) else ""
        self._at += 1
        return part

    def _sum(self, least: int, level: int) -> Number:
        if level > _MOST_LEVELS:
            raise self._wrong(f"more than {_MOST_LEVELS} levels")
        left = self._unary(level)
        while self._at < len(self._tokens):
            part = self._tokens[self._at]
            rank, apply = _OPERATORS.get(part, (0, operator.add))
            if rank < least:
                break
            self._at += 1
            right = self._sum(rank + 1, level + 1)
            if part == "%":
                left = self._folded(apply, (left, right), f"fmod({left.c}, {right.c})")
            else:
                left = self._folded(apply, (left, right), f"({left.c} {part} {right.c})")
        return left

    def _unary(self, level: int) -> Number:
        part = self._next()
        if level > _MOST_LEVELS:
            raise self._wrong(f"more than {_MOST_LEVELS} levels")
        if part in {"-", "+"}:
            inner = self._unary(level + 1)
            return inner if part == "+" else self._folded(operator.neg, (inner,), f"(-{inner.c})")
        if part == "(":
            inner = self._sum(1, level + 1)
            self._expect(")")
            return inner
        if part in _FUNCTIONS and self._tokens[self._at : self._at + 1] == ["("]:
            return self._call(part, level)
        if part.startswith("$"):
            value = _parameter(part[1:], self._scope, self._where)
            if isinstance(value, str):
                raise self._wrong(f"'{part}' is '{shortened(value)}', not a number")
            return value
        if part in _CONSTANTS:
            return constant(_CONSTANTS[part])
        found = _literal(part) if part else None
        if found is None:
            what = f"'{part}' is not known" if part else "it ends too early"
            raise self._wrong(what)
        return found

    def _call(self, name: str, level: int) -> Number:
        c, count, apply = _FUNCTIONS[name]
        self._expect("(")
        arguments = [self._sum(1, level + 1)]
        while self._tokens[self._at : self._at + 1] == [","]:
            self._at += 1
            arguments.append(self._sum(1, level + 1))
        self._expect(")")
        if len(arguments) != count:
            raise self._wrong(f"{name} takes {count} numbers, not {len(arguments)}")
        return self._folded(apply, tuple(arguments), f"{c}({', '.join(each.c for each in arguments)})")

    def _expect(self, part: str) -> None:
        found = self._next()
        if found != part:
            raise self._wrong(f"'{part}' is expected, not '{found}'" if found else f"'{part}' is missing at the end")

    def _folded(self, apply: Callable[..., float], parts: tuple[Number, ...], c: str) -> Number:
        names = frozenset[str]().union(*(each.names for each in parts))
        if names and len(c) > _MOST_C:
            raise self._wrong(f"it has more than {_MOST_C} characters with its parameters replaced by their values")
        try:
            value = float(apply(*(each.value for each in parts)))
        except (ArithmeticError, ValueError) as error:
            raise self._wrong("it has no value") from error
        if not math.isfinite(value):
            raise self._wrong("its value is not finite")
        return Number(value, c, names) if names else constant(value)
