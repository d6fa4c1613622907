"""How good designs are: their runs at all cases become objectives and a violation of the requirements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import Verdict
from dse.domain.sampler import DesignVariable, Objective, Outcomes
from dse.exploration.designs import Designs, designs_of, joined, violations

Array = NDArray[np.float64]

Key = tuple[str, tuple[float, ...]]
"""A design by its configuration and the values of its design variables."""

_DIGITS = 10
"""Significant ones that are compared: the last bits of another machine do not matter."""


class Worth(NamedTuple):
    """What n designs are worth: *objectives*, (n, m), to be minimised, and *violations*, (n,), 0 where all requirements
    are met. *slack*, (n, r + 1), tells by how much each is met, or with a minus missed, -1 … 1, and last whether they
    have all values that are looked for, 1 or -1; NaN where it is not known.
    """

    objectives: Array
    violations: Array
    slack: Array


class Judge:
    """Judges designs of a study over *variables*, as `dse.exploration.designs` says.

    Margins are measured in their usual size among the first designs that are judged.
    """

    def __init__(self, variables: Sequence[DesignVariable], objectives: Sequence[Objective]) -> None:
        self._variables, self._objectives = variables, objectives
        self._signs = np.array([-1.0 if each.maximize else 1.0 for each in objectives])
        self._scale: Array | None = None

    def judged(self, told: Sequence[Outcomes], wanted: Sequence[Key]) -> Worth:
        """What n designs are worth that are among those *told*.

        A design that lacks the value of an objective violates by 1 + the number of requirements more.
        """
        designs = designs_of(joined(told), self._variables, self._objectives)
        if self._scale is None:
            self._scale = _usual(np.abs(designs.margins))
        names = zip(designs.configurations, map(tuple, designs.points.tolist()), strict=True)
        place = {key: row for row, key in enumerate(names)}
        rows = [place[key] for key in wanted]
        lacking = np.isnan(designs.objectives).any(axis=1) * (1.0 + designs.margins.shape[1])
        violation = violations(designs, self._scale) + lacking
        slack = np.column_stack([_slack(designs, self._scale), np.where(designs.failed + lacking > 0, -1.0, 1.0)])
        objectives = self._signs * designs.objectives[rows]
        return Worth(_rounded(objectives), _rounded(violation[rows]), _rounded(slack[rows]))


def lost(outcomes: Outcomes, objectives: Sequence[Objective]) -> list[bool]:
    """Which runs prove that their design is none to take, whatever it does in other cases."""
    found = ~outcomes.done
    for verdicts in outcomes.verdicts.values():
        found = found | np.array([verdict in (Verdict.FAIL, Verdict.FAILED_TO_RUN) for verdict in verdicts], np.bool_)
    for each in objectives:
        found = found | np.isnan((outcomes.totals if each.is_total else outcomes.metrics)[each.name])
    return [bool(one) for one in found]


def _slack(designs: Designs, scale: Array) -> Array:
    """The worst margins between -1 and 1, 0 at the bound; -1 if nothing exercised them, unless runs failed."""
    share = designs.margins / scale
    known = np.where(np.isfinite(share), share / (1 + np.abs(share)), np.where(designs.failing, -1.0, 1.0))
    is_open = ~designs.failing & ~designs.shown
    return np.asarray(np.where(is_open, np.where(designs.failed[:, None] > 0, np.nan, -1.0), known))


def _usual(sizes: Array) -> Array:
    """The median of each column's numbers that are not 0; 1 where there is none."""
    columns = [column[np.isfinite(column) & (column > 0)] for column in sizes.T]
    return np.array([float(np.median(column)) if len(column) else 1.0 for column in columns])


def _rounded(values: Array) -> Array:
    rounded = [float(f"{value:.{_DIGITS}g}") for value in values.ravel().tolist()]
    return np.array(rounded).reshape(values.shape)
