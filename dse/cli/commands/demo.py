"""``dse demo``."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.terminal import print_line, show_page
from dse.errors import DseError, fail
from dse.shipped import content, lay_out

_STUDY = "acc_gains"


@app.command()
def demo(
    folder: Annotated[Path, typer.Argument(metavar="[DIR]", help="A new folder for --anew.")] = Path("dse-demo"),
    anew: Annotated[
        bool, typer.Option("--anew", help="Simulate the study here, into DIR, and open its report.")
    ] = False,
    show: Annotated[bool, typer.Option("--open/--no-open", help="Open the report in the browser.")] = True,
) -> None:
    """Open the report of an example study, or simulate that study here.

    The study varies four gains of an adaptive cruise control, in 2,178 runs. Its report comes with released wheels.
    """
    shipped = None if anew else _shipped()
    page = shipped or _simulated(folder)
    print_line(f"the report of the study '{_STUDY}': {page}")
    print_line("its sliders move the thresholds; a click on a point shows its waveforms")
    print_line(
        "next: dse demo --anew simulates it here" if shipped else f"next: cd {shlex.quote(str(folder))}; dse list"
    )
    if show:
        show_page(page.resolve().as_uri())


def _shipped() -> Path | None:
    try:
        return content("demo") / "demo" / "report.html"
    except DseError:
        return None


def _simulated(folder: Path) -> Path:
    """The report of the study, simulated in a new workspace in *folder*, or gone on with in one of an earlier demo."""
    from dse.api import ExploreOptions, Results, explore_into, open as open_workspace
    from dse.cli.exploration import progress_shown
    from dse.cli.terminal import status_line

    if not (folder / "testbenches" / f"{_STUDY}.pet.yaml").is_file():
        lay_out(folder)
        print_line(f"{folder}: a workspace with the example")
    place = folder / "out" / _STUDY
    with progress_shown(place) as watched:
        explore_into(open_workspace(folder).studies[_STUDY].noun, place, ExploreOptions(), **watched)
    results = Results(place)
    if results.summary.failed:
        raise fail(f"{results.summary.failed} runs failed to run", hint=f"dse results {shlex.quote(str(place))}")
    with status_line() as tell:
        tell("writing the report")
        return results.report(place / "report.html")
