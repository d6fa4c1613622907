"""Things built at once: all problems are told, and an interrupt begins nothing more."""

from __future__ import annotations

import math
import threading

import pytest

from dse.errors import DseError, fail
from dse.fmu import parallel
from dse.fmu.parallel import in_parallel


@pytest.fixture(params=[True, False], ids=["looked up", "made"], autouse=True)
def is_looked_up(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether each thing is there so soon that threads are not worth it."""
    monkeypatch.setattr(parallel, "_LONG", math.inf if request.param else 0.0)
    return bool(request.param)


def test_what_is_looked_up_needs_no_threads(is_looked_up: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    helped = threading.Event()

    def make(key: int) -> bool:
        is_here = threading.current_thread() is threading.main_thread()
        if not is_here:
            helped.set()
        elif key and not is_looked_up:
            helped.wait(10)
        return is_here

    assert {*in_parallel(range(9), make).values()} == ({True} if is_looked_up else {True, False})


def test_what_threads_cannot_be_started_for_is_made_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_room(*_arguments: object) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(parallel, "start_new_thread", no_room)
    assert in_parallel(range(3), str) == {0: "0", 1: "1", 2: "2"}


def test_everything_is_made_and_counted() -> None:
    told: list[tuple[int, int]] = []
    assert in_parallel([3, 1, 2], str, lambda made, of: told.append((made, of))) == {3: "3", 1: "1", 2: "2"}
    assert told == [(1, 3), (2, 3), (3, 3)]


def test_the_problems_of_all_are_told() -> None:
    def make(key: int) -> int:
        if key % 2:
            raise fail(f"{key} is odd")
        return key

    with pytest.raises(DseError) as caught:
        in_parallel(range(5), make)
    assert {problem.what for problem in caught.value.problems} == {"1 is odd", "3 is odd"}


def test_an_interrupt_begins_nothing_more() -> None:
    begun: list[int] = []
    go_on = threading.Event()

    def make(key: int) -> None:
        begun.append(key)
        if key:
            go_on.wait(10)

    def interrupt(_made: int, _of: int) -> None:
        threading.Timer(0.2, go_on.set).start()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        in_parallel(range(1000), make, interrupt)
    assert len(begun) < 1000
