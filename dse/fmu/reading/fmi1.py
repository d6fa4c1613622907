"""modelDescription.xml of FMI 1.0 for co-simulation, in the words of the later versions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from dse.domain.component import Kind
from dse.domain.fmu import Capabilities, Variable
from dse.errors import Problem, fail
from dse.fmu.reading.declared_types import DeclaredType
from dse.fmu.reading.model_structure import Structure
from dse.fmu.reading.starts import read_start
from dse.fmu.reading.variables import (
    KINDS,
    Listed,
    accessor,
    reference_of,
    typed_element,
    values_told,
    variable_elements,
)
from dse.formats.xml import XmlElement
from dse.formats.xml_values import shortened

_CAUSALITIES = ("input", "output", "internal", "none")
_VARIABILITIES = ("constant", "parameter", "discrete", "continuous")
_ALIASES = ("noAlias", "alias", "negatedAlias")


def read_implementation(root: XmlElement, problems: list[Problem]) -> Capabilities:
    """What the ``Implementation`` element says. Raises DseError if there is none: then it is for model exchange."""
    implementation = root.child("Implementation")
    if implementation is None:
        what = "the FMU is for model exchange of FMI 1.0, which is not supported"
        raise fail(what, root.where, "export it for co-simulation, or for FMI 2.0 or 3.0")
    kind = next((child for child in implementation.children if child.tag.startswith("CoSimulation_")), None)
    if kind is None:
        raise fail("<Implementation> has no CoSimulation_StandAlone", implementation.where)
    needs_tool = kind.tag == "CoSimulation_Tool"
    told = kind.child("Capabilities")
    if told is None:
        return Capabilities(needs_tool=needs_tool)
    return Capabilities(
        can_handle_variable_step=told.flag("canHandleVariableCommunicationStepSize", problems),
        can_interpolate_inputs=told.flag("canInterpolateInputs", problems),
        # Spelled like this in the standard.
        can_run_asynchronously=told.flag("canRunAsynchronuously", problems),
        once_per_process=told.flag("canBeInstantiatedOnlyOncePerProcess", problems),
        needs_tool=needs_tool,
    )


def read_variables_1(
    root: XmlElement, types: Mapping[str, DeclaredType], problems: list[Problem]
) -> list[Listed | None]:
    """What is listed under ModelVariables, in order; None for what has a problem."""
    model = root.child("ModelVariables")
    if model is None:
        return []
    listed = [_listed(element, types, problems) for element in variable_elements(model, 1)]
    bases: dict[tuple[str, int], str] = {}
    for one in listed:
        if one is not None and _alias(one.element) == "noAlias":
            bases.setdefault((one.variable.fmi_type, one.variable.reference), one.variable.name)
    return [one and _with_base(one, bases) for one in listed]


def direct_dependencies(listed: Sequence[Listed | None]) -> Structure:
    """The inputs each output says it depends on directly; nothing is known of initialization.

    An output that names what is no variable is left out: it may depend on everything.
    """
    names = {one.variable.name for one in listed if one is not None}
    inputs = {one.variable.name for one in listed if one is not None and one.variable.causality == "input"}
    depends: dict[str, tuple[str, ...]] = {}
    for one in listed:
        told = one.element.child("DirectDependency") if one is not None else None
        if one is None or told is None or one.variable.causality != "output":
            continue
        sources = [name.text.strip() for name in told.all("Name")]
        if names.issuperset(sources):
            depends[one.variable.name] = tuple(dict.fromkeys(name for name in sources if name in inputs))
    return Structure(depends, {})


def _listed(element: XmlElement, types: Mapping[str, DeclaredType], problems: list[Problem]) -> Listed | None:
    name, before = element.required("name", problems), len(problems)
    reference = reference_of(element, problems)
    typed = typed_element(element, 1, problems)
    if typed is None or reference is None or not name:
        return None
    subject = f"variable '{shortened(name)}'"
    told = values_told(typed, 1, types, problems)
    fmi_type, kind = accessor(typed.tag, 1), KINDS[typed.tag]
    start = read_start(typed, fmi_type, 1, subject, problems)
    causality, variability = _words(element, kind, has_start=bool(start), problems=problems)
    alias = element.word("alias", _ALIASES, problems, "noAlias")
    if alias == "negatedAlias" and kind in (Kind.ENUMERATION, None):
        problems.append(Problem(f"{subject} is a negated alias, but has no opposite", element.where))
    variable = Variable(
        name=name,
        reference=reference,
        fmi_type=fmi_type,
        causality=causality,
        kind=kind,
        unit=told.unit,
        start=start,
        variability=variability,
        items=told.items,
        minimum=told.minimum,
        maximum=told.maximum,
        nominal=told.nominal,
        description=element.get("description"),
        is_negated=alias == "negatedAlias",
        is_relative=bool(told.is_relative),
    )
    return Listed(variable, element) if len(problems) == before else None


def _words(element: XmlElement, kind: Kind | None, *, has_start: bool, problems: list[Problem]) -> tuple[str, str]:
    """Causality and variability as FMI 2.0 would call them."""
    causality = element.word("causality", _CAUSALITIES, problems, "internal")
    variability = element.word("variability", _VARIABILITIES, problems, "continuous")
    if variability == "parameter":
        if causality == "output":
            return "output", "fixed"
        # Without a start it follows from others, and cannot be set.
        return ("parameter" if has_start else "calculatedParameter"), "fixed"
    if variability == "continuous" and kind is not Kind.REAL:
        variability = "discrete"
    return (causality if causality in ("input", "output") else "local"), variability


def _alias(element: XmlElement) -> str:
    return element.get("alias", "noAlias").strip()


def _with_base(one: Listed, bases: Mapping[tuple[str, int], str]) -> Listed:
    variable = one.variable
    if _alias(one.element) == "noAlias":
        return one
    base = bases.get((variable.fmi_type, variable.reference), "")
    return replace(one, variable=replace(variable, alias_of=base))
