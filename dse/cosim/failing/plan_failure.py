"""Why the master itself stopped a run: loops without a solution, divergence, steps that became too short."""

from __future__ import annotations

from enum import IntEnum
from math import isfinite

from dse.cosim.failing.failure import RunFailed, moment
from dse.cosim.wiring.dependency import Loop
from dse.cosim.wiring.wiring import Wiring

MISLED = 20
"""The kernel stopped because FMUs' dependencies are not true, and it has no order that does without them yet."""


class Kind(IntEnum):
    """Why the kernel stopped, numbered as in kernel.h."""

    NOT_SETTLED = 3
    NOT_SOLVED = 16
    DIVERGED = 17
    STEP_TOO_SHORT = 18
    NEARLY_SINGULAR = 19
    ENDLESS_STEPS = 21


def not_solved(wiring: Wiring, loop: Loop, residual: float, time: float | None) -> RunFailed:
    """Newton's method found no values for *loop*; *residual* is the smallest relative one it came to."""
    what = (
        f"{_stage(time)} found no solution of the algebraic loop {loop.described}: "
        f"Newton's method came to a residual of {residual:.3g}"
    )
    return RunFailed(_first(wiring, loop), "", time, (), what)


def nearly_singular(wiring: Wiring, loop: Loop, left: float, time: float | None) -> RunFailed:
    """All kinds of values solve *loop* nearly; one more step of Newton's method would change them by *left*."""
    by = f"would change values by {left:.3g} of their size" if isfinite(left) else "has no direction"
    what = (
        f"{_stage(time)} found no solution of the algebraic loop {loop.described}: it is nearly singular, "
        f"the last step of Newton's method {by}"
    )
    return RunFailed(_first(wiring, loop), "", time, (), what)


def not_settled(wiring: Wiring, loop: Loop, time: float | None) -> RunFailed:
    """What is discrete in *loop* went on changing."""
    what = f"{_stage(time)} did not settle: the algebraic loop {loop.described} goes on changing"
    return RunFailed(_first(wiring, loop), "", time, (), what)


def diverged(wiring: Wiring, position: int, value: float, time: float) -> RunFailed:
    """A wired output has left the range in which it can mean anything."""
    name = wiring.values[position]
    what = (
        f"{name} diverged: it was {value:.3g} {moment(time)}, more than 2^53 times the nominal value that its FMU "
        f"declares and its first value; use shorter steps or another algorithm"
    )
    return RunFailed(_element(wiring, name), "", time, (), what)


def too_short(wiring: Wiring, position: int, step: float, time: float) -> RunFailed:
    """Error control asks for a step that is not allowed."""
    name = wiring.values[position]
    what = f"{name} asks for steps shorter than {step:.3g} s {moment(time)}: the tolerance cannot be kept"
    return RunFailed(_element(wiring, name), "", time, (), what)


def too_many(wiring: Wiring, position: int, steps: float, time: float) -> RunFailed:
    """Error control gets on, but takes for ever."""
    name = wiring.values[position]
    what = f"{name} asks for more than {steps:.0f} steps between two communication points, {moment(time)}"
    return RunFailed(_element(wiring, name), "", time, (), what)


def _stage(time: float | None) -> str:
    return "initialization" if time is None else f"the communication point {moment(time)}"


def _first(wiring: Wiring, loop: Loop) -> str:
    return wiring.system.elements[(*loop.reals, *loop.others)[0].element].name


def _element(wiring: Wiring, label: str) -> str:
    return max((e.name for e in wiring.system.elements if label.startswith(f"{e.name}.")), key=len)
