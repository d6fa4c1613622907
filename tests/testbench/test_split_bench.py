"""A bench is split into the car's half and the world's by a stated rule, or refused by name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from dse.domain.bench import TestBench
from dse.domain.component import Causality
from dse.domain.design import Configuration
from dse.domain.method import Bond, Coupling, Method
from dse.domain.udp import UdpSource, heard, sent
from dse.errors import DseError
from dse.loading import Workspace
from dse.testbench import Halves, WorldPlace, check_bench, halves_of, one_configuration
from dse.testbench.split_bench import far_half, near_half

_ROOT = Path(__file__).parents[2]
SOURCE = UdpSource(5005)


@pytest.fixture(scope="module")
def workspace() -> Workspace:
    return Workspace.around(_ROOT)


@pytest.fixture(scope="module")
def acc(workspace) -> TestBench:
    return workspace.bench("acc_following")


@pytest.fixture(scope="module")
def first(acc) -> Configuration:
    return one_configuration(acc.design, None)


def split(bench: TestBench, chosen: Configuration, *parts: str) -> Halves:
    return halves_of(check_bench(bench, chosen), WorldPlace(SOURCE, parts or None))


def refusal(bench: TestBench, chosen: Configuration, *parts: str) -> str:
    with pytest.raises(DseError) as refused:
        split(bench, chosen, *parts)
    return str(refused.value)


def test_the_worlds_half_is_what_is_not_of_the_design(acc, first):
    halves = split(acc, first)
    assert halves.far == {"world"}
    assert set(near_half(halves, SOURCE).parts) == {*first.parts, "world"}
    assert set(far_half(halves, SOURCE).parts) == {"world", "car"}


def test_what_crosses_is_sorted_by_name_with_numbers_by_value(workspace):
    bench = workspace.bench("road_following")
    halves = split(bench, one_configuration(bench.design, None), "road", "traffic", "scene")
    out = [port.name for port in halves.border.ports if port.causality is Causality.INPUT]
    back = [port.name for port in halves.border.ports if port.causality is Causality.OUTPUT]
    assert out == [f"chassis.contacts[{n}].{axis}" for n in range(1, 5) for axis in "xy"] + sorted(out[8:])
    previews = [name for name in back if name.startswith("road.preview[") and name.endswith(".x")]
    assert previews == [f"road.preview[{n}].x" for n in range(1, len(previews) + 1)]


def test_what_one_half_sends_is_what_the_other_hears(acc, first):
    halves = split(acc, first)
    near, far = near_half(halves, SOURCE).parts["world"], far_half(halves, SOURCE).parts["car"]
    for one, other in ((near, far), (far, near)):
        assert [type_ for _, type_ in sent(one)] == [type_ for _, type_ in heard(other)]
        assert [name for name, _ in sent(one)][:-1] == [name for name, _ in heard(other)][:-1]


def test_the_halves_together_have_the_wires_of_the_whole(acc, first):
    halves = split(acc, first, "world", "sensor")
    near, far = near_half(halves, SOURCE), far_half(halves, SOURCE)
    here, there = ({(c.source, c.target) for c in half.connections} for half in (near, far))
    for connection in halves.wired.connections:
        source, target = connection.source, connection.target
        match tuple(end.startswith(("world.", "sensor.")) for end in (source, target)):
            case False, False:
                assert (source, target) in here
            case True, True:
                assert (source, target) in there
            case False, True:
                assert {(source, f"world.{source}")} <= here
                assert {(f"car.{source}", target)} <= there
            case True, False:
                assert {(source, f"car.{source}")} <= there
                assert {(f"world.{source}", target)} <= here
    assert near.values.keys() | far.values.keys() == halves.wired.values.keys()
    assert not near.values.keys() & far.values.keys()


def test_recorded_signals_of_the_world_come_back_though_nobody_here_takes_them(acc, first):
    assert split(acc, first).border.port("world.gap") is not None
    quiet = replace(acc, metrics=(), requirements=(), figures=(), simulation=replace(acc.simulation, record=()))
    assert split(quiet, first).border.port("world.gap") is None


def test_the_layout_number_follows_from_what_the_world_is_and_nothing_else(acc, first):
    def number(bench: TestBench, *parts: str) -> int:
        return split(bench, first, *parts).number

    def given(**parameters: float) -> TestBench:
        return replace(acc, parameters={**acc.parameters, **{k.replace("__", "."): v for k, v in parameters.items()}})

    usual = number(acc)
    assert number(acc, "world") == usual == number(given(controller__set_speed=10.0))
    assert usual not in (
        number(given(world__lead_speed=3.0)),
        number(acc, "world", "sensor"),
        number(replace(acc, simulation=replace(acc.simulation, step=0.005))),
    )


def test_with_gauss_seidel_the_world_is_what_steps_last(workspace):
    bench = workspace.bench("road_following")
    chosen = one_configuration(bench.design, None)
    halves = split(bench, chosen)
    assert halves.far == {"traffic", "scene"}  # and the weather stays here, as it steps first
    assert halves.order[-1] == "world"
    told = refusal(bench, chosen, "sensor", "traffic")
    assert "the world's parts must step one after the other" in told
    assert "sensor there; then controller" in told


def test_an_architecture_is_chosen_with_all_its_parts(acc):
    hybrid = next(c for c in _configurations(acc) if c.choices.get("powertrain") == "range_extender")
    halves = split(acc, hybrid, "powertrain")
    assert halves.far == {part for part in hybrid.parts if part.startswith("powertrain.")}


def _configurations(bench: TestBench) -> list[Configuration]:
    from dse.space import open_space

    return list(open_space(bench.design).configurations(2000))


def test_what_cannot_be_in_two_places_is_refused_by_name(acc, first):
    assert "there is no part 'wrold'" in refusal(acc, first, "wrold")
    assert "all parts of the bench" in refusal(acc, first, *first.parts, "world")

    def by(method: Method) -> str:
        return refusal(replace(acc, simulation=replace(acc.simulation, method=method)), first)

    assert "coupling" in by(Method(coupling=Coupling.SOLVE))
    assert "steps of their own" in by(Method(steps={"powertrain": 0.02}))
    assert "check_step" in refusal(replace(acc, simulation=replace(acc.simulation, check_step=True)), first)
    axle = Bond("axle", "powertrain.wheels.front", "world.wheel_speed.front")
    assert "bond 'axle' touches" in by(Method(bonds=(axle,)))
