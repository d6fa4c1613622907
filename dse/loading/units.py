"""Reads ``units:``, the units and currencies that a workspace or a design defines.

They are known by name while files are read (`dse.units.own_units`). What was read contains the definitions, so nothing
depends on them later: not a stored study, not a worker, not a second design in the same process.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from dse.errors import Problems, fail, raise_if_any
from dse.expression import KEYWORDS
from dse.formats import Entry
from dse.loading.sections import Plain, Section
from dse.units import (
    OwnUnits,
    UnitError,
    coherent,
    is_currency,
    known_units,
    own_currency,
    own_unit,
    own_units,
    parse_unit,
)


class CurrencySection(Section):
    """A currency: nothing is converted into it or out of it."""

    currency: bool


UnitsSection = dict[str, Plain | CurrencySection]
"""``units``: a quantity for each name, or ``{currency: true}``."""


def read_units(sections: Iterable[tuple[Entry, UnitsSection]]) -> OwnUnits:
    """The units known so far, with those of *sections*. A unit may be defined twice if both mean the same.

    Raises DseError with every problem: circles, names that mean another unit, definitions that cannot be read.
    """
    reader = _Reader([_Written(at[name], name, given) for at, units in sections for name, given in units.items()])
    for written in reader.written:
        with reader.problems:
            reader.settle(written, ())
    raise_if_any(reader.problems)
    return reader.known


@dataclass(frozen=True, slots=True)
class _Written:
    entry: Entry
    name: str
    given: Plain | CurrencySection


class _Reader:
    def __init__(self, written: list[_Written]) -> None:
        self.written = written
        self.first = {each.name: each for each in reversed(written)}
        self.known = dict(known_units())
        self.settled: set[str] = set()
        self.problems = Problems()

    def settle(self, written: _Written, within: tuple[str, ...]) -> bool:
        """Add a unit to the known ones, after those that its definition mentions; whether it is one. DseError."""
        name, entry, first = written.name, written.entry, self.first[written.name]
        if name in within:
            circle = " -> ".join((*within[within.index(name) :], name))
            raise fail(f"units are defined by each other: {circle}", entry.where, "define one of them by SI units")
        if written is first and name in self.settled:
            return name in self.known or _usual(name) is not None
        self.settled.add(name)
        symbol = self.symbol(written, within)
        if symbol is None:
            return False
        usual = _usual(name)
        before = usual or self.known.get(name)
        if before is not None and not _alike(before, symbol):
            hint = f"see {first.entry.key}" if written is not first else "choose another name"
            raise fail(f"'{name}' is {_described(before)} already, not {_described(symbol)}", entry.key, hint)
        if usual is None:
            if not name.isalpha() or name in KEYWORDS:
                hint = "a name consists of letters; define the units of a quotient one by one"
                raise fail(f"'{name}' is not a name of a unit", entry.key, hint)
            self.known[name] = before or symbol
        return True

    def symbol(self, written: _Written, within: tuple[str, ...]) -> str | None:
        """The symbol with its definition; None if one that it mentions has a problem of its own. Raises DseError."""
        if isinstance(written.given, CurrencySection):
            if not written.given.currency:
                raise fail("a unit that is not a currency is a quantity", written.entry.where, "tick: 0.25 s")
            return own_currency(written.name)
        text = str(written.given)
        for word in _WORD.findall(text):
            if word in self.first and not self.settle(self.first[word], (*within, written.name)):
                return None
        try:
            with own_units(self.known):
                # A quotient may be defined if it means what it means anyway.
                return own_unit(written.name if written.name.isalpha() else "unit", text)
        except UnitError as error:
            hint = "write a number and a unit, as '0.25 s', or {currency: true}"
            raise fail(str(error), written.entry.where, hint) from None


_WORD = re.compile(r"[^\W\d_]+")


def _usual(name: str) -> str | None:
    """The symbol of a unit that is called *name* everywhere; None if there is none."""
    try:
        with own_units({}):
            return parse_unit(name).symbol
    except UnitError:
        return None


def _alike(one: str, other: str) -> bool:
    """Whether both symbols mean the same; a currency that exists already is that currency."""
    a, b = parse_unit(one), parse_unit(other)
    if other.startswith("¤") and is_currency(a.dimension):
        return a.factor == 1 and str(a) == str(b)
    return (a.factor, a.offset, a.dimension) == (b.factor, b.offset, b.dimension)


def _described(symbol: str) -> str:
    unit = parse_unit(symbol)
    if is_currency(unit.dimension) and unit.factor == 1:
        return f"the currency {unit}"
    return f"{float(unit.factor):.6g} {coherent(unit)}".rstrip()
