"""A generated model that is a class of C++."""

from __future__ import annotations

import re

from dse.errors import Location, fail
from dse.simulink.declarations import Array, Declarations, Declared, Function, Pointer, Record
from dse.simulink.interface import (
    MODEL,
    Data,
    Interface,
    Member,
    Style,
    by_rate,
    flat,
    holds,
    places_of_model,
    plain_name,
)

OBJECT = f"{MODEL}->object"
"""The object in a model's own storage: a pointer."""

_STEP = re.compile(r"(?:\w+_)?step\d*")


def class_of(known: Declarations, model: str, where: Location) -> Record | None:
    """The class with a step, if there is one. Raises DseError if it is not clear which."""
    found = [each for each in known.records.values() if any(_STEP.fullmatch(method.name) for method in each.methods)]
    named = [each for each in found if plain_name(each.name).startswith(model)] or found
    if len(named) > 1:
        raise fail(f"several classes have a step: {', '.join(plain_name(each.name) for each in named)}", where)
    return named[0] if named else None


def read_class(known: Declarations, kind: Record) -> Interface:
    """How a model is called that is the class *kind*."""
    made = Interface(Style.CLASS)
    methods = {method.name: method for method in kind.methods}
    rated = by_rate(methods)
    made.is_rated = bool(rated)
    fields = [(f"{OBJECT}->{each.name}", each) for each in kind.fields]
    fields += [(f"{kind.name}::{each.name}", each) for each in kind.statics]
    for place, each in fields:
        ports = made.ports_in(each.type)
        if ports is not None and not each.is_constant and not isinstance(each.type, Pointer):
            ports += flat(known, each.type, place, "", "", made.warnings)
    places_of_model(known, made, ((f"{OBJECT}->{each.name}", each.type) for each in kind.fields))
    if "initialize" in methods:
        made.initialize = _call(known, made, methods["initialize"])
    steps = rated or [name for name in methods if re.fullmatch(r"(?:\w+_)?step", name)][:1]
    made.steps = {name: _call(known, made, methods[name]) for name in steps}
    for name, variable in known.variables.items():
        if (
            holds(variable.type, Data.PARAMETERS)
            and not variable.is_constant
            and not isinstance(variable.type, Pointer)
        ):
            made.parameters += flat(known, variable.type, name, "", "", made.warnings)
    return made


def _call(known: Declarations, made: Interface, method: Function) -> str:
    return f"{OBJECT}->{method.name}({', '.join(_argument(known, made, each) for each in method.arguments)})"


def _argument(known: Declarations, made: Interface, argument: Declared) -> str:
    type_ = argument.type
    target = type_.target if isinstance(type_, Pointer) else type_
    if argument.name == "tid":
        raise fail("its step runs one of several tasks by its number", hint="generate it with one task")
    name = f"a_{argument.name}"
    place = f"{MODEL}->{name}"
    if not any(member.name == name for member in made.storage):
        made.storage.append(Member(name, target))
        is_output = isinstance(type_, Pointer | Array) and not type_is_read(argument) and not holds(target, Data.INPUTS)
        ports = made.outputs if is_output or holds(target, Data.OUTPUTS) else made.inputs
        inner = "" if known.record(target) else argument.name
        ports += flat(known, target, place, inner, argument.comment, made.warnings)
    return place


def type_is_read(argument: Declared) -> bool:
    """Whether what an argument refers to is constant."""
    return argument.is_constant or (isinstance(argument.type, Pointer) and argument.type.is_constant)
