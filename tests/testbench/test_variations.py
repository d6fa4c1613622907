"""What a run is compared with, and which metrics have no error bar: from what is known of the parts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from dse.domain.bench import Simulation
from dse.domain.component import Kind
from dse.domain.facts import Answer, FmuFacts, FmuNumerics, Lever, Question
from dse.domain.fmu import Capabilities, FmiInterface, FmuModel, Variable
from dse.domain.method import Adaptive, Algorithm, Method
from dse.domain.system import Element, SystemStructure, Wire
from dse.testbench.variations import SAFETY, Checks, checks_of

BENCH = Simulation(1.0, 0.1, (), 0.1)
EXACT = FmuNumerics(0.1, exact="it says so")
COARSE = FmuNumerics(0.1, {Lever.STEP: 1e-3}, divisor=8)
AS_ASKED = FmuNumerics(0.1, {Lever.STEP: 1e-3}, divisor=2)
TOLERANT = FmuNumerics(0.1, {Lever.TOLERANCE: 1e-4}, tolerance=1e-8)
LAZY = FmuNumerics(0.1, {Lever.DOUBLED: 1e-3})
UNKNOWN = FmuNumerics(0.1, unknown="nobody knows")
PLACE = Path("there")


@dataclass
class Metrics:
    """What is asked of a program: the waveforms of each metric."""

    metrics: Mapping[str, tuple[str, ...]]

    def signals_of(self, metric: str) -> frozenset[str]:
        return frozenset(self.metrics[metric])


def model(name: str, **more: object) -> FmuModel:
    variables = {v: Variable(v, n, "Real", c, Kind.REAL) for n, (v, c) in enumerate((("u", "input"), ("y", "output")))}
    return FmuModel(PLACE, PLACE, PLACE / name, 2, name, "", variables, **more)


def checked(
    parts: Mapping[str, FmuNumerics],
    wires: str = "",
    bench: Simulation = BENCH,
    facts: Mapping[str, FmuFacts] | None = None,
    **models: FmuModel,
) -> Checks:
    """Parts by name, wires as ``a b`` for a's output to b's input; the metrics are called like the parts."""
    built = {name: models.get(name, model(name)) for name in parts}
    elements = tuple(Element(name, m, (m.variables["u"],), (m.variables["y"],), {}) for name, m in built.items())
    ends = [pair.split() for pair in wires.split(",") if pair]
    system = SystemStructure("s", elements, tuple(Wire(a, "y", b, "u") for a, b in ends))
    program = Metrics({name: (f"{name}.port",) for name in parts})
    exchanges = {name: model(name, interface=FmiInterface.MODEL_EXCHANGE) for name in parts}
    sources = {f"{name}.port": f"{name}.y" for name in parts}
    return checks_of(system, bench, parts, exchanges, facts or {}, program, sources)


def test_half_the_step_shows_the_error_of_what_steps_as_it_is_asked_to():
    half, third = checked({"a": EXACT, "b": AS_ASKED}).variations
    assert (half.what, half.step, half.method) == ("with half the step", 0.5, BENCH.method)
    # A method of first order is off by twice what half the step changes, and by 3/2 of what a third changes.
    assert (half.errors, third.errors) == pytest.approx((2 * SAFETY, 1.5 * SAFETY))
    assert (third.what, third.step) == ("with a third of the step", 1 / 3)


def test_where_a_third_of_the_step_does_not_fit_twice_the_step_shows_whether_another_one_matters():
    found = checked({"a": AS_ASKED}, a=model("a", fixed_step=0.05)).variations
    assert [(v.step, v.errors > 0) for v in found] == [(0.5, True), (2.0, False)]
    assert len(checked({"a": AS_ASKED}, bench=replace(BENCH, stop=1.1), a=model("a", fixed_step=0.05)).variations) == 1


def test_a_part_that_shows_nothing_alone_may_show_it_in_its_system():
    relay = replace(UNKNOWN, shows_coupled=True)
    found = checked({"a": relay, "b": EXACT, "c": EXACT}, "a b,b a")
    assert (set(found.unless), found.unmeasured, found.exact) == ({"a", "b"}, {}, {"c"})
    assert checked({"a": relay, "b": UNKNOWN}, "b a").unmeasured.keys() == {"a", "b"}


def test_a_part_with_an_inner_step_is_stepped_below_it():
    *_, inner = checked({"a": EXACT, "b": COARSE}).variations
    assert (inner.step, inner.method.steps) == (1.0, {"b": pytest.approx(0.0125)})


def test_a_longer_step_of_its_own_becomes_a_part_of_the_bench_s():
    bench = replace(BENCH, method=Method(steps={"b": 0.5}))
    half, _, inner = checked({"a": EXACT, "b": replace(COARSE, step=0.5)}, bench=bench).variations
    assert half.method.steps == {"b": 0.25}
    assert inner.method.steps == {"b": 0.05}  # the longest half of half of 0.1 s below 0.5 s / 8


def test_with_adaptive_steps_all_parts_make_the_shortest():
    bench = replace(BENCH, method=Method(adaptive=Adaptive()))
    *_, inner = checked({"a": EXACT, "b": COARSE}, bench=bench).variations
    assert (inner.step, inner.method) == (pytest.approx(0.125), bench.method)


def test_a_tolerance_is_tightened_and_model_exchange_takes_the_place_of_co_simulation():
    both = replace(TOLERANT, changes={Lever.EXCHANGE: 1e-3})
    *_, inner = checked({"a": TOLERANT, "b": both, "c": EXACT}).variations
    a, b, c = inner.system.elements
    assert [e.model.experiment.tolerance for e in (a, b, c)] == [1e-8, 1e-8, None]
    assert [str(e.model.interface) for e in (a, b, c)] == ["CoSimulation", "ModelExchange", "CoSimulation"]


def test_a_part_that_answers_to_longer_steps_only_is_given_them_besides():
    assert [v.step for v in checked({"a": LAZY}).variations] == [0.5, 1 / 3, 2.0]


def test_twice_the_step_takes_the_place_of_half_where_a_part_bears_none_shorter():
    found = checked({"a": AS_ASKED, "b": LAZY}, b=model("b", fixed_step=0.1))
    assert [v.step for v in found.variations] == [2.0]


def test_an_odd_number_of_steps_cannot_be_doubled():
    found = checked({"a": LAZY, "b": EXACT}, bench=replace(BENCH, stop=1.1))
    assert [v.step for v in found.variations] == [0.5, 1 / 3]
    assert found.unmeasured == {"a": "a (a): shows its error in longer steps only, and the bench makes an odd number"}


def test_only_metrics_that_hang_on_an_unknown_part_have_no_error_bar():
    found = checked({"a": UNKNOWN, "b": EXACT, "c": EXACT, "d": EXACT}, "a b,b c")
    assert found.unmeasured == dict.fromkeys("abc", "a (a): nobody knows")
    assert found.variations


def test_where_no_metric_has_one_nothing_is_simulated_again():
    found = checked({"a": UNKNOWN, "b": EXACT}, "a b,b a")
    assert found.variations == ()
    assert set(found.unmeasured) == {"a", "b"}


@pytest.mark.parametrize("question", [Question.RENEWS, Question.COEXISTS])
def test_an_fmu_whose_instances_disturb_each_other_is_not_simulated_again(question):
    facts = {"a": FmuFacts("", "", "a", 2, "CoSimulation", {question: Answer.NO})}
    found = checked({"a": TOLERANT}, facts=facts)
    assert found.variations == ()
    assert "second instance in one process" in found.unmeasured["a"]


def test_an_fmu_that_can_be_there_once_is_still_given_half_the_step():
    once = model("a", capabilities=Capabilities(once_per_process=True))
    assert len(checked({"a": AS_ASKED}, a=once).variations) == 2
    assert "second instance" in checked({"a": COARSE}, a=once).unmeasured["a"]


def test_other_algorithms_stay_what_they_are():
    bench = replace(BENCH, method=Method(Algorithm.GAUSS_SEIDEL))
    assert {v.method.algorithm for v in checked({"a": COARSE}, bench=bench).variations} == {Algorithm.GAUSS_SEIDEL}


def test_a_run_may_take_as_long_as_all_that_are_compared():
    assert math.fsum(v.cost for v in checked({"a": COARSE}).variations) >= 2 + 8
