"""A scenario that plays by itself, in a program of its own, without an FMU."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from workspaces import written

from dse.world.openscenario.code import scenario_files
from dse.world.openscenario.scenario import Scenario, read_scenario

Track = NDArray[np.float64]
"""Rows of x, y, heading and speed every 0.1 s."""

MAIN = """
#include "scenario.h"
#include <stdio.h>
static scenario self;
int main(void) {
    self.par.drives_host = true;
    scenario_init(&self);
    for (int k = 0; k <= 1200; ++k) {
        if (k) scenario_step(&self, 0.01);
        for (int i = 0; k % 10 == 0 && i < scenario_tables.entity_count; ++i) {
            const sb_actor *a = &self.board.actors[i];
            printf("%.9g %.9g %.9g %.9g\\n", a->at.x, a->at.y, a->at.heading, a->speed);
        }
    }
    return 0;
}
"""


def played_tracks(folder: Path, text: str, roads: str) -> tuple[Scenario, dict[str, Track]]:
    """12 s of the scenario *text*, whose road network is roads.xodr."""
    written(folder, {"scenario.xosc": text, "roads.xodr": roads})
    read = read_scenario(folder / "scenario.xosc")
    written(folder / "c", scenario_files(read) | {"main.c": MAIN})
    sources = sorted((folder / "c").glob("*.c"))
    subprocess.run(["gcc", "-std=c99", "-Wall", "-Werror", "-o", folder / "run", *sources, "-lm"], check=True)
    out = subprocess.run([folder / "run"], check=True, capture_output=True, text=True).stdout
    rows = np.array([[float(x) for x in line.split()] for line in out.splitlines()])
    tracks = rows.reshape(121, len(read.entities), 4)
    return read, {name: tracks[:, i] for i, name in enumerate(read.entities)}
