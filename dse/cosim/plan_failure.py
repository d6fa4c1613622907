"""Why the master itself stopped a run: loops without a solution, divergence, steps that became too short."""

from __future__ import annotations

from enum import IntEnum

from dse.cosim.dependency import Loop
from dse.cosim.failure import RunFailed, moment
from dse.cosim.wiring import Wiring


class Kind(IntEnum):
    """Why the kernel stopped, numbered as in kernel.h."""

    NOT_SETTLED = 3
    NOT_SOLVED = 16
    DIVERGED = 17
    STEP_TOO_SHORT = 18


def not_solved(wiring: Wiring, loop: Loop, residual: float, time: float | None) -> RunFailed:
    """Newton's method found no values for *loop*; *residual* is the smallest relative one it came to."""
    what = (
        f"{_stage(time)} found no solution of the algebraic loop {loop.described}: "
        f"Newton's method came to a residual of {residual:.3g}"
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
        f"{name} diverged: it was {value:.3g} {moment(time)}, more than 2^53 times its nominal and its first value; "
        f"use shorter steps, another algorithm, or give the variable its nominal value"
    )
    return RunFailed(_element(wiring, name), "", time, (), what)


def too_short(wiring: Wiring, position: int, step: float, time: float) -> RunFailed:
    """Error control asks for a step that is not allowed."""
    name = wiring.values[position]
    what = f"{name} asks for steps shorter than {step:.3g} s {moment(time)}: the tolerance cannot be kept"
    return RunFailed(_element(wiring, name), "", time, (), what)


def _stage(time: float | None) -> str:
    return "initialization" if time is None else f"the communication point {moment(time)}"


def _first(wiring: Wiring, loop: Loop) -> str:
    return wiring.system.elements[(*loop.reals, *loop.others)[0].element].name


def _element(wiring: Wiring, label: str) -> str:
    return max((e.name for e in wiring.system.elements if label.startswith(f"{e.name}.")), key=len)
