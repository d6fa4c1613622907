"""What the draws of a point come to: the one that decides, and how often a requirement is met."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dse.domain.bench import VERDICTS, Judgement, Verdict
from dse.domain.definition import DefinedReplicates, DefinedVariable, StudyDefinition
from dse.domain.noise import DRAW, draw_of, replicate_of
from dse.domain.run import Outcome, Run, RunRequest
from dse.storage import RunTable, over_draws
from dse.storage.draws import _leading, decide, draws_sentence
from dse.storage.folder import StudyFolder
from dse.storage.rows import Measures, block_of

PASS, FAIL, SKIPPED, FAILED = range(4)


def decided(codes: list[int], margins: list[float], share: float) -> tuple[Verdict, float, int, int]:
    found = decide(
        np.zeros(len(codes), dtype=np.intp),
        np.array([codes], dtype=np.uint8).T,
        np.array([margins]).T,
        [share],
        np.ones(len(codes), dtype=np.bool_),
    )
    row = int(found.rows[0, 0])
    return VERDICTS[found.codes[0, 0]], margins[row], int(found.rates.met[0, 0]), int(found.rates.judged[0, 0])


def test_of_twenty_draws_one_may_miss_what_95_percent_must_meet() -> None:
    margins = [-3.0, *(0.5 + k for k in range(19))]
    codes = [FAIL] + [PASS] * 19
    assert decided(codes, margins, 0.95) == (Verdict.PASS, 0.5, 19, 20)
    assert decided(codes, margins, 0.96) == (Verdict.FAIL, -3.0, 19, 20)


def test_draws_that_do_not_exercise_a_requirement_do_not_count() -> None:
    assert decided([SKIPPED, FAIL, PASS], [9.0, -1.0, 2.0], 0.5) == (Verdict.PASS, 2.0, 1, 2)
    assert decided([SKIPPED, SKIPPED], [9.0, 9.0], 0.5)[0] is Verdict.NOT_EXERCISED


def test_a_draw_that_failed_to_run_fails_the_point() -> None:
    assert decided([FAILED, PASS], [np.nan, 1.0], 0.5)[0] is Verdict.FAILED_TO_RUN


@given(
    st.lists(st.floats(-5, 5), min_size=1, max_size=40),
    st.floats(0.05, 1.0),
    st.floats(-5, 5),
)
def test_the_margin_is_on_the_right_side_of_any_bound(values: list[float], share: float, bound: float) -> None:
    """A metric that must be at most 0 has the value of the draw that decides, also where the bound is moved."""
    codes = [PASS if value <= 0 else FAIL for value in values]
    verdict, margin, met, judged = decided(codes, [-value for value in values], share)
    assert (verdict is Verdict.PASS) == (met >= share * judged - 1e-9) == (margin >= 0)
    enough = sum(value <= bound for value in values) >= share * len(values) - 1e-9
    assert (-margin <= bound) == enough


@pytest.fixture
def table(tmp_path: Path, definition: StudyDefinition) -> RunTable:
    """Three draws of c1 at 0.1, two of which meet R1, and c2 at 0.2, which has no noise."""
    draws = DefinedVariable(DRAW, "", "", 0.0, 1e13, 0, 0.0, role="replicate")
    variables = (*definition.variables, draws)
    first, second = definition.configurations
    configurations = (
        replace(first, constants={"controller.kp": 0.5, DRAW: 0.0}, streams=("sensor.seed",)),
        replace(second, constants={"controller.kp": 0.5}),
    )
    requirements = tuple(replace(each, met_in=0.6) for each in definition.requirements)
    study = replace(
        definition,
        variables=variables,
        configurations=configurations,
        requirements=requirements,
        replicates=DefinedReplicates(3, 3, 0.95),
    )
    runs = []
    for number, overshoot in enumerate((1.5, 0.2, 0.7)):
        point = {"controller.kp": 0.1, DRAW: draw_of(1, [], number)}
        runs.append(made(number, "c1", point, overshoot, 10.0 * number))
    runs.append(made(3, "c2", {"controller.kp": 0.2}, 1.25, 1.0))
    with StudyFolder.create(tmp_path / "s", study) as folder:
        folder.ask(0, [run.request for run in runs], 4)
        for run in runs:
            point_of = [[run.request.point.get(name, np.nan) for name in ("controller.kp", DRAW)]]
            measures = Measures(("overshoot", "rise_time"), ("R1", "R2"))
            folder.add(run.request.configuration, point_of, block_of([run], measures))
        return folder.table()


def made(number: int, name: str, point: dict[str, float], overshoot: float, rise_time: float) -> Run:
    verdict = Verdict.PASS if overshoot <= 1 else Verdict.FAIL
    judgements = (Judgement("R1", verdict, 1 - overshoot), Judgement("R2", verdict, 1 - overshoot))
    metrics = {"overshoot": overshoot, "rise_time": rise_time}
    return Run(RunRequest(number, name, point), Outcome.DONE, metrics, judgements)


def test_a_table_over_draws_has_a_row_for_each_point(table: RunTable) -> None:
    found = over_draws(table)
    assert found.header.variables == ("controller.kp",)
    assert found.configurations == ("c1", "c2")
    assert found.numbers.tolist() == [2, 3]  # 0.7 is the second largest of three: with 60 %, one may miss
    assert found.metric("overshoot").tolist() == [0.7, 1.25]
    assert found.metric("rise_time").tolist() == [10.0, 1.0]  # no requirement is about it: the mean
    assert found.verdicts("R1").tolist() == [PASS, FAIL]
    assert found.margins("R1") == pytest.approx([0.3, -0.25])
    assert found.rates is not None
    assert found.rates.met[:, 0].tolist() == [2, 0]
    assert found.rates.judged[:, 0].tolist() == [3, 1]


def test_the_run_of_a_point_shows_the_requirement_that_is_missed() -> None:
    """R1 is met by three draws, R2 missed by all: the row is that of R2's deciding draw, though it is the first."""
    codes = np.array([[PASS, FAIL], [PASS, FAIL], [PASS, FAIL]], dtype=np.uint8)
    margins = np.array([[3.0, -9.0], [1.0, -2.0], [2.0, -1.0]])
    found = decide(np.zeros(3, dtype=np.intp), codes, margins, [1.0, 1.0], np.ones(3, dtype=np.bool_))
    assert _leading(found, np.array([0])).tolist() == [0]
    met = decide(np.zeros(3, dtype=np.intp), codes[:, :1], margins[:, :1], [1.0], np.ones(3, dtype=np.bool_))
    assert _leading(met, np.array([0])).tolist() == [1]


def test_what_does_not_depend_on_the_draw_has_no_interval_and_differing_draws_are_doubtful(table: RunTable) -> None:
    found = over_draws(table)
    assert found.rates is not None
    low, high = found.rates.interval(0)
    assert (low[1], high[1]) == (0.0, 0.0)
    assert 0 < low[0] < 0.6 < high[0] < 1
    assert found.certainties("R1").tolist() == [2, 0]


def test_a_study_says_how_many_draws_its_verdicts_rest_on(table: RunTable) -> None:
    study = table.header.definition
    said = draws_sentence(study, 2)
    assert said == (
        "verdicts are on 2 points, each with 3 draws of the noise; "
        "a requirement is met if it is in at least 60 % of them"
    )
    alone = replace(study, variables=study.variables[:1], replicates=None)
    assert "rest on one draw of the noise of sensor" in draws_sentence(alone, 2)
    seed = replace(study.variables[0], name="sensor.seed")
    assert draws_sentence(replace(alone, variables=(seed,)), 2) == ""  # the study varies it
    silent = tuple(replace(each, streams=()) for each in study.configurations)
    assert draws_sentence(replace(alone, configurations=silent), 2) == ""


def test_draws_are_the_same_for_every_design_and_different_in_every_case_and_replicate() -> None:
    draws = {draw_of(seed, case, n) for seed in (1, 2) for case in ([0.0], [1.0]) for n in range(50)}
    assert len(draws) == 200
    assert draw_of(1, [-0.0], 3) == draw_of(1, [0.0], 3)
    assert [replicate_of(draw_of(5, [2.0, 3.0], n)) for n in (0, 7, 9_999)] == [0, 7, 9_999]
