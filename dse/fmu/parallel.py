"""Many things built at once."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
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
    made: dict[Key, Made] = {}
    problems: list[Problem] = []
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        pending = {key: pool.submit(make, key) for key in keys}
        try:
            for number, (key, result) in enumerate(pending.items(), 1):
                try:
                    made[key] = result.result()
                except DseError as error:
                    problems += error.problems
                if tell is not None:
                    tell(number, len(pending))
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
    raise_if_any(dict.fromkeys(problems))
    return made
