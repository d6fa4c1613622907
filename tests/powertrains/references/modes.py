"""A system whose modes are held on while their guards are positive, and logic with memory beside them."""

from __future__ import annotations

from collections.abc import Callable

from hybrid_system import Event, Vector


def guarded(modes: dict[str, bool], guards: Callable[[float, Vector], dict[str, float]]) -> list[Event]:
    """An event for each of *modes*: its guard becomes positive (then it is on) or negative (then it is off)."""

    def event(name: str) -> Event:
        sign = -1.0 if modes[name] else 1.0

        def change(time: float, state: Vector) -> None:
            modes[name] = not modes[name]

        return Event(lambda time, state: sign * guards(time, state)[name], change)

    return [event(name) for name in modes]


def crossing(value: Callable[[float, Vector], float], change: Callable[[float], None]) -> Event:
    """*value* grows through zero: *change* is called with the time."""
    return Event(value, lambda time, state: change(time))
