"""What the figures of requirements say alike about their runs and their bounds."""

from __future__ import annotations

import numpy as np

from dse.report.content.data import Flags, Floats, MetricColumn, RequirementRow
from dse.report.verdicts import Mark, Marks

JUDGED = ((Mark.FAIL, "fail"), (Mark.PASS, "pass"))


def bounds(requirement: RequirementRow, metric: MetricColumn) -> list[tuple[float, str]]:
    """Each bound with its words: ``at most 5 %``."""
    both = (("at least", requirement.at_least), ("at most", requirement.at_most))
    return [(bound, f"{word} {bound:g} {metric.unit_symbol}".rstrip()) for word, bound in both if bound is not None]


def counted(marks: Marks, noun: str = "runs") -> str:
    """How many runs, or designs, were judged and how, and how many were not and why."""
    counts = np.bincount(marks, minlength=len(Mark))
    judged = counts[Mark.PASS] + counts[Mark.FAIL]
    text = f"{judged:,} of {len(marks):,} {noun} judged: {counts[Mark.PASS]:,} pass, {counts[Mark.FAIL]:,} fail; "
    return text + f"{counts[Mark.NOT_EXERCISED]:,} not exercised, {counts[Mark.FAILED_TO_RUN]:,} failed to run."


def hidden(values: Floats, runs: Flags, low: float | None, high: float | None) -> str:
    """A sentence on those of *runs* whose value no axis from *low* to *high* can show; "" if there are none."""
    finite = np.isfinite(values)
    beyond = finite & ((values < (-np.inf if low is None else low)) | (values > (np.inf if high is None else high)))
    parts = ((np.isnan(values), "undefined"), (np.isinf(values), "infinite"), (beyond, "beyond the axis"))
    counts = [(int(np.count_nonzero(runs & flags)), words) for flags, words in parts]
    shown = ", ".join(f"{count:,} {words}" for count, words in counts if count)
    return f" Not drawn: {shown}." if shown else ""
