"""Designs, and the runs that tell how good one is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from dse.domain.sampler import Architecture, Brief, Candidate, DesignVariable, Outcomes, Point, Role
from dse.exploration.variables import scaled, unit_of

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
        self._nominal = np.array([variable.nominal for variable in brief.variables])
        self._idle: dict[str, NDArray[np.bool_]] = {}
        self._taken: set[tuple[str, Point]] = set()

    def __len__(self) -> int:
        return len(self._cases)

    def candidate(self, design: Design, case: int) -> Candidate:
        """The run of *design* in a case, by its number. What its configuration is known not to have is nominal."""
        return Candidate(design.architecture.id, tuple(self._points([design], case)[0].tolist()))

    def units(self, designs: Sequence[Design]) -> NDArray[np.float64]:
        """Where *designs* are run, (n, design variables), in the unit cube; what they do not have is nominal."""
        return unit_of(self._points(designs, 0)[:, self._columns[Role.DESIGN]], self.variables)

    def has(self, design: Design) -> list[bool]:
        """Which of the design variables its configuration has, as far as is known."""
        idle = self._idle.get(design.architecture.id)
        return [idle is None or not idle[column] for column in self._columns[Role.DESIGN]]

    def take(self, design: Design) -> bool:
        """Whether *design* is allowed and was not taken before; then it is."""
        key = self.key(design)
        if key in self._taken or not self.is_allowed(design):
            return False
        self._taken.add(key)
        return True

    def key(self, design: Design) -> tuple[str, Point]:
        """What *design* is known by among runs: its configuration, and the values of its design variables."""
        name, point = self.candidate(design, 0)
        return name, tuple(point[column] for column in self._columns[Role.DESIGN])

    def is_allowed(self, design: Design) -> bool:
        """Whether it may be run in all cases."""
        if self._brief.allowed is None:
            return True
        points = [self._points([design], case) for case in range(len(self))]
        return bool(self._brief.allowed(np.concatenate(points)).all())

    def learn(self, asked: Sequence[Candidate], outcomes: Outcomes) -> None:
        """See from what came of those *asked* for which variables their configurations do not have."""
        told = np.array([outcomes.points[variable.name] for variable in self._brief.variables]).T
        for candidate, row in zip(asked, told.reshape(len(asked), -1), strict=True):
            self._taken.add((candidate.configuration, tuple(row[self._columns[Role.DESIGN]].tolist())))
            idle = row != np.array(candidate.point)
            if idle.any():
                known = self._idle.get(candidate.configuration)
                self._idle[candidate.configuration] = idle if known is None else idle | known

    def _points(self, designs: Sequence[Design], case: int) -> NDArray[np.float64]:
        whole = np.empty((len(designs), len(self._brief.variables)))
        condition, drawn = self._cases[case]
        whole[:, self._columns[Role.DESIGN]] = scaled(np.array([design.unit for design in designs]), self.variables)
        whole[:, self._columns[Role.CONDITION]] = condition
        whole[:, self._columns[Role.UNCERTAIN]] = drawn
        for row, design in enumerate(designs):
            idle = self._idle.get(design.architecture.id)
            if idle is not None:
                whole[row, idle] = self._nominal[idle]
        return whole


def _of(brief: Brief, role: Role) -> tuple[DesignVariable, ...]:
    return tuple(variable for variable in brief.variables if variable.role is role)


def _draws(brief: Brief, number: int) -> list[Point]:
    uncertain = _of(brief, Role.UNCERTAIN)
    if not number or not uncertain:
        return [tuple(variable.nominal for variable in uncertain)]
    from scipy.stats.qmc import LatinHypercube

    unit = LatinHypercube(len(uncertain), seed=np.random.default_rng(brief.seed)).random(number)
    return [tuple(point) for point in scaled(unit, uncertain, brief.correlations).tolist()]
