"""How often each alternative occurs among the valid configurations; which are dead, and which choices are forced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from math import hypot

import numpy as np

from dse.space.flat import by_path, single
from dse.space.lowering.shape import VariableValue
from dse.space.methods.engine import Engine
from dse.space.methods.mdd.diagram import occurrences as times_taken


@dataclass(frozen=True, slots=True)
class Occurrence:
    """The share of valid configurations with *choice* at *path*, None for left out, and its 95 % half-width.

    *dead*: in none. *forced*: in all. Both are proven, not estimated.
    """

    path: str
    choice: str | None
    share: float
    half_width: float
    dead: bool
    forced: bool


_NEAR = 1e-6
"""Shares this near to 1 may be 1."""


def occurrences(engine: Engine, seed: int = 0) -> tuple[Occurrence, ...]:
    """Every alternative of every decision, in the order of the file. Raises DseError if nothing is valid.

    Architectures may have decisions of one path; their shares are added up.
    """
    found = engine.shares(seed)
    variables, at = engine.flat.variables, by_path(engine.flat.variables)
    dead = [
        [
            not share and (not half_width or _is_dead(engine, number, value))
            for value, (share, half_width) in enumerate(zip(shares, half_widths, strict=True))
        ]
        for number, (shares, half_widths) in enumerate(zip(found.shares, found.half_widths, strict=True))
    ]
    taken: dict[tuple[str, str | None], list[VariableValue]] = {}
    for number, variable in enumerate(variables):
        for value, choice in enumerate(variable.values):
            taken.setdefault((variable.path, choice), []).append((number, value))

    def occurrence(path: str, choice: str | None, branches: Sequence[VariableValue]) -> Occurrence:
        alive = [(number, value) for number, value in branches if not dead[number][value]]
        share = sum(float(found.shares[number][value]) for number, value in branches)
        half_width = reduce(hypot, (float(found.half_widths[number][value]) for number, value in alive), 0.0)
        if len(at[path]) > 1:
            forced = share + half_width > 1 - _NEAR and _is_forced(engine, at[path], choice)
        else:
            (number,) = at[path]
            forced = bool(alive) and sum(dead[number]) == len(dead[number]) - 1
        return Occurrence(path, choice, 1.0 if forced else share, 0.0 if forced else half_width, not alive, forced)

    return tuple(occurrence(path, choice, branches) for (path, choice), branches in taken.items())


def dead_branches(engine: Engine) -> frozenset[VariableValue]:
    """Branches that no valid configuration takes, as far as that can be told at once: a sum may rule out more."""
    diagram = engine.expanded or engine.diagram
    if diagram is None:
        return frozenset()
    return frozenset(
        (variable, value)
        for variable, times in enumerate(times_taken(diagram))
        for value, number in enumerate(times[:-1])
        if not number
    )


def _is_forced(engine: Engine, variables: Sequence[int], choice: str | None) -> bool:
    """Whether every valid row takes *choice* at one of the variables, which exclude each other."""
    others = [
        single(number, np.array([*(value != choice for value in engine.flat.variables[number].values), True]))
        for number in variables
    ]
    return engine.having(*others).is_empty()


def _is_dead(engine: Engine, variable: int, value: int) -> bool:
    known = engine.flat.variables[variable]
    if value == len(known.values) and known.parent is None:
        return True
    return engine.having(engine.flat.taking(variable, value)).is_empty()
