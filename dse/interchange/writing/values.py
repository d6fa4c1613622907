"""Start values as parameter sets: those that differ from what the FMU starts with by itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from xml.etree import ElementTree as ET

from dse.domain.component import Kind
from dse.domain.fmu import Variable
from dse.domain.system import Element
from dse.errors import fail
from dse.formats import flag_of, real_of
from dse.interchange.resolving.carry import Carry
from dse.interchange.writing.type_definitions import Definitions

Inside = float | str | bytes

_SET = "start_values"


def add_values(component: ET.Element, element: Element, version: str) -> None:
    """A parameter binding of *component* with what *element* starts with; none if that is what the FMU says.

    All sets have one name, as some programs apply those that have the name they are told.
    """
    values = {**element.start, **element.texts}
    given = {label: inside(element, element.model.variable_of(label), value) for label, value in values.items()}
    lines: list[tuple[Variable, list[Inside]]] = []
    for variable in element.model.variables.values():
        own = starts(variable)
        labels = variable.labels
        if not any(label in given for label in labels):
            continue
        known = {**own, **{label: given[label] for label in labels if label in given}}
        if known == own:
            continue
        if len(known) < len(labels):
            raise fail(f"{element.name}.{variable.name}: only some of its values are given, which SSP cannot express")
        lines.append((variable, [known[label] for label in labels]))
    if not lines:
        return
    bindings = ET.SubElement(component, "ssd:ParameterBindings")
    binding = ET.SubElement(bindings, "ssd:ParameterBinding")
    inline = ET.SubElement(binding, "ssd:ParameterValues")
    written = ET.SubElement(inline, "ssv:ParameterSet", version=version, name=_SET)
    parameters = ET.SubElement(written, "ssv:Parameters")
    definitions = Definitions(version)
    for variable, own_values in lines:
        entry = ET.SubElement(parameters, "ssv:Parameter", name=variable.name)
        _add_value(entry, variable, own_values, definitions)
    definitions.add_enumerations(written, "ssv")


def starts(variable: Variable) -> dict[str, Inside]:
    """What the FMU starts with, by label; what it does not say, or not as its type asks for, is missing."""
    labels = variable.labels
    texts = variable.start * len(labels) if len(variable.start) == 1 else variable.start
    if len(texts) != len(labels):
        return {}
    found: dict[str, Inside] = {}
    for label, text in zip(labels, texts, strict=True):
        value: Inside | None
        if variable.fmi_type == "Binary":
            value = _bytes(text)
        elif variable.kind is None:
            value = text
        elif variable.kind is Kind.BOOLEAN:
            flag = flag_of(text)
            value = None if flag is None else float(flag)
        else:
            value = real_of(text)
        if value is not None:
            found[label] = value
    return found


def _bytes(text: str) -> bytes | None:
    try:
        return bytes.fromhex(text)
    except ValueError:
        return None


def inside(element: Element, variable: Variable, value: Inside) -> Inside:
    """The value in the FMU that *value* stands for outside of it. Raises DseError for a value no item has."""
    conversion = element.conversions.get(variable.name)
    if not isinstance(value, float | int):
        return value
    if conversion is not None and conversion.items:
        meant = [within for within, outside in conversion.items if outside == value]
        if not meant:
            raise fail(f"{element.name}.{variable.name}: {value:g} is the value of no item")
        return float(meant[0])
    number = Carry.inwards(conversion).apply(float(value))
    if math.isfinite(value) and not math.isfinite(number):
        raise fail(f"{element.name}.{variable.name}: {value:g} is beyond the range of numbers in the FMU's unit")
    return number


def _add_value(entry: ET.Element, variable: Variable, values: Sequence[Inside], definitions: Definitions) -> None:
    version = definitions.version
    word = variable.fmi_type
    texts, named = [_text(value, variable) for value in values], {}
    if variable.kind is Kind.ENUMERATION:
        # By their names, as other programs may number items otherwise; a number that no item has stays one.
        names = {float(number): name for name, number in reversed([*variable.items.items()])}
        is_named = all(value in names for value in values)
        word = "Enumeration" if is_named else "Integer" if version == "1.0" else "Int64"
        if is_named:
            texts = [names[value] for value in values if isinstance(value, float | int)]
            named = {"name": definitions.enumeration(variable, "")}
    elif version == "1.0":
        word = {"Float64": "Real", "Int32": "Integer"}.get(word, word)
    if word in ("String", "Binary", "Enumeration") and variable.shape:
        typed = ET.SubElement(entry, f"ssv:{word}", named)
        for text in texts:
            ET.SubElement(typed, "ssv:Value", value=text)
    else:
        ET.SubElement(entry, f"ssv:{word}", {"value": " ".join(texts), **named})
    for size in variable.shape:
        ET.SubElement(entry, "ssc:Dimension", size=str(size))


_SPECIAL = {"inf": "INF", "-inf": "-INF", "nan": "NaN"}


def _text(value: Inside, variable: Variable) -> str:
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, str):
        return value
    if variable.kind is Kind.BOOLEAN:
        return "true" if value else "false"
    if variable.kind is Kind.REAL:
        return _SPECIAL.get(repr(value), repr(value))
    return str(int(value))
