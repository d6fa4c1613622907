"""What an FMU made from Modelica tells of itself: modelDescription.xml for both interfaces, and a page."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

from dse.fmu import add_base_unit, xml_text
from dse.modelica.emit.variables import Causality, FmuVariable, Variability
from dse.modelica.flat_model import ScalarType
from dse.units import UnitError, parse_unit


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
    root = ET.Element("fmiModelDescription", fmiVersion="2.0" if version == 2 else "3.0", modelName=described.name)
    root.set("guid" if version == 2 else "instantiationToken", described.token)
    if described.title:
        root.set("description", described.title)
    root.set("generationTool", "dse")
    root.set("variableNamingConvention", "structured")
    if version == 2:
        root.set("numberOfEventIndicators", str(described.indicators))
    _interfaces(root, described, version)
    _units(root, described.variables)
    _types(root, described.variables, version)
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", name="logStatusError", description="What was refused, and why")
    ET.SubElement(categories, "Category", name="logStatusWarning", description="Warnings of the model")
    ET.SubElement(root, "DefaultExperiment", startTime="0.0", tolerance=repr(described.tolerance))
    (_variables_2 if version == 2 else _variables_3)(root, described)
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
            sources = ET.SubElement(interface, "SourceFiles")
            for file in described.files:
                ET.SubElement(sources, "File", name=file)


def _units(root: ET.Element, shown: Iterable[FmuVariable]) -> None:
    names = sorted({listed.unit for listed in shown if listed.unit and listed.kind is ScalarType.REAL})
    if not names:
        return
    definitions = ET.SubElement(root, "UnitDefinitions")
    for name in names:
        element = ET.SubElement(definitions, "Unit", name=name)
        try:
            add_base_unit(element, parse_unit(name))
        except UnitError:
            continue  # FMI lets a unit be a name alone


def _types(root: ET.Element, shown: Iterable[FmuVariable], version: int) -> None:
    types = sorted({listed.items for listed in shown if listed.kind is ScalarType.ENUMERATION})
    if not types:
        return
    definitions = ET.SubElement(root, "TypeDefinitions")
    for items in types:
        if version == 2:
            parent = ET.SubElement(ET.SubElement(definitions, "SimpleType", name=_type_name(items)), "Enumeration")
        else:
            parent = ET.SubElement(definitions, "EnumerationType", name=_type_name(items))
        for number, item in enumerate(items, start=1):
            ET.SubElement(parent, "Item", name=item, value=str(number))


def _type_name(items: Iterable[str]) -> str:
    return f"enumeration({', '.join(items)})"


_NUMBERS_3 = {ScalarType.REAL: "Float64", ScalarType.INTEGER: "Int32"}


def _variables_2(root: ET.Element, described: Described) -> None:
    shown = described.variables
    index = {listed.reference: number for number, listed in enumerate(shown, start=1)}
    variables = ET.SubElement(root, "ModelVariables")
    for listed in shown:
        typed = _typed(listed)
        if listed.derivative_of is not None:
            typed["derivative"] = str(index[listed.derivative_of])
        variable = ET.SubElement(variables, "ScalarVariable", _common(listed))
        ET.SubElement(variable, listed.kind.capitalize(), typed)
    structure = ET.SubElement(root, "ModelStructure")
    outputs, derivatives, initial = _unknowns(shown)
    for name, unknowns in {"Outputs": outputs, "Derivatives": derivatives, "InitialUnknowns": initial}.items():
        group = ET.SubElement(structure, name) if unknowns else structure
        for listed in unknowns:
            unknown = ET.SubElement(group, "Unknown", index=str(index[listed.reference]))
            if name != "InitialUnknowns":
                _depend(unknown, described, listed, {other.name: index[other.reference] for other in shown})


def _variables_3(root: ET.Element, described: Described) -> None:
    shown = described.variables
    variables = ET.SubElement(root, "ModelVariables")
    for listed in shown:
        attributes = {**_common(listed), **_typed(listed)}
        if listed.derivative_of is not None:
            attributes["derivative"] = str(listed.derivative_of)
        ET.SubElement(variables, _NUMBERS_3.get(listed.kind, listed.kind.capitalize()), attributes)
    taken = {listed.name for listed in shown}
    # The runtime's own variables come after the model's.
    first = len(described.variables)
    time = {"causality": "independent", "variability": "continuous", "description": "Simulation time in seconds"}
    ET.SubElement(variables, "Float64", {"name": _free("time", taken), "valueReference": str(first), **time})
    indicator = {"causality": "local", "variability": "continuous", "initial": "calculated"}
    for number in range(1, described.indicators + 1):
        named = {"name": _free(f"eventIndicator[{number}]", taken), "valueReference": str(first + number)}
        ET.SubElement(variables, "Float64", {**named, **indicator})
    references = {listed.name: listed.reference for listed in shown}
    structure = ET.SubElement(root, "ModelStructure")
    outputs, derivatives, initial = _unknowns(shown)
    groups = {"Output": outputs, "ContinuousStateDerivative": derivatives, "InitialUnknown": initial}
    for name, unknowns in groups.items():
        for listed in unknowns:
            unknown = ET.SubElement(structure, name, valueReference=str(listed.reference))
            if name != "InitialUnknown":
                _depend(unknown, described, listed, references)
    for number in range(1, described.indicators + 1):
        ET.SubElement(structure, "EventIndicator", valueReference=str(first + number))


def _free(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    return name


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
                attributes[name] = _number(listed.kind, number)
    if listed.kind is ScalarType.REAL and listed.nominal is not None and listed.nominal > 0:
        attributes["nominal"] = repr(listed.nominal)
    if listed.start is not None:
        attributes["start"] = _number(listed.kind, listed.start)
    return attributes


def _number(kind: ScalarType, number: float) -> str:
    if kind is ScalarType.REAL:
        return repr(float(number))
    if kind is ScalarType.BOOLEAN:
        return "true" if number else "false"
    return str(int(number))


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
