"""Runs that differ in their draw alone as one row: a requirement is met if it is in a share of the draws.

The row has the values of the draw that decides. Of 20 draws of which 95 % must meet a bound one may miss it: sorted by
their margins, with those that miss it first, the second one decides, and the requirement is met if that one meets it.
So margins, and metrics that a requirement is about, keep their meaning: they are on the right side of a bound exactly
where the share of the draws that are is large enough, also where the bound is another one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import StudyDefinition
from dse.domain.noise import DRAW
from dse.domain.rates import Rates
from dse.domain.sampler import Outcomes
from dse.storage.database.table import RunTable
from dse.storage.rows import RowBlock

_PASS, _FAIL, _NOT_EXERCISED, _FAILED, _NOT_APPLICABLE = (VERDICTS.index(verdict) for verdict in Verdict)
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Decided:
    """What g groups of rows come to under r requirements: *codes* of verdicts, and the *rows* that decide, (g, r)."""

    codes: NDArray[np.uint8]
    rows: NDArray[np.intp]
    rates: Rates


def decide(
    group: NDArray[np.intp],
    codes: NDArray[np.uint8],
    margins: NDArray[np.float64],
    shares: Sequence[float],
    random: NDArray[np.bool_],
) -> Decided:
    """What rows come to in groups: *group* is each one's number from 0, (n,); *codes* and *margins* are (n, r).

    *shares* of the draws are to meet each requirement; *random* rows depend on the draw.
    """
    count, width = int(group.max(initial=-1)) + 1, codes.shape[1]
    starts = np.searchsorted(np.sort(group), np.arange(count))
    found, rows = np.empty((count, width), dtype=np.uint8), np.empty((count, width), dtype=np.intp)
    met, judged = np.empty((count, width), dtype=np.int64), np.empty((count, width), dtype=np.int64)
    for column in range(width):
        code, margin = codes[:, column], margins[:, column]
        counted = (code == _PASS) | (code == _FAIL)
        order = np.lexsort((margin, code != _FAIL, ~counted, group))
        met[:, column] = np.bincount(group, code == _PASS, count)
        judged[:, column] = np.bincount(group, counted, count)
        most = np.floor((1.0 - shares[column]) * judged[:, column] + _ROUNDING).astype(np.int64)
        missed = judged[:, column] - met[:, column] > most
        rows[:, column] = order[starts + np.minimum(most, np.maximum(judged[:, column] - 1, 0))]
        found[:, column] = np.where(judged[:, column] == 0, _NOT_EXERCISED, np.where(missed, _FAIL, _PASS))
        found[np.bincount(group, code != _NOT_APPLICABLE, count) == 0, column] = _NOT_APPLICABLE
        found[np.bincount(group, code == _FAILED, count) > 0, column] = _FAILED
    return Decided(found, rows, Rates(met, judged, np.bincount(group, random, count) > 0))


def shares_of(definition: StudyDefinition) -> list[float]:
    """The share of the draws that is to meet each requirement."""
    return [requirement.met_in for requirement in definition.requirements]


def over_draws(table: RunTable) -> RunTable:
    """*table* with one row for the runs that differ in their draw alone, and its `Rates`; as it is where none do.

    What the header counts are such rows, too. The number of a row is that of the run that decides: whether a
    requirement is missed, else whether the first one is met. Metrics that no requirement is about are means. A row with
    a draw that failed to run failed.
    """
    definition = table.header.definition
    if definition.replicates is None or not any(variable.name == DRAW for variable in definition.variables):
        return table
    kept = tuple(variable for variable in definition.variables if variable.name != DRAW)
    columns = [np.asarray(table.points[variable.name], dtype=np.float64) for variable in kept]
    _, names = np.unique(np.array(table.configurations, dtype=np.str_), return_inverse=True)
    group = groups_of(np.column_stack([names.reshape(-1), *(np.nan_to_num(each, nan=np.inf) for each in columns)]))
    draws = np.asarray(table.points[DRAW], dtype=np.float64)
    block = table.block
    decided = decide(group, block.verdicts, block.margins, shares_of(definition), draws > 0)
    first = np.unique(group, return_index=True)[1]
    lead = _leading(decided, first)
    order = np.argsort(table.numbers[lead])
    lead = lead[order]
    metrics = merged_metrics(group, block.metrics, definition, decided)[order]
    rows = RowBlock(
        table.numbers[lead],
        np.bincount(group, ~block.done, len(first))[order] == 0,
        metrics,
        decided.codes[order],
        _at(block.margins, decided.rows)[order],
        block.wall[lead],
        _problems(table, group, lead, order),
    )
    replicates = definition.replicates
    rates = replace(
        decided.rates.part(order),
        confidence=replicates.confidence,
        sequential=replicates.at_least < replicates.at_most,
    )
    fewer, header = len(table) - len(rows), table.header
    return RunTable(
        replace(
            header,
            definition=replace(definition, variables=kept),
            runs=header.runs - fewer,
            asked=header.asked - fewer,
        ),
        rows,
        tuple(table.configurations[row] for row in lead.tolist()),
        {variable.name: table.points[variable.name][lead] for variable in kept},
        table.checks.of(rows.numbers) if len(table.checks) else table.checks,
        rates,
    )


def outcomes_over_draws(outcomes: Outcomes, group: NDArray[np.intp], definition: StudyDefinition) -> Outcomes:
    """*outcomes* with one row for each *group* of them, (n,), numbered from 0; draws are not among their points."""
    first = np.unique(group, return_index=True)[1]
    names = [requirement.name for requirement in definition.requirements]
    codes = np.array([[VERDICTS.index(v) for v in outcomes.verdicts[name]] for name in names], dtype=np.uint8)
    margins = np.array([outcomes.margins[name] for name in names], dtype=np.float64)
    n, draws = len(outcomes), outcomes.points[DRAW]
    decided = decide(
        group, codes.reshape(len(names), n).T, margins.reshape(len(names), n).T, shares_of(definition), draws > 0
    )
    metrics = np.array([*outcomes.metrics.values()], dtype=np.float64).reshape(len(outcomes.metrics), n).T
    merged = merged_metrics(group, metrics, definition, decided, tuple(outcomes.metrics))
    at_rows = _at(margins.reshape(len(names), n).T, decided.rows)
    return Outcomes(
        tuple(outcomes.configurations[row] for row in first.tolist()),
        {name: values[first] for name, values in outcomes.points.items() if name != DRAW},
        np.asarray(np.bincount(group, ~outcomes.done, len(first)) == 0),
        {name: merged[:, column] for column, name in enumerate(outcomes.metrics)},
        {name: at_rows[:, column] for column, name in enumerate(names)},
        {name: tuple(VERDICTS[code] for code in decided.codes[:, k].tolist()) for k, name in enumerate(names)},
        {name: values[first] for name, values in outcomes.totals.items()},
    )


def draws_sentence(definition: StudyDefinition, points: int) -> str:
    """How many draws verdicts on so many *points* rest on; "" if there is no noise."""
    varied = {variable.name for variable in definition.variables}
    streams = {name for each in definition.configurations for name in each.streams} - varied
    if not streams:
        return ""
    draws = definition.replicates
    if draws is None:
        parts = {name.rpartition(".")[0] for name in streams}
        where = f"in {len(parts)} parts" if len(parts) > 1 else f"of {next(iter(parts))}"
        hint = "'replicates: 20' in the study estimates how often they hold"
        return f"verdicts rest on one draw of the noise {where}: {hint}"
    count = f"{draws.at_least} … {draws.at_most}" if draws.at_least < draws.at_most else str(draws.at_least)
    shares = sorted({requirement.met_in for requirement in definition.requirements})
    among = " … ".join(f"{100 * share:g}" for share in dict.fromkeys((shares[0], shares[-1]))) if shares else ""
    what = f"verdicts are on {points} points, each with {count} draws of the noise"
    return f"{what}; a requirement is met if it is in at least {among} % of them" if shares else what


def groups_of(keys: NDArray[np.float64]) -> NDArray[np.intp]:
    """A number for each row of *keys*, (n, k), from 0 in the order of first rows; equal rows have the same, (n,)."""
    if not len(keys):
        return np.zeros(0, dtype=np.intp)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[inverse.reshape(-1)]


def merged_metrics(
    group: NDArray[np.intp],
    metrics: NDArray[np.float64],
    definition: StudyDefinition,
    decided: Decided,
    names: Sequence[str] | None = None,
) -> NDArray[np.float64]:
    """The metrics of each group, (g, m), of those of its rows, (n, m): of the row that decides, else their mean."""
    names = [metric.name for metric in definition.metrics] if names is None else names
    about: dict[str, int] = {}
    for number, requirement in enumerate(definition.requirements):
        about.setdefault(requirement.metric, number)
    count = len(decided.codes)
    sizes = np.bincount(group, minlength=count)
    found = np.empty((count, len(names)))
    for column, name in enumerate(names):
        if name in about:
            found[:, column] = metrics[decided.rows[:, about[name]], column]
        else:
            found[:, column] = np.bincount(group, metrics[:, column], count) / sizes
    return found


def _at(values: NDArray[np.float64], rows: NDArray[np.intp]) -> NDArray[np.float64]:
    return np.take_along_axis(values, rows, axis=0) if rows.size else np.zeros(rows.shape)


def _leading(decided: Decided, first: NDArray[np.intp]) -> NDArray[np.intp]:
    """The row that stands for each group: of the first requirement that is missed, else of the first one."""
    missed = decided.codes == _FAIL
    if not missed.shape[1]:
        return first
    column = np.where(missed.any(axis=1), missed.argmax(axis=1), 0)
    return np.take_along_axis(decided.rows, column[:, None], axis=1)[:, 0]


def _problems(
    table: RunTable, group: NDArray[np.intp], lead: NDArray[np.intp], order: NDArray[np.intp]
) -> dict[int, str]:
    said: dict[int, list[str]] = {}
    sizes = np.bincount(group)
    for row, text in enumerate(table.problems):
        if text:
            said.setdefault(int(group[row]), []).append(text)
    return {
        int(table.numbers[row]): f"{said[g][0]} (in {len(said[g])} of {sizes[g]} draws)"
        for row, g in zip(lead.tolist(), order.tolist(), strict=True)
        if g in said
    }
