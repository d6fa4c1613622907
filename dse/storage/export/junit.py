"""A study as JUnit XML, so that a build server shows a broken requirement like a broken test."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from html import escape

import numpy as np

from dse.domain.bench import Verdict
from dse.domain.run import Outcome, Run
from dse.storage.checks import CERTAINTIES, Certainty
from dse.storage.database.table import RunTable
from dse.storage.export.headings import Scale

_DOUBTFUL = CERTAINTIES.index(Certainty.DOUBTFUL)

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit(table: RunTable, scales: Mapping[str, Scale]) -> bytes:
    """A test suite per configuration and a test case per requirement and run.

    A failed requirement is a failure with its margin, a run that failed is an error, a requirement that was not
    exercised is skipped, and so is one whose passing is doubtful. On a bench without requirements every run is a
    test case that fails by not running. Numbers are in the units of *scales*.
    """
    by_configuration: dict[str, list[_Case]] = {name: [] for name in table.header.configurations}
    names = table.header.requirements
    doubts = np.column_stack([np.zeros((len(table), 0)), *(table.certainties(name) == _DOUBTFUL for name in names)])
    for run, doubtful in zip(table.runs(), doubts.tolist(), strict=True):
        by_configuration.setdefault(run.request.configuration, []).extend(_cases(run, doubtful, scales))
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', "<testsuites>"]
    for name, cases in by_configuration.items():
        if cases:
            lines += _suite(name, cases)
    return "\n".join([*lines, "</testsuites>", ""]).encode()


class _Case:
    """One test case; *element* is how it went wrong: failure, error, skipped, or "" if it did not."""

    def __init__(self, run: Run, point: str, name: str, element: str, message: str) -> None:
        self.name = f"{name} run {run.request.number}" + (f" ({point})" if point else "")
        self.element = element
        self.message = message


def _cases(run: Run, doubtful: Sequence[bool], scales: Mapping[str, Scale]) -> Iterator[_Case]:
    point = ", ".join(
        f"{key} = {scales[key].point(value)} {scales[key].symbol}".rstrip() for key, value in run.request.point.items()
    )
    names = [one.requirement for one in run.judgements if one.verdict is not Verdict.NOT_APPLICABLE]
    if run.outcome is Outcome.FAILED:
        yield from (_Case(run, point, name, "error", run.problem) for name in names or ["simulation"])
    elif not names:
        yield _Case(run, point, "simulation", "", "")
    for judgement, doubt in zip(run.judgements, doubtful, strict=True) if run.outcome is Outcome.DONE else ():
        if judgement.verdict is Verdict.NOT_APPLICABLE:
            continue
        margin = scales[f"{judgement.requirement}.margin"].text(judgement.margin)
        result = _result(judgement.verdict, f"margin {margin}", ", doubtful" if doubt else "")
        yield _Case(run, point, judgement.requirement, *result)


def _result(verdict: Verdict, margin: str, doubt: str) -> tuple[str, str]:
    match verdict:
        case Verdict.PASS:
            # Neither a pass nor a failure: nobody knows.
            return ("skipped", f"{margin}{doubt}") if doubt else ("", "")
        case Verdict.FAIL:
            return "failure", f"{margin}{doubt}"
        case Verdict.NOT_EXERCISED:
            return "skipped", f"not exercised{doubt}"
        case _:
            return "error", "failed to run"


def _suite(name: str, cases: Sequence[_Case]) -> Iterator[str]:
    counts = [sum(case.element == kind for case in cases) for kind in ("failure", "error", "skipped")]
    totals = 'tests="{}" failures="{}" errors="{}" skipped="{}"'.format(len(cases), *counts)
    yield f'<testsuite name="{_text(name)}" {totals}>'
    for case in cases:
        head = f'  <testcase classname="{_text(name)}" name="{_text(case.name)}"'
        if case.element:
            yield f'{head}><{case.element} message="{_text(case.message)}"/></testcase>'
        else:
            yield f"{head}/>"
    yield "</testsuite>"


def _text(text: str) -> str:
    # Characters XML has no way to write, as a library's message may hold, become question marks.
    return escape(_FORBIDDEN.sub("?", text)).replace("\n", "&#10;")
