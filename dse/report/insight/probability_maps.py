"""How probable it is that a requirement is met between the runs, on planes of two variables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dse.analysis import StudyData, drawn, model_first_order_shares, robust_centre, worst_designs
from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import DefinedVariable
from dse.domain.sampler import DesignVariable, Role
from dse.errors import DseError, fail
from dse.exploration import Band, Chances, design_variable, equal_rows, scaled, unit_of
from dse.report.content.data import Floats
from dse.report.content.insight import Around, ChanceMap
from dse.report.insight.findings import whole_of
from dse.report.insight.naming import Naming
from dse.report.insight.sample import part_of_table
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
) -> tuple[tuple[ChanceMap, ...], tuple[Around, ...], tuple[str, ...]]:
    """A map for each requirement that some runs of a part meet and others do not, and one around each robust centre;
    and why there is none of others."""
    if len(table.header.variables) < 2:
        return (), (), ()
    found: list[ChanceMap] = []
    around: list[Around] = []
    reasons: list[str] = []
    for data in parts:
        first = len(found)
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
        if len(found) > first:
            try:
                around.append(_around(table, data, found[first].plane, naming))
            except DseError as error:
                reasons.append(f"chances of all requirements around the robust centre: {error.problems[0].what}")
    return tuple(found), tuple(around), tuple(dict.fromkeys(map(naming.spoken, reasons)))


def _map(table: RunTable, data: StudyData, name: str, naming: Naming) -> ChanceMap:
    definition = table.header.definition
    configuration = Counter(data.configurations.tolist()).most_common(1)[0][0]
    mine = np.flatnonzero(data.configurations == configuration)
    if len(set(data.codes(name)[mine].tolist()) & set(_JUDGED)) < 2:
        raise fail(f"runs of configuration {configuration} all have the same verdict")
    across, along = _plane(data, name)
    rows = drawn(mine, MOST_RUNS)
    variables = tuple(map(design_variable, definition.variables))
    names = [variable.name for variable in variables]
    x, y = names.index(across), names.index(along)
    nominal = np.array([variable.nominal for variable in variables])
    cases = _conditions(table, data, mine)
    there = _at_worst(_band(table, data, name, configuration), _grid(variables, nominal, x, y), cases)
    return ChanceMap(
        (x, y),
        naming.configurations[configuration],
        naming.requirements[name],
        SIZE,
        _percents(there.passing),
        _percents(there.misjudged),
        float((there.misjudged > _DOUBTFUL).mean()),
        _held(definition.variables, nominal, x, y),
        len(rows),
        len(mine),
        len(cases),
    )


def _around(table: RunTable, data: StudyData, plane: tuple[int, ...], naming: Naming) -> Around:
    """All requirements together, through the robust centre; those that no run of its configuration fails are met."""
    designs = worst_designs(data)
    centre, (x, y) = robust_centre(designs, whole_of(designs)), plane
    (row,) = np.flatnonzero(data.numbers == centre.number)
    configuration = str(data.configurations[row])
    mine = np.flatnonzero(data.configurations == configuration)
    variables = tuple(map(design_variable, data.definition.variables))
    (at,) = np.flatnonzero(table.numbers == centre.number)
    point = table.coordinates()[at]
    points, missing = _grid(variables, point, x, y), np.zeros(SIZE * SIZE)
    cases = _conditions(table, data, mine)
    for name in data.verdicts:
        if (data.codes(name)[mine] == _JUDGED[1]).any():
            # The least that it can be, however the requirements hang together (Fréchet).
            missing += 1 - _at_worst(_band(table, data, name, configuration), points, cases).passing
    passing = np.maximum(1 - missing, 0.0)
    middle = unit_of(point[None], variables)[0, [x, y]]
    outline = largest_ellipse(middle, passing.reshape(SIZE, SIZE), 1 - _DOUBTFUL)
    doubt = np.minimum(passing, 1 - passing)
    there = ChanceMap(
        (x, y),
        naming.configurations[configuration],
        -1,
        SIZE,
        _percents(passing),
        _percents(doubt),
        float((doubt > _DOUBTFUL).mean()),
        _held(data.definition.variables, point, x, y),
        len(drawn(mine, MOST_RUNS)),
        len(mine),
        len(cases),
    )
    return Around(centre.number, there, tuple((float(a), float(b)) for a, b in outline))


def _band(table: RunTable, data: StudyData, name: str, configuration: str) -> Band:
    """What the runs of *data* on *configuration* tell of a requirement."""
    key = ("band", name, configuration)
    if key not in data.known:
        rows = drawn(np.flatnonzero(data.configurations == configuration), MOST_RUNS)
        known = part_of_table(table, np.searchsorted(table.numbers, data.numbers[rows]))
        data.known[key] = Band(known, name, configuration)
    band: Band = data.known[key]
    return band


def _conditions(table: RunTable, data: StudyData, mine: NDArray[np.intp]) -> list[Floats]:
    """The conditions that the runs *mine* of *data* were made at: for each a point, NaN where a variable is none."""
    points = table.coordinates()[np.searchsorted(table.numbers, data.numbers[mine])]
    points[:, [each.role != Role.CONDITION for each in table.header.definition.variables]] = np.nan
    return [points[rows[0]] for rows in equal_rows(np.nan_to_num(points))]


def _at_worst(band: Band, points: Floats, cases: Sequence[Floats]) -> Chances:
    """The chances at each of *points* of a verdict at the worst of *cases*: the requirement fails if it fails at one,
    and has no verdict if it has none at any."""
    found = [band.at(np.where(np.isnan(case), points, case)) for case in cases]
    failing = np.max([each.failing for each in found], axis=0)
    without = np.min([each.without_verdict for each in found], axis=0)
    return Chances(np.maximum(1 - failing - without, 0.0), failing, without)


def _held(defined: Sequence[DefinedVariable], point: Floats, x: int, y: int) -> tuple[tuple[int, float], ...]:
    """The variables that are on no axis, and no condition, with their values."""
    units = [parse_unit(each.unit) for each in defined]
    rest = [k for k, each in enumerate(defined) if k not in (x, y) and each.role != Role.CONDITION]
    return tuple((k, units[k].from_si(float(point[k]))) for k in rest)


def _plane(data: StudyData, name: str) -> tuple[str, str]:
    """The two variables that are varied, or matter most to the requirement's metric."""
    numbers = [each.name for each in data.factors if each.variable and each.is_decided and not each.variable.values]
    if len(numbers) < 2:
        raise fail("fewer than two design variables that may have any value differ between runs")
    if len(numbers) > 2:
        metric = next(each.metric for each in data.definition.requirements if each.name == name)
        try:
            shares = {each.factor: each.share.value for each in model_first_order_shares(data, metric)}
        except DseError:
            shares = {}
        strongest = sorted(numbers, key=lambda each: -shares.get(each, 0.0))[:2]
        numbers = [each for each in numbers if each in strongest]
    return numbers[0], numbers[1]


def _grid(variables: Sequence[DesignVariable], point: Floats, x: int, y: int) -> Floats:
    """Even places in the ranges of two variables, the others as in *point*."""
    unit = np.repeat(unit_of(point[None], variables), SIZE * SIZE, axis=0)
    even = np.linspace(0, 1, SIZE)
    unit[:, x], unit[:, y] = np.tile(even, SIZE), np.repeat(even, SIZE)
    points = scaled(unit, variables)
    rest = [k for k in range(len(variables)) if k not in (x, y)]
    points[:, rest] = point[rest]
    return points


def _percents(shares: Floats) -> NDArray[np.uint8]:
    return np.round(100 * np.clip(shares, 0, 1)).astype(np.uint8)


# The largest ellipse around a point in what is allowed of a plane.


_TURNS = 36
_STRETCHES = np.geomspace(1, 8, 25)
_CORNERS = 72
_FINER = 4


def largest_ellipse(centre: Floats, field: Floats, least: float) -> Floats:
    """The outline, (72, 2), of the largest ellipse around *centre* in the unit square where *field* is *least* or more.

    The field, (n, n) with x last, is on even places, and bilinear between. Of all ellipses around the centre, those
    of 36 directions and 25 shapes up to 1 : 64 are tried; (0, 2) if the field is less at the centre already.
    """
    fine = _finer(field) >= least
    edge = ~fine & _beside(fine)
    last = len(fine) - 1
    near = np.round(centre * last).astype(int)
    if not fine[near[1], near[0]]:
        return np.empty((0, 2))
    rows, columns = np.nonzero(edge)
    away = np.stack([columns, rows], axis=1) / last - centre
    room = np.minimum(centre, 1 - centre)
    best, found = 0.0, np.empty((0, 2))
    around = np.linspace(0, 2 * np.pi, _CORNERS, endpoint=False)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    for turn in np.arange(_TURNS) * np.pi / _TURNS:
        along = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        turned = (away @ along.T) ** 2
        for stretch in _STRETCHES:
            axes = np.array([stretch, 1 / stretch])
            reach = np.sqrt((along.T**2) @ axes**2)
            squared = min(float((room / reach).min()) ** 2, float((turned @ axes**-2.0).min(initial=np.inf)))
            if squared > best * (1 + 1e-9):
                best = squared
                found = centre + np.sqrt(squared) * (circle * axes) @ along
    return found


def _finer(field: Floats) -> Floats:
    """With three places more between two of them."""
    places = np.arange((len(field) - 1) * _FINER + 1) / _FINER
    below = np.minimum(places.astype(int), len(field) - 2)
    part = places - below
    rows = field[below] * (1 - part)[:, None] + field[below + 1] * part[:, None]
    return np.asarray(rows[:, below] * (1 - part) + rows[:, below + 1] * part, dtype=np.float64)


def _beside(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Where one of the four neighbours has the flag."""
    padded = np.pad(flags, 1)
    return np.asarray(padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:])
