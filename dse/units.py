"""Units and quantities: exact factors to SI, and dimensions that can be multiplied and compared.

pint knows the units; nothing above this module sees it, and it is imported only for units that no earlier process
of this user has read: what it said of the others is in the cache folder.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from dse.cache import cache_folder, keep, kept

if TYPE_CHECKING:
    import pint

Dimension = tuple[tuple[str, Fraction], ...]
"""Exponents of the base dimensions, sorted by name, without zeros: ``(("length", 1), ("time", -1))``."""

_CURRENCIES = "AUD BRL CAD CHF CNY CZK DKK GBP HUF INR JPY KRW MXN NOK PLN SEK SGD TRY TWD USD ZAR"
"""Those beside EUR; each is a dimension by itself, for exchange rates change."""

_OWN_UNITS = """
EUR = [currency]
operation = [operation] = op
TOPS = 1e12 * operation / second
GOPS = 1e9 * operation / second
@alias ohm = Ohm
"""

_MISREAD = {"Nm": "N.m", "kNm": "kN.m", "Ws": "W.s", "Wh/km": "W.h/km", "kg*m/s2": "kg.m/s2"}
"""Spellings that would be read as something else (Nm as nanometres), and what is meant."""


class UnitError(ValueError):
    """A unit or quantity that cannot be read; the message says what was expected."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of measurement: ``si = value * factor + offset``, exactly.

    `parse_unit` reads *symbol* anywhere: it contains the definitions of units that a workspace defines, which ``str``
    leaves out.
    """

    symbol: str
    factor: Fraction
    offset: Fraction
    dimension: Dimension

    def to_si(self, value: float | Fraction) -> float:
        """*value* in this unit as a value in the coherent SI unit."""
        if isinstance(value, float) and not math.isfinite(value):
            return value
        return _as_float(Fraction(value) * self.factor + self.offset)

    def from_si(self, value: float) -> float:
        """*value* in the coherent SI unit as a value in this unit."""
        return _as_float((Fraction(value) - self.offset) / self.factor) if math.isfinite(value) else value

    def written(self, si: float) -> Decimal:
        """A decimal number in this unit, of few digits if there is one, that `to_si` reads back as exactly *si*.

        A double in this unit need not be read back so: some neighbours in m/s are the same double in km/h.
        """
        near = self.from_si(si)
        reach = math.ulp(si) / abs(float(self.factor)) + math.ulp(near)
        texts = (
            text for text in (*(f"{near:.{n}g}" for n in _FEW_DIGITS), repr(near)) if abs(float(text) - near) <= reach
        )
        for text in texts:
            if self.to_si(Fraction(text)) == si:
                return Decimal(text)
        exact = (Fraction(si) - self.offset) / self.factor
        return Context(_ALL_DIGITS).divide(exact.numerator, exact.denominator)

    @property
    def is_coherent(self) -> bool:
        """Whether numbers in this unit are SI numbers already."""
        return self.factor == 1 and self.offset == 0

    def __str__(self) -> str:
        return short_symbol(self.symbol)


_FEW_DIGITS = (6, 12, 15)
_ALL_DIGITS = 20
"""Enough for a double in any unit, but within 1 mK of absolute zero in degC."""

LARGEST = 10**308
"""The largest number, in SI, that is taken; floating point ends a little above."""

LARGEST_WHOLE = 2**53
"""The largest whole number that is taken; a double holds all up to it."""

DIMENSIONLESS = Unit("", Fraction(1), Fraction(0), ())


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with a unit; *si* is exact, *text* is what the user wrote."""

    si: Fraction
    unit: Unit
    text: str

    def __float__(self) -> float:
        return float(self.si)

    @property
    def magnitude(self) -> Fraction:
        """The number in the quantity's own unit, exact."""
        return (self.si - self.unit.offset) / self.unit.factor

    def __str__(self) -> str:
        return self.text


def multiply(a: Dimension, b: Dimension) -> Dimension:
    """The dimension of a product."""
    return _combine(a, b, 1)


def divide(a: Dimension, b: Dimension) -> Dimension:
    """The dimension of a quotient."""
    return _combine(a, b, -1)


def power(a: Dimension, exponent: Fraction | int) -> Dimension:
    """The dimension of a power."""
    return tuple((name, n * Fraction(exponent)) for name, n in a if n * Fraction(exponent))


def describe(dimension: Dimension) -> str:
    """A dimension in words for a message, as ``length/time`` or ``a plain number``."""
    if not dimension:
        return "a plain number"
    return short_symbol(_quotient(dimension, lambda name, n: name if n == 1 else f"{name}^{n}"))


def si_unit(dimension: Dimension) -> Unit:
    """The SI unit of a dimension, by its own name where it has a well-known one."""
    if not dimension:
        return DIMENSIONLESS
    named = next((unit for unit in map(parse_unit, _NAMED) if unit.dimension == dimension), None)
    return named or Unit(_quotient(dimension, _symbol_power), Fraction(1), Fraction(0), dimension)


def shown(value: float, digits: int = 4) -> str:
    """A number of so many digits, or with all of a whole number of up to seven: 16258, not 1.626e+04."""
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e+" in text and abs(value) < 1e7 else text


_NAMED = ("N", "J", "W", "N/m", "V", "Pa")


def counts_otherwise(a: str, b: str) -> bool:
    """Whether one of two symbols of units counts cycles (Hz) and the other angles or turns in a time (rad/s, rpm).

    Angles have no dimension, so both are 1/time, but one Hz is 2 pi rad/s: which is meant nobody can tell. A bare 1/s
    may stand for either.
    """
    return any(_CYCLES.search(x) and _ANGLES.search(y) for x, y in ((a, b), (b, a)))


def is_rounded(usual: float, written: float) -> bool:
    """Whether *written* is *usual* with fewer digits: 0.27778 is 1/3.6, 0.3048006096 is not 0.3048."""
    if written == usual or abs(written - usual) > _ROUNDED * abs(usual):
        return written == usual
    _, digits, exponent = Decimal(repr(written)).as_tuple()
    last = Decimal((0, (1,), int(exponent))) if len(digits) < _DIGITS else Decimal(0)
    return abs(Decimal(written) - Decimal(usual)) <= max(last, Decimal(_SAME) * abs(Decimal(usual)))


_ROUNDED = 1e-4
"""Relative difference up to which a factor may be a rounded one at all."""

_DIGITS = 13
"""A number with that many digits was not rounded by hand."""

_SAME = 1e-12

_CYCLES = re.compile(r"(?i)(?<![a-z])([kMGT]?Hz|[a-z]*hertz|cycles?)(?![a-z])")
_ANGLES = re.compile(
    r"(?i)(?<![a-z])(m?rad(ian)?s?|deg(ree)?s?|rpm|rev(olution)?s?|r(?=/)|turns?|arc(min|sec)|grad)(?![a-z])"
)


def coherent(unit: Unit) -> Unit:
    """The coherent SI unit of the same dimension: ``m/s`` for ``km/h``, the plain number for ``%``."""
    if unit.is_coherent:
        return unit
    return Unit(_symbol(unit.dimension), Fraction(1), Fraction(0), unit.dimension)


SI_SYMBOLS = {
    "mass": "kg",
    "length": "m",
    "time": "s",
    "current": "A",
    "temperature": "K",
    "substance": "mol",
    "luminosity": "cd",
}
"""The base units FMI can name, by dimension, in the order they are written in."""

_OTHER_SYMBOLS = {"currency": "EUR", "operation": "op"}


OwnUnits = Mapping[str, str]
"""Units that a workspace defines: the symbol of each with its definition, by name: ``{"tick": "tick{1/4 s}"}``.

A currency is ``¤CR``. Such a symbol can be read anywhere: in a stored study, in another process.
"""

_own_units: ContextVar[OwnUnits] = ContextVar("own_units", default=MappingProxyType({}))


@contextmanager
def own_units(units: OwnUnits) -> Iterator[None]:
    """While this lasts, and in this thread alone, `parse_unit` and `parse_quantity` also know *units* by name."""
    before = _own_units.set(units)
    try:
        yield
    finally:
        _own_units.reset(before)


def known_units() -> OwnUnits:
    """Those that `parse_unit` knows by name here and now."""
    return _own_units.get()


def own_currency(name: str) -> str:
    """The symbol of a currency called *name*, which a workspace defines."""
    return f"¤{name}"


def own_unit(name: str, text: str) -> str:
    """The symbol of a unit called *name*, which a workspace defines as *text*: ``0.25 s``, ``1/3 m``, ``12``.

    Raises UnitError.
    """
    own = _own_units.get()
    text = " ".join(_OWN_OR_NAME.sub(lambda word: own.get(word[0], word[0]), text).split())
    meaning = _OWN_MEANING.fullmatch(text)
    if meaning is None:
        raise UnitError(f"'{text}' is not a positive number with a unit")
    unit = _unit(meaning[2])
    if unit.offset:
        raise UnitError(f"'{unit}' begins at another zero than {coherent(unit)}")
    if any(exponent.denominator != 1 for _, exponent in unit.dimension):
        raise UnitError(f"'{unit}' has a fractional exponent")
    if "{" in text:  # definitions are not nested
        factor = Fraction(meaning[1]) * unit.factor
        number = repr(_as_float(factor))
        number = number if _PLAIN_NUMBER.fullmatch(number) and Fraction(number) == factor else str(factor)
        text = f"{number} {_symbol(unit.dimension)}"
    _unit(symbol := f"{name}{{{text}}}")
    return symbol


def definition_of(symbol: str) -> str:
    """What `own_unit` made *symbol* of, as a person writes it; "" for a currency."""
    return short_symbol(symbol.partition("{")[2].removesuffix("}"))


def is_currency(dimension: Dimension) -> bool:
    """Whether amounts of *dimension* are money."""
    return len(dimension) == 1 and dimension[0][1] == 1 and (dimension[0][0] in _MONEY or dimension[0][0][0] == "¤")


_MONEY = {"currency", *_CURRENCIES.split()}


def short_symbol(symbol: str) -> str:
    """*symbol* as it is shown: without the definitions of units that a workspace defines."""
    return _DEFINITION.sub("", symbol) if "{" in symbol or "¤" in symbol else symbol


_DEFINITION = re.compile(r"¤|\{[^{}]*\}")
_OWN_SYMBOL = re.compile(r"¤[^\W\d_]+|[^\W\d_]+\{[^{}]*\}")
_OWN_OR_NAME = re.compile(rf"{_OWN_SYMBOL.pattern}|[^\W\d_]+")
_OWN_MEANING = re.compile(
    r"((?=[0-9.]{0,99}[1-9])[0-9]{0,99}\.?[0-9]{1,99}(?:[eE][+-]?[0-9]{1,3})?"
    r"|[1-9][0-9]{0,999}(?:/[1-9][0-9]{0,999})?) ?((?![0-9./]).*)"
)
_PLAIN_NUMBER = re.compile(r"[0-9]{1,15}\.[0-9]{1,15}")
_STAND_INS = tuple(f"dseown{letter}" for letter in "abcdefgh")
"""What pint reads in place of units that a workspace defines, in one unit."""


def parse_unit(text: str) -> Unit:
    """Read a unit as FMI, Modelica or people write it: ``m/s2``, ``N.m``, ``km/h``, ``%``, ``EUR``.

    The empty string, ``1`` and ``-`` are the plain number. Raises UnitError.
    """
    own = _own_units.get()
    return _unit(_OWN_OR_NAME.sub(lambda word: own.get(word[0], word[0]), text) if own else text)


@lru_cache(maxsize=4096)
def _unit(symbol: str) -> Unit:
    """The unit of a symbol with all definitions. Raises UnitError."""
    symbol = symbol.strip()
    if symbol in ("", "1", "-"):
        return DIMENSIONLESS
    own: list[str] = []

    def replacement(match: re.Match[str]) -> str:
        if match[0] not in own:
            own.append(match[0])
        if len(own) > len(_STAND_INS):
            raise UnitError(f"'{short_symbol(symbol)}' consists of too many units")
        return _STAND_INS[own.index(match[0])]

    text = symbol if "dseown" in symbol else _OWN_SYMBOL.sub(replacement, symbol)
    if _TOO_LARGE.search(text) or len(_GROUP_POWER.findall(text)) > 1 or (not own and "dseown" in text):
        raise UnitError(f"unknown unit '{symbol}'")
    if text in _MISREAD:
        raise UnitError(f"unknown unit '{text}': write {_MISREAD[text]}")
    known = _remembered()
    if text not in known:
        known[text] = _read(text)
    meaning = known[text]
    if meaning is None:
        raise UnitError(f"unknown unit '{short_symbol(symbol)}'")
    return Unit(symbol, *(_with_own(own, *meaning) if own else meaning))


def _with_own(own: list[str], factor: Fraction, offset: Fraction, dimension: Dimension) -> _Meaning:
    """A meaning of stand-ins as that of the units that they stand for. Raises UnitError."""
    found: Dimension = ()
    for name, exponent in dimension:
        if name not in _STAND_INS:
            found = multiply(found, ((name, exponent),))
            continue
        symbol = own[_STAND_INS.index(name)]
        if symbol.startswith("¤"):
            found = multiply(found, ((symbol, exponent),))
            continue
        meaning = _OWN_MEANING.fullmatch(symbol.partition("{")[2][:-1])
        if meaning is None or exponent.denominator != 1 or abs(exponent) > _LARGEST_POWER:
            raise UnitError(f"unknown unit '{short_symbol(symbol)}'")
        unit = _unit(meaning[2])
        factor *= (Fraction(meaning[1]) * unit.factor) ** int(exponent)
        found = multiply(found, power(unit.dimension, exponent))
    if not Fraction(1, LARGEST) <= abs(factor) <= LARGEST:
        raise UnitError("the unit is beyond the range of numbers")
    return factor, offset, found


_LARGEST_POWER = 9

_Meaning = tuple[Fraction, Fraction, Dimension]


def _read(text: str) -> _Meaning | None:
    """Factor, offset and dimension of a unit, by pint; None for what is none."""
    registry: Any = _registry()
    try:
        parsed = registry.parse_units(_pint_spelling(text))
        zero = registry.Quantity(Fraction(0), parsed).to_base_units()
        one = registry.Quantity(Fraction(1), parsed).to_base_units()
    except Exception:  # noqa: BLE001  # pint's tokenizer leaks library errors for malformed text
        return None
    offset = Fraction(str(zero.magnitude))
    dimension = tuple(
        sorted((str(name).strip("[]"), Fraction(exponent)) for name, exponent in one.dimensionality.items())
    )
    factor = Fraction(str(one.magnitude)) - offset
    if not Fraction(1, LARGEST) <= abs(factor) <= LARGEST:
        raise UnitError(f"the unit '{text}' is beyond the range of numbers")
    return factor, offset, dimension


def parse_quantity(text: str) -> Quantity:
    """Read ``number unit``, as ``70 km/h``, ``45 EUR``, ``2 %`` or ``0.3``. Raises UnitError."""
    return _quantity.__wrapped__(text) if _own_units.get() else _quantity(text)


@lru_cache(maxsize=4096)
def _quantity(text: str) -> Quantity:
    match = _QUANTITY.fullmatch(text.strip())
    if _DECIMAL_COMMA.match(text):
        raise UnitError(f"'{text}' has a decimal comma: write '{text.strip().replace(',', '.', 1)}'")
    if not match:
        raise UnitError(f"'{text}' is not a quantity")
    if len(match["number"]) > _LONGEST_NUMBER:
        raise UnitError(f"a number of more than {_LONGEST_NUMBER} characters")
    unit = parse_unit(match["unit"])
    number = Fraction(int(match["number"]) if match["number"].isdecimal() else match["number"])
    si = number if unit.is_coherent else number * unit.factor + unit.offset
    if abs(si.numerator) > LARGEST * si.denominator:
        raise UnitError(f"'{text}' is beyond the range of numbers")
    return Quantity(si, unit, text.strip())


_LONGEST_NUMBER = 100
# Powers that would take the exact factors of a unit to millions of digits.
_TOO_LARGE = re.compile(r"\d{3}|(?:\^|\*\*)[\s\d.()+-]*(?:\^|\*\*)")
_GROUP_POWER = re.compile(r"\)\s*(?:\^|\*\*|\d)")
_QUANTITY = re.compile(
    r"(?P<number>[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d{1,3})?)\s*(?P<unit>(?:[^\s\d+.-].*)?|1(?:/.*)?)", re.DOTALL
)
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d*,\d")
_DOT_PRODUCT = re.compile(r"(?<=[A-Za-z0-9_)])\.(?=[A-Za-z(])")
_BARE_EXPONENT = re.compile(r"(?<=[A-Za-z])(-?\d+)(?![A-Za-z_])")


def _pint_spelling(text: str) -> str:
    text = text.replace("%", "percent").replace("°", "degree")
    text = _DOT_PRODUCT.sub("*", text)
    return _BARE_EXPONENT.sub(r"**\1", text)


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[Any]:
    import pint

    registry: pint.UnitRegistry[Any] = pint.UnitRegistry(non_int_type=Fraction, cache_folder=None)
    for line in (
        *_OWN_UNITS.strip().splitlines(),
        *(f"{name} = [{name}]" for name in (*_CURRENCIES.split(), *_STAND_INS)),
    ):
        registry.define(line)
    return registry


_MOST_KEPT = 4096


@lru_cache(maxsize=1)
def _remembered() -> dict[str, _Meaning | None]:
    """What is known of units, from earlier processes too; what is new is handed on when this one ends."""
    import atexit

    known = _kept()
    before = len(known)

    def hand_on() -> None:
        if before < len(known) <= _MOST_KEPT:
            _keep({**_kept(), **known})

    atexit.register(hand_on)
    return known


def _kept() -> dict[str, _Meaning | None]:
    import json

    try:
        entries = json.loads(kept(*_shelf()) or b"{}")
        return {text: entry and _meaning(*entry) for text, entry in entries.items()}
    except (TypeError, ValueError, AttributeError, ZeroDivisionError, RecursionError):
        return {}


def _meaning(factor: list[int], offset: list[int], dimension: list[tuple[str, list[int]]]) -> _Meaning:
    return Fraction(*factor), Fraction(*offset), tuple((str(name), Fraction(*power)) for name, power in dimension)


def _keep(known: dict[str, _Meaning | None]) -> None:
    import json

    entries = {text: meaning and _plain(*meaning) for text, meaning in known.items()}
    keep(*_shelf(), json.dumps(entries).encode(), most=4)


def _plain(factor: Fraction, offset: Fraction, dimension: Dimension) -> list[object]:
    return [factor.as_integer_ratio(), offset.as_integer_ratio(), [(n, p.as_integer_ratio()) for n, p in dimension]]


@lru_cache(maxsize=1)
def _shelf() -> tuple[Path, str]:
    """Where units are kept, and under which key: with another pint or other rules of reading they are read anew."""
    from hashlib import sha256
    from importlib.util import find_spec

    spec = find_spec("pint")
    site = Path(spec.origin).parents[1] if spec and spec.origin else Path()
    # importlib.metadata would say the same in a hundred times the time.
    versions = ",".join(sorted(path.name for path in site.glob("pint-*.dist-info")))
    if not versions:
        from importlib.metadata import version

        versions = version("pint")
    key = sha256(versions.encode() + Path(__file__).read_bytes()).hexdigest()[:32]
    return cache_folder() / "units" / key, key


def _as_float(value: Fraction) -> float:
    """The nearest floating-point number; infinite beyond their range, as in their own arithmetic."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _combine(a: Dimension, b: Dimension, sign: int) -> Dimension:
    powers = dict(a)
    for name, n in b:
        powers[name] = powers.get(name, Fraction(0)) + sign * n
    return tuple(sorted((name, n) for name, n in powers.items() if n))


def _quotient(dimension: Dimension, written: Callable[[str, Fraction], str]) -> str:
    over = [written(name, n) for name, n in dimension if n > 0]
    under = [written(name, -n) for name, n in dimension if n < 0]
    return "*".join(over or ["1"]) + "".join(f"/{text}" for text in under)


def _symbol_power(name: str, exponent: Fraction) -> str:
    symbol = {**SI_SYMBOLS, "currency": "EUR"}.get(name, name)
    return symbol if exponent == 1 else f"{symbol}^{float(exponent):g}"


def _symbol(dimension: Dimension) -> str:
    places = {name: place for place, name in enumerate(SI_SYMBOLS)}
    ordered = sorted(dimension, key=lambda factor: places.get(factor[0], len(places)))
    over = [_power(name, exponent) for name, exponent in ordered if exponent > 0]
    under = [_power(name, -exponent) for name, exponent in ordered if exponent < 0]
    if not under:
        return ".".join(over)
    below = under[0] if len(under) == 1 else f"({'.'.join(under)})"
    return f"{'.'.join(over) or '1'}/{below}"


def _power(name: str, exponent: Fraction) -> str:
    symbol = SI_SYMBOLS.get(name) or _OTHER_SYMBOLS.get(name, name)
    return symbol if exponent == 1 else f"{symbol}{exponent}"
