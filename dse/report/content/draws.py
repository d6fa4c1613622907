"""The single draws behind the points of a report, so that a reader can compare two designs draw by draw."""

from __future__ import annotations

import numpy as np

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.noise import DRAW, MOST_REPLICATES
from dse.report.content.data import Draws
from dse.storage import RunTable, Scale, groups_of
from dse.units import parse_unit

MOST = 600_000
"""Numbers that a page carries at most."""

_JUDGED = [VERDICTS.index(verdict) for verdict in (Verdict.PASS, Verdict.FAIL)]


def draws_of(table: RunTable, merged: RunTable) -> Draws | None:
    """The runs of *table*, of which *merged* has one row for those that differ in their draw alone.

    None if there are no such runs, or more than `MOST` numbers.
    """
    requirements = table.header.definition.requirements
    names = tuple(dict.fromkeys(each.metric for each in requirements))
    if merged.rates is None or len(table) * max(len(names), 1) > MOST:
        return None
    group = groups_of(np.concatenate([_keys(merged, table), _keys(table, table)]))
    place = np.empty(len(table), dtype=np.int64)
    place[group[: len(merged)]] = np.arange(len(merged))
    draw = np.asarray(table.points[DRAW], dtype=np.float64)
    units = {metric.name: parse_unit(metric.unit) for metric in table.header.definition.metrics}
    return Draws(
        place[group[len(merged) :]],
        np.where(draw > 0, draw % MOST_REPLICATES + 1, 0).astype(np.int64),
        names,
        np.array([Scale(str(units[name]), units[name]).of(table.metric(name)) for name in names]),
        np.array([np.isin(table.verdicts(each.name), _JUDGED) for each in requirements], dtype=np.bool_),
    )


def _keys(table: RunTable, like: RunTable) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """What tells points apart, a row each."""
    code = {name: float(number) for number, name in enumerate(sorted(set(like.configurations)))}
    names = [variable.name for variable in table.header.definition.variables if variable.name != DRAW]
    points = (np.nan_to_num(np.asarray(table.points[name], dtype=np.float64), nan=np.inf) for name in names)
    return np.column_stack([np.array([code[name] for name in table.configurations]), *points])
