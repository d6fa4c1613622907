"""All runs of a study as columns."""

from __future__ import annotations

import json
import math
import sqlite3
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS
from dse.domain.component import Value
from dse.domain.rates import Rates
from dse.domain.run import ERROR_BAR, Outcome, Run, RunRequest
from dse.domain.sampler import Outcomes
from dse.storage.checks import CERTAINTIES, NO_CHECKS, Certainty, Checks, certainties, certainties_by_bars
from dse.storage.database.checks import read_checks
from dse.storage.database.header import StudyHeader
from dse.storage.database.row_checksum import Cells, cells_of, row_checksums
from dse.storage.database.schema import SEALED, columns, quoted, value_of
from dse.storage.rows import RowBlock

_AT_ONCE = 10_000

_CODES = {str(verdict): code for code, verdict in enumerate(VERDICTS)}


@dataclass(frozen=True, slots=True, eq=False)
class RunTable:
    """The n finished runs of a study, sorted by number; metrics, margins and points in SI.

    *block* holds outcome, metrics, verdicts and margins; *configurations* n ids; *points* one column of n values
    per design variable (float64, NaN where a configuration does not have it, or objects where one is no number).
    *block.wall* is not read (NaN). *checks* are those of runs of the table. With *rates* a row stands for all draws of
    its point (`dse.storage.over_draws`).
    """

    header: StudyHeader
    block: RowBlock
    configurations: tuple[str, ...]
    points: Mapping[str, NDArray[Any]]
    checks: Checks = NO_CHECKS
    rates: Rates | None = None

    def __len__(self) -> int:
        return len(self.block)

    @property
    def numbers(self) -> NDArray[np.int64]:
        """Numbers of the runs, (n,)."""
        return self.block.numbers

    @property
    def done(self) -> NDArray[np.bool_]:
        """Whether each run came to its end, (n,)."""
        return self.block.done

    @property
    def problems(self) -> tuple[str, ...]:
        """What each run has to say of itself, "" if nothing."""
        return tuple(self.block.problems.get(number, "") for number in self.numbers.tolist())

    def metric(self, name: str) -> NDArray[np.float64]:
        """Values of the metric *name*, (n,), NaN where undefined; ValueError if there is none."""
        return self.block.metrics[:, self.header.metrics.index(name)]

    def verdicts(self, requirement: str) -> NDArray[np.uint8]:
        """Verdicts on *requirement* as positions in `VERDICTS`, (n,); ValueError if there is none."""
        return self.block.verdicts[:, self.header.requirements.index(requirement)]

    def margins(self, requirement: str) -> NDArray[np.float64]:
        """Margins of *requirement*, (n,), NaN where undefined; ValueError if there is none."""
        return self.block.margins[:, self.header.requirements.index(requirement)]

    @property
    def are_all_checked(self) -> bool:
        """Whether every run has error bars, as metrics of their own."""
        return any(metric.error_of for metric in self.header.definition.metrics)

    @property
    def has_checks(self) -> bool:
        """Whether there are error bars."""
        return self.are_all_checked or len(self.checks) > 0

    @property
    def has_certainties(self) -> bool:
        """Whether there is anything that `certainties` can tell."""
        return self.has_checks or self.rates is not None

    def errors(self, metric: str) -> NDArray[np.float64]:
        """The error bars of *metric*, (n,), NaN where there is none."""
        if self.are_all_checked:
            return self.metric(f"{metric}{ERROR_BAR}")
        found = np.full(len(self), np.nan)
        if len(self.checks):
            found[self._checked] = self.checks.errors[:, self.header.metrics.index(metric)]
        return found

    def certainties(self, requirement: str) -> NDArray[np.uint8]:
        """How certain the verdicts on *requirement* are, (n,), as positions in `CERTAINTIES`."""
        at = self.header.requirements.index(requirement)
        metric = self.header.definition.requirements[at].metric
        verdicts, margins, errors = self.verdicts(requirement), self.margins(requirement), self.errors(metric)
        found = np.zeros(len(self), dtype=np.uint8)
        if self.are_all_checked:
            found = certainties_by_bars(verdicts, margins, errors)
        elif len(self.checks):
            rows = self._checked
            found[rows] = certainties(verdicts[rows], margins[rows], errors[rows], self.checks.verdicts[:, at])
        if self.rates is not None:
            share = self.header.definition.requirements[at].met_in
            found[self.rates.doubtful(at, share)] = CERTAINTIES.index(Certainty.DOUBTFUL)
        return found

    @property
    def _checked(self) -> NDArray[np.intp]:
        return np.searchsorted(self.numbers, self.checks.numbers)

    def requests(self) -> Iterator[RunRequest]:
        """What was asked for, run by run."""
        names = self.header.variables
        points = zip(*(self.points[name].tolist() for name in names), strict=True) if names else [()] * len(self)
        for number, configuration, point in zip(self.numbers.tolist(), self.configurations, points, strict=True):
            # What is not a number is a variable that the configuration does not have.
            there = {name: value for name, value in zip(names, point, strict=True) if value == value}  # noqa: PLR0124
            yield RunRequest(number, configuration, there)

    def runs(self) -> Iterator[Run]:
        """The runs one by one, without waveforms."""
        return self.block.runs(self.requests(), self.header.measures)

    def coordinates(self) -> NDArray[np.float64]:
        """The points, (n, variables); a variable that a configuration does not have is at its nominal value."""
        columns = [np.asarray(self.points[name], dtype=np.float64) for name in self.header.variables]
        nominal = [variable.nominal for variable in self.header.definition.variables]
        points = np.array(columns).reshape(len(columns), len(self)).T
        return np.where(np.isnan(points), np.array(nominal), points)

    def outcomes(self, numbers: Sequence[int], totals: Sequence[str] = ()) -> Outcomes:
        """What came of the runs of *numbers*, in this order, as a sampler is told it, with *totals* of properties."""
        rows = np.searchsorted(self.numbers, numbers) if len(self) else np.zeros(0, dtype=np.intp)
        header = self.header
        verdicts = {name: self.verdicts(name)[rows].tolist() for name in header.requirements}
        configurations = tuple(self.configurations[row] for row in rows.tolist())
        points = self.coordinates()[rows]
        return Outcomes(
            configurations,
            {name: points[:, column] for column, name in enumerate(header.variables)},
            self.done[rows],
            {name: self.metric(name)[rows] for name in header.metrics},
            {name: self.margins(name)[rows] for name in header.requirements},
            {name: tuple(VERDICTS[code] for code in codes) for name, codes in verdicts.items()},
            {name: np.array([header.total(each, name) for each in configurations]) for name in totals},
        )


def read_table(connection: sqlite3.Connection, header: StudyHeader, numbers: Sequence[int] = ()) -> RunTable:
    """The runs of *numbers* that are stored, or all of them if *numbers* is empty.

    ValueError if a row holds what no study of *header* can have.
    """
    names = columns(header)
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    choice = ", ".join([*map(quoted, names), "seal" if version >= SEALED else "NULL"])
    where = "WHERE number IN (SELECT value FROM json_each(?))" if numbers else ""
    query = f"SELECT {choice} FROM runs {where} ORDER BY number"  # noqa: S608  # quoted
    cursor = connection.execute(query, [json.dumps([*map(int, numbers)])] if numbers else [])
    parts = [_part(header, [()] * len(names))]
    # A few rows at a time: as Python's numbers they take ten times the memory.
    while rows := cursor.fetchmany(_AT_ONCE):
        *cells, checked = map(cells_of, zip(*rows, strict=True))
        _refuse_changed_rows(cells, checked)
        parts.append(_part(header, cells))
    table = _joined(header, parts)
    checks = read_checks(connection, header, numbers)
    if strange := set(checks.numbers.tolist()) - set(table.numbers.tolist() if len(checks) else ()):
        raise ValueError(f"there is a check of run {min(strange)}, which is not there")
    return replace(table, checks=checks)


def read_verdicts(connection: sqlite3.Connection, requirements: Sequence[str]) -> Mapping[tuple[str, ...], int]:
    """How many runs came to each combination of verdicts on *requirements*."""
    names = ", ".join(quoted(f"verdict:{name}") for name in requirements)
    if not names:
        return {(): int(connection.execute("SELECT count(*) FROM runs WHERE outcome <> 'failed'").fetchone()[0])}
    rows = connection.execute(f"SELECT {names}, count(*) FROM runs GROUP BY {names}")  # noqa: S608  # quoted
    return {row[:-1]: row[-1] for row in rows}


def _refuse_changed_rows(columns: Sequence[Cells], checked: Cells) -> None:
    """ValueError for a row that is not what was written; one of an earlier version's study does not tell."""
    for number, checksum, now in zip(columns[0], checked, row_checksums(columns).tolist(), strict=True):
        if checksum != now and checksum is not None and checksum == checksum:  # noqa: PLR0124  # NaN where there is none
            raise ValueError(f"run {number} is not what was written")


def _joined(header: StudyHeader, parts: list[RunTable]) -> RunTable:
    """*parts* one after the other."""

    def joined(column: Callable[[RunTable], NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate([column(part) for part in parts])

    block = RowBlock(
        joined(lambda part: part.block.numbers),
        joined(lambda part: part.block.done),
        joined(lambda part: part.block.metrics),
        joined(lambda part: part.block.verdicts),
        joined(lambda part: part.block.margins),
        joined(lambda part: part.block.wall),
        {number: text for part in parts for number, text in part.block.problems.items()},
    )
    configurations = tuple(name for part in parts for name in part.configurations)
    points = {name: joined(partial(_point_of, name)) for name in header.variables}
    return RunTable(header, block, configurations, points)


def _point_of(name: str, part: RunTable) -> NDArray[Any]:
    return part.points[name]


def _part(header: StudyHeader, given: Sequence[Cells]) -> RunTable:
    cells, n = dict(zip(columns(header), given, strict=True)), len(given[0])
    _refuse_strangers(cells, header)
    block = RowBlock(
        np.array(cells["number"], dtype=np.int64),
        np.array([entry == Outcome.DONE for entry in cells["outcome"]], dtype=np.bool_),
        _matrix(cells, n, "m", header.metrics),
        np.array(
            [[_CODES[entry] for entry in cells[f"verdict:{name}"]] for name in header.requirements], dtype=np.uint8
        )
        .reshape(len(header.requirements), n)
        .T,
        _matrix(cells, n, "margin", header.requirements),
        np.full(n, np.nan),
        {number: text for number, text in zip(cells["number"], cells["problem"], strict=True) if text},
    )
    ids = {name: name for name in header.configurations}
    return RunTable(header, block, tuple(ids[name] for name in cells["configuration"]), _points(cells, header))


def _refuse_strangers(cells: Mapping[str, Any], header: StudyHeader) -> None:
    """ValueError for a number, configuration, outcome or verdict that the study does not have."""
    known: list[tuple[str, set[Any], Any]] = [
        ("configuration", set(header.configurations), cells["configuration"]),
        ("outcome", {str(outcome) for outcome in Outcome}, cells["outcome"]),
        *((f"verdict on {name}", set(_CODES), cells[f"verdict:{name}"]) for name in header.requirements),
    ]
    for what, those, column in known:
        strange = set(column) - those
        if strange:
            raise ValueError(f"a run has the unknown {what} '{min(strange)}'")
    # They are sorted.
    if cells["number"] and not 0 <= cells["number"][0] <= cells["number"][-1] < header.numbers:
        first, last = cells["number"][0], cells["number"][-1]
        raise ValueError(f"there are runs {first} to {last} in a study of {header.numbers}")


def _matrix(cells: Mapping[str, Any], n: int, kind: str, names: Sequence[str]) -> NDArray[np.float64]:
    # NULL comes as None, which numpy reads as NaN.
    return np.array([cells[f"{kind}:{name}"] for name in names], dtype=np.float64).reshape(len(names), n).T


def _points(cells: Mapping[str, Any], header: StudyHeader) -> dict[str, NDArray[Any]]:
    points = {name: _point(name, cells[f"p:{name}"]) for name in header.variables}
    for name, column in points.items():
        if column.dtype == object and not all(type(value) in (int, float) for value in column.tolist()):
            raise ValueError(f"a run has no number for {name}")
    return points


def _point(name: str, cells: Cells) -> NDArray[Any]:
    if not len(cells) or isinstance(cells, np.ndarray):
        numbers = np.asarray(cells, dtype=np.float64)
        if np.isinf(numbers).any():
            raise ValueError(f"a run has an infinite {name}")
        return numbers
    values: list[Value] = [_value(name, cell) for cell in cells]
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return column


def _value(name: str, cell: object) -> Value:
    value = None
    if isinstance(cell, float | str):
        with suppress(ValueError):
            value = value_of(cell)
    if not isinstance(value, bool | int | float | str) or (isinstance(value, float) and not math.isfinite(value)):
        raise ValueError(f"a run has an unreadable {name}: {str(cell)[:40]}")
    return value
