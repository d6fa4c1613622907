"""Where the verdicts of a study are uncertain: what its runs tell of any other point.

It is computed from the stored runs whenever it is asked for, of whatever sampler: the same runs give the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dse.domain.bench import VERDICTS, Verdict
from dse.errors import closest, fail
from dse.exploration.level_set import Array
from dse.exploration.surrogate import Surrogate, shapes_of, single_threaded
from dse.exploration.variables import design_variable, unit_of
from dse.storage import RunTable

_AT_ONCE = 4096


@dataclass(frozen=True, slots=True, eq=False)
class Chances:
    """How probable each verdict is at m points, (m,) each; together 1.

    Without a verdict are runs that do not exercise the requirement, and those that fail.
    """

    passing: Array
    failing: Array
    without_verdict: Array

    @property
    def misjudged(self) -> Array:
        """How probable it is that another verdict than the most probable one holds, (m,)."""
        return np.asarray(1 - np.maximum(np.maximum(self.passing, self.failing), self.without_verdict))


class VerdictModel:
    """What runs with *margins*, (n,), at *points* of the unit cube, (n, d), say of the verdict anywhere.

    Margins are NaN where there is no verdict. Of more than 2,000 runs, those that say most are taken: half of them next
    to a run with another verdict.
    """

    def __init__(self, points: Array, margins: Array) -> None:
        with single_threaded():
            self._surrogate = Surrogate.of(points, margins, shapes_of(points, margins))

    def at(self, points: Array) -> Chances:
        """At *points* of the unit cube, (m, d)."""
        passing, failing = np.empty(len(points)), np.empty(len(points))
        with single_threaded():
            for first in range(0, len(points), _AT_ONCE):
                part = slice(first, first + _AT_ONCE)
                there = self._surrogate.at(points[part])
                passing[part], failing[part] = there.passing(), there.failing()
        return Chances(passing, failing, np.maximum(1 - passing - failing, 0.0))


class Band:
    """The `VerdictModel` of *requirement* by the runs of *table* on *configuration*.

    DseError if there is no such run or requirement.
    """

    def __init__(self, table: RunTable, requirement: str, configuration: str) -> None:
        header = table.header
        if requirement not in header.requirements:
            raise fail(f"there is no requirement '{requirement}'", None, closest(requirement, header.requirements))
        rows = np.flatnonzero(np.array(table.configurations) == configuration)
        if not len(rows):
            what = f"there is no run of the configuration '{configuration}'"
            raise fail(what, None, closest(configuration, dict.fromkeys(table.configurations)))
        self._variables = tuple(design_variable(variable) for variable in header.definition.variables)
        self._has = header.has(configuration)
        self._nominal = np.array([variable.nominal for variable in self._variables])
        is_judged = np.isin(
            table.verdicts(requirement)[rows], [VERDICTS.index(v) for v in (Verdict.PASS, Verdict.FAIL)]
        )
        margins = np.where(is_judged, table.margins(requirement)[rows], np.nan)
        self._model = VerdictModel(unit_of(table.coordinates()[rows], self._variables), margins)

    def at(self, points: Array) -> Chances:
        """At *points*, (m, variables), in SI; what the configuration does not have of them does not matter."""
        return self._model.at(unit_of(np.where(self._has, points, self._nominal), self._variables))
