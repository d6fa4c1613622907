"""One design against another: the same cases, and in each the same draws, so that differences are not due to luck.

In a case both designs meet a draw, one of them does, or neither. Only the draws in which they differ tell them apart:
with b of n draws that the first alone meets, and c that the second alone meets, the rates differ by (b - c) / n. The
interval is Wald's for matched pairs with half a draw added to each of the four counts (Agresti and Min, Statistics in
Medicine 24, 2005), which is approximate: of 40 draws it covers the difference in 92 % or more. Where 3 % of the draws
differ, it is as narrow as one of two independent samples of 16 times as many. Without noise the difference is exact.

The report's page has the same (`paired.ts`); both are tested with `tests/pair_cases.json`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import MET, Floats
from dse.analysis.slack import FAILING
from dse.domain.definition import DefinedVariable, StudyDefinition
from dse.domain.noise import DRAW
from dse.domain.sampler import Role
from dse.errors import closest, fail
from dse.storage import RunTable

NORMAL = 1.959963984540054
"""The 97.5 % quantile."""


@dataclass(frozen=True, slots=True)
class PairedDraws:
    """What two designs came to under a *requirement* in a *case*, values (SI) by condition, in words *label*.

    Counts of draws that *both* met, *first* or *second* alone, or *neither*; of the margins (SI) the mean difference,
    first less second, with its standard *error*: 0 without noise, NaN of a single draw. *difference* of the rates is
    between *low* and *high* with 95 %.
    """

    requirement: str
    case: tuple[float, ...]
    label: str
    both: int
    first: int
    second: int
    neither: int
    margin: float
    error: float
    difference: float
    low: float
    high: float

    @property
    def draws(self) -> int:
        """How many there are of both."""
        return self.both + self.first + self.second + self.neither

    @property
    def is_certain(self) -> bool:
        """Whether the interval leaves out that they are alike."""
        return self.low > 0 or self.high < 0


def rows_of_design(table: RunTable, name: str) -> NDArray[np.intp]:
    """Rows of the design of run *name*, a number, or of the only design of the configuration whose id starts so.

    DseError if there is none, or more than one.
    """
    ids = np.array(table.configurations, dtype=np.str_)
    points = design_points(table)
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


def design_points(table: RunTable) -> Floats:
    """Values (SI) of the design variables, (variables, n); infinite where a configuration does not have one."""
    decided = [v.name for v in table.header.definition.variables if v.role == Role.DESIGN]
    columns = np.array([np.asarray(table.points[v], dtype=np.float64) for v in decided])
    return np.asarray(np.nan_to_num(columns, nan=np.inf).reshape(len(decided), len(table)))


def paired_draws(table: RunTable, one: NDArray[np.intp], other: NDArray[np.intp]) -> Iterator[PairedDraws]:
    """The designs of rows *one* and *other* of *table*, whose runs were not merged, case by case.

    A design without noise, which has one run in a case, is compared with each draw of the other.
    """
    definition = table.header.definition
    given = [v for v in definition.variables if v.role in (Role.CONDITION, Role.UNCERTAIN)]
    columns = [np.asarray(table.points[v.name], dtype=np.float64) for v in given]
    draws = np.asarray(table.points[DRAW], dtype=np.float64) if DRAW in table.points else np.zeros(len(table))
    is_random = draws > 0 if DRAW in table.points else np.isin(table.configurations, [*noisy(definition)])
    mine, theirs = ({}, {})  # type: tuple[dict[tuple[float, ...], dict[float, int]], dict[tuple[float, ...], dict[float, int]]]
    for rows, found in ((one, mine), (other, theirs)):
        for row in rows.tolist():
            found.setdefault(tuple(float(column[row]) for column in columns), {})[float(draws[row])] = row
    pairs = {case: [*_matched(mine[case], theirs[case])] for case in mine if case in theirs}
    for requirement in definition.requirements:
        codes, margins = table.verdicts(requirement.name), table.margins(requirement.name)
        for case, both in pairs.items():
            first, second = np.array(both, dtype=np.intp).reshape(-1, 2).T
            judged = np.isin(codes[first], [MET, FAILING]) & np.isin(codes[second], [MET, FAILING])
            if not judged.any():
                continue
            first, second = first[judged], second[judged]
            random = bool(is_random[first].any() or is_random[second].any())
            counted = _counts(codes[first] == MET, codes[second] == MET, random=random)
            yield PairedDraws(
                requirement.name,
                case,
                case_label(definition, case),
                *counted[:4],
                *_mean(_differences(margins[first], margins[second]), random),
                *counted[4:],
            )


def case_label(definition: StudyDefinition, case: Iterable[float]) -> str:
    """A case in words: ``speed 60 km/h, visibility 30 m``; "" if the study imposes nothing."""
    given = (v for v in definition.variables if v.role in (Role.CONDITION, Role.UNCERTAIN))
    return ", ".join(value_label(variable, value) for variable, value in zip(given, case, strict=True))


def value_label(variable: DefinedVariable, value: float) -> str:
    """A variable and its value (SI) in words: ``speed 60 km/h``."""
    from dse.units import short_symbol

    shown = variable.label(value) or f"{_shown(value, variable.unit)} {short_symbol(variable.unit)}".rstrip()
    return f"{variable.title or variable.name} {shown}"


def noisy(definition: StudyDefinition) -> Iterator[str]:
    """The configurations in which something random is not varied by the study."""
    varied = {variable.name for variable in definition.variables}
    yield from (each.id for each in definition.configurations if not varied.issuperset(each.streams))


def _matched(mine: dict[float, int], theirs: dict[float, int]) -> Iterator[tuple[int, int]]:
    """Rows of the same draw; the only row without noise, whose draw is 0, goes with every draw."""
    for draw in sorted({*mine, *theirs}):
        pair = mine.get(draw, mine.get(0.0)), theirs.get(draw, theirs.get(0.0))
        if pair[0] is not None and pair[1] is not None:
            yield pair[0], pair[1]


def _counts(
    first: NDArray[np.bool_], second: NDArray[np.bool_], *, random: bool
) -> tuple[int, int, int, int, float, float, float]:
    """How many both, the first alone, the second alone and neither meet; the difference of the rates, its interval."""
    n, b, c = len(first), int((first & ~second).sum()), int((second & ~first).sum())
    both, difference = int((first & second).sum()), (b - c) / n
    centre = (b - c) / (n + 2)
    half = NORMAL * math.sqrt(max((b + c + 1) - (b - c) ** 2 / (n + 2), 0.0)) / (n + 2)
    ends = (max(-1.0, centre - half), min(1.0, centre + half)) if random else (difference, difference)
    return both, b, c, n - both - b - c, difference, *ends


def _differences(first: Floats, second: Floats) -> Floats:
    """*first* less *second*; 0 where they are equal, also where both are infinite."""
    return np.subtract(first, second, out=np.zeros_like(first), where=first != second)


def _mean(differences: Floats, random: bool) -> tuple[float, float]:
    """The mean with its standard error."""
    n = len(differences)
    with np.errstate(invalid="ignore"):  # of infinite ones there is no deviation
        error = 0.0 if not random else float(differences.std(ddof=1) / math.sqrt(n)) if n > 1 else math.nan
    return float(differences.mean()), error


def _shown(value: float, unit: str) -> str:
    from dse.units import parse_unit, shown

    return shown(parse_unit(unit).from_si(value), 4)
