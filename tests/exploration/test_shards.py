"""A study in shards, some of them stopped, and what is merged of them."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from fake_runners import benches, definition_of, make_fake, study_of

from dse.api.studies.exploration import ExploreOptions, explore_into
from dse.domain.run import Outcome, RunRequest
from dse.domain.study import Keep, Shard, Study
from dse.errors import DseError
from dse.exploration.batches import Chunks
from dse.exploration.loop import ExplorationInterruptedError, Explored, explore
from dse.exploration.samplers.full_factorial import FullFactorial
from dse.exploration.work import Batch, Sink, Work
from dse.storage import block_of, merge_studies, shards_in, write_waveforms
from dse.storage.database.sampler_requests import SamplerRequests, blocks_of
from dse.storage.export.tables import to_csv
from dse.storage.folder import StudyFolder

NAMES = ("a", "b")
STUDY = study_of(levels=12, keep=Keep.ALL)
RUNS = 288


class Here:
    """Makes the runs in this process; interrupted after so many batches."""

    name = "here"
    retried = 0
    remarks = ()

    def __init__(self, batches: int | None = None) -> None:
        self.left = batches

    @contextmanager
    def open(self, work: Work, sink: Sink) -> Iterator[Here]:
        self.work, self.sink = work, sink
        yield self

    def work_off(self, batches: Iterable[Batch]) -> None:
        for batch in batches:
            if self.left == 0:
                raise KeyboardInterrupt
            self.left = None if self.left is None else self.left - 1
            runner = make_fake(self.work.configurations[batch.configuration], memoryview(bytearray(64)))  # type: ignore[arg-type]
            runs = [runner.run(request, keep=batch.keep) for request in batch.requests]
            kept = [(run.request.number, run.waveforms) for run in runs if run.waveforms is not None]
            if kept:
                write_waveforms(self.work.waveforms / batch.file, kept)
            self.sink.rows(batch, block_of(runs, self.work.measures, [0.5] * len(runs)))
            self.sink.ended(batch, tuple(number for number, _ in kept))


def run(path: Path, shard: Shard | None = None, batches: int | None = None, study: Study = STUDY) -> Explored:
    with StudyFolder.resume(path, definition_of(study, NAMES)) as folder:
        return explore(
            study,
            benches(*NAMES, mischief="fails", when=(5, 200)),
            folder,
            executor=Here(batches),
            make_runner=make_fake,
            shard=shard,
        )


def in_shards(folder: Path, of: int, study: Study = STUDY) -> None:
    for number in range(1, of + 1):
        shard = Shard(number, of)
        run(folder / shard.folder, shard, study=study)


def content(path: Path) -> tuple[bytes, dict[str, bytes]]:
    with StudyFolder.open(path) as folder:
        files = {file.name: file.read_bytes() for file in folder.waveform_folder.iterdir()}
        return to_csv(folder), files


@pytest.mark.sampled(3)
@pytest.mark.parametrize("of", [1, 3, 8, 200])
def test_shards_are_whole_chunks_and_together_all_of_them(of: int) -> None:
    requests = {n: RunRequest(n, "a" if n < 1000 else "b", {}) for n in range(3000)}
    chunks = Chunks(requests, SamplerRequests(blocks_of(list(requests.values()), 0, 0)), {}.get)
    whole = {batch.numbers for batch in chunks.runs(requests)}
    parts = [chunks.part(requests, Shard(number, of)) for number in range(1, of + 1)]
    assert sorted(n for part in parts for n in part) == list(requests)
    assert {batch.numbers for part in parts for batch in chunks.runs(part)} == whole
    assert max(map(len, parts)) - min(map(len, parts)) <= 64


def test_what_is_merged_is_what_one_machine_makes(tmp_path: Path) -> None:
    run(tmp_path / "local")
    in_shards(tmp_path / "out", 8)
    merged = merge_studies(tmp_path / "out", shards_in(tmp_path / "out"))
    assert (merged.runs, merged.finished, merged.absent, merged.different) == (RUNS, RUNS, (), ())
    assert content(tmp_path / "out") == content(tmp_path / "local")
    assert run(tmp_path / "out").simulated == 0


def test_a_shard_that_is_stopped_goes_on_and_what_is_missing_is_said(tmp_path: Path) -> None:
    run(tmp_path / "local")
    for number in (1, 2, 3):
        shard = Shard(number, 3)
        if number == 2:
            with pytest.raises(ExplorationInterruptedError):
                run(tmp_path / "out" / shard.folder, shard, batches=4)
        else:
            run(tmp_path / "out" / shard.folder, shard)
    shutil.move(tmp_path / "out" / "shard-3-of-3", tmp_path / "elsewhere")
    merged = merge_studies(tmp_path / "out", shards_in(tmp_path / "out"))
    assert merged.absent == ("shard-3-of-3",)
    assert 0 < merged.of[tmp_path / "out" / "shard-2-of-3"] < RUNS // 3
    assert merged.finished == sum(merged.of.values()) < RUNS
    run(tmp_path / "out" / "shard-2-of-3", Shard(2, 3))
    shutil.move(tmp_path / "elsewhere", tmp_path / "out" / "shard-3-of-3")
    assert merge_studies(tmp_path / "out", shards_in(tmp_path / "out")).finished == RUNS
    assert content(tmp_path / "out") == content(tmp_path / "local")


def test_what_no_shard_made_is_made_after_the_merge(tmp_path: Path) -> None:
    run(tmp_path / "local")
    run(tmp_path / "out" / "shard-1-of-2", Shard(1, 2))
    assert merge_studies(tmp_path / "out", shards_in(tmp_path / "out")).finished < RUNS
    assert run(tmp_path / "out").new > 0
    assert content(tmp_path / "out") == content(tmp_path / "local")


def test_waveforms_near_a_boundary_are_made_after_the_merge(tmp_path: Path) -> None:
    study = replace(STUDY, keep=Keep.NEAR_BOUNDARY)
    run(tmp_path / "local", study=study)
    in_shards(tmp_path / "out", 3, study)
    merge_studies(tmp_path / "out", shards_in(tmp_path / "out"))
    assert content(tmp_path / "out")[1] == {}
    again = run(tmp_path / "out", study=study)
    assert again.new == 0
    assert again.again == again.kept > 0
    assert content(tmp_path / "out") == content(tmp_path / "local")


def test_attempts_are_merged_once_however_often(tmp_path: Path) -> None:
    in_shards(tmp_path / "out", 3)
    for _ in range(2):
        merge_studies(tmp_path / "out", shards_in(tmp_path / "out"))
    with StudyFolder.open(tmp_path / "out") as folder:
        attempts = folder.attempts()
    assert {attempt.run for attempt in attempts} == {*range(RUNS)}
    assert len(attempts) == RUNS + 3 * 2
    assert {attempt.seconds for attempt in attempts} == {0.5}
    assert all(attempt.maker for attempt in attempts)


def test_runs_that_two_machines_made_differently_are_told(tmp_path: Path) -> None:
    in_shards(tmp_path / "out", 2)
    shutil.copytree(tmp_path / "out" / "shard-1-of-2", tmp_path / "copy")
    with StudyFolder.open(tmp_path / "copy") as folder:
        first = min(folder.finished() - folder.failed())
    with StudyFolder.resume(tmp_path / "copy", definition_of(STUDY, NAMES)) as folder, folder._writing() as connection:
        connection.execute('UPDATE runs SET "m:m0" = "m:m0" + 1e-12, seal = NULL WHERE number = ?', (first,))
    merged = merge_studies(tmp_path / "out", [*shards_in(tmp_path / "out"), tmp_path / "copy"])
    assert merged.different == (first,)


@pytest.mark.parametrize("changed", [{"seed": 2}, {"dse": "0.0.1"}])
def test_what_is_of_another_study_is_refused_by_name(tmp_path: Path, changed: dict[str, object]) -> None:
    run(tmp_path / "out" / "shard-1-of-2", Shard(1, 2))
    other = definition_of(replace(STUDY, seed=1), NAMES, **changed)
    with StudyFolder.create(tmp_path / "out" / "shard-2-of-2", other):
        pass
    with pytest.raises(DseError, match=r"shard-2-of-2: is not of the same study as .*shard-1-of-2"):
        merge_studies(tmp_path / "out", shards_in(tmp_path / "out"))


def test_waveforms_that_are_damaged_are_not_taken_for_kept(tmp_path: Path) -> None:
    run(tmp_path / "local")
    in_shards(tmp_path / "out", 2)
    next((tmp_path / "out" / "shard-1-of-2" / "waveforms").iterdir()).write_bytes(b"")
    merge_studies(tmp_path / "out", shards_in(tmp_path / "out"))
    assert run(tmp_path / "out").again > 0
    assert content(tmp_path / "out") == content(tmp_path / "local")


def test_failed_runs_are_in_it(tmp_path: Path) -> None:
    in_shards(tmp_path / "out", 2)
    merge_studies(tmp_path / "out", shards_in(tmp_path / "out"))
    with StudyFolder.open(tmp_path / "out") as folder:
        assert folder.failed() == {5, 200}
        assert folder.run(5).outcome is Outcome.FAILED


def test_a_sampler_that_looks_at_results_has_no_shards(tmp_path: Path) -> None:
    class Patient(FullFactorial):
        name = "patient"
        once = False

    study = replace(STUDY, sampler=Patient())
    with pytest.raises(DseError, match="the sampler 'patient' looks at results before it asks for more runs"):
        explore_into(study, tmp_path, ExploreOptions(shard=Shard(1, 2)))
