from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fake_runners import DEPENDS_ON, REQUIREMENTS, benches, definition_of, make_fake, study_of

from dse.domain.run import RunRequest
from dse.exploration.executors.local import Local
from dse.exploration.loop import Explored, explore
from dse.exploration.repeat_check import Made
from dse.storage.folder import StudyFolder
from dse.storage.rows import RowBlock


def run(path: Path, *, workers: int, mischief: str) -> Explored:
    study = study_of(levels=9)
    with StudyFolder.resume(path, definition_of(study, ["a"])) as folder:
        executor = Local(workers=workers)
        return explore(study, benches("a", mischief=mischief), folder, executor=executor, make_runner=make_fake)


@pytest.mark.parametrize("cause", DEPENDS_ON)
@pytest.mark.thorough
def test_results_that_depend_on_something_else_than_the_inputs_are_told(tmp_path: Path, cause: str) -> None:
    # One worker makes all runs of a batch: where its process matters, only another one shows it.
    summary = run(tmp_path, workers=1 + (cause == "process"), mischief=cause)
    with StudyFolder.open(tmp_path) as folder:
        problems = [row.problem for row in folder.table().runs() if row.problem]
    again = "not reproducible: simulated again it gave another result; the first to differ: 'world.gap' at 0.5 s"
    assert problems == [again, again]
    assert (summary.simulated, summary.irreproducible) == (81, 2)


def made(blocks: dict[str, range], maker: str = "here/1", wall: float = 0.1) -> Made:
    runs = Made()
    for name, numbers in blocks.items():
        n = len(numbers)
        shape = (n, len(REQUIREMENTS))
        results = (np.zeros((n, 0)), np.zeros(shape, np.uint8), np.zeros(shape))
        block = RowBlock(np.array(numbers), np.ones(n, np.bool_), *results, np.full(n, wall), {}, maker)
        runs.add(name, block)
    return runs


REQUESTS = {number: RunRequest(number, "a", {}) for number in range(10_000)}


@pytest.mark.parametrize(
    ("runs", "repeated"),
    [
        (made({}), []),
        (made({"a": range(1)}), [0]),
        (made({"a": range(100)}), [25, 75]),
        (made({name: range(i * 20, i * 20 + 20) for i, name in enumerate("abc")}), [10, 30, 50]),
        (made({"a": range(100)}, wall=61.0), []),
    ],
    ids=["none", "one", "a hundred", "three configurations", "slow"],
)
def test_which_runs_are_repeated(runs: Made, repeated: list[int]) -> None:
    batches = list(runs.repeats(REQUESTS))
    assert [number for batch in batches for number in batch.numbers] == repeated
    assert {batch.unlike for batch in batches} <= {"here/1"}


def test_of_ten_thousand_runs_25_are_repeated_less_if_some_were_simulated_twice() -> None:
    runs = made({"a": range(10_000)})
    assert len(list(runs.repeats(REQUESTS))) == 25
    runs.compared = 25
    assert not list(runs.repeats(REQUESTS))
