"""``dse components``."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dse.cli.app import app
from dse.cli.arguments import Format, Output
from dse.cli.terminal import plain_table, print_json, print_line, print_table
from dse.scratch import make_folder, write_whole

if TYPE_CHECKING:
    from dse.domain.component import Component, Type, Value


@app.command()
def components(
    workspace: Annotated[Path, typer.Argument(help="A folder or file in the workspace.")] = Path(),
    output: Format = Output.TABLE,
    graph: Annotated[
        Path | None,
        typer.Option("--graph", metavar="FOLDER", help="Draw each component into FOLDER, as NAME.svg."),
    ] = None,
) -> None:
    """List the component library, or draw it.

    Shows each component with its interface, source, properties and parameters; a picture shows its ports, and the parts
    of a Modelica model.
    """
    from dse.loading import Workspace

    space = Workspace.around(workspace)
    found = sorted((space.component(name) for name in space.component_files), key=lambda c: (c.interface.name, c.name))
    if graph is not None:
        _draw(found, graph)
        return
    if output is Output.JSON:
        print_json([data(component) for component in found])
        return
    table = plain_table("component", "interface", "source", "properties", "title")
    for component in found:
        properties = ", ".join(f"{name} {quantity}" for name, quantity in component.properties.items())
        table.add_row(component.name, component.interface.name, _kind(component), properties, component.title)
    print_table(table)


def _draw(components: list[Component], folder: Path) -> None:
    from dse.pictures import draw_component, pictured

    make_folder(folder)
    for component in components:
        target = folder / f"{component.name}.svg"
        write_whole(target, draw_component(component, pictured(component)))
        print_line(f"{target}: {component.title or component.name}")


def _kind(component: Component) -> str:
    return component.source.label if component.source is not None else "none"


def data(component: Component) -> dict[str, Any]:
    """The component as in JSON: numbers of its parameters are in their units."""
    return {
        "component": component.name,
        "title": component.title,
        "implements": component.interface.name or None,
        "source": _kind(component),
        "properties": {name: str(quantity) for name, quantity in component.properties.items()},
        "parameters": {
            p.name: {
                "start": _in_unit(p.start, p.type),
                "unit": str(p.type),
                "min": _in_unit(p.minimum, p.type),
                "max": _in_unit(p.maximum, p.type),
                "title": p.title,
            }
            for p in component.parameters
        },
        "ports": {p.name: {"causality": str(p.causality), "type": str(p.type)} for p in component.interface.ports},
    }


def _in_unit(value: Value | None, type_: Type) -> Value | None:
    return float(type_.unit.written(value)) if isinstance(value, float) and isfinite(value) else value
