"""Arguments that several commands share, with one wording."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Output(StrEnum):
    """What a command prints for."""

    TABLE = "table"
    JSON = "json"


Design = Annotated[str, typer.Argument(metavar="DESIGN", help="A design space: its name, or its YAML file.")]
Bench = Annotated[str, typer.Argument(metavar="BENCH", help="A test bench: its name, or its YAML file.")]
StudyName = Annotated[str, typer.Argument(metavar="STUDY", help="A study (PET): its name, or its .pet.yaml file.")]
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="A study folder, made by 'dse explore' or 'dse run'.")]
Format = Annotated[Output, typer.Option("--format", help="For a person, or for a program.")]
Workers = Annotated[
    int, typer.Option("--workers", "-j", min=0, help="Worker processes; 0 takes one for each processor.")
]
NewFolder = Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="The study folder to make or go on with.")]
Settings = Annotated[
    list[str], typer.Option("--set", metavar="NAME=VALUE", help="Give a parameter another value, as 'controller.kp_speed=1.2'.")
]
Configuration = Annotated[
    str | None, typer.Option("--configuration", "-c", metavar="ID", help="A configuration's id (a start of it will do).")
]
FmiVersion = Annotated[int, typer.Option("--fmi", min=2, max=3, help="FMI version of the FMUs that are built.")]
Gate = Annotated[bool, typer.Option("--gate", help="Exit with 3 if a requirement failed, not only if a run did.")]


def processes(workers: int) -> int:
    """The number of worker processes *workers* asks for."""
    import os

    return workers or os.cpu_count() or 1
