"""Objectives with expected values: the mean over the cases of a design, by the weights of its conditions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from definitions import metrics, stored_definition

from dse.domain.bench import Verdict
from dse.domain.definition import (
    DefinedConfiguration,
    DefinedReplicates,
    DefinedRequirement,
    DefinedTotal,
    DefinedVariable,
    StudyDefinition,
)
from dse.domain.sampler import Objective, Outcomes
from dse.errors import DseError
from dse.exploration import design_variable, designs_of
from dse.testbench import compile_objective, with_composites


@pytest.fixture
def definition() -> StudyDefinition:
    """Two cars with a gain, on two benches of which the first counts three times as much, with an uncertain mass."""
    return stored_definition(
        tuple(
            DefinedConfiguration(name, totals={"cost": DefinedTotal(cost, "EUR")})
            for name, cost in (("a", 100.0), ("b", 300.0))
        ),
        variables=(
            DefinedVariable("car.gain", "", "", 0.0, 1.0, 2, 0.0, values=(0.0, 1.0)),
            DefinedVariable(
                "testbench", "", "", 0.0, 1.0, 2, 0.0, values=(0.0, 1.0), role="condition", weights=(3.0, 1.0)
            ),
            DefinedVariable("car.mass", "", "kg", 0.0, 9.0, 0, 1.0, role="uncertain"),
        ),
        metrics=metrics("risk"),
    )


ROWS = [
    # configuration, gain, bench, mass, risk
    ("a", 0.0, 0.0, 1.0, 0.10),
    ("b", 0.0, 0.0, 1.0, 0.00),
    ("a", 0.0, 0.0, 2.0, 0.30),
    ("a", 0.0, 1.0, 1.0, 1.00),
    ("b", 0.0, 1.0, 1.0, 0.80),
    ("a", 1.0, 1.0, 1.0, 0.40),
    ("a", 1.0, 0.0, 1.0, 0.20),
]
EXPECTED = {("a", 0.0): (3 * 0.2 + 1.0) / 4, ("b", 0.0): 0.2, ("a", 1.0): (3 * 0.2 + 0.4) / 4}
"""By hand: in a case the mean over the masses."""


def outcomes() -> Outcomes:
    names, gains, benches, masses, risks = zip(*ROWS, strict=True)
    cost = np.array([{"a": 100.0, "b": 300.0}[name] for name in names])
    points = {"car.gain": np.array(gains), "testbench": np.array(benches), "car.mass": np.array(masses)}
    done = np.ones(len(ROWS), dtype=np.bool_)
    passed = {"R": tuple(Verdict.PASS for _ in ROWS)}
    return Outcomes(names, points, done, {"risk": np.array(risks)}, {"R": np.ones(len(ROWS))}, passed, {"cost": cost})


def values(text: str, definition: StudyDefinition) -> np.ndarray:  # type: ignore[type-arg]
    return with_composites(outcomes(), [Objective(text, is_composite=True)], definition).metrics[text]


def test_each_run_of_a_design_has_its_expected_value(definition: StudyDefinition) -> None:
    wanted = [EXPECTED[name, gain] for name, gain, *_ in ROWS]
    assert values("expected(risk)", definition) == pytest.approx(wanted)
    priced = values("sum(cost) + 1000 EUR * expected(2 * risk)", definition)
    costs = {"a": 100.0, "b": 300.0}
    assert priced == pytest.approx([costs[name] + 2000 * EXPECTED[name, gain] for name, gain, *_ in ROWS])


def test_a_design_is_judged_by_its_expected_value_and_otherwise_at_its_worst_condition(
    definition: StudyDefinition,
) -> None:
    objectives = [Objective("expected(risk)", is_composite=True), Objective("risk")]
    variables = tuple(map(design_variable, definition.variables))
    designs = designs_of(with_composites(outcomes(), objectives, definition), variables, objectives)
    assert designs.objectives[:, 0] == pytest.approx([0.4, 0.2, 0.25])
    assert designs.objectives[:, 1] == pytest.approx([1.0, 0.8, 0.4])


def test_without_weights_all_cases_count_alike_and_a_weight_of_0_leaves_one_out(definition: StudyDefinition) -> None:
    gain, bench, mass = definition.variables
    alike = replace(definition, variables=(gain, replace(bench, weights=()), mass))
    assert values("expected(risk)", alike)[0] == pytest.approx((0.2 + 1.0) / 2)
    one = replace(definition, variables=(gain, replace(bench, weights=(0.0, 2.0)), mass))
    broken = outcomes()
    broken.metrics["risk"][0] = np.nan  # type: ignore[index]  # it is a dict
    text = "expected(risk)"
    found = with_composites(broken, [Objective(text, is_composite=True)], one).metrics[text]
    assert found[:2] == pytest.approx([1.0, 0.8])
    undefined = with_composites(broken, [Objective(text, is_composite=True)], definition).metrics[text]
    assert np.isnan(undefined[[0, 2, 3]]).all()
    assert np.isfinite(undefined[1])


def test_a_metric_that_has_the_value_of_the_draw_that_decides_has_no_expected_value(
    definition: StudyDefinition,
) -> None:
    requirement = DefinedRequirement("R", "R", "risk", "", at_most=1.0)
    objective = Objective("expected(risk)", is_composite=True)
    judged = replace(definition, requirements=(requirement,))
    compile_objective(objective, judged)
    with pytest.raises(DseError, match="'risk' has no mean over the draws"):
        compile_objective(objective, replace(judged, replicates=DefinedReplicates(5, 5, 0.95)))


def test_what_is_expected_has_a_unit(definition: StudyDefinition) -> None:
    assert compile_objective(Objective("expected(3 EUR * risk)", is_composite=True), definition)[1].symbol == "EUR"
    with pytest.raises(DseError, match="cannot add currency"):
        compile_objective(Objective("sum(cost) + expected(risk)", is_composite=True), definition)
