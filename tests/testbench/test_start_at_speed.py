"""A car that moves at the start: the loop of world and powertrain settles on the speeds both are given."""

from __future__ import annotations

from pathlib import Path

import pytest

from dse.cosim.failure.run_failed import RunFailed
from dse.cosim.simulator import Simulator
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.prepare import prepare_bench

ROOT = Path(__file__).parents[2]
SPEED, RADIUS = 18.6, 0.31  # m/s; the world's wheels


@pytest.fixture(scope="module")
def simulator(tmp_path_factory: pytest.TempPathFactory):
    bench = Workspace.around(ROOT).bench("acc_following")
    chosen = next(c for c in open_space(bench.design).configurations() if c.choices["powertrain"] == "combustion_6at")
    prepared = prepare_bench(bench, [chosen], cache=tmp_path_factory.mktemp("cache"))[chosen.id]
    with Simulator(prepared.system, ["world.speed", "powertrain.torque_front"]) as found:
        yield found


@pytest.mark.thorough
def test_a_combustion_powertrain_starts_in_the_gear_of_its_speed(simulator: Simulator) -> None:
    start = {"world.initial_speed": SPEED, "powertrain.initial_speed": SPEED / RADIUS}
    speed, torque = simulator.run(stop=2.0, step=0.01, start=start).T
    assert speed[0] == SPEED
    assert abs(speed - SPEED).max() < 3
    assert abs(torque[:5]).max() < 600  # no shock: the shafts are not twisted by a difference of speeds


@pytest.mark.thorough
def test_speeds_that_do_not_fit_together_are_an_error_of_the_powertrain_by_name(simulator: Simulator) -> None:
    with pytest.raises(RunFailed, match=r"powertrain: .*Initialization.* the event iteration finds no end"):
        simulator.run(stop=0.1, step=0.01, start={"world.initial_speed": 0.0, "powertrain.initial_speed": 60.0})
