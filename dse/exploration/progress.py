"""How far an exploration has come."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from enum import StrEnum

_WINDOW = 5.0


class Stage(StrEnum):
    """What an exploration is at."""

    RUNS = "runs"
    WAVEFORMS = "waveforms near the boundary"
    CHECKS = "checks near the boundary"


@dataclass(frozen=True, slots=True)
class Progress:
    """*done* of *total* runs of the stage are there, those of earlier sessions among them; *failed* of all runs failed.

    *rate* is in runs per second over the last seconds, 0 before the first; *left* is the seconds to the end at that
    rate, infinite before the first run.
    """

    stage: Stage
    done: int
    total: int
    failed: int
    rate: float

    @property
    def left(self) -> float:
        """Seconds to the end of the stage at the present rate."""
        if self.done == self.total:
            return 0.0
        return (self.total - self.done) / self.rate if self.rate else float("inf")


class Meter:
    """Runs per second over the last five seconds."""

    def __init__(self, done: int) -> None:
        self._marks = deque([(time.monotonic(), done)])

    def rate(self, done: int) -> float:
        """The rate, now that *done* runs are there."""
        now = time.monotonic()
        self._marks.append((now, done))
        while len(self._marks) > 2 and now - self._marks[1][0] > _WINDOW:
            self._marks.popleft()
        start, before = self._marks[0]
        return (done - before) / (now - start) if now > start else 0.0
