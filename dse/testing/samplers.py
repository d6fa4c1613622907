"""What every sampler has to be.

class TestMine(SamplerSuite):
    sampler = Mine
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from dse.domain.bench import Verdict
from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import Compound, Configuration, DesignSpace, Part
from dse.domain.distribution import Distribution
from dse.domain.sampler import (
    Architecture,
    Brief,
    Candidate,
    DesignVariable,
    Objective,
    Outcomes,
    Placing,
    Sampler,
    Scale,
)
from dse.exploration import unit_of
from dse.formats import read_yaml
from dse.loading import SAMPLERS, SamplerSection, Surroundings
from dse.space import open_space
from dse.units import DIMENSIONLESS

VARIABLES = (
    DesignVariable("part.x", 0.0, 2.0, 4, 0.5, DIMENSIONLESS),
    DesignVariable("part.y", -1.0, 1.0, 3, 0.0, DIMENSIONLESS),
)
CONFIGURATIONS = ("b", "a")
CHOICES = ({"s": "x", "t": "u"}, {"s": "x", "t": "v"}, {"s": "y", "t": "u"}, {"s": "y", "t": "v"}, {"t": "u"})
SCALES = {
    "scale": DesignVariable("part.x", 0.01, 100.0, 4, 0.1, DIMENSIONLESS, scale=Scale.LOG),
    "values": DesignVariable("part.x", 1.0, 50.0, 4, 2.0, DIMENSIONLESS, values=(1.0, 2.0, 40.0, 50.0)),
    "distribution": DesignVariable(
        "part.x", 0.0, 9.0, 4, 0.5, DIMENSIONLESS, distribution=Distribution("empirical", values=(0.0, 1.0, 9.0))
    ),
}
"""In place of the first of `VARIABLES`; each has its nominal value, too, at a quarter of the unit cube's side."""

_MOST_ASKS = 200


class Chosen:
    """The space of the configurations `CHOICES`: without *s*, *t* is *u*. An id lists what is chosen."""

    alternatives: Mapping[str, tuple[str | None, ...]] = {"s": ("x", "y", None), "t": ("u", "v")}

    def __init__(self) -> None:
        self._all = [Architecture("".join(choices.values()), choices) for choices in CHOICES]

    def count(self) -> int:
        """Five."""
        return len(self._all)

    def configuration(self, name: str) -> Configuration:
        """Without parts."""
        return Configuration(name, next(each.choices for each in self._all if each.id == name), {})

    def draw(self, number: int, seed: int) -> Sequence[Architecture]:
        """Any of them."""
        return [self._all[index] for index in np.random.default_rng(seed).integers(len(self._all), size=number)]

    def stratified(self, number: int, seed: int) -> Sequence[Architecture]:
        """One after the other."""
        return [self._all[(seed + index) % len(self._all)] for index in range(number)]

    def completed(self, wishes: Sequence[tuple[str, str | None]], seed: int) -> Architecture:
        """Wish after wish, of those left the ones that have it, if there are any; then any of these."""
        left = self._all
        for place, choice in wishes:
            left = [each for each in left if each.choices.get(place) == choice] or left
        return left[int(np.random.default_rng(seed).integers(len(left)))]


class SamplerSuite:
    """Each of the sampler's examples is tried on two variables and two configurations.

    The results it is told are margins of one requirement ``R`` and one metric ``m``, both linear in the point.
    """

    sampler: type[SamplerSection]
    listed = False
    """Whether its values are those that the user wrote, on whatever scale."""

    @pytest.fixture
    def settled(self, example: Mapping[str, Any], tmp_path: Path) -> Sampler:
        """The sampler with the options of *example*, as if a study file in a folder with its files had them."""
        for name, text in self.sampler.example_files.items():
            (tmp_path / name).write_text(text, encoding="utf-8")
        (tmp_path / "study.pet.yaml").write_text("study: suite\n", encoding="utf-8")
        entry = read_yaml(tmp_path / "study.pet.yaml").top["sampler"]
        around = Surroundings(entry, frozenset(v.name for v in VARIABLES), VARIABLES, tmp_path)
        return cast(Sampler, self.sampler.model_validate(example).settled(around))

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        if "example" in metafunc.fixturenames:
            metafunc.parametrize("example", self.sampler.examples, ids=str)

    def test_it_is_found_by_its_name(self) -> None:
        assert SAMPLERS.get(self.sampler.name) is self.sampler

    def test_its_options_are_plain_data(self, settled: Sampler) -> None:
        assert json.loads(json.dumps(settled.options(), allow_nan=False)) == settled.options()

    def test_an_option_it_does_not_have_is_refused(self, example: Mapping[str, Any]) -> None:
        with pytest.raises(ValueError, match="Extra inputs"):
            self.sampler.model_validate({**example, "not_an_option": 1})

    def test_every_run_it_wants_lies_in_the_ranges(self, settled: Sampler) -> None:
        """On a configuration of the study, a finite number for each variable."""
        candidates = [candidate for ask in asks(settled, brief()) for candidate in ask]
        known = [each.id for each in Chosen().stratified(len(CHOICES), 0)] if settled.proposes else CONFIGURATIONS
        assert candidates
        for configuration, point in candidates:
            assert configuration in known
            assert len(point) == len(VARIABLES)
            assert all(type(value) is float for value in point)
            assert all(v.low <= value <= v.high for v, value in zip(VARIABLES, point, strict=True))

    @pytest.mark.parametrize("key", SCALES)
    def test_it_heeds_a_scale_values_and_a_distribution(self, settled: Sampler, key: str) -> None:
        """Its first ask is at the same places of the unit cube as in a linear range; it asks for no other values."""
        if self.listed or (key == "distribution" and settled.grid is not None):
            pytest.skip("its values do not depend on scales")
        varied = SCALES[key]
        made = asks(
            settled, replace(brief(), variables=(varied, VARIABLES[1])), most=_MOST_ASKS if varied.values else 1
        )
        linear = asks(settled, brief(), most=1)[0]
        assert _places(made[0], varied) == _places(linear, VARIABLES[0], varied.values)
        assert not varied.values or {point[0] for ask in made for _, point in ask} <= {*varied.values}

    def test_what_it_declares_to_be_drawn_evenly_is(self, settled: Sampler) -> None:
        """Of each variable, by the test of Kolmogorov and Smirnov: one in 10,000 that are drawn evenly would fail."""
        placing = type(settled).placed(settled.options()) if isinstance(settled, SamplerSection) else settled.placing
        if placing is Placing.CHOSEN or settled.grid is not None:
            pytest.skip("it declares nothing, or has a grid")
        first = unit_of(np.array([point for _, point in asks(settled, brief(), most=1)[0]]), VARIABLES)
        steps = np.linspace(0, 1, len(first) + 1)[:, None]
        ordered = np.sort(first, axis=0)
        away = np.maximum(np.abs(ordered - steps[:-1]), np.abs(ordered - steps[1:])).max(axis=0)
        assert (away < 2.23 / np.sqrt(len(first))).all()

    def test_a_design_without_choices_is_explored(self, settled: Sampler, example: Mapping[str, Any]) -> None:
        """Its space has one configuration and nothing to choose; with the first example, as others may name a place."""
        if example is not self.sampler.examples[0]:
            return
        parts = {"part": Part(Component("part", NO_INTERFACE))}
        space = open_space(DesignSpace("only", Compound("only", parts))).architectures()
        (only,) = space.draw(1, 1)
        candidates = [c for ask in asks(settled, replace(brief(), configurations=(only.id,), space=space)) for c in ask]
        assert candidates
        assert {candidate.configuration for candidate in candidates} == {only.id}

    def test_no_ask_wants_a_run_twice(self, settled: Sampler) -> None:
        assert all(len(set(ask)) == len(ask) for ask in asks(settled, brief()))

    def test_the_same_results_lead_to_the_same_asks(self, settled: Sampler) -> None:
        """A study that was stopped is taken up by asking again."""
        assert asks(settled, brief()) == asks(settled, brief())

    def test_it_comes_to_an_end(self, settled: Sampler) -> None:
        """It says so by asking for nothing; with *once* after its first ask."""
        made = asks(settled, brief())
        assert len(made) < _MOST_ASKS
        assert len(made) == 1 or not settled.once

    def test_it_bears_runs_that_failed(self, settled: Sampler) -> None:
        """All of them: neither an exception nor a study that never ends."""
        assert len(asks(settled, brief(), fails=True)) < _MOST_ASKS

    def test_a_study_that_is_extended_can_be_asked_for(self, settled: Sampler) -> None:
        """With what is there, and in a wider range."""
        there = [candidate for ask in asks(settled, brief()) for candidate in ask]
        wider = (replace(VARIABLES[0], high=3.0), VARIABLES[1])
        assert asks(settled, replace(brief(), earlier=outcomes(there)))
        assert asks(settled, replace(brief(), variables=wider, earlier=outcomes(there)))

    def test_the_points_of_a_grid_are_on_it(self, settled: Sampler) -> None:
        """Who says that points lie on a grid has no others."""
        if settled.grid is None:
            return
        free = [set(names) for names in settled.grid] or [{v.name for v in VARIABLES}]
        for _, point in asks(settled, brief())[0]:
            off = {v.name for v, value in zip(VARIABLES, point, strict=True) if value != v.nominal}
            assert any(off <= names for names in free)


def _places(ask: Sequence[Candidate], variable: DesignVariable, values: Sequence[float] = ()) -> set[tuple[Any, ...]]:
    """Where in the unit cube *ask* has *variable*, to nine decimals, or in which of as many equal parts as *values*."""
    first = unit_of(np.array([[point[0]] for _, point in ask]), (variable,))[:, 0]
    count = len(values or variable.values)
    places = np.minimum(np.floor(first * count), count - 1) if count else np.round(first, 9)
    return {(name, place, point[1]) for (name, point), place in zip(ask, places.tolist(), strict=True)}


def brief() -> Brief:
    """A new study over `VARIABLES` and `CONFIGURATIONS`, with the space `Chosen` and objectives ``m`` and -``m``."""
    return Brief(VARIABLES, CONFIGURATIONS, 1, outcomes([]), Chosen(), (Objective("m"), Objective("m", maximize=True)))


def asks(sampler: Sampler, given: Brief, *, fails: bool = False, most: int = _MOST_ASKS) -> list[list[Candidate]]:
    """All that *sampler* asks for, told what `outcomes` makes of it; stops after *most* asks."""
    search = sampler.start(given)
    made: list[list[Candidate]] = []
    while len(made) < most:
        candidates = list(search.ask())
        if not candidates:
            break
        made.append(candidates)
        if sampler.once or len(made) == most:
            break
        search.tell(outcomes(candidates, fails=fails))
    return made


def outcomes(candidates: Sequence[Candidate], *, fails: bool = False) -> Outcomes:
    """What comes of *candidates*: the metric ``m`` is x + y, the requirement ``R`` that it is at most 1."""
    points = np.array([candidate.point for candidate in candidates], dtype=np.float64).reshape(-1, len(VARIABLES))
    done = np.full(len(candidates), not fails)
    metric = np.where(done, points.sum(axis=1), np.nan)
    verdicts = [Verdict.FAILED_TO_RUN if fails else Verdict.PASS if value <= 1 else Verdict.FAIL for value in metric]
    return Outcomes(
        tuple(candidate.configuration for candidate in candidates),
        {variable.name: points[:, index] for index, variable in enumerate(VARIABLES)},
        done,
        {"m": metric},
        {"R": 1.0 - metric},
        {"R": tuple(verdicts)},
    )
