"""Whether a bench's communication step suits the parts on it."""

from __future__ import annotations

from collections.abc import Mapping

from dse.domain.bench import TestBench
from dse.domain.component import Component, CSource
from dse.domain.fmu import FmuModel
from dse.errors import Problem

_EQUAL = 1e-9
"""Relative difference up to which two times are the same."""


def sampling_problems(bench: TestBench, parts: Mapping[str, Component]) -> list[Problem]:
    """Sampled parts whose sample time is not a whole number of the bench's steps.

    With a coarser step they would see each input several times (and a derivative of zero), with an uneven one they
    would run up to a step late.
    """
    step, problems = bench.simulation.step, []
    for path, component in parts.items():
        source = component.source
        if not isinstance(source, CSource) or source.step is None:
            continue
        ratio = source.step / step
        if ratio < 1 - _EQUAL or abs(ratio - round(ratio)) > _EQUAL * ratio:
            what = f"{path} ({component.name}) samples every {source.step:g} s, no multiple of the step {step:g} s"
            hint = "choose a step of which all sample times are multiples"
            problems.append(Problem(what, bench.simulation.where, hint))
    return problems


def stepping_problems(
    bench: TestBench, parts: Mapping[str, Component], models: Mapping[str, FmuModel]
) -> list[Problem]:
    """FMUs that can only step by another step than the bench's."""
    step, problems = bench.simulation.step, []
    for path, component in parts.items():
        fixed = models[component.name].fixed_step
        if fixed is not None and abs(fixed - step) > _EQUAL * step:
            what = f"{path} ({component.name}) can only step by {fixed:g} s, the bench steps by {step:g} s"
            problems.append(Problem(what, bench.simulation.where, f"step: {fixed:g} s"))
    return problems
