"""The valid configuration with the fewest choices changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dse.errors import fail
from dse.space.configurations.ids import IdentifiedChoices
from dse.space.decisions import Choices
from dse.space.dnnf.trim import UnsupportedError
from dse.space.flat import ABSENT, Ints, Rows
from dse.space.mdd.growth import TooWideError
from dse.space.methods.engine import Engine
from dse.space.optimum.best import best


@dataclass(frozen=True, slots=True)
class Change:
    """What was chosen at *path* and what is now; None where there is nothing."""

    path: str
    before: str | None
    after: str | None


@dataclass(frozen=True, slots=True)
class Nearest(IdentifiedChoices):
    """A valid configuration's choices and how they differ from those that were given."""

    changes: tuple[Change, ...]


def nearest(engine: Engine, choices: Choices) -> Nearest:
    """A valid configuration that keeps as many of *choices* as can be kept; of several the first in the list.

    Choices inside an architecture that is given up count as lost, those inside a new one are free. Raises
    DseError if there is none, or if the space is too large for every method.
    """
    found = _least(engine, _distances(engine, choices))
    if not len(found):
        hint = f"ask which constraints conflict: dse space conflict {engine.flat.name}"
        raise fail(f"'{engine.flat.name}' has no valid configuration", None, hint)
    now = engine.flat.choices(found[0])
    paths = dict.fromkeys([*(variable.path for variable in engine.flat.variables), *choices])
    changes = [Change(path, choices.get(path), now.get(path)) for path in paths]
    return Nearest(now, tuple(change for change in changes if change.before != change.after))


def _least(engine: Engine, weights: Mapping[int, Ints]) -> Rows:
    if engine.diagram is not None:
        return best(engine.diagram, weights, 1).rows
    try:
        return engine.entangled.least(weights, 1)
    except (UnsupportedError, TooWideError) as error:
        hint = "fix some of the choices, or ask for the conflict"
        what = f"'{engine.flat.name}' is too large to look for the nearest configuration"
        raise fail(what, None, hint) from error


def _distances(engine: Engine, choices: Choices) -> Mapping[int, Ints]:
    """For each variable that exists with *choices*: 1 less for the value it has there than for any other.

    That it may not exist counts like another value, which the weights, 0 for `ABSENT`, say without a constant.
    """
    weights: dict[int, Ints] = {}
    taken = [ABSENT] * len(engine.flat.variables)
    for number, variable in enumerate(engine.flat.variables):
        if variable.parent is not None and taken[variable.parent[0]] != variable.parent[1]:
            continue
        choice = choices.get(variable.path)
        if choice in variable.values:
            taken[number] = variable.values.index(choice)
            weights[number] = np.zeros(len(variable.values) + 1, np.int64)
            weights[number][taken[number]] = -1
    return weights
