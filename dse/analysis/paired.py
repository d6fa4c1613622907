"""One design against another: the same cases, and in each the same draws, so that differences are not due to luck.

In a case both designs meet a draw, one of them does, or neither. Only the draws in which they differ tell them apart:
with b of n draws that the first alone meets, and c that the second alone meets, the rates differ by (b - c) / n. The
interval is Wald's for matched pairs with half a draw added to each of the four counts (Agresti and Min, Statistics in
Medicine 24, 2005), which is approximate: of 40 draws it covers the difference in 92 % or more. Where 3 % of the draws
differ, it is as narrow as one of two independent samples of 16 times as many.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import MET
from dse.analysis.slack import FAILING
from dse.domain.noise import DRAW
from dse.domain.sampler import Role
from dse.errors import closest, fail
from dse.storage import RunTable

_NORMAL = 1.959963984540054
"""The 97.5 % quantile."""


@dataclass(frozen=True, slots=True)
class PairedDraws:
    """What two designs came to under a *requirement* in a *case*, values (SI) by condition, in words *label*.

    Counts of draws that *both* met, *first* or *second* alone, or *neither*; of the margins (SI) the mean difference,
    first less second. *difference* of the rates is between *low* and *high* with 95 %.
    """

    requirement: str
    label: str
    both: int
    first: int
    second: int
    neither: int
    margin: float
    difference: float
    low: float
    high: float

    @property
    def is_certain(self) -> bool:
        """Whether the interval leaves out that they are alike."""
        return self.low > 0 or self.high < 0


def rows_of_design(table: RunTable, name: str) -> NDArray[np.intp]:
    """Rows of the design of run *name*, a number, or of the only design of the configuration whose id starts so.

    DseError if there is none, or more than one.
    """
    ids = np.array(table.configurations, dtype=np.str_)
    decided = [v.name for v in table.header.definition.variables if v.role == Role.DESIGN]
    columns = np.array([np.asarray(table.points[v], dtype=np.float64) for v in decided])
    points = np.nan_to_num(columns, nan=np.inf).reshape(len(decided), len(table))
    if name.isdigit() and int(name) in set(table.numbers.tolist()):
        row = int(np.searchsorted(table.numbers, int(name)))
    else:
        starting = np.flatnonzero(np.char.startswith(ids, name))
        if not len(starting):
            raise fail(
                f"the study has neither a configuration nor a run '{name}'", None, closest(name, {*ids.tolist()})
            )
        row = int(starting[0])
        same = (ids[starting] == ids[row]) & (points[:, starting] == points[:, [row]]).all(axis=0)
        if not same.all():
            raise fail(f"'{name}' is the start of several designs", None, "name a run of the design by its number")
    return np.flatnonzero((ids == ids[row]) & (points == points[:, [row]]).all(axis=0))


def paired_draws(table: RunTable, one: NDArray[np.intp], other: NDArray[np.intp]) -> Iterator[PairedDraws]:
    """The designs of rows *one* and *other* of *table*, whose runs were not merged, case by case."""
    definition = table.header.definition
    given = [v for v in definition.variables if v.role in (Role.CONDITION, Role.UNCERTAIN)]
    columns = [np.asarray(table.points[v.name], dtype=np.float64) for v in given]
    draws = np.asarray(table.points[DRAW], dtype=np.float64) if DRAW in table.points else np.zeros(len(table))
    cases = [tuple(column[row] for column in columns) for row in range(len(table))]
    theirs = {(cases[row], draws[row]): row for row in other.tolist()}
    pairs: dict[tuple[float, ...], list[tuple[int, int]]] = {}
    for row in one.tolist():
        if (match := theirs.get((cases[row], draws[row]))) is not None:
            pairs.setdefault(cases[row], []).append((row, match))
    for requirement in definition.requirements:
        codes, margins = table.verdicts(requirement.name), table.margins(requirement.name)
        for case, rows in pairs.items():
            mine, match = np.array(rows, dtype=np.intp).T
            judged = np.isin(codes[mine], [MET, FAILING]) & np.isin(codes[match], [MET, FAILING])
            if not judged.any():
                continue
            first, second = codes[mine][judged] == MET, codes[match][judged] == MET
            label = ", ".join(
                f"{v.title or v.name} {v.label(value) or f'{_shown(value, v.unit)} {v.unit}'.rstrip()}"
                for v, value in zip(given, case, strict=True)
            )
            yield _paired(
                requirement.name, label, first, second, float(np.mean((margins[mine] - margins[match])[judged]))
            )


def _paired(
    requirement: str, label: str, first: NDArray[np.bool_], second: NDArray[np.bool_], margin: float
) -> PairedDraws:
    n, b, c = len(first), int((first & ~second).sum()), int((second & ~first).sum())
    centre = (b - c) / (n + 2)
    half = _NORMAL * math.sqrt(max((b + c + 1) - (b - c) ** 2 / (n + 2), 0.0)) / (n + 2)
    both = int((first & second).sum())
    low, high = max(-1.0, centre - half), min(1.0, centre + half)
    return PairedDraws(requirement, label, both, b, c, n - both - b - c, margin, (b - c) / n, low, high)


def _shown(value: float, unit: str) -> str:
    from dse.units import parse_unit, shown

    return shown(parse_unit(unit).from_si(value), 4)
