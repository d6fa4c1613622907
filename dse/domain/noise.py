"""Random numbers of a run: all streams of noise follow from one number, the *draw*.

Each parameter that a component declares as ``random`` is the seed of a stream. A run gives it a hash of its draw and of
the place of the part, so that streams of two parts are independent, even if both are of one component. The draw of a
run of a study with replicates is a hash of the study's seed and of the case (its conditions and uncertain values), and
the replicate: replicates and cases are independent, and all designs meet the same draws. With ``seed: 1``, replicate 3
of a case might have the draw 5824190770003, and then

    sensors.first.seed  = blake2b("5824190770003 sensors.first.seed")  mod 2^31
    sensors.second.seed = blake2b("5824190770003 sensors.second.seed") mod 2^31
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import blake2b

DRAW = "draw"
"""What a run's draw is called among its parameters; 0 where nothing says otherwise."""

MOST_REPLICATES = 10_000
"""A draw is a hash times this, plus the replicate."""

HIGHEST_DRAW = 2.0**30 * MOST_REPLICATES
"""One more than the largest draw; each is exact as a float."""

MOST_SEED = 2**31 - 1
"""The largest seed of a parameter without an upper bound."""


@dataclass(frozen=True, slots=True)
class NoiseStream:
    """The seed of a part, *name* as ``part.parameter``, which takes whole numbers from *low* to *high*."""

    name: str
    low: int = 0
    high: int = MOST_SEED

    def seed(self, draw: float) -> int:
        """The seed in a run of this *draw*."""
        return self.low + _hash(f"{int(draw)} {self.name}".encode()) % (self.high - self.low + 1)


def draw_of(seed: int, case: Sequence[float], replicate: int) -> float:
    """The draw of a *replicate*, from 0, of a study with this *seed* in a *case*: values (SI) in the study's order."""
    key = struct.pack(f"<{len(case)}d", *(value + 0.0 for value in case))  # -0.0 is 0
    return float((1 + _hash(f"{seed} ".encode() + key) % (2**30 - 1)) * MOST_REPLICATES + replicate)


def replicate_of(draw: float) -> int:
    """The replicate of a *draw* of a study, from 0."""
    return int(draw) % MOST_REPLICATES


def _hash(data: bytes) -> int:
    return int.from_bytes(blake2b(data, digest_size=8).digest(), "little")
