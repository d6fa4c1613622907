"""Libraries outside of the workspace: a small one made for this test, and the Modelica Standard Library.

``DSE_MODELICA_PATH`` names the folder that holds ``Modelica/package.mo``.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from modelica_components import MakeModel
from reference import Floats, trajectory
from slaves import run_cs

from dse.domain.fmu import FmuModel
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


def msl() -> Path:
    folder = os.environ.get("DSE_MODELICA_PATH")
    if not folder:
        pytest.skip("DSE_MODELICA_PATH is not set: no Modelica Standard Library to try")
    return Path(folder)


ROTATIONAL = """model Shafts
  import Modelica.Mechanics.Rotational.Components.Inertia;
  Inertia motor(J = 2, phi(start = 0.3, fixed = true), w(start = 0, fixed = true));
  Modelica.Mechanics.Rotational.Components.Spring spring(c = 50);
  Modelica.Mechanics.Rotational.Components.Fixed wall;
  output Real y = motor.phi;
equation
  connect(motor.flange_b, spring.flange_a);
  connect(spring.flange_b, wall.flange);
end Shafts;
"""
TRANSLATIONAL = """model Masses
  import Modelica.Mechanics.Translational.Components.Mass;
  Mass mass(m = 3, s(start = 0, fixed = true), v(start = 2, fixed = true));
  Modelica.Mechanics.Translational.Components.Damper damper(d = 6);
  Modelica.Mechanics.Translational.Components.Fixed wall;
  output Real y = mass.v;
equation
  connect(mass.flange_b, damper.flange_a);
  connect(damper.flange_b, wall.flange);
end Masses;
"""
BLOCKS = """model Signals
  Modelica.Blocks.Sources.Constant one(k = 1);
  Modelica.Blocks.Continuous.FirstOrder lag(k = 4, T = 0.5, initType = Modelica.Blocks.Types.Init.InitialOutput);
  output Real y = lag.y;
equation
  connect(one.y, lag.u);
end Signals;
"""


@pytest.mark.parametrize(
    ("text", "solution"),
    [
        (ROTATIONAL, lambda t: 0.3 * np.cos(5 * t)),
        (TRANSLATIONAL, lambda t: 2 * np.exp(-2 * t)),
        (BLOCKS, lambda t: 4 * (1 - np.exp(-2 * t))),
    ],
    ids=["rotational", "translational", "blocks"],
)
def test_parts_of_the_standard_library_follow_closed_forms(
    text: str, solution: Callable[[float], float], made: MakeModel, tmp_path: Path
) -> None:
    root = msl()
    file = tmp_path / f"{text.split()[1]}.mo"
    file.write_text(text, encoding="utf-8")
    model: FmuModel = made(file, (root,))
    rows = run_cs(model, ["y"], 10, 0.1, {}, {}, 1e-9)
    for k, row in enumerate(rows):
        assert row["y"] == pytest.approx(solution(k * 0.1), abs=1e-6)
