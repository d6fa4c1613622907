"""Integration of systems with events, segment by segment: DOP853 up to the first event, then the mode changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Event:
    """*value(t, y)* grows through zero; then *change(t, y)* sets the new mode."""

    value: Callable[[float, Vector], float]
    change: Callable[[float, Vector], None]


class System(Protocol):
    """What `integrate` needs. `events` are those of the current mode."""

    def derivative(self, time: float, state: Vector) -> Sequence[float]: ...
    def events(self) -> Sequence[Event]: ...


@dataclass(frozen=True)
class Solution:
    """*states[i]* at *times[i]*; *events*: the times of all mode changes."""

    times: Vector
    states: Vector
    events: tuple[float, ...]


def integrate(system: System, state: Sequence[float], times: Vector, tolerance: float, longest: float) -> Solution:
    """States at *times* (rising, from the first). *longest* step in s: what comes and goes within one is missed."""
    rows, switched = [np.array(state, dtype=float)], []
    now, y, end = float(times[0]), np.array(state, dtype=float), float(times[-1])
    while len(rows) < len(times):
        events = list(system.events())
        due = next((event for event in events if event.value(now, y) > _MARGIN), None)
        if due is None:
            solved = solve_ivp(
                system.derivative, (now, end), y, "DOP853", dense_output=True, events=[_terminal(e) for e in events],
                rtol=tolerance, atol=tolerance, max_step=longest,
            )  # fmt: skip
            assert solved.success, solved.message
            dense, found_events = solved.sol, solved.t_events
            assert dense is not None
            assert found_events is not None
            now, y = float(solved.t[-1]), solved.y[:, -1]
            while len(rows) < len(times) and (times[len(rows)] <= now or solved.status == 0):
                rows.append(dense(times[len(rows)]))
            hits = [event for event, found in zip(events, found_events, strict=True) if len(found)]
            due = hits[0] if hits else None
        if due is not None:
            due.change(now, y)
            switched.append(now)
            assert len(switched) < 2_000, f"the reference chatters at {now}"
    return Solution(times, np.array(rows), tuple(switched))


_MARGIN = 1e-9
"""An event happens this far beyond zero, so that rounding does not undo it."""


def _terminal(event: Event) -> Callable[[float, Vector], float]:
    def value(time: float, state: Vector) -> float:
        return event.value(time, state) - _MARGIN

    value.terminal, value.direction = True, 1  # type: ignore[attr-defined]
    return value
