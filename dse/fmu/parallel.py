"""Many things built at once."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
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
    made: dict[Key, Made] = {}
    problems: list[Problem] = []
    waiting = list(dict.fromkeys(keys))
    number = len(waiting)

    def end(key: Key, result: Callable[[], Made]) -> None:
        try:
            made[key] = result()
        except DseError as error:
            problems.extend(error.problems)
        if tell is not None:
            tell(number - len(waiting), number)

    # What is in the cache needs no threads.
    took = 0.0
    while waiting and took < _LONG:
        began = time.monotonic()
        key = waiting.pop(0)
        end(key, partial(make, key))
        took = time.monotonic() - began
    if waiting:
        with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
            pending = {key: pool.submit(make, key) for key in waiting}
            try:
                for key, result in pending.items():
                    waiting.remove(key)
                    end(key, result.result)
            finally:
                pool.shutdown(wait=False, cancel_futures=True)
    raise_if_any(dict.fromkeys(problems))
    return made
