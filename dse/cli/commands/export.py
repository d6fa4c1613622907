"""``dse export``: design spaces, configurations on their bench, roads and scenarios, for other programs."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import opened, space_of, workspace_of
from dse.cli.app import group
from dse.cli.arguments import (
    Bench,
    Choose,
    Configuration,
    Design,
    FmiVersion,
    Folder,
    Off,
    On,
    Platforms,
    RoadName,
    Settings,
    Where,
)
from dse.cli.terminal import console, print_line, status_line

if TYPE_CHECKING:
    from dse.domain.bench import TestBench

export_app = group(
    "export", "Write a design space, a configuration on its bench, a road or a run, for another program."
)

Target = Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="The file to write.")]


@export_app.command("uvl")
def export_uvl(design: Design, target: Target, on: On = [], off: Off = []) -> None:
    """Write a design space as a feature model in UVL.

    With the constraints that are on; a constraint that UVL cannot express is refused by name.
    """
    from dse.loading import to_uvl
    from dse.scratch import write_whole

    space = space_of(design, on, off)
    text = to_uvl(space)
    write_whole(target, text)
    print_line(f"{target}: {space.name}")


@export_app.command("csv")
def export_csv(
    design: Design, target: Target, choose: Choose = [], where: Where = None, on: On = [], off: Off = []
) -> None:
    """Write the valid configurations as CSV.

    A line for each configuration: its id, the choice at each place, and the sums that constraints use.
    """
    if target.suffix.lower() != ".csv":
        raise typer.BadParameter(f"'{target.name}' must end in .csv", param_hint="--output")
    part = opened(design, choose, where, on, off)
    written = part.save(part.blocks(), target)
    print_line(f"{target}: {written:,} configuration{'' if written == 1 else 's'}")


@export_app.command("ssp")
def export_ssp(
    bench: Bench,
    target: Target,
    configuration: Configuration = None,
    settings: Settings = [],
    version: FmiVersion = 2,
    platform: Platforms = [],
) -> None:
    """Write a configuration on its test bench as an SSP package.

    With its FMUs, connections and parameter values, so that other programs simulate the same.

    Takes the first valid configuration unless --configuration names another.
    """
    from dse.api import write_package
    from dse.cli.commands.simulate import read_settings

    if target.suffix.lower() != ".ssp":
        raise typer.BadParameter(f"'{target.name}' must end in .ssp", param_hint="--output")
    tested, screen = workspace_of(bench).bench(bench), console(stderr=True)
    with screen.status("building FMUs"):
        chosen, elements = write_package(
            tested, configuration, read_settings(settings), target, fmi=version, platforms=platform
        )
    for what in _left_behind(tested):
        screen.print(f"note: the package lacks {what}, for which SSP has no place", soft_wrap=True)
    print_line(f"{target}: configuration {chosen.id} of {tested.name}, {elements} components")


@export_app.command("opendrive")
def export_opendrive(road: RoadName, target: Target) -> None:
    """Write a road as OpenDRIVE 1.7.

    Its geometry, lanes, speed limits, traffic lights, and patches with a friction of their own. The timing of lights is
    in user data, which other programs ignore.
    """
    from dse.api import opendrive_text
    from dse.scratch import write_whole

    if target.suffix.lower() != ".xodr":
        raise typer.BadParameter(f"'{target.name}' must end in .xodr", param_hint="--output")
    name, text = opendrive_text(road)
    write_whole(target, text)
    print_line(f"{target}: {name}")


@export_app.command("mesh")
def export_mesh(road: RoadName, target: Target) -> None:
    """Write the surface of a road as a mesh, for engines such as Unity, Unreal and Godot: glTF (.glb) or Wavefront
    (.obj).

    ROAD may also be an OpenDRIVE file. In the mesh y is up: a place (x, y, z) of dse is (x, z, -y).
    """
    from dse.api import write_road_mesh

    if target.suffix.lower() not in (".glb", ".obj"):
        raise typer.BadParameter(f"'{target.name}' must end in .glb or .obj", param_hint="--output")
    name, triangles = write_road_mesh(road, target)
    print_line(f"{target}: {name}, {triangles:,} triangles")


@export_app.command("openscenario")
def export_openscenario(
    bench: Bench, target: Target, configuration: Configuration = None, settings: Settings = []
) -> None:
    """Write a run of a test bench as an OpenSCENARIO file, for players of scenarios.

    Each road user follows the path that it drove, the host included. The road is written beside it as OpenDRIVE.

    Takes the first valid configuration unless --configuration names another.
    """
    from dse.api import export_scenario
    from dse.cli.commands.simulate import read_settings

    if target.suffix.lower() != ".xosc":
        raise typer.BadParameter(f"'{target.name}' must end in .xosc", param_hint="--output")
    tested = workspace_of(bench).bench(bench)
    with status_line() as tell:
        chosen, count = export_scenario(tested, configuration, read_settings(settings), target, tell=tell, warn=_warn)
    entities = "entity" if count == 1 else "entities"
    print_line(f"{target}: configuration {chosen} of {tested.name}, {count} {entities}")


class Message(StrEnum):
    """What a trace file of one type contains."""

    GROUND_TRUTH = "ground_truth"
    SENSOR_VIEW = "sensor_view"
    SENSOR_DATA = "sensor_data"


@export_app.command("trace")
def export_trace(
    folder: Folder,
    number: Annotated[int, typer.Argument(metavar="RUN", help="A run's number.", min=0)],
    target: Target,
    message: Annotated[Message, typer.Option("--message", help="What an .osi file contains.")] = Message.GROUND_TRUTH,
    part: Annotated[
        str, typer.Option("--part", metavar="NAME", help="The sensor or tracker whose messages an .osi file contains.")
    ] = "",
    rate: Annotated[float, typer.Option("--rate", min=0.1, max=1000, help="Messages per second.")] = 25.0,
    pictures: Annotated[
        float | None,
        typer.Option("--pictures", metavar="RATE", min=0.1, max=60, help="Camera pictures per second in an MCAP file."),
    ] = None,
    layout: Annotated[
        Path | None,
        typer.Option("--layout", metavar="FILE", help="Also write a layout that Foxglove and Lichtblick import."),
    ] = None,
    source: Annotated[
        Path | None, typer.Option("--source", help="The study's or bench's YAML file, if it is not in this workspace.")
    ] = None,
) -> None:
    """Write a run as a trace file: ASAM OSI (.osi), or MCAP for Foxglove, Lichtblick and rerun.

    An .osi file contains messages of one type. An MCAP file contains the ground truth, the data of all sensors and
    trackers as messages of OSI, the scene in the messages of Foxglove, and all signals. The run is simulated again.
    """
    from dse.api import Results

    if target.suffix.lower() not in (".osi", ".mcap"):
        raise typer.BadParameter(f"'{target.name}' must end in .osi or .mcap", param_hint="--output")
    if pictures is not None and target.suffix.lower() == ".osi":
        raise typer.BadParameter("only MCAP files contain pictures", param_hint="--pictures")
    if layout is not None and target.suffix.lower() == ".osi":
        raise typer.BadParameter("a layout is for an MCAP file", param_hint="--layout")
    with status_line() as tell:
        counts = Results(folder).write_trace(
            number,
            target,
            message=message.value,
            part=part,
            rate=rate,
            pictures=pictures,
            layout=layout,
            source=source,
            tell=tell,
            warn=_warn,
        )
    print_line(f"{target}: run {number}, {sum(counts.values()):,} messages")
    if len(counts) > 1:
        for topic, count in counts.items():
            print_line(f"  {topic}  {count:,}")


def _warn(doubt: str) -> None:
    print_line(f"warning: {doubt}", stderr=True)


def _left_behind(bench: TestBench) -> Iterator[str]:
    """What of *bench* a package cannot hold."""
    from dse.domain.method import PLAIN

    counted = {"metric": bench.metrics, "requirement": bench.requirements, "figure": bench.figures}
    kept = [f"{len(things)} {name}{'s' * (len(things) > 1)}" for name, things in counted.items() if things]
    if kept:
        listed = " and ".join([", ".join(kept[:-1]), kept[-1]] if len(kept) > 1 else kept)
        yield f"the bench's {listed}"
    if bench.simulation.method != PLAIN:
        yield "the bench's co-simulation algorithm"
