"""The folds of a wide rule or an objective, gathered as its parts ask for them."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import numpy as np

from dse.space.decisions import Site
from dse.space.flat import NO_VALUE, Fold, Gather, Ints
from dse.space.lowering.shape import SpaceShape


class Folds:
    """The folds of a rule, each once."""

    def __init__(self, shape: SpaceShape) -> None:
        self.shape = shape
        self.found: list[Fold] = []
        self._known: dict[object, int] = {}

    def number(self, fold: Fold) -> int:
        """Where the fold stands among `found`; added if it is new."""
        values = tuple(sorted((variable, array.tobytes()) for variable, array in fold.values.items()))
        key = (fold.gather, fold.start, fold.scale, values)
        if key not in self._known:
            self._known[key] = len(self.found)
            self.found.append(fold)
        return self._known[key]

    def total(self, values: Iterable[tuple[Site, int]], scale: Fraction = Fraction(1), start: int = 0) -> int:
        """*start* and the sum of whole numbers over the sites that are there."""
        arrays: dict[int, Ints] = {}
        for site, value in values:
            if site.branch is None:
                start += value
            else:
                self._array(arrays, site.branch[0], 0)[site.branch[1]] += value
        some = {variable: array for variable, array in arrays.items() if array.any()}
        return self.number(Fold(Gather.SUM, some, start, scale))

    def extreme(self, gather: Gather, values: Iterable[tuple[Site, int]], scale: Fraction = Fraction(1)) -> int:
        """The least, greatest or product of whole numbers over the sites that are there."""
        start = NO_VALUE
        arrays: dict[int, Ints] = {}
        for site, value in values:
            if site.branch is None:
                start = _gathered(gather, int(start), value)
            else:
                array = self._array(arrays, site.branch[0], NO_VALUE)
                array[site.branch[1]] = _gathered(gather, int(array[site.branch[1]]), value)
        return self.number(Fold(gather, arrays, int(start), scale))

    def _array(self, arrays: dict[int, Ints], variable: int, nothing: int) -> Ints:
        if variable not in arrays:
            arrays[variable] = np.full(self.shape.widths[variable], nothing, np.int64)
        return arrays[variable]


def _gathered(gather: Gather, before: int, value: int) -> int:
    if before == NO_VALUE:
        return value
    match gather:
        case Gather.MIN:
            return min(before, value)
        case Gather.MAX:
            return max(before, value)
    return before * value
