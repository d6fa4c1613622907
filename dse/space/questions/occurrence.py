"""How often each alternative occurs among the valid configurations; which are dead, and which choices are forced."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot

import numpy as np

from dse.space.engine import Engine
from dse.space.flat import single


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
            entry.forced |= not dead[value] and sum(dead) == len(dead) - 1
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


def dead_values(engine: Engine, seed: int = 0) -> Iterator[tuple[str, str | None]]:
    """The alternatives that no valid configuration has."""
    return ((found.path, found.choice) for found in occurrences(engine, seed) if found.dead)


def _is_dead(engine: Engine, variable: int, value: int) -> bool:
    values = len(engine.flat.variables[variable].values)
    mask = np.zeros(values + 1, np.bool_)
    mask[value] = True
    if value == values and engine.flat.variables[variable].parent is None:
        return True
    return engine.having(single(variable, mask)).is_empty()
