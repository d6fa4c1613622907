"""A sampler that looks at results: on every configuration it halves the range in which a margin changes its sign."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from pydantic import Field

from dse.plugins import Brief, Candidate, Outcomes, SamplerSection


class Bisection(SamplerSection):
    """Along the first variable, the others at their nominal values, until the bracket is as narrow as *width*."""

    name: ClassVar[str] = "bisection"
    once: ClassVar[bool] = False
    grid: ClassVar[None] = None
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"requirement": "R", "width": 0.01},)

    requirement: str
    width: float = Field(gt=0)

    def start(self, brief: Brief) -> _Search:
        """The search in one study; it depends on nothing but *brief* and what it is told."""
        return _Search(self, brief)


class _Search:
    def __init__(self, sampler: Bisection, brief: Brief) -> None:
        self.sampler, self.brief = sampler, brief
        first = brief.variables[0]
        self.brackets = dict.fromkeys(brief.configurations, (first.low, first.high))
        self.signs: dict[str, bool] = {}
        self.asked: list[Candidate] = []

    def ask(self) -> Sequence[Candidate]:
        rest = tuple(variable.nominal for variable in self.brief.variables[1:])
        self.asked = []
        for name, (low, high) in self.brackets.items():
            if name not in self.signs:
                self.asked += [Candidate(name, (end, *rest)) for end in (low, high)]
            elif (middle := self._middle(low, high)) is not None:
                self.asked.append(Candidate(name, (middle, *rest)))
        return self.asked

    def _middle(self, low: float, high: float) -> float | None:
        """Of a variable that has certain values only, one of these."""
        if values := self.brief.variables[0].values:
            between = sorted(value for value in values if low < value < high)
            return between[len(between) // 2] if between else None
        return (low + high) / 2 if high - low > self.sampler.width else None

    def tell(self, outcomes: Outcomes) -> None:
        for (name, (x, *_)), margin in zip(self.asked, outcomes.margins[self.sampler.requirement], strict=True):
            low, high = self.brackets[name]
            if x == low:
                self.signs[name] = bool(margin >= 0)
            elif x < high:
                self.brackets[name] = (x, high) if bool(margin >= 0) is self.signs[name] else (low, x)


SAMPLER = Bisection
