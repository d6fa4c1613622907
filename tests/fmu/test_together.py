"""Things built at once: all problems are told, and an interrupt begins nothing more."""

from __future__ import annotations

import threading

import pytest

from dse.errors import DseError, fail
from dse.fmu.parallel import in_parallel


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
