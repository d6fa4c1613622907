"""A component's ports and parameters against the variables of its Modelica model."""

from __future__ import annotations

import re
from collections.abc import Iterator

from dse.domain.component import Causality, Component, Kind, Parameter, Port, Type, as_number
from dse.errors import Location, Problem, closest, raise_if_any
from dse.modelica.flat_model import FlatModel, Role, ScalarType, Variable
from dse.units import UnitError, describe, parse_unit

_KINDS = {scalar: Kind[scalar.name] for scalar in ScalarType}


def starts(component: Component, model: FlatModel) -> dict[str, float]:
    """Values for the model's parameters by the component's, as the model has them: enumerations count from 1.

    Raises DseError with every port and parameter that has no fitting variable, and every input that has no port.
    """
    raise_if_any(
        Problem(f"component '{component.name}': {one.what}", one.where or component.where, one.hint)
        for one in _problems(component, model)
    )
    return {
        component.variable(one.name): as_number(one.start, one.type) + (one.type.kind is Kind.ENUMERATION)
        for one in component.parameters
        if not model.variables[component.variable(one.name)].is_structural
    }


def _problems(component: Component, model: FlatModel) -> Iterator[Problem]:
    ports = component.interface.ports
    for port in ports:
        yield from _port(component, model, port)
    for parameter in component.parameters:
        yield from _parameter(component, model, parameter)
    yield from _shared(component)
    taken = {component.variable(port.name) for port in ports}
    free = [component.variable(port.name) for port in ports if component.variable(port.name) not in model.variables]
    for name, variable in model.variables.items():
        if variable.role is Role.INPUT and name not in taken and variable.start is None:
            what = f"{model.name} has an input '{name}' that is not a port of {component.interface.name}"
            hint = f"map a port to it, as {free[0]}: {name}" if free else "map a port to it, or give it a start"
            yield _at(what, variable.where, hint)


def _shared(component: Component) -> Iterator[Problem]:
    """Two ports or parameters that are one variable: of their values only one could hold."""
    first: dict[str, str] = {}
    words: list[tuple[str, str, Location | None]] = [
        (f"{port.causality} '{port.name}'", port.name, None) for port in component.interface.ports
    ]
    words += [(f"parameter '{one.name}'", one.name, one.where) for one in component.parameters]
    for word, name, where in words:
        variable = component.variable(name)
        other = first.setdefault(variable, word)
        if other is not word:
            what = f"{other} and {word} are both the variable '{variable}'"
            yield Problem(what, where, "map one of them to another variable")


def _port(component: Component, model: FlatModel, port: Port) -> Iterator[Problem]:
    name = component.variable(port.name)
    variable = model.variables.get(name)
    is_input = port.causality is Causality.INPUT
    word = f"{port.causality} '{port.name}'"
    fitting = [v.name for v in model.variables.values() if (v.role is Role.INPUT if is_input else v.is_output)]
    if variable is None:
        what = f"{model.name} has no variable '{name}' for {word}"
        yield _at(what, None, _hint(port.name, name, fitting))
    elif name not in fitting:
        what = f"'{name}' of {model.name} is not an {port.causality}, as {word} needs"
        yield _at(what, variable.where, f"declare it at the model's top level: {port.causality} …")
    elif port.type.kind is Kind.ENUMERATION or variable.kind is ScalarType.ENUMERATION:
        what = f"{word} is an enumeration: those of Modelica models cannot be ports in this version"
        yield _at(what, variable.where, "use an Integer")
    else:
        yield from _type(model, word, port.type, variable)


def _parameter(component: Component, model: FlatModel, parameter: Parameter) -> Iterator[Problem]:
    name = component.variable(parameter.name)
    variable = model.variables.get(name)
    where = parameter.where
    word = f"parameter '{parameter.name}'"
    settable = [v.name for v in model.variables.values() if not _why_not(v)]
    if variable is None:
        what = f"{model.name} has no variable '{name}' for {word}"
        yield Problem(what, where, _hint(parameter.name, name, settable))
    elif name not in settable:
        yield Problem(f"'{name}' of {model.name} {_why_not(variable)}", where, _seen(variable.where))
    elif variable.kind is ScalarType.ENUMERATION and not variable.is_structural:
        # Modelica counts items from 1, our benches from 0.
        what = f"{word} is an enumeration that the model reads while it runs: such cannot be given in this version"
        yield Problem(what, where, "use an Integer")
    elif variable.is_structural and name.endswith("]"):
        what = f"'{name}' of {model.name} is an element of an array that decides how the model is built"
        yield Problem(what, where, "set the array in a Modelica model that extends this one")
    elif variable.is_structural and parameter.tunable:
        what = f"'{name}' of {model.name} decides how the model is built, so it cannot be changed in a simulation"
        yield Problem(what, where, "set tunable: false")
    else:
        yield from _type(model, word, parameter.type, variable, where)
        yield from _limits(model, parameter, variable, where)


def _limits(model: FlatModel, parameter: Parameter, variable: Variable, where: Location | None) -> Iterator[Problem]:
    """Limits wider than those the model was made for."""
    shown = f"'{variable.name}' of {model.name}"
    lowest, highest = ("down", -1, parameter.minimum, variable.minimum), ("up", 1, parameter.maximum, variable.maximum)
    for way, sign, own, limit in (lowest, highest):
        if own is not None and limit is not None and limit.is_constant and sign * own > sign * limit.value:
            what = f"parameter '{parameter.name}' goes {way} to {own:g}, {shown} to {limit.value:g}"
            yield Problem(what, where, f"narrow it; {_seen(variable.where)}")


def _why_not(variable: Variable) -> str:
    """Why the variable cannot be set from outside; nothing if it can."""
    reasons = {
        "is not a parameter": variable.role is not Role.PARAMETER,
        "is final": variable.is_final,
        "is protected": variable.is_protected,
        "is solved for at the start": not variable.is_fixed,
        "is computed from other parameters": variable.binding is not None and not variable.binding.is_constant,
    }
    return next((reason for reason, holds in reasons.items() if holds), "")


def _type(
    model: FlatModel, word: str, type_: Type, variable: Variable, where: Location | None = None
) -> Iterator[Problem]:
    kind = _KINDS[variable.kind]
    if kind is not type_.kind:
        what = f"'{variable.name}' of {model.name} is {variable.kind}, but {word} is {type_.kind}"
        hint = {Kind.INTEGER: "type: int", Kind.BOOLEAN: "type: bool"}.get(kind, _seen(variable.where))
        yield Problem(what, where, hint)
    elif kind is Kind.ENUMERATION and type_.items != variable.items:
        what = f"'{variable.name}' of {model.name} has the items {', '.join(variable.items)}, but {word} is {type_}"
        yield Problem(what, where, f"enum: [{', '.join(variable.items)}]")
    elif kind is Kind.REAL and variable.unit:
        yield from _unit(model, word, type_, variable, where)


def _unit(model: FlatModel, word: str, type_: Type, variable: Variable, where: Location | None) -> Iterator[Problem]:
    shown = f"'{variable.name}' of {model.name}"
    try:
        unit = parse_unit(variable.unit)
    except UnitError as error:
        yield Problem(f"{shown}: {error}", variable.where or where)
        return
    if unit.dimension != type_.unit.dimension:
        mine, its = describe(type_.unit.dimension), describe(unit.dimension)
        what = f"{shown} is in {variable.unit} ({its}), but {word} is in {type_} ({mine})"
        yield Problem(what, where, _seen(variable.where))
    elif not unit.is_coherent:
        what = f"{shown} is in {variable.unit}; what a component shows must be in coherent SI units"
        yield Problem(what, variable.where or where, "convert it inside the model")


def _hint(own: str, name: str, fitting: list[str]) -> str:
    plain = re.sub(r"\W", "_", own)
    return f"map: {{{own}: {plain}}}" if name == own and plain in fitting else closest(name, fitting)


def _at(what: str, where: Location | None, hint: str) -> Problem:
    """A problem of the component, with a look at *where* in the model."""
    return Problem(what, None, f"{hint}; {_seen(where)}" if where else hint)


def _seen(where: Location | None) -> str:
    return f"see {where}" if where else ""
