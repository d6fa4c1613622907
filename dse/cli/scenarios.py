"""OpenSCENARIO files on the command line: played, checked and drawn."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from dse.cli.arguments import Output
from dse.cli.diagnostics import Checked
from dse.cli.endings import DONE
from dse.cli.terminal import plain, plain_table, print_json, print_line, print_some, print_table, status_line
from dse.errors import raise_if_any
from dse.shipped import content

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dse.api import PlayedScenario

_STOP, _STEP = 60.0, 0.01


def is_scenario(name: str) -> bool:
    """Whether *name* is that of an OpenSCENARIO file."""
    return Path(name).suffix.lower() == ".xosc"


def simulate_scenario(
    path: Path,
    settings: Mapping[str, str],
    target: Path | None,
    output: Output,
    *,
    stop: float | None,
    step: float | None,
    sandbox: bool,
    strict: bool,
) -> None:
    """Play the scenario; show what its entities and its storyboard did, write the poses, and exit."""
    played = _played(path, settings, stop, step, sandbox=sandbox)
    if strict:
        raise_if_any(played.scenario.ignored)
    print_some("ignored", played.scenario.ignored)
    if target is not None:
        played.waveforms.write(target, {"scenario": path.name})
        print_line(f"{target}: {len(played.poses)} waveforms of {len(played.time)} points")
    elif output is Output.JSON:
        print_json(_data(played))
    else:
        _show(path, played)
    raise typer.Exit(DONE)


def check_scenario(path: Path) -> Checked:
    """Read the scenario with its roads and catalogues, and compile it."""
    from dse.world import read_scenario

    scenario = read_scenario(path)
    details = [f"parameter {each.name}: {each.start:g}" for each in scenario.parameters]
    details += [f"parameter {name}: {text} (decided when the FMU is built)" for name, text in scenario.decided.items()]
    counts = {"entity": len(scenario.entities), "element of the storyboard": len(scenario.elements)}
    host = scenario.entities[scenario.host] if scenario.host >= 0 else "none"
    return Checked(ignored=scenario.ignored, counts=counts, details=details, more=f"; host: {host}")


def draw_scenario(path: Path, target: Path | None, kind: str) -> None:
    """A map with the paths of the entities, and the storyboard over time."""
    from dse.api import element_times, scenario_picture
    from dse.places import OUT
    from dse.report import draw_scenario as draw, save_drawing
    from dse.scratch import make_folder

    played = _played(path, {}, None, None, sandbox=False)
    place = target or Path(OUT) / "figures"
    make_folder(place)
    picture = None if played.scenario.network is None else scenario_picture(played, path.stem)
    written = place / f"{path.stem}.{kind}"
    save_drawing(draw(path.stem, picture, element_times(played), float(played.time[-1])), written)
    print_line(str(written))


def _played(
    path: Path, settings: Mapping[str, str], stop: float | None, step: float | None, *, sandbox: bool
) -> PlayedScenario:
    from dse.api import play_scenario

    with status_line() as tell:
        return play_scenario(
            path, content("components"), settings, stop=stop or _STOP, step=step or _STEP, sandbox=sandbox, tell=tell
        )


def _show(path: Path, played: PlayedScenario) -> None:
    from dse.api import element_times

    ended = (
        f"the stop trigger ended it at {played.ended:g} s" if played.ended is not None else "no stop trigger ended it"
    )
    print_line(f"{path.name}: {played.time[-1]:g} s, {ended}")
    table = plain_table("entity", "x from", "to", "y from", "to", "speed from", "to")
    for name in played.scenario.entities:
        cells = []
        for label, unit in (("x", "m"), ("y", "m"), ("speed", "m/s")):
            values = played.poses[f"{name}.{label}"]
            there = [value for value in values.tolist() if isfinite(value)]
            cells += [f"{value:.2f} {unit}" for value in (there[0], there[-1])] if there else ["absent", ""]
        table.add_row(plain(name), *cells)
    print_table(table)
    rows = element_times(played)
    if rows:
        table = plain_table("storyboard", "name", "begins", "completes")
        for kind, name, began, completed in rows:
            table.add_row(kind, plain(name), _time(began), _time(completed))
        print_table(table)


def _time(value: float | None) -> str:
    return "never" if value is None else f"{value:.2f} s"


def _data(played: PlayedScenario) -> dict[str, object]:
    from dse.api import element_times

    names = ("kind", "name", "begins", "completes")
    return {
        "time": played.time.tolist(),
        "poses": {name: [v if isfinite(v) else None for v in values.tolist()] for name, values in played.poses.items()},
        "storyboard": [dict(zip(names, row, strict=True)) for row in element_times(played)],
        "ended": played.ended,
        "ignored": [str(problem) for problem in played.scenario.ignored],
    }
