"""modelDescription.xml of an FMU made from Modelica: all its variables, for model exchange and co-simulation."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from dse.fmu.c.describe import add_base_unit, xml_text
from dse.modelica.emit.variables import Causality, FmuVariable, Variability
from dse.modelica.flat import Kind
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
    shown = [listed for listed in described.variables if is_shown(listed)]
    _units(root, shown)
    _types(root, shown, version)
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", name="logStatusError", description="What was refused, and why")
    ET.SubElement(categories, "Category", name="logStatusWarning", description="Warnings of the model")
    ET.SubElement(root, "DefaultExperiment", startTime="0.0", tolerance=repr(described.tolerance))
    (_variables_2 if version == 2 else _variables_3)(root, described, shown)
    return xml_text(root)


def is_shown(listed: FmuVariable) -> bool:
    """Whether the variable is the model's, not one that came in between."""
    return not listed.name.startswith("$")


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
    names = sorted({listed.unit for listed in shown if listed.unit and listed.kind is Kind.REAL})
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
    types = sorted({listed.items for listed in shown if listed.kind is Kind.ENUMERATION})
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


_TYPES_2 = {Kind.REAL: "Real", Kind.INTEGER: "Integer", Kind.BOOLEAN: "Boolean", Kind.ENUMERATION: "Enumeration"}
_TYPES_3 = {Kind.REAL: "Float64", Kind.INTEGER: "Int32", Kind.BOOLEAN: "Boolean", Kind.ENUMERATION: "Enumeration"}


def _variables_2(root: ET.Element, described: Described, shown: Sequence[FmuVariable]) -> None:
    index = {listed.reference: number for number, listed in enumerate(shown, start=1)}
    variables = ET.SubElement(root, "ModelVariables")
    for listed in shown:
        typed = _typed(listed)
        if listed.derivative_of is not None:
            typed["derivative"] = str(index[listed.derivative_of])
        variable = ET.SubElement(variables, "ScalarVariable", _common(listed))
        ET.SubElement(variable, _TYPES_2[listed.kind], typed)
    structure = ET.SubElement(root, "ModelStructure")
    outputs, derivatives, initial = _unknowns(shown)
    for name, unknowns in (("Outputs", outputs), ("Derivatives", derivatives), ("InitialUnknowns", initial)):
        group = ET.SubElement(structure, name) if unknowns else structure
        for listed in unknowns:
            unknown = ET.SubElement(group, "Unknown", index=str(index[listed.reference]))
            if name != "InitialUnknowns":
                _depend(unknown, described, listed, {other.name: index[other.reference] for other in shown})


def _variables_3(root: ET.Element, described: Described, shown: Sequence[FmuVariable]) -> None:
    variables = ET.SubElement(root, "ModelVariables")
    for listed in shown:
        attributes = {**_common(listed), **_typed(listed)}
        if listed.derivative_of is not None:
            attributes["derivative"] = str(listed.derivative_of)
        ET.SubElement(variables, _TYPES_3[listed.kind], attributes)
    taken = {listed.name for listed in shown}
    # The runtime's own variables come after the model's, whether those are shown or not.
    first = len(described.variables)
    ET.SubElement(
        variables,
        "Float64",
        name=_free("time", taken),
        valueReference=str(first),
        causality="independent",
        variability="continuous",
        description="Simulation time in seconds",
    )
    for number in range(1, described.indicators + 1):
        ET.SubElement(
            variables,
            "Float64",
            name=_free(f"eventIndicator[{number}]", taken),
            valueReference=str(first + number),
            causality="local",
            variability="continuous",
            initial="calculated",
        )
    references = {listed.name: listed.reference for listed in shown}
    structure = ET.SubElement(root, "ModelStructure")
    outputs, derivatives, initial = _unknowns(shown)
    for name, unknowns in (
        ("Output", outputs),
        ("ContinuousStateDerivative", derivatives),
        ("InitialUnknown", initial),
    ):
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
    if listed.kind is Kind.ENUMERATION:
        attributes["declaredType"] = _type_name(listed.items)
    if listed.kind is Kind.REAL and listed.unit:
        attributes["unit"] = listed.unit
    if listed.kind in (Kind.REAL, Kind.INTEGER):
        for name, number in (("min", listed.minimum), ("max", listed.maximum)):
            if number is not None:
                attributes[name] = _number(listed.kind, number)
    if listed.kind is Kind.REAL and listed.nominal is not None and listed.nominal > 0:
        attributes["nominal"] = repr(listed.nominal)
    if listed.start is not None:
        attributes["start"] = _number(listed.kind, listed.start)
    return attributes


def _number(kind: Kind, number: float) -> str:
    if kind is Kind.REAL:
        return repr(float(number))
    if kind is Kind.BOOLEAN:
        return "true" if number else "false"
    return str(int(number))
