"""Designs, and the runs that tell how good one is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from dse.domain.sampler import Architecture, Brief, Candidate, DesignVariable, Outcomes, Point, Role
from dse.exploration.variables import scaled

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Design:
    """What is chosen, and where in the unit cube the variables lie that a designer decides."""

    architecture: Architecture
    unit: Point


class Cases:
    """What every design of a study is run in: each condition, with each of *draws* of what is uncertain.

    The draws are points of a Latin hypercube, the same for all designs, so that these are compared under the same luck;
    without any, what is uncertain is at its nominal value.
    """

    def __init__(self, brief: Brief, draws: int = 0) -> None:
        self.variables = _of(brief, Role.DESIGN)
        self._brief = brief
        self._columns = {role: [i for i, v in enumerate(brief.variables) if v.role is role] for role in Role}
        self._cases = list(product(brief.conditions or ((),), _draws(brief, draws)))
        self._idle: dict[str, NDArray[np.bool_]] = {}

    def __len__(self) -> int:
        return len(self._cases)

    def candidate(self, design: Design, case: int) -> Candidate:
        """The run of *design* in a case, by its number. What its configuration is known not to have is nominal."""
        whole = np.empty(len(self._brief.variables))
        condition, drawn = self._cases[case]
        whole[self._columns[Role.DESIGN]] = scaled(np.array([design.unit]), self.variables)[0]
        whole[self._columns[Role.CONDITION]] = condition
        whole[self._columns[Role.UNCERTAIN]] = drawn
        idle = self._idle.get(design.architecture.id)
        if idle is not None:
            whole = np.where(idle, [variable.nominal for variable in self._brief.variables], whole)
        return Candidate(design.architecture.id, tuple(whole.tolist()))

    def key(self, design: Design) -> tuple[str, Point]:
        """What *design* is known by among runs: its configuration, and the values of its design variables."""
        name, point = self.candidate(design, 0)
        return name, tuple(point[column] for column in self._columns[Role.DESIGN])

    def is_allowed(self, design: Design) -> bool:
        """Whether it may be run in all cases."""
        if self._brief.allowed is None:
            return True
        points = np.array([self.candidate(design, case).point for case in range(len(self))])
        return bool(self._brief.allowed(points).all())

    def learn(self, asked: Sequence[Candidate], outcomes: Outcomes) -> None:
        """See from what came of those *asked* for which variables their configurations do not have."""
        told = np.array([outcomes.points[variable.name] for variable in self._brief.variables]).T
        for candidate, row in zip(asked, told.reshape(len(asked), -1), strict=True):
            idle = row != np.array(candidate.point)
            if idle.any():
                known = self._idle.get(candidate.configuration)
                self._idle[candidate.configuration] = idle if known is None else idle | known


def _of(brief: Brief, role: Role) -> tuple[DesignVariable, ...]:
    return tuple(variable for variable in brief.variables if variable.role is role)


def _draws(brief: Brief, number: int) -> list[Point]:
    uncertain = _of(brief, Role.UNCERTAIN)
    if not number or not uncertain:
        return [tuple(variable.nominal for variable in uncertain)]
    from scipy.stats.qmc import LatinHypercube

    unit = LatinHypercube(len(uncertain), seed=np.random.default_rng(brief.seed)).random(number)
    return [tuple(point) for point in scaled(unit, uncertain, brief.correlations).tolist()]
