"""A library outside of the workspace: a small one made for this test."""

from __future__ import annotations

from pathlib import Path

import pytest
from modelica_components import MakeModel
from reference import Floats, trajectory
from slaves import run_cs

from dse.errors import DseError

LIBRARY = Path(__file__).parent / "library"


def drive_train(t: float) -> tuple[float, float]:
    """Speed of the load and the torque on the housing, from Newton's laws and the controller's equations."""

    def right(_: float, x: Floats) -> list[float]:
        speed, twist, load, integral, torque = x
        shaft = 80 * twist + 2 * (load - speed / 3)
        error = 5 - load
        return [
            (torque + shaft / 3) / 0.5,
            load - speed / 3,
            -shaft / 4,
            error / 0.4,
            (8 * (integral + error) - torque) / 0.05,
        ]

    if t <= 0.25:
        return 0.0, 0.0
    x = trajectory(right, [0.0] * 5, 1.8)(t - 0.25)
    shaft = 80 * x[1] + 2 * (x[2] - x[0] / 3)
    return float(x[2]), float(shaft - shaft / 3)


def test_a_library_of_folders_is_found_by_its_path(made: MakeModel) -> None:
    model = made(LIBRARY.parent / "DriveTrain.mo", (LIBRARY,))
    rows = run_cs(model, ["speed", "reaction"], 20, 0.1, {}, {}, 1e-9)
    for k in range(1, 21):
        assert (rows[k]["speed"], rows[k]["reaction"]) == pytest.approx(drive_train(k * 0.1), abs=1e-6)


def test_a_path_without_the_library_is_an_error_that_names_what_is_missing(made: MakeModel, tmp_path: Path) -> None:
    with pytest.raises(DseError, match="Tiny"):
        made(LIBRARY.parent / "DriveTrain.mo", (tmp_path,))
