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
    assert conventional == pytest.approx(5.74, rel=0.01)
    assert list(shares.values()) == pytest.approx([0.856, 0.866, 0.729], abs=0.01)


def test_stop_start_saves_what_idling_costs_less_the_auxiliaries_and_the_starts() -> None:
    """The cycle stands for 242 s; some seconds pass before each of its ten stops is one of the engine."""
    idling, stopped = (
        metrics("hybrid_cycle", f"powertrain is combustion_dct7{name} and blending is separate_brakes")
        for name in ("", "_stop_start")
    )
    moved = stopped["distance"] / 1e5  # hundreds of km
    saved = (idling["fuel"] - stopped["fuel"]) * moved
    at_idle = 0.61 * 32.18e6 / 3600 * 242  # J, without the clutch that creeps
    assert 0.8 * at_idle < saved < 1.3 * at_idle
    assert stopped["battery"] * moved == pytest.approx(500 * 242 + 10 * 1900, rel=0.1)  # J: auxiliaries, ten starts


def test_a_coolant_circuit_brings_the_heat_of_the_electric_machine_to_the_battery() -> None:
    by_air, cooled = (
        metrics("electric_winter", where) for where in ("powertrain.coolant is absent", "powertrain.coolant is present")
    )
    assert cooled["battery_temperature"] - by_air["battery_temperature"] == pytest.approx(3.7, abs=0.3)
    assert by_air["machine_temperature"] - cooled["machine_temperature"] > 40
    assert cooled["energy"] < by_air["energy"]


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
    assert phases == pytest.approx(5.78, rel=0.01)
    assert turbo == pytest.approx(5.75, rel=0.01)


def test_a_shared_coolant_circuit_warms_the_battery_sooner_and_ages_it_more() -> None:
    winter, aged = (
        [metrics(bench, f"powertrain.coolant is coolant_{kind}") for kind in ("separate", "shared")]
        for bench in ("hybrid_winter", "hybrid_ageing")
    )
    assert [found["warm_up"] for found in winter] == pytest.approx([1716, 1242], rel=0.03)
    assert [found["health"] for found in aged] == pytest.approx([0.602, 0.591], abs=0.01)
    assert aged[0]["litres"] == pytest.approx(4.26, rel=0.01)
