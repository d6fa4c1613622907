"""What is asked of the other side, and how it fared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Check:
    """*is_right* is None if it could not be tried; *said* are words for the author, "" if there is nothing to say."""

    name: str
    is_right: bool | None
    said: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Latencies:
    """Seconds from requests to their answers, of requests that were sent once; *duration* is of all exchanges."""

    seconds: tuple[float, ...]
    resent: int
    duration: float

    def quantile(self, share: float) -> float:
        """The least that *share* of the exchanges did not surpass; NaN without exchanges."""
        ordered = sorted(self.seconds)
        return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else float("nan")


@dataclass(frozen=True, slots=True)
class Checked:
    """All checks in order; *ignored* counts datagrams that belonged nowhere, *steps* those of a client."""

    checks: tuple[Check, ...]
    latencies: Latencies
    ignored: int = 0
    steps: int = 0

    @property
    def is_right(self) -> bool:
        """Whether nothing is wrong and everything was tried."""
        return all(check.is_right for check in self.checks)


@dataclass(slots=True)
class Findings:
    """Checks while they are made: what was seen to be right, and what was wrong how often, first at which sequence."""

    names: Sequence[str]
    _right: set[str] = field(default_factory=set)
    _wrong: dict[str, dict[str, list[int]]] = field(default_factory=dict)

    def right(self, name: str) -> None:
        """Seen to be right, at least once."""
        self._right.add(name)

    def wrong(self, name: str, said: str, sequence: int) -> None:
        """Seen to be wrong."""
        self._wrong.setdefault(name, {}).setdefault(said, []).append(sequence)

    def judge(self, name: str, said: str, sequence: int) -> None:
        """Wrong if something is *said*, else right."""
        if said:
            self.wrong(name, said, sequence)
        else:
            self.right(name)

    def listed(self) -> tuple[Check, ...]:
        """A check for each name."""
        return tuple(self._check(name) for name in self.names)

    def _check(self, name: str) -> Check:
        told = self._wrong.get(name)
        if told is None:
            return Check(name, True if name in self._right else None)
        return Check(name, False, tuple(_counted(said, places) for said, places in told.items()))


def _counted(said: str, places: list[int]) -> str:
    if places == [0]:
        return said
    times = f"{len(places)} times, first " if len(places) > 1 else ""
    return f"{said} ({times}at sequence {places[0]})"
