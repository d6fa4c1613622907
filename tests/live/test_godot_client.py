"""Scripts of clients/godot, run in Godot 3: they are written in what Godot 3 and 4 have in common."""

from __future__ import annotations

import subprocess

import pytest
from background import LIMIT


@pytest.mark.thorough
def test_its_axes_are_those_of_exported_roads_and_road_users_are_templates_or_boxes(godot_world: list[str]) -> None:
    command = [*godot_world[:-1], "show.gd"]
    said = subprocess.run(command, check=True, capture_output=True, text=True, timeout=LIMIT).stdout
    lines = [line for line in said.splitlines() if line.startswith(("(", "True", "False"))]
    # dse export mesh writes (x, z, -y), which Godot imports as it is.
    assert lines[:4] == ["(3, 5, -4)", *["TrueTrueTrue"] * 3]
    # A car without a template is a box, whose middle is 0.75 m above the road; a truck has its origin on the road.
    assert lines[4:6] == ["(11, 1.75, -2)(1.8, 1.5, 4.5)True1", "(11, 1, -2)(1, 1, 1)True1"]
    assert lines[6].endswith("0")
