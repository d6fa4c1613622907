"""``dse new``: starts of components, design spaces, test benches, studies and roads."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import group
from dse.cli.completion import benches, components as components_of, designs
from dse.cli.terminal import print_line
from dse.shipped import content

if TYPE_CHECKING:
    from dse.loading import Workspace

new_app = group("new", "Write a commented template of a component, a design space, a test bench, a study or a road.")

Name = Annotated[str, typer.Argument(metavar="NAME", help="Its name.")]
At = Annotated[Path, typer.Option("--workspace", "-w", help="A folder or file in the workspace.")]


@new_app.command("component")
def new_component(
    name: Name,
    kind: Annotated[str, typer.Option("--kind", help="Its language: c or modelica.")] = "c",
    implements: Annotated[
        str | None,
        typer.Option("--implements", metavar="INTERFACE", help="An interface of the workspace; default: a new one."),
    ] = None,
    template: Annotated[
        str,
        typer.Option("--template", help="vehicle_interfaces: a powertrain of models that follow VehicleInterfaces."),
    ] = "",
    workspace: At = Path(),
) -> None:
    """Write a component that can be built, with its ports and a parameter.

    The files are in components/NAME of the workspace. Outside of a workspace, the current folder becomes one.
    """
    from dse.api import VEHICLE_INTERFACES, new_component as started, new_vehicle_interfaces

    if template not in ("", VEHICLE_INTERFACES):
        raise typer.BadParameter(
            f"there is no template '{template}', only '{VEHICLE_INTERFACES}'", param_hint="--template"
        )
    space = _opened(workspace)
    made = new_vehicle_interfaces(space, name, implements) if template else started(space, name, kind, implements)
    _write(space, name, made)
    print_line(f"next: dse build {name}; dse new design NAME {name}")


@new_app.command("design")
def new_design(
    name: Name,
    components: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="COMPONENT...",
            autocompletion=components_of,
            help="Its components; those with the same interface are alternatives.",
        ),
    ] = None,
    workspace: At = Path(),
) -> None:
    """Write a design space of components.

    Ports with the same name and type are connected. The file is designs/NAME.yaml.
    """
    from dse.api import new_design as started

    space = _opened(workspace)
    _write(space, name, started(space, name, components or []))
    print_line(f"next: dse enumerate {name}; dse new bench NAME --design {name}")


@new_app.command("bench")
def new_bench(
    name: Name,
    design: Annotated[
        str, typer.Option("--design", "-d", metavar="DESIGN", autocompletion=designs, help="The design space it tests.")
    ],
    around: Annotated[
        str | None,
        typer.Option(
            "--around",
            metavar="COMPONENT",
            help="The environment of the design: a plant, a road; connected by port names.",
        ),
    ] = None,
    workspace: At = Path(),
) -> None:
    """Write a test bench for a design space, that can be simulated.

    The file is testbenches/NAME.yaml.
    """
    from dse.api import new_bench as started

    space = _opened(workspace)
    _write(space, name, started(space, name, design, around))
    print_line(f"next: dse simulate {name}; dse new study NAME --bench {name}")


@new_app.command("study")
def new_study(
    name: Name,
    bench: Annotated[
        str, typer.Option("--bench", "-b", metavar="BENCH", autocompletion=benches, help="The test bench it runs on.")
    ],
    workspace: At = Path(),
) -> None:
    """Write a study of a test bench, that can be explored.

    The file is testbenches/NAME.pet.yaml.
    """
    from dse.api import new_study as started

    space = _opened(workspace)
    _write(space, name, started(space, name, bench))
    print_line(f"next: dse explore {name}; dse report {name}")


@new_app.command("road")
def new_road(name: Name, workspace: At = Path()) -> None:
    """Write a road with a bend, that can be driven.

    The file is roads/NAME.yaml.
    """
    from dse.api import new_road as started

    _write(_opened(workspace), name, started(name))
    print_line(f"next: dse figure {name}; dse export opendrive {name} -o {name}.xodr")


def _opened(path: Path) -> Workspace:
    """The workspace around *path*; where there is none, *path* becomes one."""
    from dse.loading import Workspace, find_root

    return Workspace(find_root(path) or path)


def _write(workspace: Workspace, name: str, files: Mapping[PurePosixPath, str]) -> None:
    from dse.api import write_start
    from dse.formats import shown

    for path in write_start(workspace, name, files):
        print_line(shown(path))
    # The first lines of the files name them.
    schemas = workspace.root / "schemas"
    if not schemas.exists():
        shutil.copytree(content("schemas") / "schemas", schemas)
        print_line(f"{shown(schemas)}: for editors")
