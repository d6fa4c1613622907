"""The electric car's design space: its size, and that its choices reach the simulation."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from dse.domain.design import Configuration
from dse.domain.run import Run, RunRequest
from dse.loading.workspace import Workspace
from dse.space import OpenedSpace, open_space
from dse.testbench import prepare_bench
from dse.testbench.runner import Runner

WORKSPACE = Workspace(Path(__file__).parents[2])
BASE = {
    "body": "body_mixed",
    "aero": "aero_shutters",
    "tyres": "tyre_touring_17",
    "wheels": "wheel_alloy_17",
    "discs": "discs_300",
    "climate": "heat_pump",
    "battery": "nmc_58kwh",
    "drive": "rear_drive",
    "drive.machine": "pmsm_115kw",
    "drive.inverter": "igbt_550a",
    "drive.gear": "gear_10",
    "sensor": "radar_77ghz_mid",
    "controller": "pd_acc",
    "blending": "blended_braking",
    "brake": "brake_by_wire",
}
OTHERS = [
    {"body": "body_aluminium"},
    {"aero": "aero_full"},
    {"tyres": "tyre_eco_17"},
    {"wheels": "wheel_aero_17"},
    {"discs": "discs_330"},
    {"climate": "ptc_heater"},
    {"battery": "nmc_77kwh"},
    {"drive": "front_drive"},
    {"drive.machine": "asm_105kw"},
    {"drive.inverter": "sic_500a"},
    {"drive.gear": "gear_12"},
    {"sensor": "camera_mono"},
    {"controller": "pi_time_gap_acc"},
    {"blending": "separate_braking"},
    {"blending": "separate_braking", "brake": "hydraulic_booster"},
]
SIMULATED = (
    ("mass", "mass"),
    ("ratio", "ratio"),
    ("radius", "radius"),
    ("peak_power", "max_power"),
    ("max_speed", "max_speed"),
    ("delivers", "max_discharge"),
)
"""Properties that rules reckon with, and parameters that say the same to a simulation."""


@pytest.fixture(scope="module")
def space() -> OpenedSpace:
    return open_space(WORKSPACE.design("electric_acc"))


def test_the_electric_car_has_more_than_a_million_valid_configurations(space: OpenedSpace) -> None:
    assert space.total == 1_134_673_920
    assert space.count(exact=True).value == 9_699_268


def test_what_parts_state_for_rules_is_what_they_give_to_a_simulation() -> None:
    compared = 0
    for name, file in WORKSPACE.component_files.items():
        if "cars" not in file.parts:
            continue
        part = WORKSPACE.component(name)
        parameters = {parameter.name: parameter for parameter in part.parameters}
        for stated, given in SIMULATED:
            if stated in part.properties:
                assert part.properties[stated].si == pytest.approx(parameters[given].start, rel=1e-12), (name, stated)
                compared += 1
    assert compared == 65


@pytest.fixture(scope="module")
def runs(space: OpenedSpace) -> list[tuple[Configuration, Run]]:
    """The base, then all that differ from it in a choice, each simulated once."""
    wanted = [BASE, *({**BASE, **other} for other in OTHERS)]
    configurations = [chosen(space, choices) for choices in wanted]
    prepared = prepare_bench(WORKSPACE.bench("electric_acc_motorway"), configurations)
    found = []
    for configuration in configurations:
        with Runner(prepared[configuration.id]) as runner:
            found.append((configuration, runner.run(RunRequest(0, configuration.id, {}), keep=False)))
    return found


def chosen(space: OpenedSpace, choices: Mapping[str, str]) -> Configuration:
    (found,) = space.part([f"{place}={name}" for place, name in choices.items()]).configurations()
    return found


@pytest.mark.thorough
def test_every_choice_changes_what_is_measured(runs: list[tuple[Configuration, Run]]) -> None:
    (_, base), *others = runs
    for other, (_, run) in zip(OTHERS, others, strict=True):
        assert run.problem == ""
        changed = [name for name, value in base.metrics.items() if abs(run.metrics[name] - value) > 1e-6 * abs(value)]
        assert len(changed) >= 3, other


@pytest.mark.thorough
def test_the_simulated_car_weighs_what_its_parts_do(runs: list[tuple[Configuration, Run]]) -> None:
    for configuration, run in runs:
        # Sensor, controller and booster are of the library of the paper's case, and part of the payload of 150 kg.
        devices = {"sensor", "controller", "brake"}
        weighed = [part for place, part in configuration.parts.items() if place not in devices]
        mass = sum(part.properties["mass"].si for part in weighed if "mass" in part.properties)
        assert run.metrics["car_mass"] == pytest.approx(mass + 150, rel=1e-12)


@pytest.mark.thorough
def test_heavier_slower_and_thirstier_is_what_one_expects(runs: list[tuple[Configuration, Run]]) -> None:
    base = runs[0][1].metrics
    by = {next(iter(other.values())): run.metrics for other, (_, run) in zip(OTHERS, runs[1:], strict=True)}
    assert by["body_aluminium"]["ramp_time"] < base["ramp_time"] < by["nmc_77kwh"]["ramp_time"]
    assert by["aero_full"]["consumption"] < base["consumption"] < by["ptc_heater"]["consumption"]
    assert by["tyre_eco_17"]["consumption"] < base["consumption"]
    assert by["sic_500a"]["consumption"] < base["consumption"]
    assert 1.3 * base["consumption"] < by["separate_braking"]["consumption"]
    assert base["driving_range"] < by["nmc_77kwh"]["driving_range"]
    assert 1.5 * base["following_jerk"] < by["camera_mono"]["following_jerk"]


@pytest.mark.thorough
def test_a_drive_cycle_takes_the_energy_of_its_phases_and_less_with_recuperation(space: OpenedSpace) -> None:
    wanted = [chosen(space, {**BASE, "blending": name}) for name in ("separate_braking", "blended_braking")]
    prepared = prepare_bench(WORKSPACE.bench("electric_acc_cycle"), wanted)
    metres = {"low": 3095, "medium": 4756, "high": 7162, "extra_high": 8254}
    used = []
    for configuration in wanted:
        with Runner(prepared[configuration.id]) as runner:
            run = runner.run(RunRequest(0, configuration.id, {}), keep=False)
        assert run.problem == ""
        assert [judgement.verdict for judgement in run.judgements] == ["pass", "pass"]
        assert run.metrics["distance"] == pytest.approx(23267, rel=0.002)  # of the cycle, which the car only tracks
        shares = [run.metrics[f"energy_{name}"] * distance for name, distance in metres.items()]
        assert sum(shares) == pytest.approx(run.metrics["energy"] * 23267, rel=0.003)
        used.append(run.metrics["energy"])
    assert 0.75 * used[0] < used[1] < 0.97 * used[0]
