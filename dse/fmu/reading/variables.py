"""ModelVariables of FMI 2.0 and 3.0: every variable, checked, with what it inherits from its declared type."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import prod

from dse.domain.component import Kind
from dse.domain.fmu import ClockKind, Timing, Variable
from dse.errors import Problem
from dse.fmu.reading.declared_types import NUMBER_RANGES, DeclaredType, declared_values, inherited
from dse.fmu.reading.dimensions import Sizes, declared_sizes, read_shape
from dse.formats import XmlElement, flag_of, real_of, shortened, whole_of

VALUE_KINDS: Mapping[str, Kind | None] = {
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
_TYPES_1 = frozenset(("Real", "Integer", "Boolean", "Enumeration", "String"))
_TYPES = {1: _TYPES_1, 2: _TYPES_1, 3: frozenset(VALUE_KINDS) - {"Real", "Integer"}}
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
        if version > 1:
            problems.append(Problem("there is no <ModelVariables>", root.where))
        return []
    sizes = declared_sizes(model) if version == 3 else {}
    elements = model.children if version == 3 else model.all("ScalarVariable")
    listed = [_listed(element, version, types, sizes, problems) for element in elements]
    if version == 1:
        return list(_with_bases(listed, problems))
    aliases = [alias for one in listed if one is not None for alias in _aliases(one, problems)] if version == 3 else []
    return [*listed, *aliases]


def _typed(element: XmlElement, version: int, problems: list[Problem]) -> XmlElement | None:
    """The element that has the attributes of a variable's type; None and a problem if there is none."""
    candidates = (element,) if version == 3 else element.children
    typed = next((child for child in candidates if child.tag in _TYPES[version]), None)
    if typed is None:
        problems.append(Problem(f"{_subject(element)} has no type of FMI {version}.0", element.where))
    return typed


def _reference(element: XmlElement, problems: list[Problem]) -> int | None:
    """A variable's value reference; None and a problem if there is none."""
    if "valueReference" not in element.attributes:
        problems.append(Problem(f"{_subject(element)} has no value reference", element.where))
    return element.whole("valueReference", problems, least=0, most=2**32 - 1)


def _declared(
    typed: XmlElement, version: int, types: Mapping[str, DeclaredType], problems: list[Problem]
) -> DeclaredType:
    """What a variable says of its values, with what its declared type adds."""
    own = declared_values(typed, typed.tag, version, problems)
    # A type that is not defined, or one of another base, adds nothing: no value depends on it.
    declared = types.get(typed.get("declaredType"))
    told = inherited(own, declared if declared is not None and declared.base == typed.tag else None)
    # The same holds for limits that no value lies between.
    if told.minimum is not None and told.maximum is not None and not told.minimum <= told.maximum:
        return replace(told, minimum=None, maximum=None)
    return told


def _listed(
    element: XmlElement, version: int, types: Mapping[str, DeclaredType], sizes: Sizes, problems: list[Problem]
) -> Listed | None:
    name, before = element.required("name", problems), len(problems)
    reference = _reference(element, problems)
    typed = _typed(element, version, problems)
    if typed is None or reference is None or not name:
        return None
    subject = f"variable '{shortened(name)}'"
    told = _declared(typed, version, types, problems)
    fmi_type, kind = typed.tag, VALUE_KINDS[typed.tag]
    if fmi_type == "Enumeration":  # read and written by the functions of a whole number
        fmi_type = "Int64" if version == 3 else "Integer"
    shape, sized_by = read_shape(element, subject, sizes, problems) if version == 3 else ((), ())
    start = read_start(typed, fmi_type, version, subject, problems) if prod(shape) else ()
    if version == 1:
        causality, variability = _words_1(element, kind, has_start=bool(start), problems=problems)
    else:
        causality, variability = _words(element, version, kind, problems)
    variable = Variable(
        name=name,
        reference=reference,
        fmi_type=fmi_type,
        causality=causality,
        kind=kind,
        unit=told.unit,
        start=start,
        variability=variability,
        shape=shape,
        sized_by=sized_by,
        items=told.items,
        minimum=told.minimum,
        maximum=told.maximum,
        nominal=told.nominal,
        description=element.get("description"),
        is_relative=bool(told.is_relative),
        is_intermediate=element.flag("intermediateUpdate", problems),
        clocks=read_clocks(element, problems),
        timing=read_timing(element, subject, problems) if fmi_type == "Clock" else None,
        media=" ".join(typed.get("mimeType").split()) if fmi_type == "Binary" else "",
    )
    if len(problems) == before and len(start) not in (0, 1, variable.size):
        of = f"{variable.size} elements" if shape else "a single one"
        problems.append(Problem(f"{subject} has {len(start)} start values for {of}", typed.where))
    initial = element.word("initial", _INITIALS, problems)
    variable = replace(variable, is_settable=_is_settable(variable, initial))
    derivative = typed.whole("derivative", problems, least=0)
    return Listed(variable, element, derivative, initial) if len(problems) == before else None


def _is_settable(variable: Variable, initial: str) -> bool:
    """By the tables of *initial* (FMI 2.0, 2.2.7; 3.0, 2.4.7); without a word, what has a start value is taken to
    have one that can be changed, as in FMI 1.0."""
    if variable.variability == "constant" or variable.causality == "independent":
        return False
    if variable.causality in ("input", "parameter", "structuralParameter"):
        return True
    return initial in ("exact", "approx") or (not initial and bool(variable.start))


def _subject(element: XmlElement) -> str:
    name = element.get("name")
    return f"variable '{shortened(name)}'" if name else f"<{element.tag}>"


def _words(element: XmlElement, version: int, kind: Kind | None, problems: list[Problem]) -> tuple[str, str]:
    """Causality and variability as they are said, or as the FMI documents say they are if nothing is said."""
    causalities = (*_CAUSALITIES, "structuralParameter") if version == 3 else _CAUSALITIES
    causality = element.word("causality", causalities, problems, "local")
    said = element.word("variability", _VARIABILITIES, problems)
    # Some tools call what was a parameter in the model a constant parameter; nobody can set it.
    if causality == "parameter" and said == "constant":
        causality = "local"
    if said == "constant" and causality in ("input", "structuralParameter"):
        what = f"{_subject(element)} is constant and {causality}, which excludes each other"
        problems.append(Problem(what, element.where))
    if causality in _PARAMETERS:
        return causality, said if said in ("fixed", "tunable", "constant") else "fixed"
    # Descriptions that call everything continuous are common; only real numbers can be.
    if kind is not Kind.REAL and said in ("", "continuous"):
        return causality, "discrete"
    return causality, said or "continuous"


def _aliases(one: Listed, problems: list[Problem]) -> Iterator[Listed]:
    for alias in one.element.all("Alias"):
        name = alias.required("name", problems)
        description = alias.get("description")
        yield replace(
            one, variable=replace(one.variable, name=name, description=description, alias_of=one.variable.name)
        )


_CAUSALITIES_1 = ("input", "output", "internal", "none")
_VARIABILITIES_1 = ("constant", "parameter", "discrete", "continuous")
_ALIASES_1 = ("noAlias", "alias", "negatedAlias")


def _words_1(element: XmlElement, kind: Kind | None, *, has_start: bool, problems: list[Problem]) -> tuple[str, str]:
    """Causality and variability in FMI 1.0, as FMI 2.0 would call them."""
    causality = element.word("causality", _CAUSALITIES_1, problems, "internal")
    variability = element.word("variability", _VARIABILITIES_1, problems, "continuous")
    if variability == "parameter":
        if causality == "output":
            return "output", "fixed"
        # Without a start it follows from others, and cannot be set.
        return ("parameter" if has_start else "calculatedParameter"), "fixed"
    if variability == "continuous" and kind is not Kind.REAL:
        variability = "discrete"
    return (causality if causality in ("input", "output") else "local"), variability


def _with_bases(listed: list[Listed | None], problems: list[Problem]) -> Iterator[Listed | None]:
    """What FMI 1.0 lists, with its aliases: variables that share a reference with one that is none."""
    said = [one and one.element.word("alias", _ALIASES_1, problems, "noAlias") for one in listed]
    pairs = list(zip(listed, said, strict=True))
    bases: dict[tuple[str, int], str] = {}
    for one, alias in pairs:
        if one is not None and alias == "noAlias":
            bases.setdefault((one.variable.fmi_type, one.variable.reference), one.variable.name)
    for one, alias in pairs:
        if one is None or alias == "noAlias":
            yield one
            continue
        variable, is_negated = one.variable, alias == "negatedAlias"
        if is_negated and variable.kind in (Kind.ENUMERATION, None):
            what = f"{_subject(one.element)} is a negated alias, but has no opposite"
            problems.append(Problem(what, one.element.where))
        base = bases.get((variable.fmi_type, variable.reference), "")
        yield replace(one, variable=replace(variable, alias_of=base, is_negated=is_negated))


# Clocks of FMI 3.0: what ticks when, and which variables belong to them.


_MOST = 2**53  # as exact as a double


def read_clocks(element: XmlElement, problems: list[Problem]) -> tuple[int, ...]:
    """The references of the clocks that a variable belongs to."""
    words = element.get("clocks").split()
    found = [number for number in map(whole_of, words) if number is not None]
    if len(found) < len(words):
        what = f"<{element.tag}>: 'clocks' must be a list of references, not '{shortened(element.get('clocks'))}'"
        problems.append(Problem(what, element.where))
    return tuple(dict.fromkeys(found))


def read_timing(element: XmlElement, subject: str, problems: list[Problem]) -> Timing:
    """When the clock ticks that *element* describes and messages call *subject*."""
    word = element.word("intervalVariability", [kind.value for kind in ClockKind], problems)
    if "intervalVariability" not in element.attributes:
        problems.append(
            Problem(f"{subject} does not declare when it ticks: it has no 'intervalVariability'", element.where)
        )
    kind = ClockKind(word) if word else ClockKind.TRIGGERED
    has_fractions = element.flag("supportsFraction", problems)
    counts = {
        name: element.whole(name, problems, least=0, most=_MOST)
        for name in ("resolution", "intervalCounter", "shiftCounter")
    }
    seconds = {name: element.real(name, problems) for name in ("intervalDecimal", "shiftDecimal")}
    interval, shift, resolution = seconds["intervalDecimal"], seconds["shiftDecimal"] or 0.0, 1.0
    if counts["resolution"] and counts["intervalCounter"]:
        interval, shift = float(counts["intervalCounter"]), float(counts["shiftCounter"] or 0)
        resolution = float(counts["resolution"])
    if interval is None:
        if kind is ClockKind.CONSTANT:
            problems.append(Problem(f"{subject} is a constant clock, but has no interval", element.where))
        return Timing(kind, has_fractions=has_fractions)
    if not (0.0 < interval < float("inf") and 0.0 <= shift < float("inf")):
        what = f"{subject} cannot tick every {interval / resolution:g} s from {shift / resolution:g} s on"
        problems.append(Problem(what, element.where))
    return Timing(kind, True, interval, shift, resolution, has_fractions)


# Start values of an FMU's variables: one text per value, each fit for its type.


_HEXADECIMAL = re.compile(r"(?:[0-9A-Fa-f]{2})*")
_LARGEST_FLOAT32 = 3.4028235677973366e38


def read_start(
    typed: XmlElement, fmi_type: str, version: int, subject: str, problems: list[Problem]
) -> tuple[str, ...]:
    """The start values that *typed* gives for *subject*; a problem if one of them is none of *fmi_type*.

    FMI 3.0 gives strings and binaries as ``Start`` elements and all else as a list; FMI 1.0 and 2.0 give one value.
    """
    if version == 3 and fmi_type in ("String", "Binary"):
        texts = tuple(element.get("value") for element in typed.all("Start"))
    elif "start" not in typed.attributes:
        return ()
    elif version == 3:
        texts = tuple(typed.get("start").split()) or ("",)
    else:
        texts = (typed.get("start") if fmi_type == "String" else typed.get("start").strip(),)
    for text in texts:
        expected = _expected(fmi_type, text)
        if expected:
            problems.append(Problem(f"{subject}: the start value '{shortened(text)}' is not {expected}", typed.where))
            return ()
    return texts


def _expected(fmi_type: str, text: str) -> str:
    """What the text of a start value should have been; "" if it is right."""
    if fmi_type in ("Real", "Float64", "Float32"):
        value = real_of(text)
        if value is None:
            return "a number"
        too_large = fmi_type == "Float32" and _LARGEST_FLOAT32 <= abs(value) < float("inf")
        return "in the range of Float32" if too_large else ""
    if fmi_type in NUMBER_RANGES:
        number, (least, most) = whole_of(text), NUMBER_RANGES[fmi_type]
        if number is None:
            return "a whole number"
        return "" if least <= number <= most else f"from {least} to {most}"
    if fmi_type == "Boolean":
        return "" if flag_of(text) is not None else "true or false"
    if fmi_type == "Binary":
        return "" if _HEXADECIMAL.fullmatch(text) else "a text of hexadecimal digits"
    return ""
