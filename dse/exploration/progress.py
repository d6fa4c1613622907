"""How far an exploration has come."""

from __future__ import annotations

import time
from dataclasses import dataclass
from enum import StrEnum


class Stage(StrEnum):
    """What an exploration is at."""

    RUNS = "runs"
    WAVEFORMS = "waveforms near the boundary"
    REPEATS = "a few runs twice, to compare"
    CHECKS = "checks near the boundary"


@dataclass(frozen=True, slots=True)
class Progress:
    """*done* of *total* runs of the *stage* exist, including those of earlier sessions; *failed* of all runs failed.

    *rate* is in runs per second, the mean since the start of the stage, 0 before the first run; *left* is the time in
    seconds to the end at that rate, infinite before the first run.
    """

    stage: Stage
    done: int
    total: int
    failed: int
    rate: float

    @property
    def left(self) -> float:
        """Seconds to the end of the stage at that rate."""
        if self.done == self.total:
            return 0.0
        return (self.total - self.done) / self.rate if self.rate else float("inf")


class Meter:
    """Runs per second since the stage began."""

    def __init__(self, done: int) -> None:
        self._start, self._before = time.monotonic(), done

    def rate(self, done: int) -> float:
        """The mean rate, now that *done* runs are there."""
        seconds = time.monotonic() - self._start
        return (done - self._before) / seconds if seconds > 0 else 0.0
