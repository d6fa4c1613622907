"""Parameter bindings: which parameter set goes where, and under which names."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath

from dse.errors import DseError, Location, Problem, fail
from dse.formats import XmlElement, read_xml, shortened
from dse.interchange.reading.common import (
    META,
    SSM,
    SSV,
    TRANSFORMATIONS,
    TYPES,
    Findings,
    inline,
    own_elements,
    read_scope,
    read_transformation,
    require_root,
    unit_of,
)
from dse.interchange.reading.package import PackageFile
from dse.interchange.structure import Assignment, ParameterValue

_SET = "application/x-ssp-parameter-set"
_MAPPING = "application/x-ssp-parameter-mapping"
_MOST_BYTES = 128 * 2**20


def read_bindings(file: PackageFile, element: XmlElement, fmu: Path | None, found: Findings) -> tuple[Assignment, ...]:
    """What the bindings of *element*, which stands in *file*, give; what is wrong with them goes to *found*.

    *fmu* is the component's archive, in which sets and mappings may lie, too.
    """
    assigned: list[Assignment] = []
    for child in found.listed(element, "ParameterBindings", "ParameterBinding"):
        try:
            assigned += _binding(file, child, fmu, found)
        except DseError as error:
            found.problems += error.problems
    return tuple(assigned)


def _binding(file: PackageFile, element: XmlElement, fmu: Path | None, found: Findings) -> tuple[Assignment, ...]:
    found.expect(element, {"type", "source", "sourceBase", "prefix"}, {"ParameterValues", "ParameterMapping"})
    _require_type(element, _SET, "parameter set")
    values = element.child("ParameterValues")
    if element.get("source"):
        if values is not None:
            raise fail("a binding with a 'source' has no <ParameterValues>", values.where, "remove one of them")
        root = _named(file, element, fmu, found)
    elif values is None:
        raise fail("the binding has neither a 'source' nor <ParameterValues>", element.where)
    else:
        root = inline(values, "ParameterSet")
    prefix = element.get("prefix")
    parameters = {prefix + name: value for name, value in read_parameters(root, found).items()}
    mapped = element.child("ParameterMapping")
    if mapped is None:
        return tuple(Assignment(name, value, value.where) for name, value in parameters.items())
    # With a mapping, only what it names is applied (SSP, ParameterBindings).
    found.expect(mapped, {"type", "source", "sourceBase"}, {"ParameterMapping"})
    _require_type(mapped, _MAPPING, "parameter mapping")
    rules = _named(file, mapped, fmu, found) if mapped.get("source") else inline(mapped, "ParameterMapping")
    return read_mapping(rules, parameters, found)


def _require_type(element: XmlElement, expected: str, what: str) -> None:
    type_ = element.get("type", expected)
    if type_ != expected:
        raise fail(f"the {what} is of the type '{shortened(type_)}', which is not supported", element.where)


def _named(file: PackageFile, element: XmlElement, fmu: Path | None, found: Findings) -> XmlElement:
    source = element.get("source")
    if element.word("sourceBase", ("SSD", "component"), found.problems, "SSD") == "SSD":
        return file.read(source, element.where, found)
    if fmu is None:
        raise fail(f"'{shortened(source)}' should be in the component, which is not an FMU", element.where)
    called = file.package.place(PurePosixPath(fmu.relative_to(file.package.folder).as_posix()))
    root = read_xml(_entry(fmu, source, element.where), f"{called}/{source}", found.ignored)
    return own_elements(root, found)


def _entry(fmu: Path, name: str, where: Location) -> bytes:
    """The file *name* in the archive *fmu*, which is looked into, not unpacked."""
    try:
        with zipfile.ZipFile(fmu) as archive, archive.open(name) as entry:
            content = entry.read(_MOST_BYTES + 1)
    except KeyError as error:
        raise fail(f"there is no file '{shortened(name)}' in the FMU {fmu.name}", where) from error
    except (zipfile.BadZipFile, OSError, RuntimeError, NotImplementedError, ValueError, EOFError) as error:
        raise fail(f"the FMU {fmu.name} cannot be read: {error}", where) from error
    if len(content) > _MOST_BYTES:
        raise fail(f"'{shortened(name)}' in the FMU {fmu.name} is too large", where)
    return content


# Parameter values (SSV) and parameter mappings (SSM).


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
