"""What was added is found, by whoever looks; what is damaged is not."""

from __future__ import annotations

import multiprocessing
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from dse.domain.run import Waveforms
from dse.storage import RowBlock, RunStore, read_waveforms, write_waveforms
from dse.storage.waveform_check import digest_of

KEY = "k" * 32


def names_of(*runs: int) -> np.ndarray:
    """Names as they are: no two share a byte."""
    rows = [np.random.default_rng(run).integers(0, 256, 16, dtype=np.uint8) for run in runs]
    return np.array(rows, dtype=np.uint8).reshape(len(runs), 16)


def block_for(*runs: int, add: float = 0.0, problem: str = "") -> RowBlock:
    n = len(runs)
    values = np.array(runs, dtype=np.float64)[:, None] + add
    return RowBlock(
        np.arange(n) + 7,
        np.ones(n, dtype=np.bool_),
        np.hstack((values, -values, values * np.nan)),
        np.full((n, 2), (0, 2), dtype=np.uint8),
        np.hstack((values / 3, np.full((n, 1), -np.inf))),
        np.full(n, 0.5),
        {7: problem} if problem else {},
    )


def found(store: RunStore, *runs: int) -> dict[int, float]:
    rows, block = store.find(KEY, names_of(*runs), 3, 2)
    assert block.numbers.tolist() == rows.tolist()
    return {runs[row]: value for row, value in zip(rows.tolist(), block.metrics[:, 0].tolist(), strict=True)}


def test_what_was_added_is_found_bit_for_bit(tmp_path):
    store = RunStore(tmp_path)
    store.add(KEY, names_of(1, 2, 3), block_for(1, 2, 3, problem="with half the step: none"))
    rows, block = RunStore(tmp_path).find(KEY, names_of(9, 3, 1), 3, 2)
    assert rows.tolist() == [1, 2]
    wanted = block_for(3, 1)
    for column in ("metrics", "verdicts", "margins", "wall"):
        assert getattr(block, column).tobytes() == getattr(wanted, column).tobytes()
    assert block.problems == {2: "with half the step: none"}
    assert store.seconds(KEY) == (1.5, 3)


def test_another_key_has_nothing(tmp_path):
    RunStore(tmp_path).add(KEY, names_of(1), block_for(1))
    rows, block = RunStore(tmp_path).find("l" * 32, names_of(1), 3, 2)
    assert len(rows) == len(block) == 0


def test_the_last_of_a_name_counts_and_what_was_withdrawn_is_gone(tmp_path):
    store = RunStore(tmp_path)
    store.add(KEY, names_of(1, 2), block_for(1, 2, problem="was wrong"))
    store.add(KEY, names_of(1), block_for(1, add=0.5))
    store.withdraw(KEY, names_of(2))
    assert found(store, 1, 2) == {1: 1.5}
    assert store.find(KEY, names_of(1), 3, 2)[1].problems == {}
    store.add(KEY, names_of(2), block_for(2))
    assert found(store, 1, 2) == {1: 1.5, 2: 2.0}


@given(st.data())
@settings(max_examples=60)
def test_damage_anywhere_loses_no_more_than_what_it_hit(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("store")
    store = RunStore(folder)
    ends = [0]
    for first in (0, 10, 20):
        store.add(KEY, names_of(*range(first, first + 10)), block_for(*range(first, first + 10)))
        ends.append((folder / KEY / "records").stat().st_size)
    content = bytearray((folder / KEY / "records").read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    content[at] ^= data.draw(st.integers(1, 255))
    (folder / KEY / "records").write_bytes(content)
    hit = sum(end <= at for end in ends) - 1
    assert found(store, *range(30)) == {run: float(run) for run in range(30) if run // 10 != hit}


def test_after_a_record_that_was_cut_off_others_can_be_added(tmp_path):
    store = RunStore(tmp_path)
    store.add(KEY, names_of(1), block_for(1))
    store.add(KEY, names_of(2), block_for(2))
    content = (tmp_path / KEY / "records").read_bytes()
    (tmp_path / KEY / "records").write_bytes(content[:-5])
    store.add(KEY, names_of(3), block_for(3))
    assert found(store, 1, 2, 3) == {1: 1.0, 3: 3.0}


def _add(folder: Path, first: int) -> None:
    for run in range(first, first + 50):
        assert RunStore(folder).add(KEY, names_of(run), block_for(run))


def test_processes_add_at_once(tmp_path):
    context = multiprocessing.get_context("fork")
    children = [context.Process(target=_add, args=(tmp_path, first)) for first in (0, 50, 100)]
    for child in children:
        child.start()
    for child in children:
        child.join()
    assert found(RunStore(tmp_path), *range(150)) == {run: float(run) for run in range(150)}


def test_a_folder_that_cannot_be_written_keeps_nothing(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    store = RunStore(tmp_path / "file")
    assert not store.add(KEY, names_of(1), block_for(1))
    assert found(store, 1) == {}


@pytest.fixture
def waves(tmp_path) -> Path:
    """A file of waveforms of the runs 4 and 5."""
    time = np.arange(3.0)
    write_waveforms(tmp_path / "waves.parquet", [(n, Waveforms(time, {"x": time * n})) for n in (4, 5)])
    return tmp_path / "waves.parquet"


def test_waveforms_are_there_after_their_study_is_gone(tmp_path, waves):
    store = RunStore(tmp_path / "runs")
    store.add_waveforms(KEY, names_of(1, 2), [4, 5], waves, digest_of(waves))
    size = waves.stat()
    assert size.st_nlink == 2
    waves.unlink()
    none, (file, number) = store.places(KEY, names_of(3, 2))
    assert none is None
    assert read_waveforms(file, number).values["x"].tolist() == [0.0, 5.0, 10.0]


def test_where_there_are_no_second_names_waveforms_are_found_where_they_lie(tmp_path, waves, monkeypatch):
    def refuse(*_: object) -> None:
        raise OSError

    monkeypatch.setattr("os.link", refuse)
    store = RunStore(tmp_path / "runs")
    store.add_waveforms(KEY, names_of(1, 2), [4, 5], waves, digest_of(waves))
    assert store.places(KEY, names_of(2)) == [(waves, 5)]
    waves.write_bytes(waves.read_bytes()[:-1] + b"?")
    assert RunStore(tmp_path / "runs").places(KEY, names_of(2)) == [None]
