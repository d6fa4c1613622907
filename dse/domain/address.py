"""What decides the result of a run, as a name: runs of one name give the same bits, whoever asks for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

NAME_BYTES = 16

_AT_ONCE = 1024

NOT_GIVEN = np.array([0x7FF8_DE5E_DE5E_DE5E], dtype="<u8").view("<f8")
"""Stands for what a run is not given in the bench's own point: a NaN that no computation gives."""


@dataclass(frozen=True, slots=True)
class Address:
    """What names the runs of one configuration.

    *key* stands for all that decides their results but the values they are given, *machine* for the arithmetic they
    were made with: runs of another key or machine have nothing to do with each other. *names* are what they are given,
    sorted, *values* what that is at the bench's own point, one float64 (little-endian) each. *places* are the positions
    in both that a value of a point goes to, by its name.
    """

    key: str
    names: tuple[str, ...]
    values: bytes
    places: Mapping[str, tuple[int, ...]]
    machine: str = ""

    @property
    def entry(self) -> str:
        """What its runs are kept under, as the name of a folder."""
        return f"{self.key}-{self.machine}"

    def names_alike(self, other: Address) -> bool:
        """Whether the same points name the same runs, wherever they were made."""
        return replace(self, machine="") == replace(other, machine="")

    def of(self, variables: Sequence[str], points: NDArray[np.float64]) -> NDArray[np.uint8]:
        """The names of runs at *points* (n, *variables*), as bytes (n, 16). KeyError for what no point may set.

        Which variables a study has does not matter: a run that is given the same values has the same name.
        """
        if not self.names:
            return np.zeros((len(points), NAME_BYTES), dtype=np.uint8)
        head = blake2b("\0".join(self.names).encode(), digest_size=NAME_BYTES)
        named, size = bytearray(), len(self.values)
        for part in np.split(points, range(_AT_ONCE, len(points), _AT_ONCE)):
            rows = np.tile(np.frombuffer(self.values, dtype="<f8"), (len(part), 1))
            for column, name in enumerate(variables):
                rows[:, list(self.places[name])] = part[:, [column]]
            content = memoryview(rows.tobytes())
            for first in range(0, len(content), size):
                run = head.copy()
                run.update(content[first : first + size])
                named += run.digest()
        return np.frombuffer(bytes(named), dtype=np.uint8).reshape(len(points), NAME_BYTES)
