"""Writes design spaces and components without a source as YAML that reads back as the same.

Repetitions, chosen connections, allocations and constraints are written in the form that their file has, unless they
were changed since. Only the places in the files differ, and the spelling of other constraints: one whose text is not in
our language is written out as what is required.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import (
    Alternative,
    Compound,
    Connection,
    Constraint,
    ConstraintSet,
    DesignSpace,
    Node,
    Optional,
    Part,
)
from dse.domain.expression import Chosen
from dse.errors import fail
from dse.expression import show_expression, text_of
from dse.formats import (
    inline,
    write_data,
    write_file,
    write_flow,
    write_name,
    write_parameter,
    write_scalar,
    write_text,
)
from dse.loading.design.scope import Scope, constraint_name
from dse.loading.writing.unscope import relative_rule
from dse.units import definition_of


def write_design(space: DesignSpace) -> str:
    """A file of ``designs/`` that says what *space* says; its components and interfaces are named, not written.

    Raises DseError for a compound that is called otherwise than its place, which no file can say.
    """
    writer = _TreeWriter(space)
    data: dict[str, Any] = {"design": write_name(space.name)}
    if space.title:
        data["title"] = write_text(space.title)
    if space.sets:
        data["constraint_sets"] = {one.name: _set(one) for one in space.sets}
    if space.units:
        data["units"] = {name: _unit(symbol) for name, symbol in sorted(space.units.items())}
    data["root"] = {key: _inline_each(value) for key, value in writer.compound(space.root, Scope()).items()}
    rest = [constraint for constraint in space.all_constraints if constraint.name not in writer.written]
    taken = {constraint.name for constraint in rest}
    if rest:
        data["constraints"] = {
            _free(one.name, taken): inline(_constraint(one, text_of(one.rule), None if ": " in one.name else one.form))
            for one in rest
        }
    return write_file(data)


def write_components(components: Iterable[Component]) -> str:
    """A file of ``components/`` that holds all of *components*, each once.

    Raises DseError for a component with a source, which needs a folder of its own.
    """
    data: dict[str, str] = {}
    for component in {component.name: component for component in components}.values():
        if component.source is not None:
            raise fail(f"component '{component.name}' has a source", component.where, "copy its folder instead")
        entries = {"title": write_text(component.title)} if component.title else {}
        if component.interface != NO_INTERFACE:
            entries["implements"] = write_name(component.interface.name)
        if component.parameters:
            entries["parameters"] = write_flow({p.name: write_parameter(p) for p in component.parameters})
        if component.properties:
            stated = {name: _quantity(quantity.text) for name, quantity in component.properties.items()}
            entries["properties"] = write_flow(stated)
        data[component.name] = write_flow(entries)
    return write_file({"components": data})


_WORD = re.compile(r"\w+")
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]{0,14})(?:\.[0-9]{1,9})?")


class _TreeWriter:
    """Writes containers; *written* are the names of the constraints that stand in one of them."""

    def __init__(self, space: DesignSpace) -> None:
        self.constraints = [constraint for constraint in space.all_constraints if ": " in constraint.name]
        self.unchanged = {constraint.name for constraint in space.all_constraints if constraint.form is not None}
        self.written: set[str] = set()
        self.shortened: set[int] = set()

    def compound(self, compound: Compound, scope: Scope) -> dict[str, Any]:
        short = self.short(compound)
        if short is not None:
            return short
        parts = {
            name: self.node(_without_stale_form(node, compound), scope.part(name), _called(compound, name))
            for name, node in compound.parts.items()
        }
        data: dict[str, Any] = {"title": write_text(compound.title)} if compound.title else {}
        data["compound"] = parts
        if compound.repeated:
            data["repeated"] = "true"
        if compound.interface is not None:
            data["implements"] = write_name(compound.interface.name)
        if connections := self.connections(compound):
            data["connections"] = connections
        rules = self.rules(compound, scope) if scope.trail else {}
        return {**data, "constraints": rules} if rules else data

    def short(self, compound: Compound) -> dict[str, Any] | None:
        """A repetition, chosen connections or an allocation as its file has it; None if it is none, or was changed."""
        form = compound.form
        if form is None or ("compound" in form.data and "times" not in form.data):
            return None
        if compound.parts is not form.parts or not self.unchanged.issuperset(form.constraints):
            return None
        self.written.update(form.constraints)
        self.shortened.add(id(compound))
        return {key: write_data(value) for key, value in form.data.items()}

    def connections(self, compound: Compound) -> list[str]:
        """As the file has them, unless something that they depend on was changed."""
        form = compound.form
        chosen = {id(part) for part in compound.parts.values() if _is_choice(part)}
        if form and compound.connections is form.connections and chosen <= self.shortened:
            return [write_text(text) for text in form.data.get("connections", ())]
        return [_wire(connection) for connection in compound.connections]

    def rules(self, compound: Compound, scope: Scope) -> dict[str, Any]:
        found = {}
        for constraint in self.constraints:
            own = constraint.name.rpartition(": ")[2]
            if constraint.name == constraint_name(scope, own):
                text = relative_rule(constraint.rule, scope, compound.parts)
                if text is not None:
                    self.written.add(constraint.name)
                    found[own] = _constraint(constraint, text, constraint.form)
        return found

    def node(self, node: Node, scope: Scope, name: str) -> str | dict[str, Any]:
        """*name* is what a compound there has to be called."""
        match node:
            case Part():
                return write_name(node.name)
            case Compound():
                if node.name != name:
                    what = f"the architecture '{node.name}' at '{scope.path}' is not called as its place"
                    raise fail(what, node.where, f"call it {name}, or make it an alternative")
                return self.compound(node, scope)
            case Optional():
                return {"optional": self.node(node.content, scope.optional(), name)}
            case Alternative():
                return {"alternatives": [self.option(option, scope) for option in node.options]}

    def option(self, option: Part | Compound, scope: Scope) -> str | dict[str, Any]:
        if isinstance(option, Part):
            return write_name(option.name)
        return {option.name: self.compound(option, scope.option(option.name))}


def _wire(connection: Connection) -> str:
    if connection.when is None:
        return str(connection)
    path, names = connection.when
    return f"{connection} if {show_expression(Chosen(path, names or ('present',), (0, 0)))}"


def _unit(symbol: str) -> str:
    text = definition_of(symbol)
    return write_scalar(text) if text else "{currency: true}"


def _inline_each(value: Any) -> Any:
    return {key: inline(entry) for key, entry in value.items()} if isinstance(value, Mapping) else value


def _set(one: ConstraintSet) -> str:
    title = {"title": write_text(one.title)} if one.title else {}
    return write_flow({"on": str(one.on).lower(), **title})


def _called(compound: Compound, name: str) -> str:
    """What a compound that is the part *name* has to be called."""
    return compound.name if compound.repeated else name


def _is_choice(node: Node) -> bool:
    return (
        isinstance(node, Compound) and node.form is not None and not {"connect", "allocate"}.isdisjoint(node.form.data)
    )


def _without_stale_form(node: Node, around: Compound) -> Node:
    """*node*, without the form of a choice between parts of *around* that were changed since."""
    if not isinstance(node, Compound) or not _is_choice(node) or node.form is None or around.form is None:
        return node
    before = around.form.parts
    words = {*_WORD.findall(str([node.form.data.get(key) for key in ("connect", "allocate", "to")]))}
    is_stale = any(around.parts.get(name) is not before[name] for name in words if name in before)
    return replace(node, form=None) if is_stale else node


def _constraint(constraint: Constraint, text: str, form: Mapping[str, Any] | None) -> dict[str, Any]:
    if form:
        return {key: write_data(value) for key, value in form.items()}
    stated = {"require": text, "because": constraint.because, "set": constraint.set}
    return {key: write_text(value) for key, value in stated.items() if value}


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


def _quantity(text: str) -> str:
    """A number as it is if it keeps its spelling when read, else as text."""
    return (
        text
        if _NUMBER.fullmatch(text) and repr(float(text) if "." in text else int(text)) == text
        else write_text(text)
    )
