"""What the runs of a study folder tell of the verdicts anywhere."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake_runners import benches, definition_of, make_fake, study_of

from dse.domain.sampler import Scale
from dse.domain.study import Study
from dse.errors import DseError
from dse.exploration.band import Band, Chances
from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.exploration.samplers.boundary import Boundary
from dse.exploration.samplers.sobol import Sobol
from dse.storage import RunTable
from dse.storage.folder import StudyFolder

LINE = (np.arange(40) + 0.5) / 40
FINE = np.stack(np.meshgrid(LINE, LINE), axis=-1).reshape(-1, 2)


def table_of(path: Path, study: Study) -> RunTable:
    """The runs on configuration a: R1 passes where the variables' sum is below 1, R2 is never exercised."""
    definition = definition_of(study, ("a",))
    with StudyFolder.resume(path, definition) as folder:
        explore(study, benches("a"), folder, executor=Local(workers=1), make_runner=make_fake)
        return folder.table()


@pytest.fixture(scope="module")
def searched(tmp_path_factory: pytest.TempPathFactory) -> RunTable:
    return table_of(tmp_path_factory.mktemp("searched"), study_of(Boundary(samples=24)))


def assert_sums_up(chances: Chances) -> None:
    """Certain beside the boundary, and together 1."""
    total = FINE.sum(axis=1)
    assert chances.passing + chances.failing + chances.without_verdict == pytest.approx(1.0)
    assert chances.passing[total < 0.9].min() > 0.999
    assert chances.failing[total > 1.1].min() > 0.999


def test_verdicts_are_certain_beside_the_boundary_and_open_on_it(searched: RunTable) -> None:
    assert_sums_up(Band(searched, "R1", "a").at(FINE))
    assert (Band(searched, "R1", "a").at(np.array([[0.4, 0.6], [0.7, 0.3]])).misjudged > 0.01).all()


@pytest.mark.thorough
def test_runs_of_any_sampler_have_a_band(tmp_path: Path) -> None:
    assert_sums_up(Band(table_of(tmp_path, study_of(Sobol(samples=32))), "R1", "a").at(FINE))


def test_a_requirement_that_was_never_exercised_has_no_verdict_anywhere(searched: RunTable) -> None:
    assert Band(searched, "R2", "a").at(FINE).without_verdict.min() > 0.9


def test_the_same_runs_give_the_same_band_to_the_last_bit(searched: RunTable) -> None:
    first, again = (Band(searched, "R1", "a").at(FINE) for _ in range(2))
    assert first.passing.tobytes() == again.passing.tobytes()


def test_points_are_in_the_unit_of_the_variable_and_on_its_scale(tmp_path: Path) -> None:
    study = study_of(Boundary(samples=24))
    x, y = study.variables
    study = replace(study, variables=(replace(x, low=0.01, high=1.0, scale=Scale.LOG), y))
    chances = Band(table_of(tmp_path, study), "R1", "a").at(np.array([[0.02, 0.9], [0.5, 0.9], [0.02, 0.2]]))
    assert (chances.passing > 0.99).tolist() == [True, False, True]


@pytest.mark.parametrize(
    ("requirement", "configuration", "told"),
    [("R3", "a", "there is no requirement 'R3'"), ("R1", "b", "there is no run of the configuration 'b'")],
)
def test_what_the_study_does_not_have_is_named(
    searched: RunTable, requirement: str, configuration: str, told: str
) -> None:
    with pytest.raises(DseError, match=told):
        Band(searched, requirement, configuration)
