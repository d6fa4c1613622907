"""Numbers as the page carries them: typed arrays in one compressed block, waveforms as 16-bit steps."""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from dse.report.content.data import Floats

STEPS = 65534
"""Steps between a waveform's smallest and largest value; code 65535 is a missing value."""
MISSING = 65535

_EFFORT = 7
"""Of zlib. 9 makes waveforms smaller by 3 % and takes four times as long."""

_TYPES = {"f8": "<f8", "f4": "<f4", "i4": "<i4", "u2": "<u2", "u1": "|u1"}


@dataclass(slots=True)
class Block:
    """Typed arrays gathered one after the other, to be compressed as one.

    Each array is stored as the first bytes of all its numbers, then the second bytes and so on: neighbours in a
    design resemble each other, and their bytes compress several times better apart than mixed.
    """

    directory: list[dict[str, str | int]] = field(default_factory=list)
    parts: list[bytes] = field(default_factory=list)

    def add(self, name: str, kind: str, values: NDArray[np.generic]) -> None:
        """Append *values* as *kind* (``f8 f4 i4 u2 u1``) under *name*."""
        flat = np.ascontiguousarray(values, dtype=_TYPES[kind]).reshape(-1)
        self.directory.append({"name": name, "kind": kind, "length": int(flat.size)})
        self.parts.append(flat.view(np.uint8).reshape(-1, flat.itemsize).T.tobytes())

    def text(self) -> str:
        """Everything added, as zlib data in base64; the same arrays give the same text (no clock, no name inside)."""
        return packed_text(b"".join(self.parts), _EFFORT)


def packed_text(content: bytes, effort: int = 9) -> str:
    """*content* as zlib data in base64; *effort* is zlib's."""
    return base64.b64encode(zlib.compress(content, effort)).decode("ascii")


@dataclass(frozen=True, slots=True, eq=False)
class Quantised:
    """Waveforms in steps of their own range: ``low + (high - low) * code / STEPS``, low and high per row."""

    low: Floats
    high: Floats
    codes: NDArray[np.uint16]
    error: float
    """Largest absolute difference from the waveforms given."""


def quantise(waveforms: NDArray[np.floating]) -> Quantised:
    """*waveforms* (n, n_t) in 16 bits each; every row has its own range, so that one wild run spoils no other."""
    exact = waveforms.astype(np.float64)
    finite = np.isfinite(exact)
    low = np.min(exact, axis=1, initial=np.inf, where=finite)
    high = np.max(exact, axis=1, initial=-np.inf, where=finite)
    empty = ~finite.any(axis=1)
    low[empty] = high[empty] = 0.0
    span = np.where(high > low, high - low, 1.0)
    position = (np.where(finite, exact, low[:, None]) - low[:, None]) / span[:, None]
    codes = np.round(position * STEPS).astype(np.uint16)
    codes[~finite] = MISSING
    restored = low[:, None] + (high - low)[:, None] * (codes / STEPS)
    error = np.max(np.abs(restored - exact), initial=0.0, where=finite)
    return Quantised(low, high, codes, float(error))


def second_differences(codes: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Second differences along each row, modulo 2^16, as 0, -1, 1, -2, 2, …: smooth waveforms become small numbers.

    Their first bytes are all 0 then, which compresses.
    """
    first = np.diff(codes, axis=1, prepend=np.uint16(0)).astype(np.uint16)
    signed = np.diff(first, axis=1, prepend=np.uint16(0)).astype(np.int16)
    return ((signed << 1) ^ (signed >> 15)).view(np.uint16)
