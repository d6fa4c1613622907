"""How probable it is that a requirement is met between the runs, on planes of two variables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dse.analysis import StudyData, drawn, first_order_shares
from dse.domain.bench import VERDICTS, Verdict
from dse.domain.sampler import DesignVariable
from dse.errors import DseError, fail
from dse.exploration import Band, design_variable, scaled, unit_of
from dse.report.content.insight import ChanceMap
from dse.report.content.nouns import Floats
from dse.report.insight.drawing import part_of_table
from dse.report.insight.naming import Naming
from dse.storage import RunTable
from dse.units import parse_unit

SIZE = 31
MOST_RUNS = 500
"""What is known from more is no clearer by much, and takes the cube of their number."""

MOST_MAPS = 6
_DOUBTFUL = 0.05
_JUDGED = [VERDICTS.index(Verdict.PASS), VERDICTS.index(Verdict.FAIL)]


def chances_of(
    table: RunTable, parts: Sequence[StudyData], naming: Naming
) -> tuple[tuple[ChanceMap, ...], tuple[str, ...]]:
    """A map for each requirement that some runs of a part meet and others do not; and why there is none of others."""
    if len(table.header.variables) < 2:
        return (), ()
    found: list[ChanceMap] = []
    reasons: list[str] = []
    for data in parts:
        for name in data.verdicts:
            codes = set(data.codes(name).tolist())
            if not set(_JUDGED) <= codes:
                continue
            if len(found) == MOST_MAPS:
                reasons.append(f"chances of {name}: the page has those of {MOST_MAPS} requirements at most")
                continue
            try:
                found.append(_map(table, data, name, naming))
            except DseError as error:
                reasons.append(f"chances of {name}: {error.problems[0].what}")
    return tuple(found), tuple(dict.fromkeys(map(naming.spoken, reasons)))


def _map(table: RunTable, data: StudyData, name: str, naming: Naming) -> ChanceMap:
    definition = table.header.definition
    configuration = Counter(data.configurations.tolist()).most_common(1)[0][0]
    mine = np.flatnonzero(data.configurations == configuration)
    if len(set(data.codes(name)[mine].tolist()) & set(_JUDGED)) < 2:
        raise fail(f"runs of configuration {configuration} all have the same verdict")
    across, along = _plane(data, name)
    rows = drawn(mine, MOST_RUNS)
    known = part_of_table(table, np.searchsorted(table.numbers, data.numbers[rows]))
    variables = tuple(map(design_variable, definition.variables))
    names = [variable.name for variable in variables]
    x, y = names.index(across), names.index(along)
    points = _grid(variables, x, y)
    there = Band(known, name, configuration).at(points)
    held = tuple(
        (k, parse_unit(each.unit).from_si(each.nominal))
        for k, each in enumerate(definition.variables)
        if k not in (x, y)
    )
    return ChanceMap(
        (x, y),
        naming.configurations[configuration],
        naming.requirements[name],
        SIZE,
        _percents(there.passing),
        _percents(there.misjudged),
        float((there.misjudged > _DOUBTFUL).mean()),
        held,
        len(rows),
        len(mine),
    )


def _plane(data: StudyData, name: str) -> tuple[str, str]:
    """The two variables that are varied, or matter most to the requirement's metric."""
    numbers = [each.name for each in data.factors if each.variable and each.is_decided and not each.variable.values]
    if len(numbers) < 2:
        raise fail("fewer than two design variables that may have any value differ between runs")
    if len(numbers) > 2:
        metric = next(each.metric for each in data.definition.requirements if each.name == name)
        try:
            shares = {each.factor: each.share.value for each in first_order_shares(data, metric)}
        except DseError:
            shares = {}
        strongest = sorted(numbers, key=lambda each: -shares.get(each, 0.0))[:2]
        numbers = [each for each in numbers if each in strongest]
    return numbers[0], numbers[1]


def _grid(variables: Sequence[DesignVariable], x: int, y: int) -> Floats:
    nominal = np.array([[variable.nominal for variable in variables]])
    unit = np.repeat(unit_of(nominal, variables), SIZE * SIZE, axis=0)
    even = np.linspace(0, 1, SIZE)
    unit[:, x], unit[:, y] = np.tile(even, SIZE), np.repeat(even, SIZE)
    points = scaled(unit, variables)
    rest = [k for k in range(len(variables)) if k not in (x, y)]
    points[:, rest] = nominal[0, rest]
    return points


def _percents(shares: Floats) -> NDArray[np.uint8]:
    return np.round(100 * np.clip(shares, 0, 1)).astype(np.uint8)
