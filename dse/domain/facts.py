"""What an FMU was seen to do, whatever its description says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import nan

PROBE_VERSION = 4
"""Of the experiments: facts found by another version are not comparable."""


class Answer(StrEnum):
    """The outcome of an experiment."""

    YES = "yes"
    NO = "no"
    UNKNOWN = "unknown"
    """Not tried, as the FMU does not offer it or does not even run; or tried without a clear outcome."""


class Question(StrEnum):
    """What is asked of an FMU. Equal means: all outputs at all communication points, bit for bit."""

    RUNS = "runs"
    """Does a simulation over the default experiment come to its end?"""
    REPEATS = "repeats"
    """Do two processes give equal outputs?"""
    RESETS = "resets"
    """Is an instance that ran and was reset equal to a fresh one?"""
    RENEWS = "renews"
    """Is a second instance in the same process, made after the first was freed, equal to the first?"""
    COEXISTS = "coexists"
    """Are two instances that step in turns equal to one alone?"""
    SAVES = "saves"
    """Does a state that was saved and restored lead to equal outputs again?"""
    SERIALIZES = "serializes"
    """And one that was turned into bytes in between?"""
    VARIES_STEP = "varies step"
    """Does it take steps of uneven length?"""
    THREADS = "threads"
    """Are two instances that run at the same time in two threads each equal to one alone?"""
    FEEDS_THROUGH = "feeds through"
    """Do outputs follow inputs without a step?"""
    LASTS = "lasts"
    """Could as many instances as were tried be made one after the other in one process?"""
    RELOADS = "reloads"
    """Could its library be loaded and unloaded as often as was tried?"""


@dataclass(frozen=True, slots=True)
class FmuFacts:
    """Answers of the experiments on one FMU, on one platform.

    *reasons* say why an answer is NO or UNKNOWN, by question. *steps* of *step* seconds were made in every run;
    *drive* is the part of the usual variation that inputs had, 0.0 if they were held at their start values.
    *instances* were made one after the other and *loads* of the library; where the answer to LASTS or RELOADS is NO it
    died of the next one. *step_cost* is wall time per communication step in seconds, *run_growth* how many bytes the
    process grew per run on a fresh instance; both NaN if not measured. *memory* is the resident size in bytes one
    instance added.
    """

    content_hash: str
    platform: str
    identifier: str
    version: int
    interface: str
    answers: Mapping[Question, Answer] = field(default_factory=dict)
    reasons: Mapping[Question, str] = field(default_factory=dict)
    step: float = nan
    steps: int = 0
    drive: float = nan
    step_cost: float = nan
    memory: float = nan
    run_growth: float = nan
    instances: int = 0
    loads: int = 0

    def answer(self, question: Question) -> Answer:
        """The answer to *question*; UNKNOWN if it was not asked."""
        return self.answers.get(question, Answer.UNKNOWN)

    def denies(self, question: Question) -> bool:
        """Whether the answer is known to be no."""
        return self.answer(question) is Answer.NO

    @property
    def most_instances(self) -> int | None:
        """How many instances may be made in one process; None if no limit was found."""
        return max(1, self.instances) if self.denies(Question.LASTS) else None


# What changes how exactly an FMU computes, as was seen: what an error bar can be made of, or why it cannot.


class Lever(StrEnum):
    """What an FMU's outputs answer to, so that its own error shows."""

    STEP = "shorter steps"
    DOUBLED = "longer steps"
    TOLERANCE = "tolerance"
    EXCHANGE = "model exchange"


@dataclass(frozen=True, slots=True)
class FmuNumerics:
    """What was seen of an FMU that makes steps of *step* seconds, or what is told of it.

    *changes* says by how much outputs change with each lever that settles, on average over time and relative to their
    range: what is left of the FMU's own error. *divisor* is what the step is divided by for that, 0 without that lever;
    *tolerance* what it is told, of either interface. *inner_step* is about the step it makes inside whatever it is
    asked for (seconds), *floor* what outputs still change by between the two shortest steps that were tried; both NaN
    if there is none. *exact* tells why it has no error of its own; *unknown*, why nobody can say how large that is. If
    there is neither a lever nor one of these, no experiment was needed.
    """

    step: float
    changes: Mapping[Lever, float] = field(default_factory=dict)
    divisor: int = 0
    tolerance: float = 0.0
    inner_step: float = nan
    floor: float = nan
    exact: str = ""
    unknown: str = ""
    shows_coupled: bool = False
