"""What a bench may record and measure of a place where components and architectures stand in turn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from dse.domain.bench import TestBench as Bench
from dse.domain.design import Configuration
from dse.errors import DseError
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.prepare import check_bench

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def bench() -> Bench:
    return Workspace.around(ROOT).bench("acc_following")


def with_powertrain(bench: Bench, name: str) -> Configuration:
    return next(c for c in open_space(bench.design).configurations() if c.choices["powertrain"] == name)


def recording(bench: Bench, *names: str) -> Bench:
    return replace(bench, simulation=replace(bench.simulation, record=names))


@pytest.mark.parametrize("powertrain", ["combustion_6at", "hybrid_p2", "range_extender"])
def test_outputs_of_the_interface_are_there_whatever_stands_in_its_place(bench: Bench, powertrain: str) -> None:
    check_bench(recording(bench, "powertrain.co2", "powertrain.wheels.front"), with_powertrain(bench, powertrain))


@pytest.mark.parametrize("powertrain", ["combustion_6at", "hybrid_p2"])
def test_outputs_inside_an_architecture_are_left_out_where_another_one_stands(bench: Bench, powertrain: str) -> None:
    check_bench(recording(bench, "powertrain.engine.torque"), with_powertrain(bench, powertrain))


@pytest.mark.parametrize("powertrain", ["combustion_6at", "hybrid_p2"])
def test_what_no_architecture_has_is_refused(bench: Bench, powertrain: str) -> None:
    with pytest.raises(DseError, match=r"cannot record 'powertrain\.smoke'"):
        check_bench(recording(bench, "powertrain.smoke"), with_powertrain(bench, powertrain))
