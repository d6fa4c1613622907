"""Workers that grow, or that must not go on, are renewed; the runs are made all the same."""

from __future__ import annotations

import multiprocessing
import sys
from pathlib import Path

import pytest
from fake_runners import FakeBench, definition_of, make_fake, study_of
from first_asks import first_ask

from dse.domain.run import Outcome
from dse.domain.study import Keep, Study
from dse.exploration.batches import Chunks
from dse.exploration.executors.local import Local
from dse.exploration.loop import Explored, explore
from dse.storage.database.sampler_requests import SamplerRequests, blocks_of
from dse.storage.folder import StudyFolder

BASELINE = 200e6  # a worker by itself, with room to spare


def explored(path: Path, study: Study, bench: FakeBench, *, runs: int = 25, threads: int = 1, workers: int = 1):
    with StudyFolder.create(path, definition_of(study)) as folder:
        summary: Explored = explore(
            study, {"a": bench}, folder, executor=Local(workers=workers, threads=threads), make_runner=make_fake
        )
        table = folder.table()
        kept = folder.kept()
    assert multiprocessing.active_children() == []
    failures = {run.request.number: run.problem for run in table.runs() if run.outcome is Outcome.FAILED}
    assert len(table) == runs
    return summary, failures, kept


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("threads", [1, 2])
def test_a_run_that_grows_beyond_its_memory_is_ended_and_named(tmp_path: Path, threads: int) -> None:
    bench = FakeBench("a", "grows", (7,), memory=BASELINE + 500e6)
    _, failures, _ = explored(tmp_path, study_of(), bench, threads=threads)
    assert set(failures) == {7}
    assert failures[7].startswith("grew beyond 0.7 GB of memory")
    assert failures[7].endswith("in fake: fmi2DoStep of run 7")


@pytest.mark.thorough
def test_runs_that_leak_a_little_have_their_worker_renewed_and_none_is_blamed(tmp_path: Path) -> None:
    # 25 runs of 50 MB: twice as much as a worker may hold, and no run of them too much by itself.
    bench = FakeBench("a", "leaks", memory=BASELINE + 400e6, seconds=0.1)
    summary, failures, _ = explored(tmp_path, study_of(), bench)
    assert failures == {}
    assert summary.retried == 0  # each left before it was too large


def pids(file: Path) -> list[str]:
    return [line.split()[0] for line in file.read_text(encoding="utf-8").splitlines()]


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("keep", [Keep.NONE, Keep.ALL])
def test_no_process_makes_more_runs_than_it_bears(tmp_path: Path, keep: Keep) -> None:
    file = tmp_path / "processes"
    bench = FakeBench("a", "tells its process", file=file, most_runs=3)
    summary, failures, kept = explored(tmp_path / "study", study_of(levels=3, keep=keep), bench, runs=9)
    assert failures == {}
    made = pids(file)
    assert len(made) == summary.simulated + 1 == 10  # one is repeated
    assert max(made.count(pid) for pid in made) <= 3
    assert (set(kept) == set(range(9))) is (keep is Keep.ALL)


def test_a_chunk_is_no_larger_than_what_a_process_bears() -> None:
    asked = first_ask(study_of(levels=50), ("a", "b"))
    asks = SamplerRequests(blocks_of(asked, 0, 0))
    batches = Chunks(dict(enumerate(asked)), asks, {"b": 5}.get).runs(range(5000))
    sizes = {(batch.configuration, len(batch.numbers)) for batch in batches}
    assert sizes == {("a", 32), ("a", 2500 % 32), ("b", 5)}


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("keep", [Keep.NONE, Keep.ALL])
def test_after_a_fatal_failure_the_other_runs_are_made_by_another_process(tmp_path: Path, keep: Keep) -> None:
    # 2,500 runs make chunks of 32: what follows run 40 in its chunk would be lost with the process.
    study = study_of(levels=50, keep=keep)
    bench = FakeBench("a", "is fatal", (40, 41))
    summary, failures, kept = explored(tmp_path, study, bench, runs=2500)
    assert set(failures) == {40, 41}
    assert summary.irreproducible == 0
    if keep is Keep.ALL:
        assert {number for number, name in kept.items() if name} == set(range(2500)) - {40, 41}


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("mischief", ["crashes", "hangs", "exits"])
@pytest.mark.thorough
def test_in_threads_the_run_at_fault_is_blamed_and_no_other(tmp_path: Path, mischief: str) -> None:
    study = study_of(levels=50)
    bench = FakeBench("a", mischief, (40, 70), timeout=2)
    _, failures, _ = explored(tmp_path, study, bench, runs=2500, threads=3)
    assert set(failures) == {40, 70}
    assert all(problem.endswith(f"in fake: fmi2DoStep of run {number}") for number, problem in failures.items())


@pytest.mark.thorough
def test_threads_give_the_same_bytes_as_one_run_at_a_time(tmp_path: Path) -> None:
    study = study_of(levels=12, keep=Keep.ALL)
    content = []
    for threads in (1, 3):
        bench = FakeBench("a", "fails", (5,), seconds=0.0005)
        folder = tmp_path / str(threads)
        explored(folder, study, bench, runs=144, threads=threads)
        with StudyFolder.open(folder) as store:
            files = {file.name: file.read_bytes() for file in store.waveform_folder.iterdir()}
            rows = [(r.request, r.outcome, r.problem, repr(r.metrics), r.judgements) for r in store.table().runs()]
        content.append((repr(rows), files))
    assert content[0] == content[1]


def places(tmp_path: Path, **settings: object) -> set[str]:
    file = tmp_path / "places"
    bench = FakeBench("a", "tells its process", file=file, seconds=0.005, **settings)  # type: ignore[arg-type]  # by name
    explored(tmp_path / "study", study_of(levels=20), bench, runs=400, threads=3)
    return set(file.read_text(encoding="utf-8").splitlines())


@pytest.mark.thorough
def test_where_fmus_bear_it_one_process_runs_several_threads(tmp_path: Path) -> None:
    used = places(tmp_path)
    assert len({place.split()[0] for place in used}) == 1
    assert len(used) > 1


@pytest.mark.thorough
def test_where_fmus_do_not_bear_threads_there_are_as_many_processes(tmp_path: Path) -> None:
    used = places(tmp_path, thread_safe=False)
    assert len({place.split()[0] for place in used}) == len(used) > 1
