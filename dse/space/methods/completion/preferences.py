"""What is preferred at a place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dse.space.flat import NO_OWNER, Bools, Clause, FlatSpace, Ints, Rows, Rule, Variable, by_path, single


@dataclass(frozen=True, slots=True, eq=False)
class Preference:
    """Granted by a row whose sum of marks[variable][value] is *most*, the greatest there can be.

    Shape (values + 1,) each, 0 for `ABSENT`. At a place where architectures have decisions of the same path, there is
    one variable for each, of which at most one exists.
    """

    marks: Mapping[int, Ints]
    most: int

    def is_met(self, row: Rows) -> bool:
        """Whether a row of shape (variables,) has it."""
        return sum(int(marks[row[variable]]) for variable, marks in self.marks.items()) == self.most

    def masks(self) -> dict[int, Bools] | None:
        """What each variable may take if it is met; None if that is not all there is to it."""
        if self.most and len(self.marks) > 1:
            return None
        return {variable: marks == self.most for variable, marks in self.marks.items()}

    def rules(self) -> tuple[Rule, ...]:
        """That it is met."""
        masks = self.masks()
        if masks is None:
            return (Clause(tuple((variable, marks == 1) for variable, marks in self.marks.items()), NO_OWNER),)
        return tuple(single(variable, mask) for variable, mask in masks.items())


class PreferenceReader:
    """Reads preferences over the variables of a space."""

    def __init__(self, flat: FlatSpace) -> None:
        self._variables = flat.variables
        self._at = by_path(flat.variables)
        self._known: dict[tuple[str, str | None], Preference | None] = {}

    def read(self, preferences: Sequence[tuple[str, str | None]]) -> list[Preference]:
        """Preferences ``(place, choice)``, None for leaving the part out; without those that no space like this has."""
        found = []
        for wanted in dict.fromkeys(preferences):
            if wanted not in self._known:
                self._known[wanted] = self._preference(*wanted)
            preference = self._known[wanted]
            if preference is not None:
                found.append(preference)
        return found

    def _preference(self, path: str, choice: str | None) -> Preference | None:
        numbers = self._at.get(path, ())
        marks = {number: _marks(self._variables[number], choice) for number in numbers}
        marks = {number: each for number, each in marks.items() if each.any()}
        return Preference(marks, int(choice is not None)) if marks else None


def _marks(variable: Variable, choice: str | None) -> Ints:
    if choice is None:
        return np.array([*(-1 if value is not None else 0 for value in variable.values), 0], np.int64)
    return np.array([*(int(value == choice) for value in variable.values), 0], np.int64)
