"""Writes design spaces and components without a source as YAML that reads back as the same.

Only the places in the files differ, and the spelling of constraints: one whose text is not in our language, or that
was given in another form than ``require``, is written out as what is required.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Node, Optional, Part
from dse.errors import fail
from dse.expression.text import text_of
from dse.formats.yaml_text import write_name, write_parameter, write_text
from dse.loading.design.scope import Spot, constraint_name
from dse.loading.writing.unscope import relative_rule


def write_design(space: DesignSpace) -> str:
    """A file of ``designs/`` that says what *space* says; its components and interfaces are named, not written.

    Raises DseError for a compound that is called otherwise than its place, which no file can say.
    """
    writer = _TreeWriter(space)
    lines = [f"design: {write_name(space.name)}"]
    if space.title:
        lines.append(f"title: {write_text(space.title)}")
    if space.sets:
        lines.append("constraint_sets:")
        for one in space.sets:
            title = f", title: {write_text(one.title)}" if one.title else ""
            lines.append(f"  {write_name(one.name)}: {{on: {str(one.on).lower()}{title}}}")
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
        entries = [f"title: {write_text(component.title)}"] if component.title else []
        if component.interface != NO_INTERFACE:
            entries.append(f"implements: {write_name(component.interface.name)}")
        if component.parameters:
            stated = (
                f"{write_name(parameter.name)}: {write_parameter(parameter)}" for parameter in component.parameters
            )
            entries.append(f"parameters: {{{', '.join(stated)}}}")
        if component.properties:
            stated = (
                f"{write_name(name)}: {_quantity(quantity.text)}" for name, quantity in component.properties.items()
            )
            entries.append(f"properties: {{{', '.join(stated)}}}")
        lines.append(f"  {write_name(component.name)}: {{{', '.join(entries)}}}")
    return "\n".join(lines) + "\n"


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
            yield from self.node(node, spot.part(name), f"{pad}  {write_name(name)}:", level + 1)
        if compound.interface is not None:
            yield f"{pad}implements: {write_name(compound.interface.name)}"
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
                yield f"{head} {write_name(node.name)}"
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
                        yield f"{pad}  - {write_name(option.name)}"
                    else:
                        yield f"{pad}  - {write_name(option.name)}:"
                        yield from self.compound(option, spot.option(option.name), level + 4)


def _constraint(name: str, constraint: Constraint, text: str, level: int) -> Iterator[str]:
    pad = "  " * level
    yield f"{pad}{write_name(name)}:"
    yield f"{pad}  require: {write_text(text)}"
    if constraint.because:
        yield f"{pad}  because: {write_text(constraint.because)}"
    if constraint.set:
        yield f"{pad}  set: {write_name(constraint.set)}"


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
