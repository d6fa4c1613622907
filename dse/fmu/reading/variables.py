"""ModelVariables of FMI 2.0 and 3.0: every variable, checked, with what it inherits from its declared type."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import prod

from dse.domain.component import Kind
from dse.domain.fmu import Variable
from dse.errors import Problem
from dse.fmu.reading.declared_types import NUMBER_RANGES, DeclaredType, inherited, said_of_values
from dse.fmu.reading.dimensions import Sizes, read_shape, sizes_told
from dse.fmu.reading.starts import read_start
from dse.formats.xml import XmlElement
from dse.formats.xml_values import shortened

MOST_REFERENCES = 2**32
KINDS: Mapping[str, Kind | None] = {
    "Real": Kind.REAL,
    "Float32": Kind.REAL,
    "Float64": Kind.REAL,
    **dict.fromkeys(NUMBER_RANGES, Kind.INTEGER),
    "Boolean": Kind.BOOLEAN,
    "Enumeration": Kind.ENUMERATION,
    "String": None,
    "Binary": None,
    "Clock": None,
}
TYPES: Mapping[int, frozenset[str]] = {
    1: frozenset(("Real", "Integer", "Boolean", "Enumeration", "String")),
    2: frozenset(("Real", "Integer", "Boolean", "Enumeration", "String")),
    3: frozenset(KINDS) - {"Real", "Integer"},
}
"""The names of a version's types, as its descriptions spell them."""

_CAUSALITIES = ("parameter", "calculatedParameter", "input", "output", "local", "independent")
_VARIABILITIES = ("constant", "fixed", "tunable", "discrete", "continuous")
_INITIALS = ("exact", "approx", "calculated")
_PARAMETERS = ("parameter", "calculatedParameter", "structuralParameter")


@dataclass(frozen=True, slots=True)
class Listed:
    """A variable where it is listed. *derivative* is the position (FMI 2.0) or reference (3.0) of its state."""

    variable: Variable
    element: XmlElement
    derivative: int | None = None
    initial: str = ""


def read_variables(
    root: XmlElement, version: int, types: Mapping[str, DeclaredType], problems: list[Problem]
) -> list[Listed | None]:
    """What is listed under ModelVariables, in order; None for what has a problem.

    Names of FMI 3.0's aliases follow after all others, so that positions are FMI 2.0's indices (from 0).
    """
    model = root.child("ModelVariables")
    if model is None:
        problems.append(Problem("there is no <ModelVariables>", root.where))
        return []
    sizes = sizes_told(model) if version == 3 else {}
    listed = [_listed(element, version, types, sizes, problems) for element in variable_elements(model, version)]
    aliases = [alias for one in listed if one is not None for alias in _aliases(one, problems)] if version == 3 else []
    return [*listed, *aliases]


def variable_elements(model: XmlElement, version: int) -> Iterator[XmlElement]:
    """The elements below ModelVariables that are variables."""
    for element in model.children:
        if version == 3 or element.tag == "ScalarVariable":
            yield element


def typed_element(element: XmlElement, version: int, problems: list[Problem]) -> XmlElement | None:
    """The element that has the attributes of a variable's type; None and a problem if there is none."""
    names = TYPES[version]
    candidates = (element,) if version == 3 else element.children
    typed = next((child for child in candidates if child.tag in names), None)
    if typed is None:
        problems.append(Problem(f"{_subject(element)} has no type of FMI {version}.0", element.where))
    return typed


def reference_of(element: XmlElement, problems: list[Problem]) -> int | None:
    """A variable's value reference; None and a problem if there is none."""
    if "valueReference" not in element.attributes:
        problems.append(Problem(f"{_subject(element)} has no value reference", element.where))
    return element.whole("valueReference", problems, least=0, most=MOST_REFERENCES - 1)


def values_told(
    typed: XmlElement, version: int, types: Mapping[str, DeclaredType], problems: list[Problem]
) -> DeclaredType:
    """What a variable says of its values, with what its declared type adds."""
    own = said_of_values(typed, typed.tag, version, problems)
    # A type that is not defined, or one of another base, adds nothing: no value depends on it.
    declared = types.get(typed.get("declaredType"))
    told = inherited(own, declared if declared is not None and declared.base == typed.tag else None)
    # The same holds for limits that no value lies between.
    if told.minimum is not None and told.maximum is not None and not told.minimum <= told.maximum:
        return replace(told, minimum=None, maximum=None)
    return told


def accessor(base: str, version: int) -> str:
    """The type by whose functions a variable of the type *base* is read and written."""
    if base == "Enumeration":
        return "Int64" if version == 3 else "Integer"
    return base


def _listed(
    element: XmlElement, version: int, types: Mapping[str, DeclaredType], sizes: Sizes, problems: list[Problem]
) -> Listed | None:
    name, before = element.required("name", problems), len(problems)
    reference = reference_of(element, problems)
    typed = typed_element(element, version, problems)
    if typed is None or reference is None or not name:
        return None
    subject = f"variable '{shortened(name)}'"
    causalities = (*_CAUSALITIES, "structuralParameter") if version == 3 else _CAUSALITIES
    causality = element.word("causality", causalities, problems, "local")
    # Some tools call what was a parameter in the model a constant parameter; nobody can set it.
    if causality == "parameter" and element.get("variability").strip() == "constant":
        causality = "local"
    told = values_told(typed, version, types, problems)
    fmi_type, kind = accessor(typed.tag, version), KINDS[typed.tag]
    shape, sized_by = read_shape(element, subject, sizes, problems) if version == 3 else ((), ())
    variable = Variable(
        name=name,
        reference=reference,
        fmi_type=fmi_type,
        causality=causality,
        kind=kind,
        unit=told.unit,
        start=read_start(typed, fmi_type, version, subject, problems) if prod(shape) else (),
        variability=_variability(element, causality, kind, problems),
        shape=shape,
        sized_by=sized_by,
        items=told.items,
        minimum=told.minimum,
        maximum=told.maximum,
        nominal=told.nominal,
        description=element.get("description"),
        is_relative=bool(told.is_relative),
        is_clocked=bool(element.get("clocks").strip()),
        is_intermediate=element.flag("intermediateUpdate", problems),
    )
    if len(problems) == before and len(variable.start) not in (0, 1, variable.size):
        of = f"{variable.size} elements" if variable.shape else "a single one"
        what = f"{subject} has {len(variable.start)} start values for {of}"
        problems.append(Problem(what, typed.where))
    initial = element.word("initial", _INITIALS, problems)
    derivative = typed.whole("derivative", problems, least=0)
    return Listed(variable, element, derivative, initial) if len(problems) == before else None


def _subject(element: XmlElement) -> str:
    name = element.get("name")
    return f"variable '{shortened(name)}'" if name else f"<{element.tag}>"


def _variability(element: XmlElement, causality: str, kind: Kind | None, problems: list[Problem]) -> str:
    """As it is said, or as the FMI documents say it is if nothing is said."""
    said = element.word("variability", _VARIABILITIES, problems)
    if said == "constant" and causality in ("input", "structuralParameter"):
        what = f"{_subject(element)} is constant and {causality}, which excludes each other"
        problems.append(Problem(what, element.where))
    if causality in _PARAMETERS:
        return said if said in ("fixed", "tunable", "constant") else "fixed"
    # Descriptions that call everything continuous are common; only real numbers can be.
    if kind is not Kind.REAL and said in ("", "continuous"):
        return "discrete"
    return said or "continuous"


def _aliases(one: Listed, problems: list[Problem]) -> Iterator[Listed]:
    for alias in one.element.all("Alias"):
        name = alias.required("name", problems)
        description = alias.get("description")
        yield replace(
            one, variable=replace(one.variable, name=name, description=description, alias_of=one.variable.name)
        )
