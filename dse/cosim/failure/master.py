"""Why the master itself stops a run: loops without a solution, divergence, steps that become too short, clocks."""

from __future__ import annotations

from math import isfinite, isnan

from dse.cosim.binding.calls import MOST_EVENT_ITERATIONS
from dse.cosim.failure.fmu_messages import moment
from dse.cosim.failure.run_failed import RunFailed
from dse.cosim.failure.stop_reason import StopReason
from dse.cosim.wiring.dependency import AlgebraicLoop
from dse.cosim.wiring.wiring import Wiring

OF_LOOPS = frozenset({StopReason.NOT_SOLVED, StopReason.NEARLY_SINGULAR, StopReason.NOT_SETTLED})
OF_OUTPUTS = frozenset({StopReason.DIVERGED, StopReason.STEP_TOO_SHORT, StopReason.ENDLESS_STEPS})
OF_CLOCKS = frozenset({StopReason.ENDLESS_TICKS, StopReason.BAD_INTERVAL, StopReason.BETWEEN_POINTS})


def of_loop(
    reason: StopReason, wiring: Wiring, loop: AlgebraicLoop, time: float | None, value: float = 0.0
) -> RunFailed:
    """No values were found for *loop*.

    *value* is the smallest relative residual Newton's method came to; if the loop is nearly singular, by how much of
    their size one more step would change values.
    """
    stage = "initialization" if time is None else f"the communication point {moment(time)}"
    unsolved = f"{stage} found no solution of the algebraic loop {loop.described}:"
    match reason:
        case StopReason.NOT_SOLVED:
            what = f"{unsolved} Newton's method came to a residual of {value:.3g}"
        case StopReason.NEARLY_SINGULAR:
            by = f"would change values by {value:.3g} of their size" if isfinite(value) else "has no direction"
            what = f"{unsolved} it is nearly singular, the last step of Newton's method {by}"
        case _:
            what = f"{stage} did not settle: the algebraic loop {loop.described} keeps changing"
    first = (*loop.reals, *loop.others)[0]
    return RunFailed(wiring.system.elements[first.element].name, what, time=time)


def of_output(reason: StopReason, wiring: Wiring, position: int, time: float, value: float) -> RunFailed:
    """A wired output is *value*, too large to mean anything; or asks for shorter steps than that, or more."""
    name = wiring.values[position]
    match reason:
        case StopReason.DIVERGED:
            what = (
                f"{name} diverged: it was {value:.3g} {moment(time)}, more than 2^53 times the nominal value that its "
                f"FMU declares and its first value; use shorter steps or another algorithm"
            )
        case StopReason.STEP_TOO_SHORT:
            what = f"{name} asks for steps shorter than {value:.3g} s {moment(time)}: the tolerance cannot be kept"
        case _:
            what = f"{name} asks for more than {value:.0f} steps between two communication points, {moment(time)}"
    return RunFailed(wiring.system.elements[wiring.owners[position]].name, what, time=time)


def of_clock(
    reason: StopReason, wiring: Wiring, element: int, position: int, time: float | None, value: float
) -> RunFailed:
    """The clock number *position* (-1: none) does what it may not, or *element* cannot stop where it ticks."""
    name = wiring.system.elements[element].name
    clock = wiring.clocks.label(position, wiring.system) if position >= 0 else ""
    at = "in the initialization" if time is None else moment(time)
    match reason:
        case StopReason.ENDLESS_TICKS if value:
            what = f"{clock}: what ticks with it, and what belongs to that, does not settle {at}"
        case StopReason.ENDLESS_TICKS:
            what = f"{clock} ticks more than {MOST_EVENT_ITERATIONS} times {at}"
        case StopReason.BAD_INTERVAL:
            told = "no interval" if isnan(value) else f"{value:.10g} s"
            what = f"{clock}: its FMU gives {told} for its ticks {at}"
        case _:
            why = f"{clock} ticks" if clock else "there is an event"
            what = (
                f"{name} takes only steps of one length, and {why} {moment(value)}, between two communication points; "
                f"use a step that ends there"
            )
    owner = wiring.system.elements[wiring.clocks.clocks[position].element].name if position >= 0 else name
    return RunFailed(name if reason is StopReason.BETWEEN_POINTS else owner, what, time=time)
