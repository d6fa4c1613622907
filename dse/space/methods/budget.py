"""What an exact count would cost, known before it is begun."""

from __future__ import annotations

from dataclasses import dataclass


class TooMuchError(Exception):
    """Counting would take more work or memory than allowed, or a rule is not one it can count; callers estimate."""


@dataclass(frozen=True, slots=True)
class Cost:
    """An estimate: *work* in additions of one cell, of the order of 0.4 ns each, and peak *memory* in bytes."""

    work: float
    memory: float
