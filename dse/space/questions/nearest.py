"""The valid configuration with the fewest choices changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dse.errors import fail
from dse.space.configurations.ids import IdentifiedChoices
from dse.space.decisions import Choices
from dse.space.flat import ABSENT, Ints
from dse.space.methods.budget import TooMuchError
from dse.space.methods.engine import Engine


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
    try:
        found = engine.least(_distances(engine, choices), 1)
    except TooMuchError as error:
        hint = "fix some of the choices, or ask for the conflict"
        what = f"'{engine.flat.name}' is too large to look for the nearest configuration"
        raise fail(what, None, hint) from error
    if not len(found):
        raise engine.nothing()
    now = engine.flat.choices(found[0])
    paths = dict.fromkeys([*(variable.path for variable in engine.flat.variables), *choices])
    changes = [Change(path, choices.get(path), now.get(path)) for path in paths]
    return Nearest(now, tuple(change for change in changes if change.before != change.after))


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
