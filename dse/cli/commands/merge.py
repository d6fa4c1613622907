"""``dse merge``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import named_folder
from dse.cli.completion import folders
from dse.cli.terminal import print_line, status_line

Sources = Annotated[
    list[Path],
    typer.Argument(
        metavar="DIR…",
        autocompletion=folders,
        callback=lambda paths: [named_folder(path) for path in paths],
        help="The folder that contains the shards, or each shard's folder; the name of a study means out/STUDY.",
    ),
]
Target = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="DIR", help="The study folder to create; default: the given one."),
]


@app.command()
def merge(folders: Sources, target: Target = None) -> None:
    """Merge the shards of a study into one study folder (dse explore --shard).

    Missing shards are reported; the same command merges shards that are added later.
    """
    from dse.api import merge_into

    with status_line() as tell:
        tell("merging")
        place, merged = merge_into(folders, target)
    print_line(f"{place}: {merged.finished} of {merged.runs} runs, from {len(merged.of)} folders")
    for name in merged.absent:
        print_line(f"  {name} is not there")
    if merged.finished < merged.runs:
        for path, runs in merged.of.items():
            print_line(f"  {path}: {runs} runs")
    if merged.different:
        count = len(merged.different)
        print_line(
            f"  {count} runs were made twice, with other results (the first is run {merged.different[0]}); those that"
        )
        print_line("  came first are kept. Are these machines alike?")
    is_complete = merged.finished == merged.runs
    print_line(f"next: dse report {place}" if is_complete else f"next: dse explore STUDY -o {place} makes the rest")
