"""Work beside a test, which ends with it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import ParamSpec, TypeVar

LIMIT = 120.0
"""Seconds after which a test that waits gives up: only a test that hangs waits so long, on however busy a machine."""

P = ParamSpec("P")
R = TypeVar("R")


@contextmanager
def in_background(work: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> Iterator[Future[R]]:
    """*work* runs in a thread meanwhile. Afterwards it is over; what it raises, the test raises."""
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(work, *args, **kwargs)
        yield running
    running.result()
