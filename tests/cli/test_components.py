"""``dse components``: the numbers of a component's parameters."""

from __future__ import annotations

from pathlib import Path

from dse.cli.commands.components import data
from dse.loading import Workspace


def test_numbers_of_a_parameter_are_in_the_unit_that_is_named_with_them():
    camera = data(Workspace.around(Path(__file__).parents[2]).component("camera_mono"))
    angle = camera["parameters"]["field_of_view"]
    assert angle == {"start": 50, "unit": "deg", "min": 0, "max": 120, "title": "from edge to edge"}
    assert camera["parameters"]["seed"]["max"] is None
