"""What the powertrains of the shipped designs are worth in their benches: the figures of docs/powertrains.md."""

from __future__ import annotations

from pathlib import Path

import pytest

import dse

pytestmark = [pytest.mark.usefixtures("kept_cache"), pytest.mark.thorough]
ROOT = Path(__file__).parents[2]
HYBRID = "powertrain is hybrid_p2 and powertrain.engine is otto_1l5 and powertrain.machine is pmsm_85kw"


def metrics(bench: str, where: str) -> dict[str, float]:
    """Of the only configuration that *where* leaves."""
    tested = dse.open(ROOT).benches[bench]
    (configuration,) = tested.design.list(2, where=where)
    return dict(tested.simulate(configuration).metrics)


def test_a_hybrid_with_recuperation_and_equivalent_consumption_saves_a_quarter() -> None:
    conventional = metrics("hybrid_cycle", "powertrain is combustion_dct7")["litres"]
    shares = {
        (control, blending): metrics(
            "hybrid_cycle", f"{HYBRID} and powertrain.control is {control} and blending is {blending}"
        )["litres"]
        / conventional
        for control, blending in (
            ("p2_control", "recuperating_brakes"),
            ("p2_ecms", "separate_brakes"),
            ("p2_ecms", "recuperating_brakes"),
        )
    }
    assert conventional == pytest.approx(5.68, rel=0.01)
    assert list(shares.values()) == pytest.approx([0.90, 0.90, 0.76], abs=0.01)


def test_a_limited_slip_differential_starts_on_split_friction_and_pulls_to_one_side() -> None:
    open_, limited = (
        metrics("split_start", f"powertrain is combustion_dct7_{name} and road is road_split_friction")
        for name in ("open", "limited_slip")
    )
    assert limited["speed_reached"] > 2 * open_["speed_reached"]
    assert limited["spin"] < 5 < open_["spin"]
    assert limited["offset"] > 1 > open_["offset"]


def test_shift_phases_and_a_charger_cost_little_on_the_cycle() -> None:
    phases, turbo = (
        metrics("hybrid_cycle", f"powertrain is combustion_dct7_{name}")["litres"] for name in ("phases", "turbo")
    )
    assert phases == pytest.approx(5.72, rel=0.01)
    assert turbo == pytest.approx(5.69, rel=0.01)


def test_a_shared_coolant_circuit_warms_the_battery_sooner_and_ages_it_more() -> None:
    winter, aged = (
        [metrics(bench, f"powertrain.coolant is coolant_{kind}") for kind in ("separate", "shared")]
        for bench in ("hybrid_winter", "hybrid_ageing")
    )
    assert [found["warm_up"] for found in winter] == pytest.approx([1719, 1265], rel=0.03)
    assert [found["health"] for found in aged] == pytest.approx([0.596, 0.586], abs=0.01)
    assert aged[0]["litres"] == pytest.approx(4.24, rel=0.01)
