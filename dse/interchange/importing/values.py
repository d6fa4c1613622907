"""Start values of a package as parameters of a bench."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from dse.domain.component import Causality, Component, Kind, Type, Value
from dse.domain.system import Conversion, Element
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.interchange.importing.parts import Catalogue
from dse.interchange.resolving.resolve import ResolvedSystem
from dse.interchange.writing.values import starts
from dse.system.binding import IDENTITY, bind

_CAUSES = ("parameter", "structuralParameter", "input")


def given_values(
    resolved: ResolvedSystem,
    names: Mapping[str, str],
    catalogue: Catalogue,
    components: Mapping[str, Component],
) -> dict[str, tuple[Value, Type]]:
    """What the bench gives, by ``part.port``: values of the package, and inputs that nothing is connected to.

    Raises DseError for every value that is given to what is no parameter and no input.
    """
    found: dict[str, tuple[Value, Type]] = {}
    problems: list[Problem] = []
    for element in sorted(resolved.structure.elements, key=lambda e: names[e.name]):
        component = components[element.name]
        types = {port.name: port.type for port in component.interface.ports}
        types |= {parameter.name: parameter.type for parameter in component.parameters}
        given: dict[str, float | str | bytes] = {**element.start, **element.texts}
        for label, value in {**_loose(element, component), **given}.items():
            own = catalogue.own_name(component, label)
            where = resolved.places.get(f"{element.name}.{label}")
            try:
                if own is None:
                    raise _homeless(element, label, where)
                converted = _outside(component, own, types[own], catalogue, value)
            except DseError as error:
                problems += [Problem(p.what, p.where or where, p.hint) for p in error.problems]
                continue
            parameter = component.parameter(own)
            if parameter is None or parameter.start != converted:
                found[f"{names[element.name]}.{own}"] = converted, types[own]
    raise_if_any(problems)
    return found


def _homeless(element: Element, label: str, where: Location | None) -> DseError:
    what = f"{element.name}.{label} is given a value, but is neither a parameter nor an input that a workspace can give"
    return DseError(
        Problem(what, where, "leave the value out, or simulate the package as it is: dse simulate FILE.ssp")
    )


def _loose(element: Element, component: Component) -> dict[str, float | str | bytes]:
    """What the FMU starts its inputs with that nothing is connected to."""
    connected = {label for variable in element.inputs for label in variable.labels}
    found: dict[str, float | str | bytes] = {}
    for port in component.interface.ports:
        label = component.variable(port.name)
        if port.causality is Causality.INPUT and label not in connected:
            variables = element.model.variables
            variable = variables.get(label) or variables[label.rpartition("[")[0]]
            found[label] = starts(variable).get(label, 0.0)
    return found


def _outside(component: Component, own: str, type_: Type, catalogue: Catalogue, value: float | str | bytes) -> Value:
    if isinstance(value, str | bytes):
        return value if isinstance(value, str) else value.hex()
    conversion = bind(component, own, type_, catalogue.model(component), _CAUSES).conversion
    number = _converted(conversion, value)
    match type_.kind:
        case Kind.BOOLEAN:
            return bool(number)
        case Kind.INTEGER:
            return int(number)
        case Kind.ENUMERATION:
            if not (number.is_integer() and 0 <= number < len(type_.items)):
                raise DseError(Problem(f"{component.name}.{own}: {value:g} is the value of no item"))
            return type_.items[int(number)]
    return number


def _converted(conversion: Conversion, value: float) -> float:
    if conversion == IDENTITY:
        return value
    if conversion.items:
        return dict(conversion.items).get(value, -1.0)
    return float(Fraction(value) * Fraction(conversion.factor) + Fraction(conversion.offset))
