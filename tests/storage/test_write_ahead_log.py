"""The write-ahead log: what a process had written when it was killed is there, whatever else is not."""

from __future__ import annotations

import errno
import math
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dse.domain.bench import Judgement, Verdict
from dse.domain.component import Value
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.storage.rows import Measures, block_of
from dse.storage.waveforms import waveform_file, write_waveforms
from dse.storage.write_ahead_log import LoggedBatch, LogWriter, assemble, clear_log, logged_names, read_log

MEASURES = Measures(("m", "n"), ("R", "S"))
CHUNK = waveform_file(0, 7)


def waves(number: int, rows: int = 5) -> Waveforms:
    values = np.random.default_rng(number).normal(size=(3, rows))
    return Waveforms(np.arange(rows) * 0.1, {"a.x": values[0], "b.y ä": values[1] * math.inf})


def done(number: int, *, keep: bool = False, x: Value = 0.5, metric: float = 1.0, problem: str = "") -> Run:
    judgements = (Judgement("S", Verdict.FAIL, -metric), Judgement("R", Verdict.NOT_EXERCISED, math.nan))
    waveforms = waves(number) if keep else None
    request = RunRequest(number, "c <ä>", {"part.x": x, "part.y": number / 3})
    return Run(request, Outcome.DONE, {"n": number / 7, "m": metric}, judgements, problem, waveforms)


RUNS = [
    done(3, keep=True),
    done(0, metric=-math.inf),
    replace(done(5), outcome=Outcome.FAILED, metrics={}, judgements=(), problem='world: "t" < 3 s\x00 & more'),
    done(1, keep=True, metric=math.nan, problem="a note"),
    done(2, x=2**70),
    done(6, x="eco"),
    done(7, x=True, keep=True),
]


def log_folder(
    folder: Path, runs: Sequence[Run], name: str = CHUNK, study: str = "0123", maker: str = "host/7"
) -> Path:
    """The one file that comes of *runs*."""
    before = set(folder.glob("*"))
    with LogWriter(folder, name, maker, MEASURES, study) as writer:
        for run in runs:
            writer.add(run, run.request.number / 16)
    (file,) = set(folder.glob("*")) - before
    return file


def numbers(found: Sequence[LoggedBatch]) -> list[int]:
    return [number for each in found for number in each.block.numbers.tolist()]


def test_runs_come_back_bit_for_bit(tmp_path: Path) -> None:
    """Failures in words, NaN and infinities, points that are no numbers, with waveforms and without."""
    log_folder(tmp_path / "spool", RUNS)
    (found,) = read_log(tmp_path / "spool", MEASURES, "0123")
    expected = block_of(RUNS, MEASURES, [run.request.number / 16 for run in RUNS])
    for name in ("numbers", "done", "metrics", "verdicts", "margins", "wall"):
        ours, theirs = getattr(found.block, name), getattr(expected, name)
        assert (ours.dtype, ours.shape, ours.tobytes()) == (theirs.dtype, theirs.shape, theirs.tobytes()), name
    assert (found.block.problems, found.block.maker) == (expected.problems, "host/7")
    assert (found.name, found.configuration, found.variables) == (CHUNK, "c <ä>", ("part.x", "part.y"))
    assert [*map(repr, found.points)] == [repr(tuple(run.request.point.values())) for run in RUNS]
    assert found.kept == {1, 3, 7}
    for number in found.kept:
        read, written = found.waveforms(number), waves(number)
        assert read.time.tobytes() == written.time.tobytes()
        assert {n: v.tobytes() for n, v in read.values.items()} == {n: v.tobytes() for n, v in written.values.items()}


def test_waveforms_become_the_chunk_that_one_writer_would_have_written(tmp_path: Path) -> None:
    """From two makers, one of them killed, out of order, one run made twice."""
    log_folder(tmp_path / "spool", [done(n, keep=n != 4) for n in (5, 4, 1)])
    log_folder(tmp_path / "spool", [done(n, keep=True) for n in (7, 5, 0)])
    found = read_log(tmp_path / "spool", MEASURES, "0123", CHUNK)
    assert assemble(tmp_path / CHUNK, found, range(7)) == (0, 1, 5)
    write_waveforms(tmp_path / "expected", [(n, waves(n)) for n in (0, 1, 5)])
    assert (tmp_path / CHUNK).read_bytes() == (tmp_path / "expected").read_bytes()
    assert assemble(tmp_path / "none", found, [4]) == ()
    assert not (tmp_path / "none").exists()


def test_a_file_that_is_torn_anywhere_gives_its_whole_records(tmp_path: Path) -> None:
    file = log_folder(tmp_path, RUNS[:4])
    data = file.read_bytes()
    ends = [data.find(b"\xd5SPOOL1\n", at) for at in range(len(data)) if data.startswith(b"\xd5SPOOL1\n", at)]
    ends = [*ends[1:], len(data)]
    for size in range(len(data)):
        file.write_bytes(data[:size])
        whole = max(0, sum(end <= size for end in ends) - 1)
        assert numbers(read_log(tmp_path, MEASURES, "0123")) == [run.request.number for run in RUNS[:whole]]


def test_a_damaged_byte_costs_the_record_that_it_is_in(tmp_path: Path) -> None:
    file = log_folder(tmp_path, RUNS[:4])
    data = bytearray(file.read_bytes())
    head = data.find(b"\xd5SPOOL1\n", 1)
    everything = [run.request.number for run in RUNS[:4]]
    for at in range(len(data)):
        changed = bytearray(data)
        changed[at] ^= 0x10
        file.write_bytes(changed)
        found = numbers(read_log(tmp_path, MEASURES, "0123"))
        assert len(found) == (0 if at < head else 3)
        assert found == [number for number in everything if number in found]


def test_what_another_study_left_is_passed_over(tmp_path: Path) -> None:
    file = log_folder(tmp_path, RUNS[:2])
    assert read_log(tmp_path, MEASURES, "4567") == []
    assert read_log(tmp_path, Measures(("m",), ("R", "S")), "0123") == []
    assert read_log(tmp_path, MEASURES, "0123", "runs-00000008-00000015.parquet") == []
    (tmp_path / f"empty{file.suffix}").touch()
    (tmp_path / f"random{file.suffix}").write_bytes(np.random.default_rng(1).bytes(5000))
    (tmp_path / f"folder{file.suffix}").mkdir()
    assert numbers(read_log(tmp_path, MEASURES, "0123")) == [3, 0]
    assert read_log(tmp_path / "nowhere", MEASURES, "0123") == []


def test_a_file_that_cannot_be_read_now_does_not_pass_for_an_empty_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log_folder(tmp_path, RUNS)

    def no_memory(*arguments: object, **more: object) -> None:
        raise OSError(errno.ENOMEM, "Cannot allocate memory")

    monkeypatch.setattr("mmap.mmap", no_memory)
    with pytest.raises(OSError, match="Cannot allocate memory"):
        read_log(tmp_path, MEASURES, "0123")


def test_a_folder_that_cannot_be_read_does_not_pass_for_an_empty_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(errno.EACCES, "as the test says")

    monkeypatch.setattr("os.listdir", refuse)
    monkeypatch.setattr("os.scandir", refuse)
    for look in (lambda: read_log(tmp_path, MEASURES), lambda: logged_names(tmp_path)):
        with pytest.raises(PermissionError):
            look()


def test_two_writers_for_a_chunk_do_not_meet(tmp_path: Path) -> None:
    writers = [LogWriter(tmp_path, CHUNK, maker, MEASURES) for maker in ("b/1", "a/1")]
    with writers[0], writers[1]:
        for number in range(4):
            writers[number % 2].add(done(number), 0.0)
    found = read_log(tmp_path, MEASURES)
    assert {each.block.maker: each.block.numbers.tolist() for each in found} == {"a/1": [1, 3], "b/1": [0, 2]}


def test_a_batch_is_cleared_and_others_stay(tmp_path: Path) -> None:
    other = log_folder(tmp_path, RUNS[:1], "runs-00000000")
    log_folder(tmp_path, RUNS[:1])
    log_folder(tmp_path, RUNS[1:2])
    clear_log(tmp_path, {CHUNK})
    assert [*tmp_path.iterdir()] == [other]


WRITES = """
import resource, signal, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from test_write_ahead_log import *
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
writer = LogWriter(Path(sys.argv[1]), CHUNK, "a/1", MEASURES)
for number in range(6):
    limit = int(sys.argv[3]) if number == 3 else resource.RLIM_INFINITY
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        writer.add(done(number, keep=True), 0.0)
    except OSError as error:
        print(number, error.errno)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits of processes")
@pytest.mark.parametrize("room", [1, 1100])
def test_a_file_without_room_stays_whole_and_goes_on_when_there_is(tmp_path: Path, room: int) -> None:
    tests = str(Path(__file__).parent)
    command = [sys.executable, "-c", WRITES, str(tmp_path), tests, str(room)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert done.stdout.split() == ["3", "27"]
    assert numbers(read_log(tmp_path, MEASURES)) == [0, 1, 2, 4, 5]
