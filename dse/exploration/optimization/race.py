"""Designs are run in one case after the other, and no further once one is lost."""

from __future__ import annotations

from collections.abc import Sequence


class RaceOrder:
    """The cases of a study by how often designs were lost in them, the most often first."""

    def __init__(self, cases: int) -> None:
        self._lost = [0] * cases
        self._run = [0] * cases

    def count(self, case: int, is_lost: bool) -> None:
        """Take one more run into account."""
        self._run[case] += 1
        self._lost[case] += is_lost

    def now(self) -> tuple[int, ...]:
        """The numbers of the cases. A case that was never run counts as one in which every other design is lost."""
        share = [(lost + 1) / (run + 2) for lost, run in zip(self._lost, self._run, strict=True)]
        return tuple(sorted(range(len(share)), key=lambda case: (-share[case], case)))


class Race:
    """*number* designs on their way through the cases in *order*: one case first, then two more, then four, and so on.

    So a design that is lost costs few runs, and what is left is enough work for all processors. *run* counts the cases
    that each was run in.
    """

    def __init__(self, number: int, order: Sequence[int]) -> None:
        self.run = [0] * number
        self._left = dict.fromkeys(range(number))
        self._order = order
        self._begun = 0

    def wanted(self) -> list[tuple[int, int]]:
        """Which design is to be run in which case next, case after case; none at the end."""
        cases = self._order[self._begun : 2 * self._begun + 1]
        self._begun += len(cases)
        return [(design, case) for case in cases for design in self._left]

    def tell(self, asked: Sequence[tuple[int, int]], lost: Sequence[bool]) -> None:
        """Which designs are lost by what was wanted."""
        for (design, _), is_lost in zip(asked, lost, strict=True):
            self.run[design] += 1
            if is_lost:
                self._left.pop(design, None)
