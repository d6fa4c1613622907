"""Many things built at once."""

from __future__ import annotations

import os
import time
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

_LONG = 0.1
"""Seconds after which one thing was not just looked up."""


def in_parallel(keys: Iterable[Key], make: Callable[[Key], Made], tell: Tell | None = None) -> dict[Key, Made]:
    """What *make* makes of each of *keys*, several at a time.

    Raises one DseError with the problems of all. Interrupted, it begins nothing more.
    """
    pending: dict[Key, Future[Made]] = {key: Future() for key in keys}
    waiting = deque(pending.items())
    made: dict[Key, Made] = {}
    problems: list[Problem] = []
    is_helped = False

    def make_next() -> None:
        with suppress(IndexError):  # another thread has the last
            key, future = waiting.popleft()
            _make(key, future, make)

    def help_out() -> None:
        while waiting:
            make_next()

    try:
        for number, (key, future) in enumerate(pending.items(), 1):
            while waiting and not future.done():
                began = time.monotonic()
                make_next()
                # What is in the cache needs no threads.
                if not is_helped and time.monotonic() - began >= _LONG:
                    is_helped = True
                    _start(help_out, min(os.cpu_count() or 1, len(waiting) + 1) - 1)
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


def _start(help_out: Callable[[], None], helpers: int) -> None:
    # Not as a pool: starting a thread that finds no memory to begin with would wait for it for ever. What no helper
    # has begun is made without them.
    for _ in range(helpers):
        with suppress(RuntimeError):  # there is no room for another
            start_new_thread(help_out, ())


def _make(key: Key, future: Future[Made], make: Callable[[Key], Made]) -> None:
    future.set_running_or_notify_cancel()
    try:
        future.set_result(make(key))
    except BaseException as error:
        future.set_exception(error)  # told to whoever asks for the result
        if not isinstance(error, Exception):
            raise
