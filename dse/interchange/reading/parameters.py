"""Parameter values (SSV) and parameter mappings (SSM)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from dse.errors import Problem
from dse.formats import XmlElement, shortened
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
from dse.interchange.structure import Assignment, ParameterValue

_VALUES = TYPES - {"Clock"}


def read_parameters(root: XmlElement, found: Findings) -> dict[str, ParameterValue]:
    """The values, by name, of an ``ssv:ParameterSet``. Raises DseError if *root* is none; all else goes to *found*."""
    require_root(root, "ParameterSet", SSV, found)
    found.expect(root, META | {"version", "name"}, {"Parameters", "Enumerations", "Units"})
    scope = read_scope(root, found)
    values: dict[str, ParameterValue] = {}
    for element in found.listed(root, "Parameters", "Parameter"):
        found.expect(element, {"name"}, _VALUES | {"Dimension"})
        name = element.required("name", found.problems)
        typed = [child for child in element.children if child.tag in _VALUES]
        if len(typed) != 1:
            found.add(f"<Parameter> '{shortened(name)}' needs one value", element.where)
            continue
        (value,) = typed
        given = ParameterValue(value.tag, _texts(value, found), element.where, unit_of(value, scope))
        first = values.setdefault(name, given)
        if first is given:
            continue
        if replace(given, where=first.where, rival=first.rival) == first:
            found.ignore(f"the parameter '{shortened(name)}' is there twice", element.where)
        else:
            found.ignore(f"the parameter '{shortened(name)}' is there twice, with another value", element.where)
            values[name] = replace(first, rival=element.where)
    return values


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


def read_mapping(root: XmlElement, values: Mapping[str, ParameterValue], found: Findings) -> tuple[Assignment, ...]:
    """What the entries of an ``ssm:ParameterMapping`` do with *values*.

    Raises DseError if *root* is none; all else goes to *found*.
    """
    require_root(root, "ParameterMapping", SSM, found)
    found.expect(root, META | {"version"}, {"MappingEntry"})
    assigned: list[Assignment] = []
    targets: set[str] = set()
    for element in root.all("MappingEntry"):
        found.expect(element, {"source", "target", "suppressUnitConversion"}, TRANSFORMATIONS)
        if element.attributes.get("source") == "":
            found.ignore(f"no source is given for '{shortened(element.get('target'))}'", element.where)
            continue
        source, target = element.required("source", found.problems), element.required("target", found.problems)
        if target in targets:
            found.add(f"'{shortened(target)}' is the target of two entries", element.where)
        targets.add(target)
        transformation = read_transformation(element, found)
        suppresses = element.flag("suppressUnitConversion", found.problems)
        if source in values:
            assigned.append(Assignment(target, values[source], element.where, transformation, suppresses))
        else:
            what = f"the parameter set has no '{shortened(source)}', so that '{shortened(target)}' is not set"
            found.notes.append(Problem(what, element.where))
    return tuple(assigned)
