"""FMUs of all versions and both interfaces are probed alike; these are right, so no answer may be no."""

from __future__ import annotations

from pathlib import Path

import pytest
from reference_fmus import build

from dse.cosim.probing.child import ProbeLimits
from dse.cosim.probing.probe import probe
from dse.domain.facts import Answer, Question
from dse.fmu.unpack import open_fmu

ASKED = frozenset(Question) - {Question.LASTS, Question.RELOADS, Question.THREADS}


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("name", "version", "interface", "unknown"),
    [
        ("StateSpace", 1, "CoSimulation", {Question.SAVES, Question.SERIALIZES}),
        ("Feedthrough", 2, "CoSimulation", set()),
        ("Feedthrough", 3, "CoSimulation", set()),
        ("BouncingBall", 2, "ModelExchange", {Question.SERIALIZES, Question.FEEDS_THROUGH}),
        ("VanDerPol", 3, "ModelExchange", {Question.SERIALIZES, Question.FEEDS_THROUGH}),
    ],
)
def test_a_right_fmu_has_nothing_against_it(tmp_path: Path, name, version, interface, unknown):
    archive = build(name, version, interface, tmp_path)
    model = open_fmu(archive, cache=tmp_path / "cache")
    facts = probe(model, "x86_64-test", limits=ProbeLimits(time=20.0), only=ASKED)
    assert facts.interface == interface
    assert {q for q in ASKED if facts.answer(q) is Answer.UNKNOWN} == unknown
    assert {q: facts.reasons[q] for q in ASKED if facts.denies(q)} == {}


def test_outputs_that_follow_inputs_without_a_step_are_seen(tmp_path: Path):
    model = open_fmu(build("Feedthrough", 2, "CoSimulation", tmp_path), cache=tmp_path / "cache")
    facts = probe(model, "x86_64-test", limits=ProbeLimits(time=20.0), only=frozenset({Question.FEEDS_THROUGH}))
    assert facts.answer(Question.FEEDS_THROUGH) is Answer.YES
