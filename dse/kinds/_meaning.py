"""What numbers in generated code mean: their units, scales and ranges, and the items of enumerations."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from dse.domain.component import Kind, Type
from dse.errors import Location, closest, fail
from dse.kinds._coded import Code
from dse.loading import Plain, Section, SourcePlace, read_unit
from dse.units import DIMENSIONLESS, Unit

if TYPE_CHECKING:
    from dse.simulink import Scalar


class NumberSection(Section):
    """What a number in the code means."""

    unit: str | None = None
    scale: Plain = 1
    offset: Plain = 0
    min: Plain | None = None
    max: Plain | None = None


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a number in the code means: a value is *offset* + *scale* times it in *unit*, if that is not SI.

    A value has to be from *low* to *high* (SI).
    """

    unit: Unit | None
    scale: float
    offset: float
    low: float
    high: float
    where: Location = field(compare=False)

    @property
    def is_bounded(self) -> bool:
        """Whether it says a smallest or largest value."""
        return (self.low, self.high) != (float("-inf"), float("inf"))


def read_meaning(name: str, section: NumberSection, place: SourcePlace) -> Meaning:
    """What *section* says of the numbers of *name*. Raises DseError."""
    keys = ("in_code", name)
    unit = None if section.unit is None else read_unit(section.unit, place.at(*keys, "unit"))
    scale = place.number(section.scale, "", *keys, "scale")
    if scale == 0:
        raise fail(f"the scale of '{name}' is 0", place.at(*keys, "scale"))
    bare = section.unit or ""
    low = float("-inf") if section.min is None else place.number(section.min, bare, *keys, "min")
    high = float("inf") if section.max is None else place.number(section.max, bare, *keys, "max")
    if low > high:
        raise fail(f"'{name}' has a smallest value above its largest", place.at(*keys))
    return Meaning(unit, scale, place.number(section.offset, "", *keys, "offset"), low, high, place.at(*keys))


def code_of(
    name: str, type_: Type, scalar: Scalar, meaning: Meaning | None, where: Location | None, *, is_given: bool
) -> Code:
    """How a value of *type_* is one of the code's *scalar*; what *is_given* to the code is held in its range.

    Raises DseError if it can be none.
    """
    number = str(scalar.number)
    fits = {
        Kind.REAL: ("real", "integer"),
        Kind.INTEGER: ("integer", "enumeration"),
        Kind.BOOLEAN: ("boolean", "integer"),
        Kind.ENUMERATION: ("enumeration",),
    }
    if number not in fits.get(type_.kind, ()):
        raise fail(f"'{name}' is a {type_.kind}, but {_shown(scalar)} in the code", where)
    if meaning is not None and type_.kind is not Kind.REAL and (meaning.scale, meaning.offset, meaning.unit) != _PLAIN:
        raise fail(f"'{name}' is a {type_.kind}: its numbers have neither unit nor scale", meaning.where)
    if meaning is not None and meaning.is_bounded and not is_given:
        raise fail(f"'{name}' is an output: 'min' and 'max' are for what the code is given", meaning.where)
    if type_.kind is Kind.ENUMERATION:
        if meaning is not None and meaning.is_bounded:
            raise fail(f"'{name}' has items, which are all there are: it has no 'min' and 'max'", meaning.where)
        return Code(numbers=tuple(_item(name, item, scalar, where) for item in type_.items))
    low, high = (meaning.low, meaning.high) if meaning else (float("-inf"), float("inf"))
    if type_.kind is Kind.INTEGER and number == "enumeration":
        return Code(low=low, high=high, only=tuple(value for _, value in scalar.items) if is_given else ())
    if type_.kind is Kind.INTEGER and is_given:
        return Code(low=max(low, float(scalar.low)), high=min(high, float(scalar.high)))
    is_whole = is_given and type_.kind is Kind.REAL and number == "integer"
    if meaning is None:
        return Code(is_rounded=is_whole)
    unit = meaning.unit or DIMENSIONLESS
    if meaning.unit is not None and unit.dimension != type_.unit.dimension:
        raise fail(f"'{name}' is in {type_.unit or '1'}, which {unit} cannot be", meaning.where)
    factor, shift = float(unit.factor), float(unit.offset)
    is_rounded = is_whole and (meaning.scale, meaning.offset, meaning.unit) == _PLAIN
    return Code(factor * meaning.scale, shift + factor * meaning.offset, low, high, is_rounded=is_rounded)


_PLAIN = (1.0, 0.0, None)


def _item(name: str, item: str, scalar: Scalar, where: Location | None) -> int:
    """The number of an item, which the coder spells with the type's name before it or without."""
    spelled = (item, f"{scalar.name}_{item}")
    found = next((value for each, value in scalar.items if each in spelled), None)
    if found is None:
        names = [each for each, _ in scalar.items]
        hint = closest(item, names) or f"it has {', '.join(names[:8])}"
        raise fail(f"'{name}' has the item '{item}', which {scalar.name} in the code does not have", where, hint)
    return found


def _shown(scalar: Scalar) -> str:
    return f"of the type {scalar.name}, {'an' if scalar.number[0] in 'aeiou' else 'a'} {scalar.number},"
