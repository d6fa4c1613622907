"""Facts about FMUs are found again by content, and what is unreadable counts as unknown."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from dse.cache import CacheWarning
from dse.domain.component import Component, CSource, Interface
from dse.domain.facts import Answer, FmuFacts, Question
from dse.domain.fmu import Capabilities, FmiInterface, FmuModel
from dse.domain.system import Element, SystemStructure
from dse.fmu.toolchain.platforms import this_platform
from dse.kinds.fmu import FmuSource
from dse.testbench.facts import KnownFmus, consequences, keep_facts, known_facts

HASH = "5a" * 32


def model(content: str = HASH, **changes: object) -> FmuModel:
    here = Path("nowhere")
    plain = FmuModel(here, here, here / f"{content[:8]}.so", 2, "thing", "", {}, content_hash=content)
    return replace(plain, **changes)


def facts(content: str = HASH, **changes: object) -> FmuFacts:
    return replace(FmuFacts(content, this_platform().name, "thing", 2, "CoSimulation"), **changes)


def system(**models: FmuModel) -> SystemStructure:
    return SystemStructure("test", tuple(Element(name, fmu, (), (), {}) for name, fmu in models.items()), ())


ANSWERS = st.dictionaries(st.sampled_from(Question), st.sampled_from(Answer))
NUMBERS = st.floats(0.0, 1e12) | st.just(float("nan"))


@given(ANSWERS, st.dictionaries(st.sampled_from(Question), st.text()), NUMBERS, NUMBERS, st.integers(0, 5000))
def test_facts_are_read_as_they_were_kept(tmp_path_factory, answers, reasons, cost, growth, instances):
    cache = tmp_path_factory.mktemp("cache")
    found = facts(answers=answers, reasons=reasons, step_cost=cost, run_growth=growth, instances=instances)
    keep_facts(found, cache=cache)
    assert repr(sorted_(known_facts(model(), cache=cache))) == repr(sorted_(found))


def sorted_(found: FmuFacts | None) -> FmuFacts:
    assert found is not None
    order = list(Question)
    return replace(
        found,
        answers={q: found.answers[q] for q in order if q in found.answers},
        reasons={q: found.reasons[q] for q in order if q in found.reasons},
    )


def test_the_same_facts_are_the_same_bytes(tmp_path: Path):
    answers = {Question.RESETS: Answer.NO, Question.RUNS: Answer.YES}
    turned = dict(reversed(answers.items()))
    first = keep_facts(facts(answers=answers), cache=tmp_path / "a").read_bytes()
    assert keep_facts(facts(answers=turned), cache=tmp_path / "b").read_bytes() == first


def test_what_is_known_of_one_interface_says_nothing_of_the_other(tmp_path: Path):
    keep_facts(facts(), cache=tmp_path)
    assert known_facts(model(), cache=tmp_path) is not None
    assert known_facts(model(interface=FmiInterface.MODEL_EXCHANGE), cache=tmp_path) is None


def test_another_fmu_is_not_known(tmp_path: Path):
    keep_facts(facts(), cache=tmp_path)
    assert known_facts(model("7b" * 32), cache=tmp_path) is None


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "null", '{"answers": {}}', '{"answers": {"resets": "maybe"}, "reasons": {}}']
)
def test_a_file_that_is_not_what_it_should_be_counts_as_nothing_known(tmp_path: Path, text: str):
    file = keep_facts(facts(), cache=tmp_path)
    file.write_text(text, encoding="utf-8")
    with pytest.warns(CacheWarning, match="damaged"):
        assert known_facts(model(), cache=tmp_path) is None
    earlier_version(file)
    assert known_facts(model(), cache=tmp_path) is None


def earlier_version(file: Path) -> None:
    """Leave *file* as an earlier version would have kept it."""
    file.with_name(f"{file.name}.digest").unlink()


def test_facts_that_an_earlier_version_kept_are_known(tmp_path: Path):
    earlier_version(keep_facts(facts(), cache=tmp_path))
    found = known_facts(model(), cache=tmp_path)
    assert found is not None
    assert keep_facts(found, cache=tmp_path / "again").read_bytes() == keep_facts(facts(), cache=tmp_path).read_bytes()


def test_a_file_with_a_word_too_many_or_too_few_counts_as_nothing_known(tmp_path: Path):
    file = keep_facts(facts(), cache=tmp_path)
    data = json.loads(file.read_text(encoding="utf-8"))
    del data["step_cost"]
    earlier_version(file)
    file.write_text(json.dumps(data), encoding="utf-8")
    assert known_facts(model(), cache=tmp_path) is None


def test_every_element_of_a_known_fmu_has_its_facts(tmp_path: Path):
    keep_facts(facts(), cache=tmp_path)
    found = KnownFmus(tmp_path).facts_of(system(a=model(), b=model("7b" * 32), c=model()))
    assert set(found) == {"a", "c"}


OURS = Component("ours", Interface("", ()), source=CSource((), Path("x.h"), "x", "init", "step", None))
THEIRS = Component("theirs", Interface("", ()), source=FmuSource(Path("x.fmu")))


@pytest.mark.parametrize(
    ("component", "known", "safe"),
    [
        (THEIRS, None, False),
        (THEIRS, facts(answers={Question.THREADS: Answer.YES}), True),
        (THEIRS, facts(answers={Question.THREADS: Answer.UNKNOWN}), False),
        (OURS, facts(answers={Question.THREADS: Answer.NO}), False),
        (THEIRS, facts(answers={Question.THREADS: Answer.YES, Question.LASTS: Answer.NO}), False),
    ],
    ids=["theirs", "probed", "unclear", "ours, but seen to fail", "wears out"],
)
def test_threads_are_for_fmus_that_bear_them(component: Component, known: FmuFacts | None, safe: bool):
    assert KnownFmus().is_thread_safe(system(a=model()), {"a": known} if known else {}, {"a": component}) is safe


def test_an_fmu_at_several_places_is_looked_into_once(monkeypatch: pytest.MonkeyPatch):
    seen = []
    monkeypatch.setattr("dse.testbench.facts.shares_nothing", lambda model, cache: not seen.append(model))
    known = KnownFmus()
    for _ in range(2):
        assert known.is_thread_safe(system(a=model(), b=model()), {}, {"a": OURS, "b": OURS})
    assert seen == [model()]


def test_an_fmu_that_can_be_instantiated_only_once_is_never_run_in_threads():
    once = model(capabilities=Capabilities(once_per_process=True))
    assert not KnownFmus().is_thread_safe(system(a=once), {}, {"a": OURS})


def test_a_good_fmu_has_no_consequences_and_a_bad_one_has_each():
    assert consequences(facts(answers=dict.fromkeys(Question, Answer.YES))) == ()
    answers = {**dict.fromkeys(Question, Answer.NO), Question.RUNS: Answer.YES}
    bad = consequences(facts(answers=answers, instances=300))
    assert len(bad) == 6
    assert bad[-1] == "has its process renewed in time, as it died after 300 instances"


def test_of_an_fmu_that_does_not_run_nothing_else_is_said():
    assert consequences(facts(answers={Question.RUNS: Answer.NO})) == ("cannot be simulated as it is",)
