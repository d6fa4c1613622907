"""``dse figure``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Configuration, FolderOrRoad, named_folder
from dse.cli.scenarios import draw_scenario, is_scenario
from dse.cli.terminal import print_line, show_problems, status_line
from dse.errors import DseError, Problem, raise_if_any
from dse.scratch import make_folder


class PictureFormat(StrEnum):
    """File formats of figures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


@app.command()
def figure(
    folder: FolderOrRoad,
    target: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Default: DIR/figures; out/figures for a road. A file for --scene."
        ),
    ] = None,
    kind: Annotated[PictureFormat, typer.Option("--format", help="File format.")] = PictureFormat.PNG,
    x: Annotated[str | None, typer.Option("--x", help="Design variable of the horizontal axis.")] = None,
    y: Annotated[str | None, typer.Option("--y", help="Design variable of the vertical axis.")] = None,
    configuration: Configuration = None,
    number: Annotated[
        int | None, typer.Option("--run", help="The run whose waveforms, or whose path, are drawn.", min=0)
    ] = None,
    only: Annotated[list[str] | None, typer.Option("--only", metavar="NAME", help="Only this figure.")] = None,
    driven: Annotated[
        list[Path] | None,
        typer.Option(
            "--drive", metavar="SOURCE", help="On a road: the path of a run of a study, or of a waveform file."
        ),
    ] = None,
    scene: Annotated[
        int | None, typer.Option("--scene", metavar="RUN", min=0, help="This run in three dimensions instead.")
    ] = None,
    at: Annotated[
        str, typer.Option("--at", metavar="TIME", help="With --scene: the time, or the start of a film.")
    ] = "0 s",
    until: Annotated[str | None, typer.Option("--until", metavar="TIME", help="End of a film.")] = None,
    frames: Annotated[
        float | None,
        typer.Option("--frames", metavar="RATE", min=0.1, max=120, help="A film with this many frames per second."),
    ] = None,
    camera: Annotated[str, typer.Option("--view", help="Camera of --scene: chase, driver, top or side.")] = "chase",
    size: Annotated[str, typer.Option("--size", metavar="WxH", help="Pixels of --scene.")] = "1280x720",
) -> None:
    """Draw the constraint plot, the waveforms and all other figures for print; or a road; or a scene of a run.

    PNG, SVG or PDF. The paper's figures 6 and 7 are 'constraints' and 'waveforms'.

    Without --x and --y one constraint plot is drawn for each slice of the study. Without --run the waveforms are those
    of the run nearest the bounds of all requirements among those that pass.

    A scenario (.xosc) is drawn as a map with the paths of its entities, and as its storyboard over time.

    A road is drawn as a map to scale, with lanes, slippery patches, lights, height, bank and curvature along the road;
    --drive adds driven paths.

    --scene draws a moment of a run in three dimensions as PNG. With --frames it is a film: WebP, GIF, with ffmpeg MP4
    or WebM, or a folder of numbered PNG files, by the ending of -o. It needs a Chromium; the run is simulated again.
    """
    from dataclasses import replace

    from dse.api import is_road

    if is_scenario(folder.name):
        draw_scenario(folder, target, kind)
        return
    if is_road(folder):
        _draw_road(folder, target, kind, [(named_folder(source), number or 0) for source in driven or ()])
        return
    if driven:
        raise typer.BadParameter("paths are drawn on roads", param_hint="--drive")

    if scene is not None:
        _draw_scene(folder, scene, target, (at, until), frames, (camera, size))
        return

    from dse.report import (
        FIGURES,
        View,
        configuration_called,
        drawings,
        read_content,
        read_insight,
        save_drawing,
        uses_insight,
    )

    if (x is None) != (y is None):
        raise typer.BadParameter("give both --x and --y, or neither", param_hint="--x/--y")
    names = tuple(dict.fromkeys(only or FIGURES.names()))
    with status_line() as tell:
        tell("reading the runs")
        content = read_content(folder)
        if uses_insight(names):
            tell("computing findings")
            content = replace(content, insight=read_insight(folder))
    view = View(x, y, configuration_called(content, configuration), number)
    place = target or folder / "figures"
    make_folder(place)
    if content.missing:
        show_problems(DseError(*content.missing))
    problems: list[Problem] = []
    for name in names:
        written = []
        try:
            for stem, sheet in drawings(name, content, view):
                written.append(place / f"{stem}.{kind}")
                save_drawing(sheet, written[-1])
                print_line(str(written[-1]))
        except DseError as error:  # the other figures can be drawn all the same
            problems += error.problems
        else:
            if not written:
                print_line(f"{name}: nothing to draw of this study", stderr=True)
    raise_if_any(problems)


def _draw_road(road: Path, target: Path | None, kind: PictureFormat, driven: list[tuple[Path, int]]) -> None:
    from dse.api import picture_of
    from dse.places import OUT
    from dse.report import draw_road, save_drawing

    place = target or Path(OUT) / "figures"
    with status_line() as tell:
        tell("drawing the road")
        sheet = draw_road(picture_of(road, driven))
    make_folder(place)
    written = place / f"{road.stem}.{kind}"
    save_drawing(sheet, written)
    print_line(str(written))


def _draw_scene(
    folder: Path,
    run: int,
    target: Path | None,
    times: tuple[str, str | None],
    rate: float | None,
    seen: tuple[str, str],
) -> None:
    from dse.api import Results
    from dse.report import Shot

    (at, until), (view, size) = times, seen
    sides = size.lower().split("x")
    if len(sides) != 2 or not all(side.isascii() and side.isdecimal() and len(side) < 6 for side in sides):
        raise typer.BadParameter(f"'{size}' is not a size, as 1280x720", param_hint="--size")
    end = None if until is None else _moment("--until", until)
    shot = Shot(_moment("--at", at), end, rate, view, (int(sides[0]), int(sides[1])))
    place = target or folder / "figures" / (f"run_{run}.png" if rate is None else f"run_{run}.webp")
    if target is None:
        make_folder(place.parent)
    with status_line() as tell:
        count = Results(folder).film_scene(run, place, shot, tell=tell)
    print_line(f"{place}: run {run}" + ("" if rate is None else f", {count} frames"))


def _moment(option: str, text: str) -> float:
    from dse.units import UnitError, parse_quantity, parse_unit

    try:
        quantity = parse_quantity(text)
    except UnitError as error:
        raise typer.BadParameter(str(error), param_hint=option) from None
    if quantity.unit.symbol and quantity.unit.dimension != parse_unit("s").dimension:
        raise typer.BadParameter(f"'{text}' is not a time", param_hint=option)
    if quantity.si < 0:
        raise typer.BadParameter(f"'{text}' is before the run", param_hint=option)
    return float(quantity.si)
