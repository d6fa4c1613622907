"""The public ALKS and Euro NCAP scenarios beside the project: every road user where the logs of another player have it.

The limit is 0.2 m, as the logs are those of a player that makes the same steps of 10 ms by rules of its own.
"""

from __future__ import annotations

import csv
import subprocess
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from dse.fmu.toolchain.compiler import find_compiler
from dse.world import read_scenario, scenario_files

DATA = Path(__file__).parents[4] / "shared" / "data"
NEAR = 0.2  # m
# The other player ignores that this car is turned by an <Orientation> in its <RoutePosition>.
TURNED = {("NCAP_AEB_VRU_CBFA_2023", "ObstructionSmall"), ("CBFA", "ObstructionSmall")}
MAIN = """
#include "scenario.h"

#include <stdio.h>

static scenario world;

int main(void) {
    world.par.drives_host = true;
%s
    scenario_init(&world);
    for (int k = 0; k <= %d; ++k) {
        if (k) scenario_step(&world, 0.01);
        for (int i = 0; k %% 10 == 0 && i < scenario_tables.entity_count; ++i) {
            printf("%%d %%d %%.9g %%.9g\\n", k / 10, i, world.board.actors[i].at.x, world.board.actors[i].at.y);
        }
    }
    return 0;
}
"""
Track = dict[int, tuple[float, float]]
"""Positions by tenths of a second."""


def pairs() -> Iterator[tuple[Path, Path]]:
    """Scenarios with their logs."""
    for log in sorted((DATA / "alks" / "traces").glob("*.csv")):
        yield DATA / "alks" / f"{log.stem}.xosc", log
    for log in sorted((DATA / "ncap" / "traces").rglob("*.csv")):
        (scenario,) = (path for path in (DATA / "ncap").rglob(f"{log.stem}.xosc") if "Variations" not in path.parts)
        yield scenario, log


def logged(path: Path) -> dict[str, Track]:
    tracks: dict[str, Track] = defaultdict(dict)
    with path.open(encoding="utf-8") as file:
        for time, *groups in list(csv.reader(file))[1:]:
            for at in range(0, len(groups), 5):
                name, x, y, *_ = groups[at : at + 5]
                tracks[name][round(float(time) * 10)] = (float(x), float(y))
    return tracks


def driven(path: Path, tenths: int, folder: Path) -> dict[str, NDArray[np.float64]]:
    read = read_scenario(path)
    given = "\n".join(f"    world.par.{each.name} = {each.start!r};" for each in read.parameters)
    files = {**scenario_files(read), "main.c": MAIN % (given, 10 * tenths)}
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    sources = [folder / name for name in files if name.endswith(".c")]
    subprocess.run([*find_compiler().command, "-std=c11", "-o", folder / "run", *sources, "-lm"], check=True)
    out = subprocess.run([folder / "run"], check=True, capture_output=True, text=True).stdout
    rows = np.array([line.split() for line in out.splitlines()], dtype=float)
    return {name: rows[rows[:, 1] == number][:, 2:] for number, name in enumerate(read.entities)}


@pytest.mark.thorough
@pytest.mark.skipif(not DATA.is_dir(), reason="the public scenarios are not beside the project")
@pytest.mark.parametrize(("scenario", "log"), [pytest.param(*pair, id=pair[1].stem) for pair in pairs()])
def test_every_road_user_is_where_the_log_has_it(scenario: Path, log: Path, tmp_path: Path) -> None:
    tracks = logged(log)
    found = driven(scenario, max(max(track) for track in tracks.values()), tmp_path)
    assert set(tracks) <= set(found)
    for name, track in tracks.items():
        away = max(np.hypot(*(found[name][at] - place)) for at, place in track.items())
        assert away < NEAR or (scenario.stem, name) in TURNED, name
