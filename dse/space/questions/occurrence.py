"""How often each alternative occurs among the valid configurations; which are dead, and which choices are forced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np

from dse.space.flat import by_path, single
from dse.space.lowering.shape import Branch
from dse.space.mdd.diagram import occurrences as times_taken
from dse.space.methods.engine import Engine


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


@dataclass(slots=True)
class _Sum:
    share: float = 0.0
    half_width: float = 0.0
    dead: bool = True
    forced: bool = False


def occurrences(engine: Engine, seed: int = 0) -> tuple[Occurrence, ...]:
    """Every alternative of every decision, in the order of the file. Raises DseError if nothing is valid.

    Architectures may have decisions of one path; their shares are added up.
    """
    shares = engine.shares(seed)
    at = by_path(engine.flat.variables)
    sums: dict[tuple[str, str | None], _Sum] = {}
    for number, variable in enumerate(engine.flat.variables):
        share, half_width = shares.shares[number], shares.half_widths[number]
        dead = [
            not times and (not half or _is_dead(engine, number, value))
            for value, (times, half) in enumerate(zip(share, half_width, strict=True))
        ]
        for value, choice in enumerate(variable.values):
            entry = sums.setdefault((variable.path, choice), _Sum())
            entry.share += float(share[value])
            entry.half_width = 0.0 if dead[value] else hypot(entry.half_width, float(half_width[value]))
            entry.dead &= dead[value]
            if len(at[variable.path]) == 1:
                entry.forced = not dead[value] and sum(dead) == len(dead) - 1
    for (path, choice), entry in sums.items():
        if len(at[path]) > 1 and entry.share + entry.half_width > 1 - _NEAR:
            entry.forced = _is_forced(engine, at[path], choice)
    return tuple(
        Occurrence(
            path,
            choice,
            1.0 if entry.forced else entry.share,
            0.0 if entry.forced else entry.half_width,
            entry.dead,
            entry.forced,
        )
        for (path, choice), entry in sums.items()
    )


def dead_branches(engine: Engine) -> frozenset[Branch]:
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
