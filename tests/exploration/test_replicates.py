"""Replicates of any sampler: which draws are asked for, when more are, and what the sampler is told."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from fake_runners import METRICS, REQUIREMENTS, definition_of, study_of

from dse.domain.bench import Verdict
from dse.domain.definition import DefinedReplicates, StudyDefinition
from dse.domain.noise import DRAW, HIGHEST_DRAW, replicate_of
from dse.domain.sampler import Brief, Candidate, DesignVariable, Outcomes, Role
from dse.domain.study import Replicates, Study
from dse.exploration.replicates import start_search
from dse.units import DIMENSIONLESS

DRAWN = DesignVariable(DRAW, 0.0, HIGHEST_DRAW, 0, 0.0, DIMENSIONLESS, role=Role.REPLICATE)


def replicated(replicates: Replicates, met_in: float = 0.95, levels: int = 2) -> tuple[Study, StudyDefinition]:
    """Two variables on a grid, the second of which is a condition."""
    plain = study_of(levels=levels)
    first, second = plain.variables
    variables = (first, replace(second, role=Role.CONDITION), DRAWN)
    study = replace(plain, variables=variables, replicates=replicates)
    definition = definition_of(study)
    return study, replace(
        definition,
        requirements=tuple(replace(each, met_in=met_in) for each in definition.requirements),
        replicates=DefinedReplicates(replicates.at_least, replicates.at_most, replicates.confidence),
    )


def outcomes_of(
    asked: Sequence[Candidate], is_met: Callable[[Candidate], bool], definition: StudyDefinition
) -> Outcomes:
    """What came of *asked*: m0 is 0.5 where the requirements are met, 2 where they are not."""
    names = [variable.name for variable in definition.variables]
    points = np.array([candidate.point for candidate in asked]).reshape(len(asked), len(names))
    met = [is_met(candidate) for candidate in asked]
    values = np.where(met, 0.5, 2.0)
    return Outcomes(
        tuple(candidate.configuration for candidate in asked),
        {name: points[:, k] for k, name in enumerate(names)},
        np.ones(len(asked), dtype=np.bool_),
        dict.fromkeys(METRICS, values),
        dict.fromkeys(REQUIREMENTS, 1.0 - values),
        dict.fromkeys(REQUIREMENTS, tuple(Verdict.PASS if each else Verdict.FAIL for each in met)),
    )


def brief_of(study: Study, definition: StudyDefinition) -> Brief:
    conditions = ((0.0,), (1.0,))
    none = outcomes_of((), lambda _: True, definition)
    return Brief(study.variables, ("a", "b"), 1, none, conditions=conditions)


def test_a_chosen_number_of_draws_is_asked_for_at_once_and_designs_meet_the_same_ones() -> None:
    study, definition = replicated(Replicates(3, 3))
    assert study.once
    search = start_search(study, brief_of(study, definition), definition)
    candidates = [*search.ask()]
    assert len(candidates) == 2 * 4 * 3
    draws: dict[tuple[str, float, float], list[float]] = {}
    for name, (x, condition, draw) in candidates:
        draws.setdefault((name, x, condition), []).append(draw)
    assert draws["a", 0.0, 1.0] == draws["b", 1.0, 1.0]  # paired
    assert not set(draws["a", 0.0, 0.0]) & set(draws["a", 0.0, 1.0])  # cases are independent
    assert [replicate_of(draw) for draw in draws["a", 0.0, 0.0]] == [0, 1, 2]


def rounds(
    study: Study, definition: StudyDefinition, is_met: Callable[[Candidate], bool]
) -> dict[tuple[float, ...], int]:
    """How many draws each point of 'a' was made with in the end."""
    search = start_search(study, replace(brief_of(study, definition), configurations=("a",)), definition)
    counts: dict[tuple[float, ...], int] = {}
    while asked := search.ask():
        for _, point in asked:
            counts[point[:2]] = counts.get(point[:2], 0) + 1
        search.tell(outcomes_of(asked, is_met, definition))
    return counts


def test_more_draws_are_made_where_a_verdict_is_open_and_none_where_it_is_not() -> None:
    study, definition = replicated(Replicates(5, 100), met_in=0.9)
    assert not study.once

    def is_met(candidate: Candidate) -> bool:
        x, condition, draw = candidate.point
        # Never; always; in every other draw; in all but one of ten.
        return (
            (x, condition) == (0, 1)
            or ((x, condition) == (1, 0) and draw % 2 == 0)
            or (x == condition == 1 and draw % 10 > 0)
        )

    found = rounds(study, definition, is_met)
    assert found[0, 0] == 5
    assert found[1, 0] <= 15
    assert 35 <= found[0, 1] < 100  # as many as it takes to tell 100 % from less than 90 %
    assert found[1, 1] == 100


def test_one_draw_is_enough_for_what_has_no_noise() -> None:
    """A configuration without a random part is at the nominal draw, 0, whatever draw was asked for."""
    study, definition = replicated(Replicates(5, 100))
    search = start_search(study, brief_of(study, definition), definition)
    asked = search.ask()
    silent = outcomes_of(asked, lambda _: True, definition)
    search.tell(replace(silent, points={**silent.points, DRAW: np.zeros(len(asked))}))
    assert not search.ask()


def test_a_sampler_is_told_one_outcome_for_each_run_it_asked_for() -> None:
    study, definition = replicated(Replicates(20, 20))

    class Twice:
        """Asks for one point twice, and is told of it."""

        name, once, proposes, grid = "twice", False, False, None
        told: ClassVar[list[Outcomes]] = []

        def options(self) -> dict[str, object]:
            return {}

        def start(self, brief: Brief) -> Twice:
            assert [variable.name for variable in brief.variables] == ["part.x0", "part.x1"]
            return self

        def ask(self) -> Sequence[Candidate]:
            return (
                []
                if self.told
                else [Candidate("a", (0.5, 0.0)), Candidate("a", (0.2, 1.0)), Candidate("a", (0.5, 0.0))]
            )

        def tell(self, outcomes: Outcomes) -> None:
            self.told.append(outcomes)

    study = replace(study, sampler=Twice())  # type: ignore[arg-type]  # no Placing
    search = start_search(study, brief_of(study, definition), definition)
    asked = search.ask()
    assert len(asked) == 40
    # One draw of twenty misses what 95 % must meet, at one of the points two do.
    search.tell(outcomes_of(asked, lambda c: replicate_of(c.point[2]) >= (1 if c.point[0] == 0.5 else 2), definition))
    (told,) = Twice.told
    assert told.points["part.x0"].tolist() == [0.5, 0.2, 0.5]
    assert DRAW not in told.points
    assert told.verdicts["R1"] == (Verdict.PASS, Verdict.FAIL, Verdict.PASS)
    assert told.margins["R1"].tolist() == [0.5, -1.0, 0.5]
