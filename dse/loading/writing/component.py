"""Writes components, and interfaces, as YAML that reads back as the same."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from dse.domain.component import Causality, Component, Interface, Parameter
from dse.domain.fmu import FmiInterface
from dse.domain.labels import array_of
from dse.domain.outline import Outlined, outline
from dse.formats import write_file, write_name, write_parameter, write_text


def write_fmu_component(component: Component, file: str) -> str:
    """A ``component.yaml`` for a *component* whose source is the FMU in *file*, a path relative to it."""
    asked = component.source and component.source.interface
    way = f", interface: {FmiInterface(asked[0]).word}" if asked else ""
    return write_component(component, f"{{kind: fmu, file: {write_text(file)}{way}}}")


def write_component(component: Component, source: str) -> str:
    """A ``component.yaml`` for a *component* whose *source* is written already."""
    data: dict[str, Any] = {"component": write_name(component.name)}
    if component.title:
        data["title"] = write_text(component.title)
    data["implements"] = write_name(component.interface.name)
    data["source"] = source
    if component.names:
        data["map"] = {own: write_text(label) for own, label in component.names.items()}
    if component.parameters:
        arrays: dict[str, list[Parameter]] = {}
        for parameter in component.parameters:
            arrays.setdefault(array_of(parameter.name) or parameter.name, []).append(parameter)
        data["parameters"] = {name: write_parameter(*several) for name, several in arrays.items()}
    return write_file(data)


def write_interfaces(interfaces: Iterable[Interface]) -> str:
    """An ``interfaces.yaml`` with *interfaces*, and types for their arrays of structures."""
    types: dict[str, Any] = {}
    written = {interface.name: _interface(interface, types) for interface in interfaces}
    return write_file({**({"types": types} if types else {}), "interfaces": written})


def _interface(interface: Interface, types: dict[str, Any]) -> dict[str, Any]:
    sides = {
        f"{c}s": outline((port.name, str(port.type)) for port in interface.ports if port.causality is c)
        for c in Causality
    }
    return {side: _group(ports.items(), interface.name, types) for side, ports in sides.items() if ports}


def _group(members: Iterable[tuple[str, Outlined]], path: str, types: dict[str, Any]) -> dict[str, Any]:
    return {name: _written(member, f"{path}_{name}", types) for name, member in members}


def _written(member: Outlined, path: str, types: dict[str, Any]) -> Any:
    """As a person writes it; a structure that there is an array of gets a name in *types*."""
    sizes = f"[{', '.join(map(str, member.shape))}]" if member.shape else ""
    if not member.members:
        return write_text(member.type + sizes)
    group = _group(member.members, path, types)
    if not sizes:
        return group
    name = next((name for name, known in types.items() if known == group), path)
    types[name] = group
    return write_text(name + sizes)
