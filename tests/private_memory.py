"""Memory that is kept: a leak keeps some every time, whatever else a long test process allocates only now and then."""

from __future__ import annotations

import gc
from collections.abc import Callable

import psutil


def keeps(use: Callable[[], object], least: int) -> bool:
    """Whether each of four uses leaves ``least`` bytes or more behind.

    Counted is what the process has reserved for itself (Linux): the system takes idle pages away and gives them back
    when it likes, so that resident memory grows and shrinks without anybody's doing.
    """
    for _ in range(4):
        before = psutil.Process().memory_info().data
        use()
        gc.collect()
        if psutil.Process().memory_info().data - before < least:
            return False
    return True
