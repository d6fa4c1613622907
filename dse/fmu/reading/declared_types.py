"""TypeDefinitions of an FMU: what its variables may inherit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from dse.errors import Problem
from dse.formats import XmlElement

NUMBER_RANGES: Mapping[str, tuple[int, int]] = {
    "Integer": (-(2**31), 2**31 - 1),
    **{f"Int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
}
"""The whole numbers that fit into a type of FMI, both ends included."""


@dataclass(frozen=True, slots=True)
class DeclaredType:
    """What a type, or a variable itself, says of values. *base* is FMI's name of the type: Real, Float64, Int8, …"""

    base: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    is_relative: bool | None = None
    items: Mapping[str, int] = field(default_factory=dict)


def read_types(root: XmlElement, version: int, problems: list[Problem]) -> Mapping[str, DeclaredType]:
    """The declared types of a description of FMI *version*, by name."""
    types: dict[str, DeclaredType] = {}
    for named, typed in _elements(root, version):
        name = named.required("name", problems)
        told = declared_values(typed, typed.tag.removesuffix("Type"), version, problems)
        if types.setdefault(name, told) != told:
            problems.append(Problem(f"type '{name}' is there twice, with different meanings", named.where))
    return types


def declared_values(typed: XmlElement, base: str, version: int, problems: list[Problem]) -> DeclaredType:
    """What the attributes and items of *typed*, a type of the kind *base* or a variable, say."""
    items = _items(typed, version, problems) if base == "Enumeration" else {}
    if base in ("Boolean", "String", "Binary", "Clock"):
        return DeclaredType(base)
    return DeclaredType(
        base=base,
        unit=typed.get("unit").strip(),
        minimum=typed.real("min", problems),
        maximum=typed.real("max", problems),
        nominal=typed.real("nominal", problems),
        is_relative=typed.flag("relativeQuantity", problems) if "relativeQuantity" in typed.attributes else None,
        items=items,
    )


def inherited(own: DeclaredType, declared: DeclaredType | None) -> DeclaredType:
    """What *own* says, and what it leaves to *declared*."""
    if declared is None:
        return own
    return DeclaredType(
        base=own.base,
        unit=own.unit or declared.unit,
        minimum=declared.minimum if own.minimum is None else own.minimum,
        maximum=declared.maximum if own.maximum is None else own.maximum,
        nominal=declared.nominal if own.nominal is None else own.nominal,
        is_relative=declared.is_relative if own.is_relative is None else own.is_relative,
        items=declared.items,
    )


def _elements(root: XmlElement, version: int) -> Iterator[tuple[XmlElement, XmlElement]]:
    """The element that has the name and the one that has the attributes."""
    definitions = root.child("TypeDefinitions")
    for element in definitions.children if definitions is not None else ():
        if version == 3:
            if element.tag.endswith("Type"):
                yield element, element
        elif element.tag in ("SimpleType", "Type") and element.children:
            yield element, element.children[0]


def _items(typed: XmlElement, version: int, problems: list[Problem]) -> Mapping[str, int]:
    items: dict[str, int] = {}
    values: set[int] = set()
    for number, item in enumerate(typed.all("Item"), start=1):
        name = item.required("name", problems)
        if name in items:
            problems.append(Problem(f"item '{name}' of an enumeration is there twice", item.where))
        if version == 1:
            # FMI 1.0 has no values: the items count from 1.
            items[name] = number
            continue
        least, most = NUMBER_RANGES["Integer" if version == 2 else "Int64"]
        value = item.whole("value", problems, least=least, most=most)
        if value is None:
            if "value" not in item.attributes:
                problems.append(Problem(f"item '{name}' of an enumeration has no value", item.where))
        elif value in values:
            problems.append(Problem(f"two items of an enumeration have the value {value}", item.where))
        else:
            items[name] = value
            values.add(value)
    return items
