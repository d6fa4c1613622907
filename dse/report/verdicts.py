"""Verdicts of runs at thresholds that the reader may move; the page computes the same in the browser."""

from __future__ import annotations

from enum import IntEnum

from dse.domain.bench import VERDICTS, Verdict
from dse.metrics import Codes, margin_to_bounds, overall_codes, verdict_codes
from dse.report.content.nouns import Floats, ReportContent, RequirementRow


class Mark(IntEnum):
    """How a run is marked in the plot and counted; the numbers are those of the page's ``marks.ts``."""

    PASS = VERDICTS.index(Verdict.PASS)
    FAIL = VERDICTS.index(Verdict.FAIL)
    NOT_EXERCISED = VERDICTS.index(Verdict.NOT_EXERCISED)
    FAILED_TO_RUN = VERDICTS.index(Verdict.FAILED_TO_RUN)


Marks = Codes


def marks_of(content: ReportContent, requirement: RequirementRow) -> Marks:
    """The mark of every run for one requirement."""
    margin = margins(content.metric(requirement.metric).values, requirement)
    marks: Marks = verdict_codes(margin, requirement.exercised, content.runs.done)
    return marks


def overall_marks(content: ReportContent) -> Marks:
    """The mark of every run for all requirements."""
    return overall_codes([marks_of(content, requirement) for requirement in content.requirements], content.runs.done)


def margins(values: Floats, requirement: RequirementRow) -> Floats:
    """The distance of *values* to the nearer bound, in their unit."""
    return margin_to_bounds(values, requirement.at_most, requirement.at_least)


def outside(requirement: RequirementRow) -> str:
    """What values fail the requirement: ``> 5``, ``< 3`` or ``outside 3 … 5``."""
    if requirement.at_least is None:
        return f"> {requirement.at_most:g}"
    if requirement.at_most is None:
        return f"< {requirement.at_least:g}"
    return f"outside {requirement.at_least:g} \u2026 {requirement.at_most:g}"
