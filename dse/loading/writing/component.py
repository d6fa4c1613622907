"""Writes components of finished FMUs, and interfaces, as YAML that reads back as the same."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from dse.domain.component import Causality, Component, Interface, Port, Type
from dse.formats.yaml_text import write_name, write_parameter, write_text


def write_fmu_component(component: Component, file: str) -> str:
    """A ``component.yaml`` for a *component* whose source is the FMU in *file*, a path relative to it."""
    lines = [f"component: {write_name(component.name)}"]
    if component.title:
        lines.append(f"title: {write_text(component.title)}")
    lines.append(f"implements: {write_name(component.interface.name)}")
    lines.append(f"source: {{kind: fmu, file: {write_text(file)}}}")
    if component.names:
        lines.append("map:")
        lines += [f"  {write_name(own)}: {write_text(label)}" for own, label in component.names.items()]
    if component.parameters:
        lines.append("parameters:")
        lines += [f"  {write_name(p.name)}: {write_parameter(p)}" for p in component.parameters]
    return "\n".join(lines) + "\n"


def write_interfaces(interfaces: Iterable[Interface]) -> str:
    """An ``interfaces.yaml`` with *interfaces*."""
    lines = ["interfaces:"]
    for interface in interfaces:
        lines.append(f"  {write_name(interface.name)}:{'' if interface.ports else ' {}'}")
        for causality in Causality:
            ports = [port for port in interface.ports if port.causality is causality]
            if ports:
                lines.append(f"    {causality}s:")
                lines += _tree(ports, "", 3)
    return "\n".join(lines) + "\n"


def _tree(ports: Iterable[Port], prefix: str, level: int) -> Iterator[str]:
    """Ports below *prefix*, groups nested, each group where its first port stands."""
    pad = "  " * level
    groups: dict[str, list[Port]] = {}
    for port in ports:
        groups.setdefault(port.name.removeprefix(prefix).split(".")[0], []).append(port)
    for name, members in groups.items():
        if len(members) == 1 and members[0].name == f"{prefix}{name}":
            yield f"{pad}{write_name(name)}: {write_text(_type(members[0].type))}"
        else:
            yield f"{pad}{write_name(name)}:"
            yield from _tree(members, f"{prefix}{name}.", level + 1)


def _type(type_: Type) -> str:
    return str(type_)
