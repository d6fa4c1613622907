"""Configurations as a table: an id, a column for every decision, and the sums the design space speaks of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.domain.design import DesignSpace
from dse.space.configurations.ids import Identifier
from dse.space.flat import Ints, Rows, Variable, by_path
from dse.space.lowering.shape import shape_of
from dse.space.output.sums import PropertySum, property_sums

Codes = NDArray[np.int32]
"""What is chosen, as a number in the names of a `ChoiceColumn`; -1 where nothing is."""


@dataclass(frozen=True, slots=True, eq=False)
class ChoiceColumn:
    """The column of the decisions at *path*, of which at most one exists at a time, and all they can choose.

    *codes* has, for each of these decisions, the codes of its values and of `ABSENT`.
    """

    path: str
    names: tuple[str, ...]
    codes: tuple[tuple[int, Codes], ...]

    def of(self, rows: Rows) -> Codes:
        """The code of each row."""
        found = np.full(len(rows), -1, np.int32)
        for variable, codes in self.codes:
            np.maximum(found, codes[rows[:, variable]], out=found)
        return found

    def chosen(self, rows: Rows) -> list[str | None]:
        """What is chosen in each row; None where nothing is."""
        return [self.names[code] if code >= 0 else None for code in self.of(rows).tolist()]


class Sheet:
    """The table of configurations of one design space, for a block of rows at a time."""

    def __init__(self, space: DesignSpace) -> None:
        self.space = space
        self.variables = shape_of(space).variables
        self.places = _places(self.variables)
        self.totals: tuple[PropertySum, ...] = property_sums(space)
        self._identifier = Identifier(self.variables)

    @property
    def headings(self) -> tuple[str, ...]:
        """The names of the columns: ``id``, the paths of the decisions, and ``sum(cost) [EUR]`` for each sum."""
        return ("id", *(place.path for place in self.places), *(total.heading for total in self.totals))

    def ids(self, rows: Rows) -> list[str]:
        """The ids of a block."""
        return self._identifier.ids(rows)

    def codes(self, rows: Rows) -> Ints:
        """The codes of all places, shape (rows, places)."""
        found = np.zeros((len(rows), len(self.places)), np.int64)
        for number, place in enumerate(self.places):
            found[:, number] = place.of(rows)
        return found


def _places(variables: tuple[Variable, ...]) -> tuple[ChoiceColumn, ...]:
    return tuple(_place(path, numbers, variables) for path, numbers in by_path(variables).items())


def _place(path: str, numbers: list[int], variables: tuple[Variable, ...]) -> ChoiceColumn:
    names = tuple(dict.fromkeys(name for number in numbers for name in variables[number].values if name is not None))
    code = {name: place for place, name in enumerate(names)}
    codes = [
        (number, np.array([*(-1 if name is None else code[name] for name in variables[number].values), -1], np.int32))
        for number in numbers
    ]
    return ChoiceColumn(path, names, tuple(codes))
