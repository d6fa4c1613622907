"""Emergency brakes beside the reference drivers of UN R157, in the world: who avoids which cut-in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import dse

ROOT = Path(__file__).parents[2]
FAST = {"traffic.lateral_speed": 1.8}


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "avoided"),
    [
        ("two_stage_aeb", [False, True, True]),
        ("reference_driver_cc", [False, False, True]),
        ("reference_driver_fsm", [False, False, True]),
    ],
)
def test_there_are_cut_ins_that_an_emergency_brake_avoids_and_a_careful_driver_does_not(
    name: str,
    avoided: list[bool],
    built_before: Callable[[Path], Path],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(built_before(tmp_path / "cache")))
    bench = dse.open(ROOT).benches["driver_cut_in"]
    configuration, *_ = bench.design.list(1, where=f"aeb is {name}")
    runs = [bench.simulate(configuration, set={"traffic.begin_gap": gap, **FAST}) for gap in (30.0, 40.0, 80.0)]
    assert [run.metrics["impact_speed"] == 0 for run in runs] == avoided
    # All but the first are what UN R157 has a system avoid.
    assert [run.metrics["beyond"] > 0 for run in runs] == [False, True, True]
