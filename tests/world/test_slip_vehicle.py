"""What slip control and all-wheel drive are worth, from the study of the library."""

from __future__ import annotations

from pathlib import Path

import pytest

import dse

pytestmark = [pytest.mark.usefixtures("kept_cache"), pytest.mark.thorough]
ROOT = Path(__file__).parents[2]


def test_anti_lock_brakes_shorten_the_stop_on_ice_and_all_wheel_drive_does_not(tmp_path: Path) -> None:
    study = dse.open(ROOT).studies["slip_surfaces"]
    rows = study.explore(tmp_path / "out", fresh=True).to_pandas("si")
    stops = rows[(rows["testbench"] == "emergency_stop") & (rows["weather.road"] == "ice")]
    distance = stops.set_index(["slip", "powertrain"])["stopping_distance"]
    for slip in ("no_slip_control", "anti_lock"):
        assert distance[slip, "bev_ideal_awd"] == pytest.approx(distance[slip, "bev_ideal"], rel=1e-9)
    # A locked tyre of two_track has 0.54 of its peak on ice.
    assert distance["anti_lock", "bev_ideal"] / distance["no_slip_control", "bev_ideal"] == pytest.approx(
        0.57, abs=0.05
    )
    starts = rows[(rows["testbench"] == "full_start") & (rows["weather.road"] == "ice")]
    speed = starts.set_index(["slip", "powertrain"])["speed_reached"]
    assert speed["no_slip_control", "bev_ideal_awd"] > 1.5 * speed["no_slip_control", "bev_ideal"]
    assert speed["traction_control", "bev_ideal"] > 1.3 * speed["no_slip_control", "bev_ideal"]
