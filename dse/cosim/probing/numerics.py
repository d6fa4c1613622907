"""How exact an FMU is by itself: what its outputs answer to, and what follows from that."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import inf, isfinite, nan

from dse.cosim.probing.child import Experiment, ExperimentOutcome, ProbeLimits, attempt
from dse.cosim.probing.convergence import Settling
from dse.cosim.probing.excitation import Excitation, driven, excitation_of
from dse.cosim.probing.refinement import (
    digest_of_run,
    exchanged,
    forgets,
    longer_steps,
    shorter_steps,
    tighter,
    tighter_tolerances,
)
from dse.domain.facts import FmuNumerics, Lever
from dse.domain.fmu import FmuModel
from dse.domain.system import Conversion, Element

_HALVINGS, _MOST_HALVINGS = 8, 12
_STEPS, _FEW_STEPS = 1024, 64
_STRENGTHS = (1.0, 0.05, 0.0)
_VOUCHING = "; if it is right, set 'sampled: TIME' or 'exact: true' in its source"


def probe_numerics(
    element: Element,
    times: tuple[float, float] | None = None,
    *,
    exchange: FmuModel | None = None,
    is_ours: bool = False,
    limits: ProbeLimits | None = None,
    sandboxed: bool = False,
) -> FmuNumerics:
    """What makes *element* more exact than it is. Takes a second or two; never raises for what an FMU does.

    *times* are its step and when to stop, in seconds; without, they are those of its default experiment. Its start
    values hold; connected inputs are given one of the usual variation. *exchange* is the same FMU for model exchange,
    if *element* is for co-simulation and it has both. One that *is_ours* is made of a step function without hidden
    steps, by its contract: what nothing changes is exact.
    """
    drive = excitation_of(element.model)
    step, stop = times or (drive.step, drive.stop)
    return _Numerics(element, step, stop, exchange, is_ours, limits or ProbeLimits(), sandboxed).found()


@dataclass(frozen=True, slots=True)
class _Numerics:
    element: Element
    step: float
    stop: float
    exchange: FmuModel | None
    is_ours: bool
    limits: ProbeLimits
    sandboxed: bool

    def found(self) -> FmuNumerics:
        steps = max(1, min(_STEPS, round(self.stop / self.step)))
        for strength in _STRENGTHS if driven(self.element.model) else _STRENGTHS[-1:]:
            element = _driven(self.element, Excitation(self.step, steps, strength, seed=1))
            outcome = self._attempt(shorter_steps, element, self.step, steps, _HALVINGS)
            if not outcome.failure or outcome.hung:
                break  # waiting once is enough
        if outcome.failure:
            return FmuNumerics(self.step, unknown=f"by itself it {_failure_text(outcome.failure)}")
        digests, by_step, grid, is_moving = outcome.result
        by_step = Settling(*by_step)
        if digests[0] != digests[1]:
            return FmuNumerics(self.step, unknown="its outputs depend on what was simulated before in its process")
        if not self.is_ours and (why := self._other_process(element, steps, digests[0])):
            return FmuNumerics(self.step, unknown=why)
        if not by_step.settles:
            deeper = self._attempt(shorter_steps, element, self.step, min(steps, _FEW_STEPS), _MOST_HALVINGS)
            if not deeper.failure:
                _, more, finer_grid, _ = deeper.result
                finer = Settling(*more)
                by_step = finer if finer.settles or not by_step.reacts else by_step
                grid = min(grid, finer_grid)
        return self._judged(element, steps, by_step, grid, is_moving=is_moving)

    def _judged(self, element: Element, steps: int, by_step: Settling, grid: float, *, is_moving: bool) -> FmuNumerics:
        changes: dict[Lever, float] = {}
        divisor, told = 0, 0.0
        if by_step.settles:
            changes[Lever.STEP], divisor = by_step.change, 2**by_step.at
        told_other = self._attempt(tighter_tolerances, element, self.step, steps)
        if not told_other.failure:
            tolerance = Settling(*told_other.result)
            if tolerance.settles:
                changes[Lever.TOLERANCE] = tolerance.change
                told = tighter(element.model)[tolerance.at - 1]
        if self.exchange is not None and not _is_discrete(self.exchange):
            apart = self._attempt(exchanged, element, self.exchange, self.step, steps)
            if not apart.failure and apart.result is not None:
                changes[Lever.EXCHANGE] = apart.result
                told = min(told or 1.0, tighter(self.exchange)[0])
        inner = by_step.place > 0 and by_step.reacts
        found = FmuNumerics(
            self.step,
            changes,
            divisor,
            told,
            inner_step=grid if isfinite(grid) else self.step / 2**by_step.place if inner else nan,
            floor=by_step.last if by_step.reacts else nan,
        )
        if changes:
            return found
        if why := self._exact(by_step, grid, is_moving=is_moving):
            return replace(found, exact=why)
        # What samples sees a longer step, too: as if it were late, not as an error.
        if not self.step * 1.01 < grid < inf:
            longer = self._attempt(longer_steps, element, self.step, steps)
            if not longer.failure and longer.result is not None:
                return replace(found, changes={Lever.DOUBLED: longer.result})
        unknown = self._unknown(found, by_step, grid, is_moving=is_moving)
        shows_coupled = not isfinite(grid) and (by_step.reacts or not is_moving)
        return replace(found, unknown=unknown if self.is_ours else unknown + _VOUCHING, shows_coupled=shows_coupled)

    def _exact(self, by_step: Settling, grid: float, *, is_moving: bool) -> str:
        model = self.element.model
        if _is_discrete(model if self.exchange is None else self.exchange):
            return "it has no continuous states"
        # Some tools call everything discrete: that outputs stand still between samples has to be seen as well.
        if isfinite(grid) and all(v.kind is None or v.variability == "discrete" for v in self.element.outputs):
            return f"its outputs are discrete, and change every {grid:.3g} s"
        if not by_step.reacts and self.is_ours and not isfinite(grid):
            return "no step makes it compute anything else"
        if not by_step.reacts and not is_moving and driven(model):
            outcome = self._attempt(forgets, self.step)
            if not outcome.failure and outcome.result:
                return "its outputs follow from its inputs alone"
        return ""

    def _unknown(self, found: FmuNumerics, by_step: Settling, grid: float, *, is_moving: bool) -> str:
        if isfinite(grid):
            return f"it makes steps of about {grid:.3g} s inside, whatever it is asked for"
        if by_step.reacts:
            return f"its outputs change by {found.floor:.1g} of their range with each shorter step, and do not settle"
        if not is_moving:
            return "its outputs do not move by themselves, so that nothing shows how it computes them"
        return "neither other steps nor another tolerance make it compute anything else"

    def _other_process(self, element: Element, steps: int, digest: bytes) -> str:
        ended = int(time.time())
        while int(time.time()) == ended:  # a clock that was read before may count seconds
            time.sleep(0.05)
        outcome = self._attempt(digest_of_run, element, self.step, steps)
        if outcome.failure:
            return f"in another process it {_failure_text(outcome.failure)}"
        return "" if outcome.result == digest else "its outputs differ from one process to another: by time or chance"

    def _attempt(self, experiment: Experiment, *arguments: object) -> ExperimentOutcome:
        given = (self.element.model, *arguments) if experiment is forgets else arguments
        return attempt(experiment, *given, limits=self.limits, sandboxed=self.sandboxed)


def _is_discrete(model: FmuModel) -> bool:
    return model.exchange is not None and not model.exchange.n_states


def _driven(element: Element, drive: Excitation) -> Element:
    """*element* with its inputs at what *drive* begins with, those that nothing else has set."""
    given = drive.inputs(element.model, 0)
    start = dict(element.start)
    for variable in element.inputs or driven(element.model):
        conversion = element.conversions.get(variable.name, Conversion())
        if not conversion.items:
            start |= {
                label: conversion.factor * given[label] + conversion.offset
                for label in variable.labels
                if label in given and (element.inputs or label not in start)
            }
    return replace(element, start=start)


def _failure_text(failure: str) -> str:
    return f"fails: {failure}"
