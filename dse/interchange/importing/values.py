"""Start values of a package as parameters of a bench."""

from __future__ import annotations

from dse.domain.component import Causality, Component, Kind, Type, Value
from dse.domain.system import Element
from dse.errors import DseError, Problem, fail, raise_if_any
from dse.interchange.importing.parts import Parts
from dse.interchange.resolving.carry import Carry
from dse.interchange.writing.values import starts
from dse.system import bind


def given_values(parts: Parts) -> dict[str, tuple[Value, Type]]:
    """What the bench gives, by ``part.port``: values of the package, and inputs that nothing is connected to.

    Raises DseError for every value that is given to what is no parameter and no input.
    """
    found: dict[str, tuple[Value, Type]] = {}
    problems: list[Problem] = []
    for element in sorted(parts.resolved.structure.elements, key=lambda e: parts.names[e.name]):
        component = parts.component(element.name)
        types = {port.name: port.type for port in component.interface.ports}
        types |= {parameter.name: parameter.type for parameter in component.parameters}
        for label, value in {**_loose(element, component), **element.start, **element.texts}.items():
            own = parts.own_name(element.name, label)
            where = parts.resolved.places.get(f"{element.name}.{label}")
            if own is None:
                what = "is given a value, but is neither a parameter nor an input that a workspace can give"
                hint = "leave the value out, or simulate the package as it is: dse simulate FILE.ssp"
                problems.append(Problem(f"{element.name}.{label} {what}", where, hint))
                continue
            try:
                outside = _outside(parts, component, own, types[own], value)
            except DseError as error:
                problems += [Problem(p.what, p.where or where, p.hint) for p in error.problems]
                continue
            parameter = component.parameter(own)
            if parameter is None or parameter.start != outside:
                found[f"{parts.names[element.name]}.{own}"] = outside, types[own]
    raise_if_any(problems)
    return found


def _loose(element: Element, component: Component) -> dict[str, float | str | bytes]:
    """What the FMU starts its inputs with that nothing is connected to."""
    connected = {label for variable in element.inputs for label in variable.labels}
    inputs = [port for port in component.interface.ports if port.causality is Causality.INPUT]
    labels = [label for port in inputs if (label := component.variable(port.name)) not in connected]
    nothing: dict[str, float | str | bytes] = {"String": "", "Binary": b""}
    variables = {label: element.model.variable_of(label) for label in labels}
    return {label: starts(v).get(label, nothing.get(v.fmi_type, 0.0)) for label, v in variables.items()}


def _outside(parts: Parts, component: Component, own: str, type_: Type, value: float | str | bytes) -> Value:
    if isinstance(value, str | bytes):
        return value if isinstance(value, str) else value.hex()
    causes = ("parameter", "structuralParameter", "input")
    conversion = bind(component, own, type_, parts.catalogue.models[component.name], causes).conversion
    # A number that is none of the items is none outside either.
    number = dict(conversion.items).get(value, -1.0) if conversion.items else Carry.outwards(conversion).apply(value)
    match type_.kind:
        case Kind.BOOLEAN:
            return bool(number)
        case Kind.INTEGER:
            return int(number)
        case Kind.ENUMERATION:
            if not (number.is_integer() and 0 <= number < len(type_.items)):
                raise fail(f"{component.name}.{own}: {value:g} is the value of no item")
            return type_.items[int(number)]
    return number
