"""``dse list``."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli import streams
from dse.cli.app import app
from dse.cli.arguments import Format, Output
from dse.cli.terminal import plain, plain_table, print_json, print_line, print_table, status_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dse.api import ListedFile, ListedResults

_RUNS = ("runs", "pass", "fail", "not exercised", "failed to run")


@app.command("list")
def list_(
    workspace: Annotated[Path, typer.Argument(help="A folder or file in the workspace.")] = Path(),
    output: Format = Output.TABLE,
) -> None:
    """List design spaces, test benches, studies, ratings, procedures and results.

    Results are the study folders below out/: the number of runs, and their verdicts over all requirements.
    """
    from dse.api import listing
    from dse.loading import Workspace

    with status_line() as tell:
        tell("reading results")
        found = listing(Workspace.around(workspace))
    if any(each.state == "running" for each in found.results):
        streams.record.content = None  # that ends without a trace in a file
    if output is Output.JSON:
        files = {kind: [_data(each) for each in listed] for kind, listed in found.files.items()}
        folders = [{**asdict(each), "folder": each.folder.as_posix()} for each in found.results]
        print_json({**files, "results": folders})
        return
    _show_files("design space", (), found.designs)
    _show_files("test bench", ("design",), found.benches)
    _show_files("study", ("testbench", "sampler"), found.studies)
    if found.ratings:
        _show_files("rating", ("protocol",), found.ratings)
    if found.procedures:
        _show_files("procedure", (), found.procedures)
    _show_results(found.results)


def _data(file: ListedFile) -> dict[str, str]:
    return {"name": file.name, "file": file.file, "title": file.title, **file.facts, "problem": file.problem}


def _show_files(what: str, facts: Sequence[str], files: Sequence[ListedFile]) -> None:
    if not files:
        print_line(f"no {what}\n", style="dim")
        return
    headings = [{"testbench": "test bench"}.get(fact, fact) for fact in facts]
    table = plain_table(what, *headings, "title")
    for each in files:
        title = f"cannot be read: {each.problem}" if each.problem else each.title
        table.add_row(each.name, *(plain(each.facts.get(fact, "")) for fact in facts), plain(title))
    print_table(table)
    print_line("")


def _show_results(results: Sequence[ListedResults]) -> None:
    if not results:
        print_line("no results in out/: dse explore STUDY, dse run BENCH", style="dim")
        return
    table = plain_table("results", "study", "is", *_RUNS, right=_RUNS)
    for each in results:
        if each.problem:
            table.add_row(each.folder.as_posix(), "", f"cannot be read: {plain(each.problem)}")
            continue
        runs = f"{each.finished:,}" if each.finished >= each.runs else f"{each.finished:,} of {each.runs:,}"
        counts = (f"{count:,}" if count else "–" for count in (each.verdicts[verdict] for verdict in _RUNS[1:]))
        table.add_row(each.folder.as_posix(), plain(each.study), each.state, runs, *counts)
    print_table(table)
