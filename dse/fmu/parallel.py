"""Many things built at once."""

from __future__ import annotations

import os
from _thread import start_new_thread
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import Future, wait
from contextlib import suppress
from typing import TypeVar

from dse.errors import DseError, Problem, raise_if_any

Key = TypeVar("Key")
Made = TypeVar("Made")
Tell = Callable[[int, int], None]
"""Is told how many are made, of how many."""


def in_parallel(keys: Iterable[Key], make: Callable[[Key], Made], tell: Tell | None = None) -> dict[Key, Made]:
    """What *make* makes of each of *keys*, several at a time.

    Raises one DseError with the problems of all. Interrupted, it begins nothing more.
    """
    pending: dict[Key, Future[Made]] = {key: Future() for key in keys}
    waiting = deque(pending.items())

    def work_off() -> None:
        while waiting:
            with suppress(IndexError):  # another thread has the last
                _make(*waiting.popleft(), make)

    # Not with a pool: starting a thread that finds no memory to begin with would wait for it for ever. Here all that
    # no other thread has begun is made by this one.
    for _ in range(min(os.cpu_count() or 1, len(pending)) - 1):
        with suppress(RuntimeError):  # there is no room for another
            start_new_thread(work_off, ())
    made: dict[Key, Made] = {}
    problems: list[Problem] = []
    try:
        for number, (key, future) in enumerate(pending.items(), 1):
            while waiting and not future.done():
                with suppress(IndexError):
                    _make(*waiting.popleft(), make)
            try:
                made[key] = future.result()
            except DseError as error:
                problems += error.problems
            if tell is not None:
                tell(number, len(pending))
    finally:
        waiting.clear()
        wait([future for future in pending.values() if future.running()])
    raise_if_any(dict.fromkeys(problems))
    return made


def _make(key: Key, future: Future[Made], make: Callable[[Key], Made]) -> None:
    future.set_running_or_notify_cancel()
    try:
        future.set_result(make(key))
    except BaseException as error:  # noqa: BLE001  # told to whoever asks for the result
        future.set_exception(error)
