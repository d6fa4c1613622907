"""The template of a powertrain by VehicleInterfaces, with a stand-in; its buses have no members either."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench import Bench

from dse.api import new_vehicle_interfaces, write_start
from dse.errors import DseError
from dse.fmu import build, open_fmu
from dse.loading import Workspace

STAND_IN = Path(__file__).parents[1] / "modelica" / "stand_in"


@pytest.mark.thorough
def test_pedal_and_flanges_become_the_ports_of_a_powertrain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MODELICA_PATH", str(STAND_IN))
    files = Workspace(tmp_path)
    write_start(files, "my_car", new_vehicle_interfaces(files, "my_car", None))
    component = Workspace(tmp_path).component("my_car")
    cache = tmp_path / "cache"
    bench = Bench(open_fmu(build(component, cache=cache), cache=cache), 1e-8)
    bench.set({"wheel_speed_front": 10.0, "wheel_speed_rear": 10.0})
    # 50 N.m of the engine, 4 and 3 to one; the twist of the half shafts dies out by exp(-3.5 t).
    for number, (demand, torque) in enumerate([(300.0, 300.0), (-100.0, 0.0), (9e3, 600.0)]):
        bench.set({"torque_demand": demand})
        for k in range(5):
            bench.step(5.0 * number + k, 1.0)
        assert bench.get(["torque_front", "torque_rear"]) == pytest.approx([torque, 0.0], abs=1e-3)
    bench.close()


def test_the_template_is_refused_where_a_powertrain_has_other_ports(tmp_path: Path) -> None:
    own = tmp_path / "components" / "interfaces.yaml"
    own.parent.mkdir()
    own.write_text("interfaces:\n  powertrain:\n    inputs: {demand: N.m}\n", encoding="utf-8")
    with pytest.raises(DseError, match=r"(?s)interfaces.yaml:2:3: .* other ports .*hint: .*torque_demand"):
        new_vehicle_interfaces(Workspace(tmp_path), "my_car", None)
    with pytest.raises(DseError, match="cannot implement 'engine'"):
        new_vehicle_interfaces(Workspace(tmp_path), "my_car", "engine")
