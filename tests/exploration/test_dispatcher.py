"""Work for other machines, over a line that ends in this process: what is cut, sent again, put together and told."""

from __future__ import annotations

import errno
import os
import pickle
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Future
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NoReturn

import pytest

from dse.domain.run import RunRequest
from dse.errors import DseError, fail
from dse.exploration.packed_configuration import Packer
from dse.exploration.remote import dispatcher as module
from dse.exploration.remote.dispatcher import Dispatcher
from dse.exploration.remote.machine import Machine, this_machine
from dse.exploration.remote.messages import (
    Answer,
    BatchResults,
    BatchRows,
    MissingEntries,
    WorkerError,
    WorkMessage,
    message_bytes,
    read_message,
)
from dse.exploration.remote.worker import dismiss, work_on
from dse.exploration.work import Batch
from dse.testing.executors import Gathered, SmallBench, batches, files, make_here, work_in

FAR = replace(this_machine(), host="far")


@dataclass
class Line:
    """Carries messages out here; *mischief* may raise before or answer instead. *log* has the runs of each message."""

    folder: Path
    mischief: Callable[[WorkMessage], Answer | None] = lambda message: None
    machine: Machine = FAR
    seconds: float = 0.1
    slots_here: int = 2
    renewed: int = 0
    most_at_once: int = 0
    log: list[tuple[int, ...]] = field(default_factory=list)
    under_way: list[Future[Answer]] = field(default_factory=list)

    def slots(self) -> int:
        return self.slots_here

    def send(self, content: bytes, worker: str) -> Future[Answer]:
        message = read_message(content, "far")
        self.log.append(tuple(n for batch in message.batches for n in batch.numbers))
        self.under_way = [f for f in self.under_way if not f.done()] + [_Late(self, message)]
        self.most_at_once = max(self.most_at_once, len(self.under_way))
        return self.under_way[-1]

    def renew(self, error: BaseException) -> None:
        self.renewed += 1

    def answer(self, message: WorkMessage) -> Answer:
        return self.mischief(message) or carried(message, self.folder, self.machine, self.seconds)


class _Late(Future[Answer]):
    """Is done when somebody waits for it to be: so several are under way at once."""

    def __init__(self, line: Line, message: WorkMessage) -> None:
        super().__init__()
        self._line, self._message = line, message

    def add_done_callback(self, fn: Callable[[Future[Answer]], object]) -> None:
        fn(self)

    def result(self, timeout: float | None = None) -> Answer:
        if not self.done():
            try:
                self.set_result(self._line.answer(self._message))
            except Exception as error:  # noqa: BLE001  # what a future does
                self.set_exception(error)
        return super().result(timeout)


def carried(message: WorkMessage, folder: Path, machine: Machine, seconds: float = 0.1) -> BatchResults:
    work = work_in(folder)
    pieces = []
    for batch in (message.canary, *message.batches):
        sink = Gathered()
        make_here(batch, work, sink)
        kept = [number for numbers in sink.kept.values() for number in numbers]
        contents = [(work.waveforms / batch.file).read_bytes()] if kept else []
        pieces.append(BatchRows(tuple(sink.blocks), tuple(kept), tuple(contents)))
    runs = sum(len(batch.numbers) for batch in message.batches)
    return BatchResults(tuple(pieces[1:]), machine, seconds * runs, 0, (), pieces[0].blocks[0])


@pytest.fixture(autouse=True)
def _canary_here(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def carry_out_here(content: bytes) -> Answer:
        return carried(read_message(content, "here"), tmp_path / "here", this_machine())

    monkeypatch.setattr(module, "work_on", carry_out_here)


@pytest.fixture
def line(tmp_path: Path) -> Line:
    return Line(tmp_path / "far")


@dataclass(frozen=True)
class Filed(SmallBench):
    file: Path = Path()


def work_off(line: Line, folder: Path, todo: Iterator[Batch] | list[Batch]) -> tuple[Gathered, Dispatcher]:
    sink = Gathered()
    with Dispatcher(line, work_in(folder / "found"), sink) as pool:
        pool.work_off(todo)
    return sink, pool


def expected(folder: Path, todo: list[Batch]) -> Gathered:
    sink, work = Gathered(), work_in(folder / "expected")
    for batch in todo:
        make_here(batch, work, sink)
    return sink


def deadly(*numbers: int, error: Exception | None = None) -> Callable[[WorkMessage], None]:
    def mischief(message: WorkMessage) -> None:
        if any(n in numbers for batch in message.batches for n in batch.numbers):
            raise error or OSError("worker 7 is gone")

    return mischief


def many(count: int) -> Iterator[Batch]:
    for first in range(0, count, 32):
        yield Batch(first, "plain", tuple(RunRequest(n, "plain", {"x": n * 0.1}) for n in range(first, first + 32)))


def test_work_travels_in_loads_of_a_second_after_the_first(line: Line, tmp_path: Path) -> None:
    line.seconds = 0.02
    sink, _ = work_off(line, tmp_path, list(many(640)))
    sizes = [len(numbers) for numbers in line.log]
    assert sizes[0] == 1
    assert set(sizes[4:-1]) == {50}
    assert sorted(sink.results()) == list(range(640))
    assert sorted(sink.ends) == list(range(0, 640, 32))


def test_few_loads_are_under_way_however_many_runs_there_are(line: Line, tmp_path: Path) -> None:
    line.seconds, taken = 0.02, []

    def counted() -> Iterator[Batch]:
        for batch in many(6400):
            taken.append(batch)
            assert len(taken) * 32 - sum(map(len, sink.blocks)) < 10 * 50
            yield batch

    sink = Gathered()
    with Dispatcher(line, work_in(tmp_path / "found"), sink) as pool:
        pool.work_off(counted())
    assert len(sink.results()) == 6400
    assert line.most_at_once <= 4


@pytest.mark.thorough
def test_of_many_workers_loads_are_larger(line: Line, tmp_path: Path) -> None:
    """One coordinator cannot take more than some hundred answers a second."""
    line.seconds, line.slots_here = 0.5, 200
    work_off(line, tmp_path, list(many(6400)))
    assert len(line.log[-2]) == 8


def test_waveforms_of_long_runs_come_in_parts_and_make_the_same_file(line: Line, tmp_path: Path) -> None:
    line.seconds = 10.0
    todo = batches(keep=True)[:12]
    sink, _ = work_off(line, tmp_path, todo)
    assert max(map(len, line.log)) <= 2
    reference = expected(tmp_path, todo)
    assert sink.results() == reference.results()
    assert sink.kept == reference.kept
    assert files(tmp_path / "found") == files(tmp_path / "expected")


@pytest.mark.parametrize("keep", [False, True])
def test_a_run_that_ends_its_worker_twice_alone_is_a_failed_run_and_no_other_is(
    line: Line, tmp_path: Path, keep: bool
) -> None:
    line.mischief, line.seconds = deadly(17, 40), 0.02
    todo = batches(keep=keep)[:9]
    sink, pool = work_off(line, tmp_path, todo)
    reference = expected(tmp_path, todo).results()
    found = sink.results()
    assert {n for n in found if found[n] != reference[n]} == {17, 40}
    assert found[17][2] == "ended its worker twice: worker 7 is gone"
    assert line.log.count((17,)) == 2
    assert {17, 40} <= {attempt.run for attempt in sink.attempts}
    assert all(attempt.cause == "lost with its worker: worker 7 is gone" for attempt in sink.attempts)
    assert sorted(sink.ends) == [batch.identity for batch in todo]
    assert pool.retried


def test_where_a_whole_pool_breaks_each_load_is_tried_alone(line: Line, tmp_path: Path) -> None:
    line.mischief, line.seconds, line.slots_here = deadly(17, error=BrokenExecutor("a process died")), 0.02, 4
    todo = batches(keep=False)[:9]
    sink, _ = work_off(line, tmp_path, todo)
    found, reference = sink.results(), expected(tmp_path, todo).results()
    assert [n for n in found if found[n] != reference[n]] == [17]
    assert line.renewed >= 2


def test_a_connection_that_is_lost_is_nobodys_fault(line: Line, tmp_path: Path) -> None:
    losses = iter(range(4))

    def mischief(message: WorkMessage) -> None:
        if len(line.log) > 5 and next(losses, None) is not None:
            raise CancelledError("scheduler gone")

    line.mischief = mischief
    todo = batches(keep=False)[:9]
    sink, _ = work_off(line, tmp_path, todo)
    assert sink.results() == expected(tmp_path, todo).results()
    assert line.renewed == 4


def test_a_connection_that_is_lost_when_something_is_sent_loses_no_run(tmp_path: Path) -> None:
    class Lossy(Line):
        def send(self, content: bytes, worker: str) -> Future[Answer]:
            if self.renewed < 3 and len(self.log) == 4:
                raise CancelledError("the connection to the scheduler was lost")
            return super().send(content, worker)

    line = Lossy(tmp_path / "far")
    sink, _ = work_off(line, tmp_path, list(many(64)))
    assert line.renewed == 3
    assert sorted(sink.results()) == list(range(64))


def test_workers_that_all_die_are_not_the_runs_fault(line: Line, tmp_path: Path) -> None:
    line.mischief = deadly(*range(63))
    with pytest.raises(DseError, match="workers end with what they are given, the last: worker 7 is gone"):
        work_off(line, tmp_path, batches(keep=False)[:9])


def test_a_machine_that_cannot_work_is_named(line: Line, tmp_path: Path) -> None:
    line.mischief = lambda message: WorkerError("node3", "the disk is full")
    with pytest.raises(DseError, match="node3 cannot make runs: the disk is full"):
        work_off(line, tmp_path, batches(keep=False)[:9])


def test_a_disk_that_is_full_here_is_named_and_the_next_time_the_files_are_the_same(
    line: Line, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    todo = batches(keep=True)[:9]
    with monkeypatch.context() as full:
        full.setattr(Path, "write_bytes", refusing(errno.ENOSPC))
        with pytest.raises(DseError, match=r"^waveforms cannot be written: No space left on device\n.*are stored"):
            work_off(line, tmp_path, todo)
    sink, _ = work_off(line, tmp_path, todo)
    assert sink.results() == expected(tmp_path, todo).results()
    assert files(tmp_path / "found") == files(tmp_path / "expected")


def refusing(number: int) -> Callable[..., NoReturn]:
    def refuse(*_arguments: object, **_options: object) -> NoReturn:
        raise OSError(number, os.strerror(number))

    return refuse


def test_a_worker_that_answers_without_some_runs_is_asked_again(line: Line, tmp_path: Path) -> None:
    def mischief(message: WorkMessage) -> Answer | None:
        answer = carried(message, line.folder, FAR)
        return replace(answer, pieces=tuple(BatchRows(()) for _ in answer.pieces)) if len(line.log) == 5 else None

    line.mischief = mischief
    todo = batches(keep=True)[:9]
    sink, _ = work_off(line, tmp_path, todo)
    assert sink.results() == expected(tmp_path, todo).results()
    assert files(tmp_path / "found") == files(tmp_path / "expected")


def test_a_worker_that_lacks_a_package_is_told_at_once(line: Line, tmp_path: Path) -> None:
    line.mischief = deadly(0, error=ModuleNotFoundError("No module named 'dse'"))
    with pytest.raises(DseError, match="cannot take up the work: ModuleNotFoundError: No module named 'dse'"):
        work_off(line, tmp_path, batches(keep=False))
    assert len(line.log) <= 4


def test_what_a_worker_lacks_is_sent_to_it(line: Line, tmp_path: Path) -> None:
    def mischief(message: WorkMessage) -> Answer | None:
        names = {batch.configuration for batch in message.batches} - message.configurations.keys()
        return MissingEntries(tuple(names), (), "tcp://far:1") if names else None

    line.mischief = mischief
    todo = batches(keep=False)
    sink, _ = work_off(line, tmp_path, todo)
    assert sink.results() == expected(tmp_path, todo).results()


def test_a_machine_that_gives_other_bits_is_told_by_its_name(line: Line, tmp_path: Path) -> None:
    line.machine = Machine("node9", "Other CPU", "glibc 2.99", "another")
    _, pool = work_off(line, tmp_path, batches(keep=False)[:2])
    (remark,) = pool.remarks
    assert remark.startswith("node9 (Other CPU, glibc 2.99) gives different bits than ")
    assert remark.endswith(": exp, sin, pow and atan2")


def test_a_machine_whose_run_differs_is_told_by_its_name(line: Line, tmp_path: Path) -> None:
    def mischief(message: WorkMessage) -> Answer:
        answer = carried(message, line.folder, FAR)
        assert answer.canary is not None
        return replace(answer, canary=replace(answer.canary, metrics=answer.canary.metrics * (1 + 2e-16)))

    line.mischief = mischief
    _, pool = work_off(line, tmp_path, batches(keep=False)[:2])
    (remark,) = pool.remarks
    assert remark.startswith("far (")
    assert remark.endswith(": run 0 of the study")


def test_machines_that_give_the_same_are_not_worth_a_word(line: Line, tmp_path: Path) -> None:
    assert work_off(line, tmp_path, batches(keep=False)[:2])[1].remarks == ()


def test_nobody_waits_for_ever_for_workers(line: Line, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PATIENCE", -1.0)
    line.slots_here = 0
    with pytest.raises(DseError, match="no worker was there"):
        work_off(line, tmp_path, batches(keep=False))


def test_a_worker_with_another_version_is_told_which(monkeypatch: pytest.MonkeyPatch) -> None:
    content = pickle.dumps(("dse 0.0.1 for linux64, Python 3", b"not read"))
    with pytest.raises(DseError, match=r"the worker on node3 has dse .*, this machine dse 0\.0\.1"):
        read_message(content, "node3")


def test_an_error_of_ours_ends_the_exploration_with_its_words(line: Line, tmp_path: Path) -> None:
    line.mischief = deadly(0, error=fail("the worker on node3 has dse 0.0.1"))
    with pytest.raises(DseError, match="node3 has dse"):
        work_off(line, tmp_path, batches(keep=False))


def test_a_file_that_only_this_machine_has_is_named(line: Line, tmp_path: Path) -> None:
    work = replace(work_in(tmp_path / "found"), configurations={"plain": Filed("plain", file=tmp_path / "lead.csv")})
    with (
        pytest.raises(DseError, match=r"plain needs .*lead\.csv, which only this machine has"),
        Dispatcher(line, work, Gathered()) as pool,
    ):
        pool.work_off(batches(keep=False))


@pytest.fixture(scope="module")
def small_message(tmp_path_factory: pytest.TempPathFactory) -> Iterator[WorkMessage]:
    work = work_in(tmp_path_factory.mktemp("work"))
    todo = batches(keep=True)[:2]
    names = {batch.configuration for batch in todo}
    configurations = {name: Packer().pack(work.configurations[name]).content for name in names}
    needs: dict[str, dict[str, str]] = {name: {} for name in names}
    yield WorkMessage(
        "a study",
        tuple(todo),
        work.make_runner,
        work.measures,
        needs,
        replace(todo[0], identity=1 << 50, file="", requests=todo[0].requests[:1]),  # one run, as dispatchers send
        configurations,
        {},
    )
    dismiss("a study")


def runs(answer: Answer) -> list[tuple[list[int], bytes, tuple[int, ...], tuple[bytes, ...]]]:
    assert isinstance(answer, BatchResults)
    return [
        (
            [number for block in piece.blocks for number in block.numbers.tolist()],
            b"".join(block.metrics.tobytes() for block in piece.blocks),
            piece.kept,
            piece.files,
        )
        for piece in answer.pieces
    ]


def test_a_parcel_that_was_carried_out_already_gives_the_same_again(small_message: WorkMessage) -> None:
    """A scheduler that lost the results asks the same machine once more."""
    first, again = runs(work_on(message_bytes(small_message))), runs(work_on(message_bytes(small_message)))
    assert [numbers for numbers, *_ in first] == [list(batch.numbers) for batch in small_message.batches]
    assert again == first


@pytest.mark.parametrize("where", ["_Crew._pieces", "ScratchFolder.__init__"])
def test_what_fails_on_a_machine_for_want_of_files_is_no_verdict_on_the_runs(
    small_message: WorkMessage, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    dismiss("a study")
    with monkeypatch.context() as short:
        short.setattr(f"dse.exploration.remote.worker.{where}", refusing(errno.EMFILE))
        answer = work_on(message_bytes(small_message))
    assert isinstance(answer, WorkerError)
    assert "Too many open files" in answer.words
    assert runs(work_on(message_bytes(small_message)))
