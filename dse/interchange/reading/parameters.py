"""Parameter values (SSV) and parameter mappings (SSM)."""

from __future__ import annotations

from dse.errors import Problem, fail
from dse.formats.xml import XmlElement
from dse.formats.xml_values import shortened
from dse.interchange.reading.common import (
    META,
    SSM,
    SSV,
    TRANSFORMATIONS,
    TYPES,
    Findings,
    expect,
    read_scope,
    read_transformation,
    require_root,
    unit_of,
)
from dse.interchange.structure import MappingEntry, ParameterValue

_VALUES = frozenset(TYPES) - {"Clock"}
_TEXTS = ("String", "Binary")


def read_parameters(root: XmlElement, found: Findings) -> tuple[ParameterValue, ...]:
    """The values of an ``ssv:ParameterSet``. Raises DseError if *root* is none; all else goes to *found*."""
    require_root(root, "ParameterSet", SSV)
    expect(root, META | {"version", "name"}, {"Parameters", "Enumerations", "Units"}, found)
    scope = read_scope(root, found)
    values: dict[str, ParameterValue] = {}
    for group in root.all("Parameters"):
        expect(group, set(), {"Parameter"}, found)
        for element in group.all("Parameter"):
            expect(element, {"name"}, _VALUES | {"Dimension"}, found)
            name = element.required("name", found.problems)
            if name in values:
                found.problems.append(Problem(f"the parameter '{shortened(name)}' is there twice", element.where))
            typed = [child for child in element.children if child.tag in _VALUES]
            if len(typed) != 1:
                found.problems.append(Problem(f"<Parameter> '{shortened(name)}' needs one value", element.where))
                continue
            values[name] = ParameterValue(
                name, typed[0].tag, _texts(typed[0], found), element.where, unit_of(typed[0], scope)
            )
    return tuple(values.values())


def _texts(element: XmlElement, found: Findings) -> tuple[str, ...]:
    expect(element, {"value", "unit", "name", "mime-type"}, {"Value"}, found)
    listed = [child.get("value") for child in element.all("Value")]
    if listed:
        return tuple(listed)
    if "value" not in element.attributes:
        found.problems.append(Problem(f"<{element.tag}> has no 'value'", element.where))
    text = element.get("value")
    # SSP 2.0 writes the values of an array with blanks in between; a text or an item's name may hold some itself.
    return (text,) if element.tag in (*_TEXTS, "Enumeration") else tuple(text.split())


def read_mapping(root: XmlElement, found: Findings) -> tuple[MappingEntry, ...]:
    """The entries of an ``ssm:ParameterMapping``. Raises DseError if *root* is none; all else goes to *found*."""
    require_root(root, "ParameterMapping", SSM)
    expect(root, META | {"version"}, {"MappingEntry"}, found)
    entries = []
    targets: set[str] = set()
    for element in root.all("MappingEntry"):
        expect(element, {"source", "target", "suppressUnitConversion"}, set(TRANSFORMATIONS), found)
        target = element.required("target", found.problems)
        if target in targets:
            found.problems.append(Problem(f"'{shortened(target)}' is the target of two entries", element.where))
        targets.add(target)
        entries.append(
            MappingEntry(
                element.required("source", found.problems),
                target,
                element.where,
                read_transformation(element, found),
                element.flag("suppressUnitConversion", found.problems),
            )
        )
    return tuple(entries)


def inline(element: XmlElement, tag: str) -> XmlElement:
    """The single child *tag* that *element* holds. Raises DseError if it holds something else."""
    if len(element.children) == 1 and element.children[0].tag == tag:
        return element.children[0]
    raise fail(f"<{element.tag}> must hold one <{tag}>", element.where)
