"""One simulation of one configuration at one parameter point, and what came of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import Judgement
from dse.domain.component import Value

ERROR_BAR = ".error"
"""What a metric's name ends in that is another's error bar: how much that one changes where the numerics do."""

VERDICTS_UNDER = ".verdicts"
"""What a requirement's name ends in, among the numbers of a run that was repeated for error bars: the verdicts that the
repetitions gave, as a sum of 2^position in `VERDICTS`; 0 where none can tell."""

TESTBENCH = "testbench"
"""The condition that says which of a study's benches a run is made on."""


class Outcome(StrEnum):
    """Whether a run came to its end."""

    DONE = "done"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class RunRequest:
    """A run that is to be made; *point* holds what differs from the bench, by ``part.parameter`` (SI)."""

    number: int
    configuration: str
    point: Mapping[str, Value]

    def __reduce__(self) -> tuple[type[RunRequest], tuple[int, str, Mapping[str, Value]]]:
        # A study sends millions of them to workers; what a frozen dataclass does by itself takes twice as long.
        return RunRequest, (self.number, self.configuration, self.point)


@dataclass(frozen=True, slots=True, eq=False)
class Waveforms:
    """Recorded variables over time: *time* has n rows in seconds, every array in *values* has n rows, SI."""

    time: NDArray[np.float64]
    values: Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Run:
    """The result of one request. A failed run has a *problem* that names the component, and no metrics."""

    request: RunRequest
    outcome: Outcome
    metrics: Mapping[str, float] = field(default_factory=dict)
    judgements: tuple[Judgement, ...] = ()
    problem: str = ""
    waveforms: Waveforms | None = None
