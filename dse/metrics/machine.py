"""Compiled metrics: a list of instructions over registers, small enough to be sent to every worker."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Judgement, Requirement, Verdict
from dse.errors import fail
from dse.units import Unit

Register = int
TIME: Register = 0
"""The register that holds the time."""


@dataclass(frozen=True, slots=True)
class Instruction:
    """``registers[target] = function(registers[arguments]…)``; the function is found by its name when unpickled."""

    function: Callable[..., Any]
    arguments: tuple[Register, ...]
    target: Register


@dataclass(frozen=True, slots=True)
class RequirementCheck:
    """A requirement with the registers of its metric and of the condition under which it is exercised.

    *condition_metrics* are the registers of the metrics the condition speaks of.
    """

    requirement: str
    at_most: float | None
    at_least: float | None
    metric: Register
    exercised: Register | None
    condition_metrics: tuple[Register, ...] = ()


@dataclass(frozen=True, slots=True)
class MetricProgram:
    """Metrics and requirements, compiled.

    *signals* are the waveforms and *constants* the single values that `evaluate` needs. *units* are those to show the
    metrics in; values are SI.
    """

    signals: tuple[str, ...]
    constants: tuple[str, ...]
    units: Mapping[str, Unit]
    inputs: Mapping[str, Register]
    literals: tuple[tuple[Register, float], ...]
    instructions: tuple[Instruction, ...]
    metrics: Mapping[str, Register]
    checks: tuple[RequirementCheck, ...]
    size: int

    def signals_of(self, metric: str) -> frozenset[str]:
        """The waveforms that *metric* is computed from."""
        wanted = {self.metrics[metric]}
        for instruction in reversed(self.instructions):
            if instruction.target in wanted:
                wanted.update(instruction.arguments)
        return frozenset(name for name in self.signals if self.inputs[name] in wanted)

    def evaluate(
        self,
        time: NDArray[np.float64],
        columns: Mapping[str, NDArray[np.float64]],
        constants: Mapping[str, float],
    ) -> tuple[dict[str, float], tuple[Judgement, ...]]:
        """The metrics, SI and unrounded, and a judgement for every requirement.

        *time* has n ≥ 1 rows in seconds; *columns* holds n rows for every signal and *constants* a number for
        every constant: SI, 0 and 1 for truth values, the number of an item. Raises KeyError if one is missing, DseError
        if a function fails.
        """
        registers = self.registers(time, columns, constants)
        try:
            values = {name: float(registers[register]) for name, register in self.metrics.items()}
        except (TypeError, ValueError) as error:
            raise fail(f"a metric function did not give a number: {error}") from error
        return values, self.judge(registers)

    def judge(self, registers: Sequence[Any]) -> tuple[Judgement, ...]:
        """A judgement for every requirement, from what `registers` gives."""
        return tuple([_judge(check, registers) for check in self.checks])

    def registers(
        self,
        time: NDArray[np.float64],
        columns: Mapping[str, NDArray[np.float64]],
        constants: Mapping[str, float],
    ) -> list[Any]:
        """Everything that is computed, register by register; *time*, *columns* and *constants* as for `evaluate`."""
        registers: list[Any] = [None] * self.size
        registers[TIME] = time
        for register, literal in self.literals:
            registers[register] = np.float64(literal)
        for name in self.signals:
            registers[self.inputs[name]] = columns[name]
        for name in self.constants:
            registers[self.inputs[name]] = np.float64(constants[name])
        # numpy's own numbers follow IEEE 754 where Python's would raise.
        with np.errstate(all="ignore"):
            for step in self.instructions:
                try:
                    registers[step.target] = step.function(*[registers[argument] for argument in step.arguments])
                except Exception as error:
                    raise fail(f"metric function {step.function.__name__}: {type(error).__name__}: {error}") from error
        return registers


def judge_failed(requirements: Sequence[Requirement]) -> tuple[Judgement, ...]:
    """The judgements of a run that did not come to its end."""
    return tuple(Judgement(requirement.name, Verdict.FAILED_TO_RUN, math.nan) for requirement in requirements)


def _judge(check: RequirementCheck, registers: Sequence[Any]) -> Judgement:
    value = float(registers[check.metric])
    margin = float(margin_to_bounds(value, check.at_most, check.at_least))
    verdict = VERDICTS[verdict_codes(margin, _is_exercised(check, registers, value))]
    return Judgement(check.requirement, verdict, margin)


def _is_exercised(check: RequirementCheck, registers: Sequence[Any], value: float) -> bool:
    """Whether the run came to exercise the requirement; nothing follows from an undefined metric, not even by 'not'."""
    if check.exercised is None:
        return not math.isnan(value)
    if any(math.isnan(registers[register]) for register in check.condition_metrics):
        return False
    return bool(registers[check.exercised])


Codes = NDArray[np.uint8]
"""Verdicts as their positions in `VERDICTS`."""

_N = TypeVar("_N", float, NDArray[np.float64])


def margin_to_bounds(value: _N, at_most: float | None, at_least: float | None) -> _N:
    """The distance of *value* to the nearer bound, of which there is one at least: negative outside, NaN where it is.

    An open side is no bound at infinity: an infinite time to collision would have no margin to it.
    """
    below: Any = None if at_most is None else at_most - value
    above: Any = None if at_least is None else value - at_least
    found: _N = above if below is None else below if above is None else np.minimum(below, above)
    return found


def verdict_codes(margin: Any, exercised: Any, done: Any = True) -> Any:
    """The verdict with that *margin* as its position in `VERDICTS`; all three may be arrays of runs.

    A metric that is undefined although the run exercised the requirement has not met it: no comparison with NaN holds.
    """
    return _BY_CASE[4 * done + 2 * exercised + (margin >= 0)]


def overall_codes(verdicts: Sequence[Codes], done: NDArray[np.bool_]) -> Codes:
    """The verdict on all requirements that apply: one failure fails a run, and without one a gap leaves it open."""
    least = np.full(len(done), 0 if verdicts else _RANK[_PASS], dtype=np.uint8)
    ranks = [least, *(_RANK[codes] for codes in verdicts)]
    found: Codes = np.where(done, _BY_RANK[np.maximum.reduce(ranks)], _FAILED).astype(np.uint8)
    return found


def worst_codes(codes: Codes, groups: Sequence[NDArray[np.intp]]) -> Codes:
    """The verdict on a requirement of each of *groups* of runs, by their positions: fail if one fails, else failed to
    run if one did, else pass if one passes: what is exercised at one condition only is met if it is met there. Runs to
    which it does not apply do not count."""
    if not groups:
        return codes[:0]
    ranks = _WORST[codes[np.concatenate(groups)]]
    starts = np.cumsum([0, *map(len, groups[:-1])])
    found: Codes = _BY_WORST[np.maximum.reduceat(ranks, starts)].astype(np.uint8)
    return found


_PASS, _FAIL, _OPEN, _FAILED, _NONE = (
    VERDICTS.index(verdict)
    for verdict in (
        Verdict.PASS,
        Verdict.FAIL,
        Verdict.NOT_EXERCISED,
        Verdict.FAILED_TO_RUN,
        Verdict.NOT_APPLICABLE,
    )
)
_BY_CASE = np.array([_FAILED] * 4 + [_OPEN, _OPEN, _FAIL, _PASS], dtype=np.uint8)
_BY_RANK = np.array([_NONE, _PASS, _OPEN, _FAIL, _FAILED], dtype=np.uint8)
_RANK = np.argsort(_BY_RANK).astype(np.uint8)
_BY_WORST = np.array([_NONE, _OPEN, _PASS, _FAILED, _FAIL], dtype=np.uint8)
_WORST = np.argsort(_BY_WORST).astype(np.uint8)
