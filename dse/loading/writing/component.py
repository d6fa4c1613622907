"""Writes components of finished FMUs, and interfaces, as YAML that reads back as the same."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from dse.domain.component import Causality, Component, Interface, Port
from dse.domain.fmu import FmiInterface
from dse.formats import write_file, write_name, write_parameter, write_text


def write_fmu_component(component: Component, file: str) -> str:
    """A ``component.yaml`` for a *component* whose source is the FMU in *file*, a path relative to it."""
    data: dict[str, Any] = {"component": write_name(component.name)}
    if component.title:
        data["title"] = write_text(component.title)
    data["implements"] = write_name(component.interface.name)
    asked = component.source and component.source.interface
    way = f", interface: {FmiInterface(asked[0]).word}" if asked else ""
    data["source"] = f"{{kind: fmu, file: {write_text(file)}{way}}}"
    if component.names:
        data["map"] = {own: write_text(label) for own, label in component.names.items()}
    if component.parameters:
        data["parameters"] = {parameter.name: write_parameter(parameter) for parameter in component.parameters}
    return write_file(data)


def write_interfaces(interfaces: Iterable[Interface]) -> str:
    """An ``interfaces.yaml`` with *interfaces*."""
    return write_file({"interfaces": {interface.name: _interface(interface) for interface in interfaces}})


def _interface(interface: Interface) -> dict[str, Any]:
    groups = {f"{c}s": _tree(port for port in interface.ports if port.causality is c) for c in Causality}
    return {name: ports for name, ports in groups.items() if ports}


def _tree(ports: Iterable[Port]) -> dict[str, Any]:
    """Ports by name, groups nested, each group where its first port stands."""
    tree: dict[str, Any] = {}
    for port in ports:
        *groups, name = port.name.split(".")
        inner = tree
        for group in groups:
            inner = inner.setdefault(group, {})
        inner[name] = write_text(str(port.type))
    return tree
