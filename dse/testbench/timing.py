"""Whether a bench's communication step suits the parts on it."""

from __future__ import annotations

from collections.abc import Mapping

from dse.domain.bench import TestBench
from dse.domain.component import Component
from dse.domain.fmu import FmuModel
from dse.domain.method import Method
from dse.errors import Problem

_EQUAL = 1e-9
"""Relative difference up to which two times are the same."""


def sampling_problems(bench: TestBench, parts: Mapping[str, Component], method: Method) -> list[Problem]:
    """Sampled parts whose sample time is not a whole number of their steps: their own by *method*, or the bench's.

    With a coarser step they would see each input several times (and a derivative of zero), with an uneven one they
    would run up to a step late.
    """
    problems = []
    for path, component in parts.items():
        step = method.steps.get(path, bench.simulation.step)
        sample_time = component.source.sample_time if component.source is not None else None
        if sample_time is not None and not _is_multiple(sample_time, step):
            what = f"{path} ({component.name}) samples every {sample_time:g} s, no multiple of the step {step:g} s"
            hint = "choose a step of which all sample times are multiples"
            problems.append(Problem(what, bench.simulation.where, hint))
    return problems


def stepping_problems(
    bench: TestBench, parts: Mapping[str, Component], models: Mapping[str, FmuModel], method: Method
) -> list[Problem]:
    """FMUs whose step, their own by *method* or the bench's, is no whole multiple of what they can do.

    With ``check_step`` the same is asked of half the step.
    """
    problems = []
    for path, component in parts.items():
        fixed = models[component.name].fixed_step
        step = method.steps.get(path, bench.simulation.step)
        if fixed is None:
            continue
        if not _is_multiple(step, fixed):
            what = f"{path} ({component.name}) steps by {fixed:g} s, and {step:g} s is no multiple of that"
            hint = f"step: {fixed:g} s, or for this part alone steps: {{{path}: {fixed:g} s}}"
            problems.append(Problem(what, bench.simulation.where, hint))
        elif bench.simulation.check_step and not _is_multiple(step / 2, fixed):
            what = f"{path} ({component.name}) steps by {fixed:g} s, so it cannot be checked with half the step"
            problems.append(Problem(what, bench.simulation.where, "leave out check_step, or double the step"))
    return problems


def _is_multiple(step: float, fixed: float) -> bool:
    ratio = step / fixed
    return ratio >= 1 - _EQUAL and abs(ratio - round(ratio)) <= _EQUAL * ratio
