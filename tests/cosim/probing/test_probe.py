"""Every experiment finds the one thing that is wrong with an FMU, and nothing with one that is right."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest

from dse.cosim.probing.child import ProbeLimits
from dse.cosim.probing.probe import probe
from dse.domain.facts import Answer, FmuFacts, Question
from dse.domain.fmu import Capabilities

BOTH = pytest.mark.parametrize("version", [2, 3])

HURRY = ProbeLimits(time=5.0, memory=1e9)


def asked(model: object, *questions: Question, limits: ProbeLimits = HURRY) -> FmuFacts:
    """The facts, and only these questions asked beside those that come before all others."""
    return probe(model, "x86_64-test", limits=limits, only=frozenset(questions))


@BOTH
@pytest.mark.thorough
def test_an_fmu_that_does_all_right_is_told_so(odd, version):
    facts = probe(odd(version=version), "x86_64-test", limits=HURRY)
    good = dict.fromkeys(Question, Answer.YES) | {Question.FEEDS_THROUGH: Answer.NO}
    assert facts.answers == good
    assert facts.reasons == {}
    assert (facts.step, facts.steps, facts.drive) == (0.01, 50, 1.0)
    assert facts.instances == 2000
    assert facts.loads == 1100
    assert 0.0 < facts.step_cost < 1e-3  # a handful of additions
    assert facts.run_growth < 1000.0


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("flag", "question", "reason"),
    [
        ("KEEPS_PARAMETERS", Question.RESETS, r"y differs at t = 0\.0[12] s"),
        ("RESET_CRASHES", Question.RESETS, r"crashed \(signal 6\) while resetting"),
        ("COUNTS_INSTANCES", Question.RENEWS, r"n differs at t = 0 s"),
        ("SHARES_ITS_INPUT", Question.COEXISTS, r"y differs at t = "),
        ("RACES", Question.THREADS, r"outputs differ from those of a run alone"),
        ("SAVING_DISTURBS", Question.SAVES, r"after saving, y differs at t = 0\.26 s"),
        ("FORGETS_STATE", Question.SAVES, r"after restoring, y differs at t = 0\.26 s"),
        ("BYTES_LOSE_STATE", Question.SERIALIZES, r"after restoring, y differs at t = 0\.26 s"),
        ("ONLY_EVEN_STEPS", Question.VARIES_STEP, r"fmi2DoStep at t = 0 s returned error"),
        ("DIFFERS_BY_PROCESS", Question.REPEATS, r"y differs at t = 0\.01 s"),
        ("FRAGILE=300", Question.LASTS, r"crashed \(signal 6\) while making one instance after the other"),
    ],
)
def test_what_is_wrong_is_found_and_told(odd, flag, question, reason):
    facts = asked(odd(flag), question)
    assert facts.answer(Question.RUNS) is Answer.YES
    assert facts.answer(question) is Answer.NO
    assert re.search(reason, facts.reasons[question]), facts.reasons[question]


def test_the_number_of_instances_it_survived_is_counted(odd):
    facts = asked(odd("FRAGILE=300"), Question.LASTS)
    assert facts.instances == 300
    assert facts.most_instances == 300


def test_memory_that_every_run_leaves_behind_is_measured(odd):
    facts = asked(odd("LEAKS=20000"), Question.LASTS)
    assert facts.run_growth == pytest.approx(20000, rel=0.05)  # malloc adds some bytes to each


@pytest.mark.sampled(2)
@BOTH
def test_an_fmu_that_hangs_is_a_fact_and_not_a_hanging_probe(odd, version):
    facts = probe(odd("INITIALIZATION_HANGS", version=version), "x86_64-test", limits=ProbeLimits(time=0.5))
    assert facts.answers == {Question.RUNS: Answer.NO}
    assert facts.reasons == {Question.RUNS: "no answer for 0.5 s while initializing"}
    assert math.isnan(facts.step_cost)


@pytest.mark.thorough
def test_an_fmu_that_eats_memory_is_stopped(odd):
    facts = probe(odd("EATS_MEMORY"), "x86_64-test", limits=ProbeLimits(memory=5e8))
    assert facts.reasons == {Question.RUNS: "grew beyond 0.5 GB of memory while stepping at t = 0 s"}


def test_an_fmu_that_fails_says_why_with_its_own_log(odd):
    facts = probe(odd("INITIALIZATION_FAILS", version=3), "x86_64-test", limits=HURRY)
    assert facts.answer(Question.RUNS) is Answer.NO
    assert "no equilibrium found in iteration" in facts.reasons[Question.RUNS]


def test_inputs_are_held_if_the_fmu_does_not_bear_them_varied(odd):
    facts = asked(odd("HATES_INPUTS"))
    assert facts.answer(Question.RUNS) is Answer.YES
    assert facts.drive == 0.05
    assert facts.reasons[Question.RUNS].startswith("with inputs varied by 5% of the usual; else: crashed (signal 6)")


def test_what_a_description_does_not_offer_is_not_tried(odd):
    model = replace(odd(), capabilities=Capabilities(once_per_process=True))
    facts = asked(model, Question.SAVES, Question.VARIES_STEP, Question.COEXISTS)
    for question in (Question.SAVES, Question.VARIES_STEP, Question.COEXISTS, Question.THREADS):
        assert facts.answer(question) is Answer.UNKNOWN
        assert facts.reasons[question]


def test_the_same_fmu_gives_the_same_facts(odd):
    first, second = (asked(odd("KEEPS_PARAMETERS"), Question.RESETS) for _ in range(2))
    assert first.answers == second.answers
    assert first.reasons == second.reasons
