"""Values that depend on what is chosen: properties, choices and roll-ups over the parts that are there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from math import lcm
from typing import TypeVar

from dse.space.decisions import Choices, Condition
from dse.space.language.arithmetic import Real

T = TypeVar("T")


def lookup(entries: Sequence[tuple[Condition, T]]) -> Callable[[Choices], T | None]:
    """The one entry whose condition is met, None if there is none. At most one may be met at a time."""
    if len(entries) == 1 and not entries[0][0]:
        only = entries[0][1]
        return lambda _: only
    paths = {condition[0][0] for condition, _ in entries if len(condition) == 1}
    if len(paths) == 1 and all(len(condition) == 1 for condition, _ in entries):
        (path,) = paths
        table: dict[str | None, T] = {condition[0][1]: value for condition, value in entries}
        return lambda choices: table.get(choices.get(path))

    def search(choices: Choices) -> T | None:
        return next((value for condition, value in entries if _is_met(condition, choices)), None)

    return search


def roll_up(function: str, entries: Sequence[tuple[Condition, Fraction]]) -> Callable[[Choices], Real | None]:
    """*function* over the properties of the parts that are there.

    Of no part at all sum and count are 0 and product is 1; min, max and mean are undefined.
    """
    if function == "count":
        count = _fold([(condition, 1) for condition, _ in entries], _add)
        return lambda choices: Fraction(count(choices) or 0)
    if function == "product":
        times = _fold(entries, _multiply)
        return lambda choices: _or_else(times(choices), Fraction(1))
    if function in ("min", "max"):
        return _fold(entries, min if function == "min" else max)
    # Whole multiples of a common part add up faster than fractions.
    parts = lcm(*(value.denominator for _, value in entries))
    total = _fold([(condition, int(value * parts)) for condition, value in entries], _add)
    if function == "sum":
        return lambda choices: Fraction(total(choices) or 0, parts)
    number = _fold([(condition, 1) for condition, _ in entries], _add)

    def mean(choices: Choices) -> Fraction | None:
        there = number(choices)
        return Fraction(total(choices) or 0, parts * there) if there else None

    return mean


def _fold(entries: Iterable[tuple[Condition, T]], combine: Callable[[T, T], T]) -> Callable[[Choices], T | None]:
    always: T | None = None
    tables: dict[str, dict[str | None, T]] = {}
    rest: list[tuple[Condition, T]] = []
    for condition, value in entries:
        if not condition:
            always = _joined(always, value, combine)
        elif len(condition) == 1:
            ((path, choice),) = condition
            table = tables.setdefault(path, {})
            table[choice] = _joined(table.get(choice), value, combine)
        else:
            rest.append((condition, value))
    pairs = list(tables.items())

    def evaluate(choices: Choices) -> T | None:
        result = always
        for path, table in pairs:
            value = table.get(choices.get(path))
            if value is not None:
                result = value if result is None else combine(result, value)
        for condition, value in rest:
            if _is_met(condition, choices):
                result = value if result is None else combine(result, value)
        return result

    return evaluate


def _is_met(condition: Condition, choices: Choices) -> bool:
    return all(choices.get(path) == name for path, name in condition)


def _joined(before: T | None, value: T, combine: Callable[[T, T], T]) -> T:
    return value if before is None else combine(before, value)


def _or_else(value: T | None, default: T) -> T:
    return default if value is None else value


def _add(a: int, b: int) -> int:
    return a + b


def _multiply(a: Fraction, b: Fraction) -> Fraction:
    return a * b
