"""Declarations: the front-end's variables as scalars with all their attributes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from dse.errors import Location, fail
from dse.modelica.algebra.expression import Expression
from dse.modelica.flat_model import Check, Equation, Role, ScalarType, Variable
from dse.modelica.flatten.document import Document, Record, fields
from dse.modelica.flatten.evaluation.context import Frame
from dse.modelica.flatten.evaluation.evaluation import Evaluation
from dse.modelica.flatten.model import Declared, Model

_VARIABLE = "name role variability value_type declaration attributes"
# fmt: off
_ATTRIBUTES = (
    "component_ref binding start fixed min max nominal unit state_select description causality declared_causality "
    "is_tunable is_held evaluable origin"
)
_SCALAR_TYPES = {scalar.lower(): scalar for scalar in ScalarType}
_ROLES = {
    "parameter": Role.PARAMETER, "input": Role.INPUT, "state": Role.CONTINUOUS, "algebraic": Role.CONTINUOUS,
    "output": Role.CONTINUOUS, "discrete_real": Role.DISCRETE, "discrete_value": Role.DISCRETE,
}
# fmt: on
_QUOTED = re.compile(r"'(?:[^'\\]|\\.)*'")
_PREFERENCES = {"Never": -2, "Avoid": -1, "Default": 0, "Prefer": 1, "Always": 2}


def declared(document: Document) -> tuple[Declared, ...]:
    """All variables of *document* by number, not yet with their attributes."""
    found = []
    for record in document.lists["variables"]:
        where = document.where(record.get("declaration"))
        fields(record, _VARIABLE, f"the variable '{record.get('name')}'", where)
        fields(record["attributes"], _ATTRIBUTES, f"attributes of '{record['name']}'", where)
        kind = document.value_type(record)
        fields(kind, "scalar dimensions record_name record_fields", f"the type of '{record['name']}'", where)
        if record["role"] not in _ROLES and record["role"] != "constant":
            raise fail(f"'{record['name']}', a variable in the role '{record['role']}', is not supported", where)
        is_text = kind["scalar"] == "string" and record["role"] in ("parameter", "constant")
        if (kind["scalar"] not in _SCALAR_TYPES and not is_text) or kind["record_fields"]:
            what = f"'{record['name']}' of type {kind['scalar']} that is not a parameter"
            raise fail(f"{what} is not supported", where)
        if record["attributes"]["is_held"]:
            raise fail(f"'{record['name']}', held in a clocked partition, is not supported", where)
        shape = tuple(kind["dimensions"])
        role = _role(document, record, where)
        is_discrete = record["variability"] == "discrete" or kind["scalar"] != "real"
        found.append(Declared(record["name"], role, kind["scalar"], shape, is_discrete, where))
    return tuple(found)


def bindings(document: Document, evaluation: Evaluation) -> list[Equation]:
    """The equations of inputs of the model itself that its declaration or a modifier binds."""
    found = []
    for item, record in zip(evaluation.model.declared, document.lists["variables"], strict=True):
        node = record["attributes"]["binding"]
        if record["role"] != "input" or node is None:
            continue
        frame, refusal = Frame(makes_events=True), f"this binding of '{item.name}' is not supported"
        for name, element in evaluation.scalars(item, node, frame, refusal, item.where):
            found.append(Equation(evaluation.graph.variable(name) - element, item.where))
        if frame.asserts:
            raise fail(refusal, item.where)
    return found


def declare(document: Document, model: Model) -> None:
    """Enter all scalars into *model* without values; what refers to a variable needs its role alone."""
    for item, record in zip(model.declared, document.lists["variables"], strict=True):
        if item.role == "constant" or item.scalar == "string":
            continue
        attributes = record["attributes"]
        is_top = "." not in _QUOTED.sub("", item.name)
        flat = document.flat["variables"].get(item.name, {})
        for name in item.names:
            if name in model.variables:
                raise fail(f"the name '{name}' is declared twice", item.where)
            model.variables[name] = Variable(
                name,
                _SCALAR_TYPES[item.scalar],
                _ROLES[item.role],
                is_output=is_top and attributes["declared_causality"] == "output" and item.role != "parameter",
                unit=attributes["unit"] or "",
                description=attributes["description"] or "",
                prefers_state=_PREFERENCES[attributes["state_select"]],
                is_final=bool(document.flat["variable_final_flags"].get(item.name)),
                is_protected=bool(flat.get("is_protected")),
                is_structural=bool(attributes["evaluable"]) or item.name in document.result.structural,
                items=_items(document, item) if item.scalar == "enumeration" else (),
                where=item.where,
            )


def complete(document: Document, evaluation: Evaluation) -> list[Check]:
    """Give every scalar its start, binding and bounds. Returns the asserts of functions that parameters call."""
    model, frame = evaluation.model, Frame(makes_events=False)
    for item, record in zip(model.declared, document.lists["variables"], strict=True):
        if item.role == "constant" or item.scalar == "string":
            continue
        attributes = record["attributes"]
        fixed = attributes["fixed"] or []
        if len(fixed) not in (0, 1, len(item.names)):
            raise fail(f"'fixed' of '{item.name}' in another size", item.where)
        is_free = item.role == "parameter" and bool(fixed) and not all(fixed)
        if is_free and any(fixed):
            raise fail(f"the parameter '{item.name}' of which some elements are fixed is not supported", item.where)
        is_bound = item.role == "parameter" and not is_free and attributes["binding"] is not None
        # The start of one that is bound is the front-end's evaluation of the binding, which is read itself.
        wanted = ("binding" if is_bound else "start", "min", "max", "nominal")
        given = {name: _spread(evaluation, item, attributes[name], name, frame) for name in wanted}
        if item.role != "parameter" and attributes["binding"] is not None and record["role"] != "input":
            raise fail(f"a binding of '{item.name}' that is not an equation is not supported", item.where)
        has_start = _has_start(document, record)
        for place, name in enumerate(item.names):
            own = {key: None if values is None else values[place] for key, values in given.items()}
            is_fixed = bool(fixed[place if len(fixed) > 1 else 0]) if fixed else item.role == "parameter"
            binding = own.get("binding")
            start = own["start"] if not is_bound and (has_start or item.role == "parameter") else None
            model.variables[name] = replace(
                model.variables[name],
                start=start,
                binding=binding,
                is_fixed=is_fixed,
                minimum=own["min"],
                maximum=own["max"],
                nominal=own["nominal"],
            )
    return frame.asserts


def _role(document: Document, record: Record, where: Location | None) -> str:
    """The front-end's word for the role, but for inputs with a binding: they are ordinary unknowns."""
    role: str = record["role"]
    bound = role == "input" and document.flat["variables"].get(record["name"], {}).get("binding") is not None
    is_real = document.value_type(record)["scalar"] == "real"
    if role == "input" and (bound != (record["attributes"]["binding"] is not None) or (bound and not is_real)):
        raise fail(f"the input '{record['name']}' with a default value is not supported", where, "use its start value")
    return "algebraic" if bound else role


def _has_start(document: Document, record: Record) -> bool:
    """Whether the model gives a start value: the front-end's own 0 stands at the declaration itself."""
    start = record["attributes"]["start"]
    if start is None:
        return False
    provenance = document.provenance[document.nodes[start].place]
    return bool(provenance.get("span") != record["declaration"].get("span"))


def _spread(
    evaluation: Evaluation, item: Declared, node: int | None, what: str, frame: Frame
) -> Sequence[Expression] | None:
    """Attribute *what* for each scalar of *item*."""
    if node is None:
        return None
    known = len(frame.asserts)
    value = evaluation.elements(node, frame)
    if len(frame.asserts) > known and item.role != "parameter":
        raise fail(f"an assert in a function called for '{what}' of '{item.name}' is not supported", item.where)
    if value.shape == item.shape:
        elements = value.elements
    elif value.shape == ():
        elements = value.elements * len(item.names)
    else:
        raise fail(f"'{what}' of '{item.name}' has size {list(value.shape)}, not {list(item.shape)}", item.where)
    model = evaluation.model
    is_start = what == "start" and item.role != "parameter"
    if not all(model.is_parameter(one) or (is_start and model.is_known_at_start(one)) for one in elements):
        raise fail(f"'{what}' of '{item.name}' that depends on more than parameters is not supported", item.where)
    return elements


def _items(document: Document, item: Declared) -> tuple[str, ...]:
    """Names of an enumeration's values, in order."""
    name = document.flat["variable_type_names"].get(item.name)
    ordinals: Mapping[str, Any] = document.flat["enum_literal_ordinals"]
    owners = {literal.rpartition(".")[0] for literal in ordinals}
    if name not in owners:  # A type may be named by a part of its path, as where it is declared.
        ending = [owner for owner in owners if owner.endswith(f".{name}")]
        name = ending[0] if len(ending) == 1 else name
    found = {}
    for literal, ordinal in ordinals.items():
        owner, _, word = literal.rpartition(".")
        if owner == name and not word.startswith("'"):
            found[ordinal] = word
    if not found or sorted(found) != list(range(1, len(found) + 1)):
        raise fail(f"the enumeration '{name}' of '{item.name}' cannot be listed", item.where)
    return tuple(found[number] for number in sorted(found))
