"""Test benches: what a configuration is put through, what is measured and what is required of it."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum

from dse.domain.component import Component, Type, Value
from dse.domain.design import Connection, DesignSpace
from dse.domain.expression import Expression
from dse.domain.method import PLAIN, Method
from dse.domain.noise import DRAW
from dse.errors import Location
from dse.units import DIMENSIONLESS, Unit


@dataclass(frozen=True, slots=True)
class TestComponent:
    """A part of the bench that is not part of the design, with its parameter values (SI)."""

    name: str
    component: Component
    parameters: Mapping[str, Value]
    where: Location | None = None

    __test__ = False


@dataclass(frozen=True, slots=True)
class Simulation:
    """How long, how fine, by what algorithm, and what is kept. All times in seconds.

    *timeout* is how long a single run may take, *memory* how many bytes its process may hold.

    *record* names ports as ``part.port``, and bonds of the *method* as ``bonds.NAME``. The method speaks of parts and
    ports; what a configuration does not have is left out there. With *check_step* every run is made with half the step
    as well, and the difference is each metric's error bar. *tolerance* is what FMUs are told; None for their own.
    """

    stop: float
    step: float
    record: tuple[str, ...]
    record_every: float
    timeout: float = 60.0
    where: Location | None = None
    method: Method = PLAIN
    check_step: bool = False
    memory: float = 4e9
    tolerance: float | None = None

    @property
    def steps(self) -> int:
        """Number of communication steps; a run has one row more."""
        return round(self.stop / self.step)

    @property
    def stride(self) -> int:
        """Communication steps between two kept rows of a waveform."""
        return round(self.record_every / self.step)


def is_multiple(whole: float, part: float) -> bool:
    """Whether *whole* is *part* once or several times, but for rounding."""
    ratio = whole / part
    return math.isfinite(ratio) and round(ratio) >= 1 and abs(ratio - round(ratio)) <= 1e-9 * ratio


@dataclass(frozen=True, slots=True)
class Metric:
    """A number computed from a run's waveforms; of their rows *over* a window alone, in seconds, if there is one."""

    name: str
    expression: Expression
    unit: Unit = DIMENSIONLESS
    title: str = ""
    over: tuple[float, float] | None = None

    @property
    def text(self) -> str:
        """The expression, and its window."""
        if self.over is None:
            return self.expression.text
        return f"{self.expression.text} over [{self.over[0]:.15g} s, {self.over[1]:.15g} s]"


ALL_BUT_FEW = 0.95
"""The share of the draws that is to meet a requirement which states none."""


@dataclass(frozen=True, slots=True)
class Trace:
    """Where a requirement comes from, in the user's words; "" for what is not stated."""

    text: str = ""
    source: str = ""
    rationale: str = ""
    severity: str = ""


@dataclass(frozen=True, slots=True)
class Requirement:
    """*metric* at most *at_most* and at least *at_least* (SI), provided the run came to exercise it at all.

    A design meets it if it does in a share *met_in* of the draws at least, where runs are made with several. If bounds
    vary from run to run, *of* is the metric they are about, the metrics `bound_of` are the bounds, and *metric* is
    the margin, `margin_of`.
    """

    name: str
    metric: str
    at_most: float | None = None
    at_least: float | None = None
    unit: Unit = DIMENSIONLESS
    exercised_when: Expression | None = None
    title: str = ""
    where: Location | None = None
    met_in: float = ALL_BUT_FEW
    trace: Trace = Trace()
    of: str = ""


def bound_of(requirement: str, key: str) -> str:
    """The metric that is the bound *key*, ``at_most`` or ``at_least``, of *requirement* if it varies."""
    return f"{requirement}_{key}"


def margin_of(requirement: str) -> str:
    """The metric that is the margin of *requirement* if its bounds vary."""
    return f"{requirement}_margin"


@dataclass(frozen=True, slots=True)
class Figure:
    """A waveform shown against its target, in *unit*: the paper's Figure 7. *target* is a port or parameter."""

    name: str
    current: str
    target: str | None
    unit: Unit
    title: str = ""
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class Derived:
    """A parameter, by ``part.parameter``, that follows from others; an *expression* over their names."""

    name: str
    expression: Expression
    type: Type
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class TestBench:
    """Design space + test components + connections + settings + metrics + requirements.

    *derived* parameters are set in every run, in their order. *direct* connections join single ports and parameters of
    parts wherever they stand, as no file of a user can: those of a driver in the loop, that sees and tunes everything.
    """

    name: str
    design: DesignSpace
    test_components: tuple[TestComponent, ...]
    connections: tuple[Connection, ...]
    parameters: Mapping[str, Value]
    simulation: Simulation
    metrics: tuple[Metric, ...]
    requirements: tuple[Requirement, ...]
    figures: tuple[Figure, ...] = ()
    title: str = ""
    where: Location | None = None
    derived: tuple[Derived, ...] = ()
    direct: tuple[Connection, ...] = ()

    __test__ = False

    @property
    def draw(self) -> float:
        """What the seeds of its parts follow from, where a run has no draw of its own (`dse.domain.noise`)."""
        return float(self.parameters.get(DRAW, 0))


class Verdict(StrEnum):
    """Outcome of one requirement in one run."""

    PASS = "pass"  # noqa: S105  # a verdict, no password
    FAIL = "fail"
    NOT_EXERCISED = "not exercised"
    FAILED_TO_RUN = "failed to run"
    NOT_APPLICABLE = "does not apply"
    """The requirement is not one of the run's bench: it is not counted."""


VERDICTS = tuple(Verdict)
"""Verdicts by the number that stands for them in tables."""

_WORST = (Verdict.FAILED_TO_RUN, Verdict.FAIL, Verdict.NOT_EXERCISED)


def overall_verdict(verdicts: Collection[str]) -> Verdict:
    """That on all requirements: one failure fails a run, and without one a gap leaves it open. The same for arrays is
    `dse.metrics.overall_codes`."""
    if verdicts and all(each == Verdict.NOT_APPLICABLE for each in verdicts):
        return Verdict.NOT_APPLICABLE
    return next((each for each in _WORST if each in verdicts), Verdict.PASS)


@dataclass(frozen=True, slots=True)
class Judgement:
    """A verdict and by how much: *margin* in SI, positive inside the bound, NaN where the metric is undefined."""

    requirement: str
    verdict: Verdict
    margin: float
