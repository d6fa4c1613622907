"""Designs are run in one case after the other, and no further once one is lost."""

from __future__ import annotations

from collections.abc import Sequence

from dse.exploration.optimising.judging import Result


class Order:
    """The cases of a study by how often designs were lost in them, the most often first."""

    def __init__(self, cases: int) -> None:
        self._lost = [0] * cases
        self._run = [0] * cases

    def count(self, case: int, result: Result) -> None:
        """Take one more run into account."""
        self._run[case] += 1
        self._lost[case] += result.is_lost

    def now(self) -> tuple[int, ...]:
        """The numbers of the cases. Of those that were never run nothing is known: they come in the middle."""
        share = [(lost + 1) / (run + 2) for lost, run in zip(self._lost, self._run, strict=True)]
        return tuple(sorted(range(len(share)), key=lambda case: (-share[case], case)))


class Race:
    """*number* designs on their way through the cases in *order*: one case first, then two more, then four, and so on.

    So a design that is lost costs few runs, and what is left is enough work for all processors.
    """

    def __init__(self, number: int, order: Sequence[int]) -> None:
        self.results: list[list[Result]] = [[] for _ in range(number)]
        self._order = order
        self._begun = 0

    def wanted(self) -> list[tuple[int, int]]:
        """Which design is to be run in which case next, case after case; none at the end."""
        cases = self._order[self._begun : 2 * self._begun + 1]
        self._begun += len(cases)
        left = [design for design, found in enumerate(self.results) if not any(one.is_lost for one in found)]
        return [(design, case) for case in cases for design in left]

    def tell(self, asked: Sequence[tuple[int, int]], found: Sequence[Result]) -> None:
        """What came of what was wanted."""
        for (design, _), result in zip(asked, found, strict=True):
            self.results[design].append(result)
