"""Verdicts of runs at thresholds that the reader may move; the page computes the same in the browser."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.sampler import Role
from dse.exploration import equal_rows
from dse.metrics import Codes, margin_to_bounds, overall_codes, verdict_codes, worst_codes
from dse.report.content.data import Floats, ReportContent, ReportVariable, RequirementRow


class Mark(IntEnum):
    """How a run is marked in the plot and counted; the numbers are those of the page's ``marks.ts``."""

    PASS = VERDICTS.index(Verdict.PASS)
    FAIL = VERDICTS.index(Verdict.FAIL)
    NOT_EXERCISED = VERDICTS.index(Verdict.NOT_EXERCISED)
    FAILED_TO_RUN = VERDICTS.index(Verdict.FAILED_TO_RUN)
    NOT_APPLICABLE = VERDICTS.index(Verdict.NOT_APPLICABLE)


Marks = Codes


def marks_of(content: ReportContent, requirement: RequirementRow) -> Marks:
    """The mark of every run for one requirement."""
    margin = margins(content.metric(requirement.metric).values, requirement)
    marks: Marks = verdict_codes(margin, requirement.exercised, content.runs.done)
    if requirement.applies is not None:
        marks = np.where(requirement.applies, marks, Mark.NOT_APPLICABLE).astype(np.uint8)
    return marks


def overall_marks(content: ReportContent) -> Marks:
    """The mark of every run for all requirements."""
    return overall_codes([marks_of(content, requirement) for requirement in content.requirements], content.runs.done)


def alike(content: ReportContent, names: Sequence[str]) -> list[NDArray[np.intp]]:
    """Positions of the runs of one configuration with the same values of the variables *names*, first ones first."""
    _, codes = np.unique(np.array(content.runs.configurations, dtype=np.str_), return_inverse=True)
    return equal_rows(np.column_stack([codes.reshape(-1), *(content.variable(name).values for name in names)]))


def worst_marks(
    content: ReportContent, designs: Sequence[NDArray[np.intp]], conditions: Sequence[ReportVariable]
) -> Marks:
    """The mark of each of *designs*, given by its runs, over all *conditions*: one that lacks some does not pass."""
    each = [worst_codes(marks_of(content, requirement), designs) for requirement in content.requirements]
    done = np.array([content.runs.done[rows].all() for rows in designs], dtype=np.bool_)
    marks: Marks = overall_codes(each, done)
    at = np.column_stack([np.zeros(len(content.runs)), *(each.values for each in conditions)])
    most = len(equal_rows(at))
    whole = np.array([len(equal_rows(at[rows])) == most for rows in designs], dtype=np.bool_)
    return np.where((marks == Mark.PASS) & ~whole, Mark.NOT_EXERCISED, marks).astype(np.uint8)


def marks_of_designs(content: ReportContent) -> Marks:
    """For every run the mark of its design at the worst of its conditions; its own where there are no conditions."""
    conditions = conditions_of(content)
    marks = overall_marks(content)
    if conditions:
        designs = alike(content, [each.name for each in content.variables if each not in conditions])
        for rows, mark in zip(designs, worst_marks(content, designs, conditions), strict=True):
            marks[rows] = mark
    return marks


def deciding_runs(content: ReportContent, requirement: RequirementRow) -> tuple[NDArray[np.intp], Marks]:
    """For each design the run with its smallest margin of *requirement* at any condition, and the design's mark for it;
    every run where there are no conditions."""
    marks = marks_of(content, requirement)
    conditions = conditions_of(content)
    if not conditions:
        return np.arange(len(marks)), marks
    designs = alike(content, [each.name for each in content.variables if each not in conditions])
    margin = margins(content.metric(requirement.metric).values, requirement)
    margin = np.where(marks <= Mark.FAIL, np.where(np.isnan(margin), -np.inf, margin), np.inf)
    rows = np.array([rows[int(np.argmin(margin[rows]))] for rows in designs], dtype=np.intp)
    return rows, worst_codes(marks, designs)


def conditions_of(content: ReportContent) -> list[ReportVariable]:
    """The variables that are conditions."""
    return [variable for variable in content.variables if variable.role == Role.CONDITION]


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
