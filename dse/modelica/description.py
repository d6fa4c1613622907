"""What an FMU made from Modelica tells of itself: modelDescription.xml for both interfaces, and a page."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

from dse.domain.component import Kind
from dse.fmu import (
    TYPES_2,
    TYPES_3,
    add_enumerations,
    add_source_files,
    add_time,
    add_units,
    description_root,
    free_name,
    number_text,
    xml_text,
)
from dse.modelica.emit.variables import Causality, FmuVariable, Variability
from dse.modelica.flat_model import ScalarType
from dse.units import Unit, UnitError, parse_unit


@dataclass(frozen=True, slots=True)
class Described:
    """What is described. *variables* are all, in order of their references; *files* lie in ``sources/``.

    *dependencies*: for outputs and derivatives by name, the names of inputs and states they depend on; what is not
    there depends on all. *indicators* counts the event indicators.
    """

    name: str
    identifier: str
    title: str
    token: str
    tolerance: float
    variables: Sequence[FmuVariable]
    indicators: int
    files: tuple[str, ...] = ()
    dependencies: Mapping[str, frozenset[str]] = field(default_factory=dict)


def describe_model(described: Described, version: int) -> bytes:
    """The description for FMI *version* 2 or 3."""
    root = description_root(described.name, described.token, described.title, version)
    if version == 2:
        root.set("numberOfEventIndicators", str(described.indicators))
    _interfaces(root, described, version)
    shown = described.variables
    units = {listed.unit for listed in shown if listed.unit and listed.kind is ScalarType.REAL}
    add_units(root, {name: _unit(name) for name in units})
    enumerations = {listed.items for listed in shown if listed.kind is ScalarType.ENUMERATION}
    add_enumerations(root, {_type_name(items): items for items in enumerations}, 1, version)
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", name="logStatusError", description="What was refused, and why")
    ET.SubElement(categories, "Category", name="logStatusWarning", description="Warnings of the model")
    ET.SubElement(root, "DefaultExperiment", startTime="0.0", tolerance=repr(described.tolerance))
    _variables(root, described, version)
    return xml_text(root)


def _interfaces(root: ET.Element, described: Described, version: int) -> None:
    state = "FMUstate" if version == 2 else "FMUState"
    saving = {f"canGetAndSet{state}": "true", f"canSerialize{state}": "true"}
    for kind in ("ModelExchange", "CoSimulation"):
        interface = ET.SubElement(root, kind, modelIdentifier=described.identifier)
        if version == 2:
            interface.set("canNotUseMemoryManagementFunctions", "true")
        elif kind == "ModelExchange":
            interface.set("needsCompletedIntegratorStep", "true")
        if kind == "CoSimulation":
            interface.set("canHandleVariableCommunicationStepSize", "true")
        for name, value in saving.items():
            interface.set(name, value)
        if version == 2:
            add_source_files(interface, described.files)


def _unit(name: str) -> Unit | None:
    try:
        return parse_unit(name)
    except UnitError:
        return None


def _type_name(items: Iterable[str]) -> str:
    return f"enumeration({', '.join(items)})"


_GROUPS = {
    2: ("Outputs", "Derivatives", "InitialUnknowns"),
    3: ("Output", "ContinuousStateDerivative", "InitialUnknown"),
}


def _variables(root: ET.Element, described: Described, version: int) -> None:
    """All variables, and the model's structure: FMI 2.0 counts variables from 1, FMI 3.0 has their references."""
    shown = described.variables
    word = "index" if version == 2 else "valueReference"
    numbers = {one.reference: number if version == 2 else one.reference for number, one in enumerate(shown, 1)}
    variables = ET.SubElement(root, "ModelVariables")
    for listed in shown:
        common, typed, kind = _common(listed), _typed(listed), Kind[listed.kind.name]
        if listed.derivative_of is not None:
            typed["derivative"] = str(numbers[listed.derivative_of])
        if version == 2:
            ET.SubElement(ET.SubElement(variables, "ScalarVariable", common), TYPES_2[kind], typed)
        else:
            ET.SubElement(variables, TYPES_3[kind], {**common, **typed})
    indicators = range(1, described.indicators + 1) if version == 3 else ()
    # The runtime's own variables come after the model's.
    first, taken = len(shown), {listed.name for listed in shown}
    if version == 3:
        add_time(variables, first, taken)
    for number in indicators:
        named = {"name": free_name(f"eventIndicator[{number}]", taken), "valueReference": str(first + number)}
        indicator = {"causality": "local", "variability": "continuous", "initial": "calculated"}
        ET.SubElement(variables, "Float64", {**named, **indicator})
    by_name = {listed.name: numbers[listed.reference] for listed in shown}
    structure = ET.SubElement(root, "ModelStructure")
    for name, unknowns in zip(_GROUPS[version], _unknowns(shown), strict=True):
        group = ET.SubElement(structure, name) if version == 2 and unknowns else structure
        for listed in unknowns:
            own = {word: str(numbers[listed.reference])}
            unknown = ET.SubElement(group, "Unknown" if version == 2 else name, own)
            if not name.startswith("Initial"):
                _depend(unknown, described, listed, by_name)
    for number in indicators:
        ET.SubElement(structure, "EventIndicator", valueReference=str(first + number))


def _unknowns(shown: Sequence[FmuVariable]) -> tuple[list[FmuVariable], list[FmuVariable], list[FmuVariable]]:
    """Outputs, derivatives of the states, and what is computed during the initialization."""
    by_reference = {listed.reference: listed for listed in shown}
    outputs = [listed for listed in shown if listed.causality is Causality.OUTPUT]
    rates = {listed.derivative_of: listed for listed in shown if listed.derivative_of is not None}
    derivatives = [rates[reference] for reference in by_reference if reference in rates]
    states = {listed.derivative_of for listed in derivatives}
    computed = {listed.reference for listed in (*outputs, *derivatives)}
    initial = [
        listed
        for listed in shown
        if listed.reference in computed | states or listed.causality is Causality.CALCULATED_PARAMETER
    ]
    return outputs, derivatives, initial


def _depend(unknown: ET.Element, described: Described, listed: FmuVariable, numbers: Mapping[str, int]) -> None:
    names = described.dependencies.get(listed.name)
    if names is not None and names <= numbers.keys():
        unknown.set("dependencies", " ".join(str(number) for number in sorted(numbers[name] for name in names)))


def _spelled(name: str) -> str:
    """The name as FMI's structured convention wants it: ``der(x,2)`` for ``der(der(x))``."""
    order = 0
    while name.startswith("der(") and name.endswith(")"):
        name, order = name[4:-1], order + 1
    return name if order == 0 else f"der({name})" if order == 1 else f"der({name},{order})"


def _common(listed: FmuVariable) -> dict[str, str]:
    attributes = {"name": _spelled(listed.name), "valueReference": str(listed.reference)}
    if listed.description:
        attributes["description"] = listed.description
    attributes["causality"] = str(listed.causality)
    attributes["variability"] = str(listed.variability)
    if listed.causality is Causality.PARAMETER or listed.variability is Variability.CONSTANT:
        attributes["initial"] = "exact"
    elif listed.causality is not Causality.INPUT:
        attributes["initial"] = "calculated"
    return attributes


def _typed(listed: FmuVariable) -> dict[str, str]:
    attributes: dict[str, str] = {}
    if listed.kind is ScalarType.ENUMERATION:
        attributes["declaredType"] = _type_name(listed.items)
    if listed.kind is ScalarType.REAL and listed.unit:
        attributes["unit"] = listed.unit
    if listed.kind in (ScalarType.REAL, ScalarType.INTEGER):
        for name, number in (("min", listed.minimum), ("max", listed.maximum)):
            if number is not None:
                attributes[name] = number_text(Kind[listed.kind.name], number)
    if listed.kind is ScalarType.REAL and listed.nominal is not None and listed.nominal > 0:
        attributes["nominal"] = repr(listed.nominal)
    if listed.start is not None:
        attributes["start"] = number_text(Kind[listed.kind.name], listed.start)
    return attributes


def documentation(title: str, model: str, files: Iterable[str], settings: str, notes: Iterable[str]) -> bytes:
    """``documentation/index.html``, which FMI has a place for; no clock, no path of this machine."""
    noted = list(notes)
    lines = [
        "<!DOCTYPE html>",
        '<html lang="en">',
        f'<head><meta charset="utf-8"><title>{escape(title)}</title></head>',
        "<body>",
        f"<h1>{escape(title)}</h1>",
        f"<p>Made by dse from the Modelica model <code>{escape(model)}</code>; {escape(settings)}.</p>",
        "<h2>What was assumed</h2>",
        *(_listed(noted) if noted else ["<p>Nothing: all starts are given, and no event joins states.</p>"]),
        "<h2>Files</h2>",
        *_listed(files),
        "</body>",
        "</html>",
    ]
    return ("\n".join(lines) + "\n").encode()


def _listed(items: Iterable[str]) -> list[str]:
    return ["<ul>", *(f"<li>{escape(item)}</li>" for item in items), "</ul>"]
