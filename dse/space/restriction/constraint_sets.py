"""Constraint sets switched on and off."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from dse.domain.design import DesignSpace
from dse.errors import Problem, closest, raise_if_any


def switched(space: DesignSpace, on: Collection[str] = (), off: Collection[str] = ()) -> DesignSpace:
    """*space* with the constraint sets *on* switched on and *off* switched off; the others stay as they are.

    Constraints that belong to no set are always on. Raises DseError with every set that does not exist, and every
    one that is to be on and off.
    """
    known = [found.name for found in space.sets]
    problems = [
        Problem(f"'{space.name}' has no constraint set '{name}'", space.where, closest(name, known) or "it has none")
        for name in dict.fromkeys((*on, *off))
        if name not in known
    ]
    problems += [
        Problem(f"constraint set '{name}' cannot be on and off", space.where, "name it once")
        for name in dict.fromkeys(on)
        if name in off
    ]
    raise_if_any(problems)
    sets = tuple(replace(found, on=(found.on or found.name in on) and found.name not in off) for found in space.sets)
    standing = {found.name for found in sets if found.on}
    constraints = tuple(rule for rule in space.all_constraints if not rule.set or rule.set in standing)
    return replace(space, sets=sets, constraints=constraints)
