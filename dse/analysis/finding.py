"""A finding: a sentence, and the numbers that are in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from dse.errors import DseError


class Topic(StrEnum):
    """What a finding is about, in the order in which they are told."""

    RUNS = "runs"
    FAILURES = "share that fails"
    MET = "requirements met"
    CONDITIONS = "worst cases"
    BOX = "where they are met"
    CENTRE = "how much may change"
    SHARES = "main effects"
    TOGETHER = "total effects"
    WITHHELD = "withheld"


@dataclass(frozen=True, slots=True)
class Finding:
    """A sentence on a *topic* *about* a requirement or metric (by name); *facts* are its numbers as plain data, SI.

    *plane* are the variables that were varied where all others were held; () if none was.
    """

    topic: Topic
    about: str
    text: str
    facts: Mapping[str, Any] = field(default_factory=dict)
    plane: tuple[str, ...] = ()


class Account:
    """Findings as they are made, and what could not be said, by its reason."""

    def __init__(self, notice: Callable[[str], None] = lambda _: None) -> None:
        """*notice* is called with what is computed next: with many runs that may take a minute."""
        self._notice = notice
        self.findings: list[Finding] = []
        self._reasons: dict[tuple[str, str], list[str]] = {}

    def add(self, what: str, about: str, label: str, finding: Callable[[], Iterable[Finding]]) -> None:
        """Add what *finding* gives; or its reason why *what* is withheld *about* something called *label*."""
        self._notice(f"{what} of {label}")
        try:
            self.findings += finding()
        except DseError as error:
            reason = error.problems[0].what.removeprefix(f"{about}: ")
            hint = f" ({error.problems[0].hint})" if error.problems[0].hint else ""
            self._reasons.setdefault((what, reason + hint), []).append(label)

    def withheld(self) -> Iterator[Finding]:
        """A finding for each reason, about all it is the reason for."""
        for (what, reason), labels in self._reasons.items():
            yield Finding(Topic.WITHHELD, what, f"{what} of {', '.join(labels)}: {reason}", {"reason": reason})
