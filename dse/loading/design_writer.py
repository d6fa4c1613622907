"""Writes design spaces and components without a source as YAML that reads back as the same.

Only the places in the files differ, and the spelling of constraints: one whose text is not in our language, or that
was given in another form than ``require``, is written out as what is required.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator
from fractions import Fraction

from dse.domain.component import NO_INTERFACE, Component, Kind, Parameter
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Node, Optional, Part
from dse.errors import Location, fail
from dse.loading.design_scope import Spot, constraint_name
from dse.loading.design_unscope import relative_rule
from dse.loading.expression_text import text_of
from dse.units import Unit


def write_design(space: DesignSpace) -> str:
    """A file of ``designs/`` that says what *space* says; its components and interfaces are named, not written.

    Raises DseError for a compound that is called otherwise than its place, which no file can say.
    """
    writer = _TreeWriter(space)
    lines = [f"design: {_name(space.name)}"]
    if space.title:
        lines.append(f"title: {_text(space.title)}")
    if space.sets:
        lines.append("constraint_sets:")
        for one in space.sets:
            title = f", title: {_text(one.title)}" if one.title else ""
            lines.append(f"  {_name(one.name)}: {{on: {str(one.on).lower()}{title}}}")
    lines += ["root:", *writer.compound(space.root, Spot(), 1)]
    rest = [constraint for constraint in space.all_constraints if constraint.name not in writer.written]
    taken = {constraint.name for constraint in rest}
    if rest:
        lines.append("constraints:")
        for constraint in rest:
            lines += _constraint(_free(constraint.name, taken), constraint, text_of(constraint.rule), 1)
    return "\n".join(lines) + "\n"


def write_components(components: Iterable[Component]) -> str:
    """A file of ``components/`` that holds all of *components*, each once.

    Raises DseError for a component with a source, which needs a folder of its own.
    """
    lines = ["components:"]
    for component in {component.name: component for component in components}.values():
        if component.source is not None:
            raise fail(f"component '{component.name}' has a source", component.where, "copy its folder instead")
        entries = [f"title: {_text(component.title)}"] if component.title else []
        if component.interface != NO_INTERFACE:
            entries.append(f"implements: {_name(component.interface.name)}")
        if component.parameters:
            stated = (f"{_name(parameter.name)}: {_parameter(parameter)}" for parameter in component.parameters)
            entries.append(f"parameters: {{{', '.join(stated)}}}")
        if component.properties:
            stated = (f"{_name(name)}: {_quantity(quantity.text)}" for name, quantity in component.properties.items())
            entries.append(f"properties: {{{', '.join(stated)}}}")
        lines.append(f"  {_name(component.name)}: {{{', '.join(entries)}}}")
    return "\n".join(lines) + "\n"


_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_PLAIN_TEXT = re.compile(r"[A-Za-z_][A-Za-z0-9_ ./<>=+*^%()-]*")
_OTHERS = frozenset({"null", "true", "false"})
# What ends a line in YAML, and not in JSON.
_ENDS_OF_LINES = {0x85: "\\N", 0x2028: "\\L", 0x2029: "\\P", 0xFEFF: "\\uFEFF"}
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]{0,14})(?:\.[0-9]{1,9})?")


class _TreeWriter:
    """Writes containers; *written* are the names of the constraints that stand in one of them."""

    def __init__(self, space: DesignSpace) -> None:
        self.constraints = [constraint for constraint in space.all_constraints if ": " in constraint.name]
        self.written: set[str] = set()

    def compound(self, compound: Compound, spot: Spot, level: int) -> Iterator[str]:
        pad = "  " * level
        yield f"{pad}compound:{'' if compound.parts else ' {}'}"
        for name, node in compound.parts.items():
            yield from self.node(node, spot.part(name), f"{pad}  {_name(name)}:", level + 1)
        if compound.interface is not None:
            yield f"{pad}implements: {_name(compound.interface.name)}"
        if compound.connections:
            yield f"{pad}connections:"
            yield from (f"{pad}  - {connection}" for connection in compound.connections)
        if spot.trail:
            yield from self.rules(compound, spot, level)

    def rules(self, compound: Compound, spot: Spot, level: int) -> Iterator[str]:
        head = f"{'  ' * level}constraints:"
        for constraint in self.constraints:
            own = constraint.name.rpartition(": ")[2]
            if constraint.name != constraint_name(spot, own):
                continue
            text = relative_rule(constraint.rule, spot, compound.parts)
            if text is not None:
                self.written.add(constraint.name)
                yield from ([head] if head else [])
                yield from _constraint(own, constraint, text, level + 1)
                head = ""

    def node(self, node: Node, spot: Spot, head: str, level: int) -> Iterator[str]:
        """*head* and, at *level* + 1 or behind it, what stands at the place."""
        pad = "  " * (level + 1)
        match node:
            case Part():
                yield f"{head} {_name(node.name)}"
            case Compound():
                place = spot.path.rpartition(".")[2]
                if node.name != place:
                    what = f"the architecture '{node.name}' at '{spot.path}' is not called as its place"
                    raise fail(what, node.where, f"call it {place}, or make it an alternative")
                yield head
                yield from self.compound(node, spot, level + 1)
            case Optional():
                yield head
                yield from self.node(node.content, spot.optional(), f"{pad}optional:", level + 1)
            case Alternative():
                yield head
                yield f"{pad}alternatives:"
                for option in node.options:
                    if isinstance(option, Part):
                        yield f"{pad}  - {_name(option.name)}"
                    else:
                        yield f"{pad}  - {_name(option.name)}:"
                        yield from self.compound(option, spot.option(option.name), level + 4)


def _constraint(name: str, constraint: Constraint, text: str, level: int) -> Iterator[str]:
    pad = "  " * level
    yield f"{pad}{_name(name)}:"
    yield f"{pad}  require: {_text(text)}"
    if constraint.because:
        yield f"{pad}  because: {_text(constraint.because)}"
    if constraint.set:
        yield f"{pad}  set: {_name(constraint.set)}"


def _free(name: str, taken: set[str]) -> str:
    """A constraint of a container that cannot be written there has a name of the whole design."""
    if ": " not in name:
        return name
    plain = wanted = name.replace(": ", "_").replace(".", "_")
    number = 2
    while plain in taken:
        plain, number = f"{wanted}_{number}", number + 1
    taken.add(plain)
    return plain


def _parameter(parameter: Parameter) -> str:
    type_ = parameter.type
    start = parameter.start
    entries = [f"start: {_value(start, type_.unit, parameter.where)}"]
    for key, bound in (("min", parameter.minimum), ("max", parameter.maximum)):
        if bound is not None:
            entries.append(f"{key}: {_value(bound, type_.unit, parameter.where)}")
    if type_.kind is Kind.ENUMERATION:
        entries.append(f"enum: [{', '.join(map(_name, type_.items))}]")
    elif type_.kind is Kind.REAL:
        entries.append(f"unit: {_text(type_.unit.symbol or '1')}")
    else:
        entries.append(f"type: {type_.kind}")
    if not parameter.tunable:
        entries.append("tunable: false")
    if parameter.title:
        entries.append(f"title: {_text(parameter.title)}")
    return f"{{{', '.join(entries)}}}"


def _value(value: float | int | bool | str, unit: Unit, where: Location | None) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, int):
        return str(value)
    near = unit.from_si(value)
    for number in (near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf)):
        if float(Fraction(repr(number)) * unit.factor + unit.offset) == value:
            return repr(number)
    raise fail(f"{value} in SI is no floating-point number of {unit}", where, "give it in an SI unit")


def _name(name: str) -> str:
    return name if _PLAIN.fullmatch(name) and name.lower() not in _OTHERS else json.dumps(name)


def _quantity(text: str) -> str:
    """A number as it is if it keeps its spelling when read, else as text."""
    return text if _NUMBER.fullmatch(text) and repr(float(text) if "." in text else int(text)) == text else _text(text)


def _text(text: str) -> str:
    """A YAML scalar that reads as *text*: as it is if it looks like nothing else, in double quotes otherwise."""
    if _PLAIN_TEXT.fullmatch(text) and not text.endswith(" ") and text.lower() not in _OTHERS:
        return text
    return json.dumps(text, ensure_ascii=False).translate(_ENDS_OF_LINES)
