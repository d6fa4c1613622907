"""Arguments that several commands share, with one wording."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.completion import benches, designs, folders, folders_and_roads, roads, studies

if TYPE_CHECKING:
    from dse.api import WorldPlace
    from dse.domain.study import Study


class Output(StrEnum):
    """What a command prints for."""

    TABLE = "table"
    JSON = "json"


Design = Annotated[
    str, typer.Argument(metavar="DESIGN", autocompletion=designs, help="A design space: its name, or its YAML file.")
]
Bench = Annotated[
    str, typer.Argument(metavar="BENCH", autocompletion=benches, help="A test bench: its name, or its YAML file.")
]
StudyName = Annotated[
    str, typer.Argument(metavar="STUDY", autocompletion=studies, help="A study (PET): its name, or its .pet.yaml file.")
]


RoadName = Annotated[
    str, typer.Argument(metavar="ROAD", autocompletion=roads, help="A road: its name, or its YAML file.")
]


def named_folder(path: Path) -> Path:
    """The study folder meant: a path, or the name of one in the workspace's ``out/``."""
    from dse.api import study_folder

    return study_folder(path)


Folder = Annotated[
    Path,
    typer.Argument(
        metavar="DIR",
        callback=named_folder,
        autocompletion=folders,
        help="A study folder, made by 'dse explore' or 'dse run'; the name of a study means out/STUDY.",
    ),
]
FolderOrRoad = Annotated[
    Path,
    typer.Argument(
        metavar="DIR|ROAD",
        callback=named_folder,
        autocompletion=folders_and_roads,
        help="A study folder, or the name of a study; or a road: its name, its YAML file, or an OpenDRIVE file.",
    ),
]
SI = Annotated[bool, typer.Option("--si", help="Write numbers in SI units, not in display units.")]


def units_word(si: bool) -> str:
    """What ``--si`` means to the front door."""
    return "si" if si else "shown"


Format = Annotated[Output, typer.Option("--format", help="For a person, or for a program.")]
Workers = Annotated[int, typer.Option("--workers", "-j", min=0, help="Worker processes; 0: one for each processor.")]
Threads = Annotated[
    int,
    typer.Option("--threads", "-t", min=1, help="Simultaneous runs in a worker, if the FMUs support it (dse probe)."),
]
NewFolder = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="The study folder to create or resume; default: out/NAME in the workspace.",
    ),
]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Delete the folder's contents and simulate all runs, also those made before.")
]
RetryFailed = Annotated[
    bool, typer.Option("--retry-failed", help="Simulate runs again that failed or were not reproducible.")
]
DryRun = Annotated[
    bool, typer.Option("--dry-run", help="Only list which runs would be simulated, why, and how long that takes.")
]
Settings = Annotated[
    list[str],
    typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter, as 'controller.kp_speed=1.2'."),
]
Configuration = Annotated[
    str | None, typer.Option("--configuration", "-c", metavar="ID", help="A configuration's id, or a start of it.")
]


def _picture(path: Path | None) -> Path | None:
    """Refuse a file that could not be written before anything is simulated for it."""
    if path is not None and path.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise typer.BadParameter(f"'{path.name}' must end in .png, .svg or .pdf")
    if path is not None and not path.parent.is_dir():
        raise typer.BadParameter(f"there is no folder '{path.parent}'")
    return path


Plot = Annotated[
    Path | None,
    typer.Option("--plot", metavar="FILE", callback=_picture, help="Draw the bench's figures (.png, .svg or .pdf)."),
]
FmiVersion = Annotated[int, typer.Option("--fmi", min=2, max=3, help="FMI version of the FMUs that are built.")]
Platforms = Annotated[
    list[str],
    typer.Option(
        "--platform",
        metavar="NAME",
        help="The FMUs get a library for this platform, too: win64, darwin. Can be repeated.",
    ),
]
CheckStep = Annotated[
    bool,
    typer.Option(
        "--check-step",
        help="Simulate with half the step and other numerics as well; what that changes is the error bar.",
    ),
]
Fuse = Annotated[
    bool, typer.Option("--fuse", help="Compile each configuration into one library first: same results, faster runs.")
]
World = Annotated[
    str | None,
    typer.Option("--world", metavar="HOST:PORT", help="Simulate half of the bench there, by 'dse world BENCH'."),
]


def _parts(text: str | None) -> str | None:
    """Refuse an empty list."""
    if text is not None and not split_parts(text):
        raise typer.BadParameter("name parts of the bench, as 'chassis,road'", param_hint="--parts")
    return text


def split_parts(text: str | None) -> tuple[str, ...] | None:
    """The parts that a list with commas names; None for none."""
    return None if text is None else tuple(part for piece in text.split(",") if (part := piece.strip()))


Parts = Annotated[
    str | None,
    typer.Option(
        "--parts",
        metavar="PART,…",
        callback=_parts,
        help="The parts of the world's half; default: the bench's test components.",
    ),
]


def world_of_bench(world: str | None, parts: str | None, wait: float = 10.0) -> WorldPlace | None:
    """Where the other half of a bench is, if it is not here, and how many seconds a run waits for it to be free."""
    if parts is not None and world is None:
        raise typer.BadParameter("this goes with --world", param_hint="--parts")
    if world is None:
        return None
    from dse.api import world_at

    return world_at(world, split_parts(parts), wait=wait)


def world_of_study(world: str | None, parts: str | None, study: Study) -> WorldPlace | None:
    """The same of a study, whose workers wait for each other almost as long as a run may take."""
    return world_of_bench(world, parts, min(0.9 * study.bench.simulation.timeout, 3600.0))


Listen = Annotated[
    str,
    typer.Option("--listen", metavar="ADDRESS", help="Listen on this address instead of loopback, with a token."),
]
ServerPort = Annotated[int, typer.Option("--port", min=0, max=65535, help="The port; 0: any free one.")]
Minimize = Annotated[
    list[str] | None,
    typer.Option("--minimize", metavar="VALUE", help="Value to minimize, as 'sum(cost)'."),
]
Maximize = Annotated[
    list[str] | None,
    typer.Option("--maximize", metavar="VALUE", help="Value to maximize, as 'sum(power) / sum(mass)'."),
]
Gate = Annotated[bool, typer.Option("--gate", help="Exit with 3 also if a requirement failed or is doubtful.")]


def _shard(text: str | None) -> str | None:
    """Refuse what is not I/N."""
    found = re.fullmatch(r"([1-9][0-9]{0,5})/([1-9][0-9]{0,5})", text or "1/1")
    if found is None or int(found[1]) > int(found[2]):
        raise typer.BadParameter(f"'{text}' is not I/N with 1 <= I <= N, as '3/8'", param_hint="--shard")
    return text


ShardOf = Annotated[
    str | None,
    typer.Option(
        "--shard",
        metavar="I/N",
        callback=_shard,
        help="Only part I of N, into DIR/shard-I-of-N; 'dse merge DIR' makes one study of all.",
    ),
]

On = Annotated[list[str], typer.Option("--on", metavar="SET", help="Switch a constraint set on.")]
Off = Annotated[list[str], typer.Option("--off", metavar="SET", help="Switch a constraint set off.")]


def _condition(text: str | None) -> str | None:
    """Refuse an empty condition: a variable of a script may be unset."""
    if text is not None and not text.strip():
        raise typer.BadParameter("the condition is empty", param_hint="--where")
    return text


Where = Annotated[
    str | None,
    typer.Option(
        "--where",
        metavar="CONDITION",
        callback=_condition,
        help="Only those that meet this condition, as 'sensor is lidar_905nm'.",
    ),
]
Choose = Annotated[
    list[str],
    typer.Option("--choose", metavar="PLACE=CHOICE", help="Choose an alternative at a place, as 'sensor=lidar_905nm'."),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of random draws; the same seed gives the same draws.")]


def _sandbox(asked: bool) -> bool:
    """Say what holds in the sandbox; DseError, before anything is done, where there is none."""
    if asked:
        from dse.cli.terminal import print_line
        from dse.sandbox import enforced

        print_line(f"sandbox: FMUs have {enforced()}", stderr=True)
    return asked


Strict = Annotated[bool, typer.Option("--strict", help="Treat content that would be ignored as an error.")]
Sandbox = Annotated[
    bool,
    typer.Option("--sandbox", callback=_sandbox, help="Keep FMUs from the network, and from files (Linux)."),
]
