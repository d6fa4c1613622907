"""Parameter values (SSV) and parameter mappings (SSM)."""

from __future__ import annotations

from dse.formats.xml import XmlElement
from dse.formats.xml_values import shortened
from dse.interchange.reading.common import (
    META,
    SSM,
    SSV,
    TRANSFORMATIONS,
    TYPES,
    Findings,
    read_scope,
    read_transformation,
    require_root,
    unit_of,
)
from dse.interchange.structure import MappingEntry, ParameterValue

_VALUES = TYPES - {"Clock"}


def read_parameters(root: XmlElement, found: Findings) -> tuple[ParameterValue, ...]:
    """The values of an ``ssv:ParameterSet``. Raises DseError if *root* is none; all else goes to *found*."""
    require_root(root, "ParameterSet", SSV)
    found.expect(root, META | {"version", "name"}, {"Parameters", "Enumerations", "Units"})
    scope = read_scope(root, found)
    values: dict[str, ParameterValue] = {}
    for element in found.listed(root, "Parameters", "Parameter"):
        found.expect(element, {"name"}, _VALUES | {"Dimension"})
        name = found.new(element, values, "the parameter")
        typed = [child for child in element.children if child.tag in _VALUES]
        if len(typed) != 1:
            found.add(f"<Parameter> '{shortened(name)}' needs one value", element.where)
            continue
        (value,) = typed
        values[name] = ParameterValue(name, value.tag, _texts(value, found), element.where, unit_of(value, scope))
    return tuple(values.values())


def _texts(element: XmlElement, found: Findings) -> tuple[str, ...]:
    found.expect(element, {"value", "unit", "name", "mime-type"}, {"Value"})
    listed = [child.get("value") for child in element.all("Value")]
    if listed:
        return tuple(listed)
    if "value" not in element.attributes:
        found.add(f"<{element.tag}> has no 'value'", element.where)
    text = element.get("value")
    # SSP 2.0 writes the values of an array with blanks in between; a text or an item's name may hold some itself.
    return (text,) if element.tag in ("String", "Binary", "Enumeration") else tuple(text.split())


def read_mapping(root: XmlElement, found: Findings) -> tuple[MappingEntry, ...]:
    """The entries of an ``ssm:ParameterMapping``. Raises DseError if *root* is none; all else goes to *found*."""
    require_root(root, "ParameterMapping", SSM)
    found.expect(root, META | {"version"}, {"MappingEntry"})
    entries: dict[str, MappingEntry] = {}
    for element in root.all("MappingEntry"):
        found.expect(element, {"source", "target", "suppressUnitConversion"}, TRANSFORMATIONS)
        target = element.required("target", found.problems)
        if target in entries:
            found.add(f"'{shortened(target)}' is the target of two entries", element.where)
        entries[target] = MappingEntry(
            element.required("source", found.problems),
            target,
            element.where,
            read_transformation(element, found),
            element.flag("suppressUnitConversion", found.problems),
        )
    return tuple(entries.values())
