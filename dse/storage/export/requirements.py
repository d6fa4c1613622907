"""The requirements of a study for a review board: what is asked, where it comes from, and what the runs came to."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import DefinedRequirement
from dse.storage.database.table import RunTable
from dse.storage.export.headings import Scale

_PASS, _FAIL, _OPEN, _FAILED = (
    VERDICTS.index(verdict) for verdict in (Verdict.PASS, Verdict.FAIL, Verdict.NOT_EXERCISED, Verdict.FAILED_TO_RUN)
)


def requirement_sheet(table: RunTable, scales: Mapping[str, Scale]) -> bytes:
    """A CSV line for each requirement and configuration, over all points of *table*; numbers in the units of *scales*.

    The *verdict* is the worst of any point: ``pass`` if each point that exercises it passes. *run* is the one with the
    least margin. *met in* is the least share of the draws of any point, with the interval it leaves, where points have
    several draws.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(HEADS)
    writer.writerows(sheet_rows(table, scales))
    return out.getvalue().encode()


def sheet_rows(table: RunTable, scales: Mapping[str, Scale]) -> Iterator[list[object]]:
    """The lines of `requirement_sheet`, with cells as `HEADS` names them."""
    names = np.array(table.configurations, dtype=np.str_)
    for column, requirement in enumerate(table.header.definition.requirements):
        for configuration in table.header.configurations:
            rows = np.flatnonzero(names == configuration)
            if len(rows):
                yield [*asked_cells(requirement, scales), configuration, *_found(table, column, rows, scales)]


HEADS = (
    *("id", "title", "text", "source", "rationale", "severity", "benches", "metric", "unit", "at least", "at most"),
    *("exercised when", "configuration", "verdict", "points", "pass", "fail", "not exercised", "failed to run"),
    *("least margin", "error bar", "run", "met in", "from", "to", "must be met in", "study"),
)


def asked_cells(requirement: DefinedRequirement, scales: Mapping[str, Scale]) -> Iterator[object]:
    """The cells of a line before the configuration: what is asked for."""
    scale = scales[requirement.metric]
    yield from (requirement.name, requirement.title, requirement.text, requirement.source)
    yield from (requirement.rationale, requirement.severity, " ".join(requirement.on), requirement.metric, scale.symbol)
    yield from ("" if bound is None else scale.number(bound) for bound in (requirement.at_least, requirement.at_most))
    yield requirement.exercised_when or ""


def _found(table: RunTable, column: int, rows: NDArray[np.intp], scales: Mapping[str, Scale]) -> Iterator[object]:
    requirement = table.header.definition.requirements[column]
    codes, margins = table.verdicts(requirement.name)[rows], table.margins(requirement.name)[rows]
    counts = [int((codes == code).sum()) for code in (_PASS, _FAIL, _OPEN, _FAILED)]
    passed, failed, _, broken = counts
    verdict = Verdict.FAILED_TO_RUN if broken else Verdict.NOT_EXERCISED
    yield str(Verdict.FAIL if failed else verdict if broken or not passed else Verdict.PASS)
    yield sum(counts)
    yield from counts
    judged = np.isin(codes, [_PASS, _FAIL])
    if not judged.any():
        yield from [""] * 6
    else:
        worst = rows[judged][int(np.argmin(np.nan_to_num(margins[judged], nan=-np.inf)))]
        scale = scales[f"{requirement.name}.margin"]
        error = table.errors(requirement.metric)[worst]
        yield float(scale.of(table.margins(requirement.name)[worst]))
        yield "" if np.isnan(error) else float(scale.of(error))
        yield int(table.numbers[worst])
        yield from _rates(table, column, rows[judged])
    yield requirement.met_in if table.rates is not None else ""
    yield table.header.fingerprint


def _rates(table: RunTable, column: int, rows: NDArray[np.intp]) -> Iterator[object]:
    """The least share of the draws of any of *rows*, and between which rates that leaves it."""
    if table.rates is None:
        yield from ("", "", "")
        return
    met, judged = table.rates.met[rows, column], np.maximum(table.rates.judged[rows, column], 1)
    least = rows[int(np.argmin(met / judged))]
    low, high = table.rates.interval(column)
    yield from (float(np.min(met / judged)), round(float(low[least]), 6), round(float(high[least]), 6))
