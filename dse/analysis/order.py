"""The order of designs: which of them to take.

    run at all conditions | critical missed: certain, doubtful | major: certain, doubtful | objectives | least margin
            yes           |             0       0              |     0        2           |    5450    |    -3.9
            yes           |             0       0              |     0        2           |    5990    |    -3.9
            yes           |             1       0              |     0        0           |    5400    |    -1.1

The first column in which two designs differ decides: above, 540 EUR, and then a missed critical verdict, whatever it
costs. A verdict is that on a requirement at a point. It is missed if it fails, or if the run failed. It is doubtful if
more draws or finer numerics may change it, or if no run of the design exercised the requirement. Classes of severity
are those that the requirements name; requirements without one are the last class. Several objectives count in the order
in which the study lists them.

Command line and page have the same order (`order.ts`); both are tested with `tests/order_cases.json`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import MET, Floats
from dse.analysis.slack import FAILING, slack_of_runs
from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import StudyDefinition
from dse.domain.sampler import Role
from dse.storage import CERTAINTIES, Certainty, RunTable, groups_of

MISSED = (FAILING, VERDICTS.index(Verdict.FAILED_TO_RUN))
"""Codes of verdicts that are missed."""
_DIGITS = 10
"""Significant ones that are compared."""
_SEVERITIES = (
    *("catastrophic", "critical", "severe", "high", "major", "medium", "moderate", "minor", "low", "negligible"),
    *("asil d", "asil c", "asil b", "asil a", "qm"),
)

FIRST, NEITHER, SECOND = 1, 0, -1
"""Which of two designs is ahead."""

Key = tuple[float, ...]
"""A design's place in the order, columns as above; smaller values are ahead."""


@dataclass(frozen=True, slots=True, eq=False)
class DesignOrder:
    """n designs, with verdicts by c classes of severity, the highest first.

    Of *judged* verdicts, (n, c), so many are missed for *certain*, (n, c), and so many that are *doubtful*, (n, c).
    *is_whole*, (n,), are those that were run at all conditions, *slack*, (n,), their least margins as shares
    (`dse.analysis.slack`). *keys*, (n, k), are each a `Key`.
    """

    judged: NDArray[np.int64]
    certain: NDArray[np.int64]
    doubtful: NDArray[np.int64]
    is_whole: NDArray[np.bool_]
    slack: Floats
    keys: Floats

    @property
    def first_to_last(self) -> list[int]:
        """Numbers of the designs; of equal ones the one that was run first."""
        return [int(row) for row in np.lexsort(self.keys.T[::-1])]


def design_order(table: RunTable, rows: Sequence[NDArray[np.intp]], objectives: Floats) -> DesignOrder:
    """The designs that have these *rows* of *table*, which has one for each point.

    Their *objectives*, (n, m), are to be small.
    """
    definition, size = table.header.definition, len(rows)
    design = np.full(len(table), -1, dtype=np.intp)
    for number, own in enumerate(rows):
        design[own] = number
    classes = severities_of(definition)
    judged, certain, doubtful = np.zeros((3, size, len(classes)), dtype=np.int64)
    for requirement in definition.requirements:
        column = classes.index(_severity(requirement.severity))
        codes, unsure = table.verdicts(requirement.name), unsure_of(table, requirement.name)
        missed = np.isin(codes, MISSED)

        def counted(which: NDArray[np.bool_]) -> NDArray[np.int64]:
            return np.asarray(np.bincount(design[which & (design >= 0)], minlength=size))

        # What no run exercises is not met.
        all_ = counted(missed | (codes == MET))
        judged[:, column] += np.maximum(all_, 1)
        certain[:, column] += counted(missed & ~unsure)
        doubtful[:, column] += np.where(all_ == 0, 1, counted(missed & unsure))
    is_whole, slack = _whole(table, design, size), np.full(size, np.inf)
    np.minimum.at(slack, design[design >= 0], slack_of_runs(table)[design >= 0])
    by_class = np.stack([certain, doubtful], axis=2).reshape(size, 2 * len(classes))
    last = significant(np.column_stack([np.nan_to_num(objectives, nan=np.inf), -slack]))
    return DesignOrder(judged, certain, doubtful, is_whole, slack, np.column_stack([~is_whole, by_class, last]))


def severities_of(definition: StudyDefinition) -> tuple[str, ...]:
    """Classes of severity in lower case, the highest first; unknown words in the order in which they are listed, and
    last "" for requirements that name none."""
    words = dict.fromkeys(_severity(each.severity) for each in definition.requirements)

    def rank(word: str) -> int:
        return _SEVERITIES.index(word) if word in _SEVERITIES else len(_SEVERITIES) + (not word)

    return tuple(sorted(words, key=rank))


def severity_levels(definition: StudyDefinition) -> tuple[int, ...]:
    """The place of each requirement's class among `severities_of`."""
    classes = severities_of(definition)
    return tuple(classes.index(_severity(each.severity)) for each in definition.requirements)


def unsure_of(table: RunTable, requirement: str) -> NDArray[np.bool_]:
    """Verdicts that more draws or finer numerics may change, (n,)."""
    return np.asarray(table.certainties(requirement) == CERTAINTIES.index(Certainty.DOUBTFUL))


def ahead_by(first: Key, second: Key) -> tuple[int, int]:
    """Which of two designs is ahead, and the column that decides; -1 if none does."""
    for column, (a, b) in enumerate(zip(first, second, strict=True)):
        if a != b:
            return (FIRST if a < b else SECOND), column
    return NEITHER, -1


def significant(values: Floats) -> Floats:
    """*values* without the digits that are rounding."""
    rounded = [float(f"{value:.{_DIGITS}g}") for value in values.ravel().tolist()]
    return np.array(rounded, dtype=np.float64).reshape(values.shape)


def _severity(word: str) -> str:
    return word.strip().lower()


def _whole(table: RunTable, design: NDArray[np.intp], size: int) -> NDArray[np.bool_]:
    """Which designs were run at all conditions."""
    conditions = [n for n, v in enumerate(table.header.definition.variables) if v.role == Role.CONDITION]
    if not conditions:
        return np.ones(size, dtype=np.bool_)
    group = groups_of(table.coordinates()[:, conditions])
    count, run = int(group.max(initial=0)) + 1, design >= 0
    pairs = np.unique(design[run] * count + group[run])
    return np.asarray(np.bincount(pairs // count, minlength=size) == count)
