"""Whether a bench's communication step suits the parts on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from dse.domain.bench import Simulation
from dse.domain.component import Component
from dse.domain.fmu import FmuModel
from dse.errors import Problem
from dse.loading import is_multiple


def sampling_problems(simulation: Simulation, parts: Mapping[str, Component]) -> Iterator[Problem]:
    """Sampled parts whose sample time is not a whole number of their steps: their own, or the bench's.

    With a coarser step they would see each input several times (and a derivative of zero), with an uneven one they
    would run up to a step late.
    """
    for path, component in parts.items():
        step = simulation.method.steps.get(path, simulation.step)
        sample_time = component.source.sample_time if component.source is not None else None
        if sample_time is not None and not is_multiple(sample_time, step):
            what = f"{path} ({component.name}) samples every {sample_time:g} s, no multiple of the step {step:g} s"
            yield Problem(what, simulation.where, "choose a step of which all sample times are multiples")


def stepping_problems(
    simulation: Simulation, parts: Mapping[str, Component], models: Mapping[str, FmuModel]
) -> Iterator[Problem]:
    """FMUs whose step, their own or the bench's, is no whole multiple of what they can do.

    With ``check_step`` the same is asked of half the step, or of twice the step until the end.
    """
    for path, component in parts.items():
        fixed = models[component.name].fixed_step
        step = simulation.method.steps.get(path, simulation.step)
        if fixed is None:
            continue
        if not is_multiple(step, fixed):
            what = f"{path} ({component.name}) steps by {fixed:g} s, and {step:g} s is not a multiple of that"
            hint = f"step: {fixed:g} s, or for this part alone steps: {{{path}: {fixed:g} s}}"
            yield Problem(what, simulation.where, hint)
        elif simulation.check_step and not is_multiple(step / 2, fixed) and simulation.steps % 2:
            what = (
                f"{path} ({component.name}) steps by {fixed:g} s: half the step is none, and twice the step ends late"
            )
            yield Problem(what, simulation.where, "leave out check_step, or let 'stop' be an even number of steps")
