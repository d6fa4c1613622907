"""A drive: what somebody at the wheel did in a run, step by step, so that the run can be made again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Value
from dse.domain.run import Run

OTHER = "other1."
"""What the inputs of a shared drive begin with that are the first of the other cars."""
TUNE = "tune"
"""The group of a driver in the loop's outputs that go to parameters: ``tune.<part>.<parameter>``."""


@dataclass(frozen=True, slots=True)
class Pace:
    """How well a run in real time has kept its deadlines: *steps* made, *overruns* of them too late, and how late steps
    ended in the middle and of the worst hundredth (s)."""

    steps: int
    overruns: int
    median: float
    p99: float


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """*inputs* are what the driver in the loop put out, by its port (``accelerator``, ``tune.controller.gain``), SI,
    Booleans 0/1, items by number: a value for each *time* in s, which are *step* apart and begin at 0.

    *bench* and *configuration* are names; *settings* are what the bench was given besides, by ``part.parameter``.
    *driver* is what somebody called themself: any text. A drive that ended early has fewer rows than its bench.
    """

    bench: str
    configuration: str
    driver: str
    step: float
    time: NDArray[np.float64]
    inputs: Mapping[str, NDArray[np.float64]]
    pace: Pace
    settings: Mapping[str, Value] = field(default_factory=dict)
    bits: Mapping[str, str] = field(default_factory=dict)
    """What came of it as it was driven, as `bits_of` tells; nothing where nobody noted it."""

    @property
    def is_shared(self) -> bool:
        """Whether it was driven among others, whose cars are inputs: ``other1.speed``."""
        return any(name.startswith(OTHER) for name in self.inputs)


def bits_of(run: Run) -> dict[str, str]:
    """What came of *run* to the last bit: metrics in hexadecimal digits, SHA-256 of the values of each waveform."""
    waveforms = run.waveforms.values if run.waveforms else {}
    digests = {name: sha256(np.ascontiguousarray(values, "<f8").tobytes()) for name, values in waveforms.items()}
    metrics = {f"metric {name}": float(value).hex() for name, value in run.metrics.items()}
    return {**metrics, **{f"waveform {name}": digest.hexdigest() for name, digest in digests.items()}}
