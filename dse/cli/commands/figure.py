"""``dse figure``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app, console
from dse.cli.arguments import Configuration, Folder
from dse.errors import Location, fail

if TYPE_CHECKING:
    from dse.report.content import ReportContent


class Kind(StrEnum):
    """File formats of figures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


@app.command()
def figure(
    folder: Folder,
    target: Annotated[Path | None, typer.Option("--output", "-o", metavar="DIR", help="Default: DIR/figures.")] = None,
    kind: Annotated[Kind, typer.Option("--format", help="File format.")] = Kind.PNG,
    x: Annotated[str | None, typer.Option("--x", help="Design variable of the horizontal axis.")] = None,
    y: Annotated[str | None, typer.Option("--y", help="Design variable of the vertical axis.")] = None,
    configuration: Configuration = None,
    number: Annotated[int | None, typer.Option("--run", help="The run whose waveforms are drawn.", min=0)] = None,
) -> None:
    """Draw the constraint plot and waveforms for print.

    The paper's figures 6 and 7, as PNG, SVG or PDF.

    Without --x and --y one constraint plot is drawn for each slice of the study. Without --run the waveforms are those
    of the run nearest the bounds of all requirements among those that pass.
    """
    from dse.report.draw import draw_constraint_plot, draw_waveforms, save
    from dse.report.figures import constraint_plot_data, default_run, planes, waveform_data
    from dse.report.study import read_content
    from dse.results.folder import StudyFolder

    if (x is None) != (y is None):
        raise typer.BadParameter("give both --x and --y, or neither", param_hint="--x/--y")
    with StudyFolder.open(folder) as store:
        content = read_content(store, shown_as=folder.as_posix())
    chosen = _configuration(content, configuration)
    run = number if number is not None else default_run(content) if content.figures else None
    place = target or folder / "figures"
    place.mkdir(parents=True, exist_ok=True)
    written = []
    for across, up in [(x, y)] if x and y else planes(content):
        data = constraint_plot_data(content, across, up, chosen)
        written.append(place / f"constraints_{across}_{up}.{kind}")
        save(draw_constraint_plot(data), written[-1])
    if run is not None and content.figures:
        written.append(place / f"waveforms_{run}.{kind}")
        save(draw_waveforms(waveform_data(content, run)), written[-1])
    else:
        console(stderr=True).print("no waveforms are drawn: the study kept none", soft_wrap=True)
    for path in written:
        console().print(str(path), soft_wrap=True)


def _configuration(content: ReportContent, wanted: str | None) -> str:
    """The id that starts with *wanted*; the first configuration's if it is None. Raises DseError."""
    ids = [entry.id for entry in content.configurations if entry.id.startswith(wanted or "")]
    if not ids or (wanted and wanted not in ids and len(ids) > 1):
        what = f"{len(ids) or 'no'} configurations of this study start with '{wanted}'"
        known = ", ".join(ids or [entry.id for entry in content.configurations][:6])
        raise fail(what, Location(content.study_folder), f"as {known}")
    return wanted if wanted in ids else ids[0]
