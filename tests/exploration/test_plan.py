from __future__ import annotations

from fake_runners import study_of
from hypothesis import given
from hypothesis import strategies as st

from dse.exploration.plan import chunks, missing_runs, missing_waveforms
from dse.exploration.samplers import requests


@given(st.integers(1, 80), st.integers(1, 40))
def test_chunks_hold_every_run_once_and_one_configuration_each(points: int, configurations: int) -> None:
    made = requests(study_of(levels=points, variables=1), tuple(f"c{i}" for i in range(configurations)))
    cut = list(chunks(made))
    assert [request for chunk in cut for request in chunk] == list(made)
    assert all(len({request.configuration for request in chunk}) == 1 for chunk in cut)
    assert all(len(chunk) <= 32 for chunk in cut)


def test_a_small_study_is_cut_fine_enough_for_many_workers() -> None:
    made = requests(study_of(levels=25, variables=2), ("a",))
    assert len(list(chunks(made))) >= 64


def test_what_is_finished_is_not_planned_again_and_chunks_stay_where_they_were() -> None:
    made = requests(study_of(levels=64, variables=2), ("a",))
    every = {batch.identity: set(batch.numbers) for batch in missing_runs(made, set())}
    finished = set(range(0, 4096, 2)) | set(range(32, 64))
    for batch in missing_runs(made, finished):
        assert set(batch.numbers) == every[batch.identity] - finished
        assert not batch.keep
    assert 1 not in {batch.identity for batch in missing_runs(made, finished)}
    assert list(missing_runs(made, set(range(4096)))) == []


def test_a_waveform_file_is_named_after_its_chunk_and_written_whole() -> None:
    made = requests(study_of(levels=64, variables=2), ("a",))
    (batch,) = missing_waveforms(made, {33, 40, 41}, {33: "runs-00000032-00000063.parquet", 41: ""})
    assert batch.file == "runs-00000032-00000063.parquet"
    assert batch.numbers == (33, 40)
    assert list(missing_waveforms(made, {33}, {33: "runs-00000032-00000063.parquet"})) == []


def test_a_batch_holds_each_runs_point() -> None:
    made = requests(study_of(levels=3, variables=2), ("a",))
    for batch in missing_runs(made, set()):
        for number in batch.numbers:
            assert dict(zip(batch.names, batch.point(number), strict=True)) == made[number].point
