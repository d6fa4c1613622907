"""The C of a road: the core in ``dse/world/core`` with the tables that it interprets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import comb
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.world.in_the_way import HEIGHTS, LEVEL, STEEPEST
from dse.world.opendrive.roadside import COLOURS
from dse.world.tables import Conflict, LaneBand, Light, Piecewise, RoadPath, RoadTables

STRUCT = "road"
"""The name of the struct in C, and of the header."""

Array = NDArray[np.float64]

_CORE = Path(__file__).parent / "core"
_SAME = 1e-9  # m; pieces that begin so near to each other begin together
_LENGTH_ERROR = 1e-9  # m in the middle of each piece
_LINE_NUMBERS = 6  # of x and of y in a row; the core counts on it


def road_files(tables: RoadTables) -> dict[str, str]:
    """The files by name, for the FMU of a component of the interface ``road``."""
    return {**core_files("*.[ch]"), **table_files(tables)}


def core_files(pattern: str) -> dict[str, str]:
    """The files of the core with names like *pattern*."""
    return {path.name: path.read_text("utf-8") for path in sorted(_CORE.glob(pattern))}


def table_files(tables: RoadTables) -> dict[str, str]:
    """The file with the tables."""
    laid = [_lengths(path, _common_starts(path)) for path in tables.paths]
    texts = [_path_text(path, number, *laid[number]) for number, path in enumerate(tables.paths)]
    arrays = [_array("path_table paths", [table for _, table in texts])]
    if tables.conflicts:
        rows = [_conflict(each, tables.paths, laid) for each in tables.conflicts]
        arrays.append(_array("path_conflict conflicts", rows))
    arrays.append(_array("double heights", [repr(height) for height in HEIGHTS]))
    count, conflicts = len(tables.conflicts), "conflicts" if tables.conflicts else "0"
    rule = f"{{heights, {len(HEIGHTS)}, {LEVEL!r}, {STEEPEST!r}}}"
    network = f"const road_network road_tables = {{{len(texts)}, {count}, paths, {conflicts}, {rule}}};\n"
    return {"road_tables.c": "\n".join(['#include "path.h"\n', *(numbers for numbers, _ in texts), *arrays, network])}


def along_own_lane(path: RoadPath) -> Piecewise:
    """How far along the middle of the path's own lane its stations are, in m, as the core has it."""
    starts, lengths = _lengths(path, _common_starts(path))
    return Piecewise(starts, lengths[0])


class _Columns:
    """Numbers side by side, a row for each piece of a path that begins at *starts*."""

    def __init__(self, starts: Array) -> None:
        self.starts = starts
        self.blocks = [starts[:, None]]

    def put(self, block: Array) -> str:
        """*block* (pieces, coefficients); in C, where it begins and how many columns it has. Zeros have none."""
        at = sum(each.shape[1] for each in self.blocks)
        used = np.flatnonzero(np.any(block != 0, axis=0))
        count = int(used[-1]) + 1 if len(used) else 0
        self.blocks.append(block[:, :count])
        return f"{{{at}, {count}}}"


def _path_text(path: RoadPath, number: int, starts: Array, lengths: list[Array]) -> tuple[str, str]:
    """The numbers of a path, and the table that says what they mean."""
    columns = _Columns(starts)
    for line in (path.x, path.y):
        columns.blocks.append(_wide(_moved(line, starts), _LINE_NUMBERS))
    quantities = {
        "height": columns.put(_moved(path.height, starts)),
        "bank": columns.put(_moved(path.bank, starts)),
        "limit": columns.put(_moved(path.speed_limit, starts)),
    }
    lanes = []
    for lane, along in zip(path.lanes, lengths, strict=True):
        width = np.subtract(*_alike(_moved(lane.left, starts), _moved(lane.right, starts)))
        blocks = _middle(lane, starts), width, _slipperiness(lane, starts), along
        places = [columns.put(block) for block in blocks]
        lanes.append(f"{{{lane.number}, {lane.users}, {', '.join(places)}}}")
    patches = [_numbers((p.start, p.end, p.right, p.left, p.friction)) for p in path.patches]
    rows = np.hstack(columns.blocks)
    numbered = [(light, f"phases_{number}_{i}") for i, light in enumerate(path.lights)]
    phases = [_array(f"path_phase {name}", _phases(light)) for light, name in numbered if light.phases]
    lights = [_light(light, name, _along(light.station, starts, lengths[0])) for light, name in numbered]
    arrays = [
        _array(f"double rows_{number}", [_numbers(row)[1:-1] for row in rows]),
        _array(f"path_lane lanes_{number}", lanes),
        *([_array(f"path_patch patches_{number}", patches)] if patches else []),
        *phases,
        *([_array(f"path_light lights_{number}", lights)] if lights else []),
    ]
    fields = {
        "length": repr(float(path.length)),
        "closed": str(path.closed).lower(),
        "has_slippery_lanes": str(any(np.any(_slipperiness(lane, starts)) for lane in path.lanes)).lower(),
        "pieces": rows.shape[0],
        "stride": rows.shape[1],
        "rows": f"rows_{number}",
        **quantities,
        "lane_count": len(lanes),
        "lanes": f"lanes_{number}",
        "patch_count": len(patches),
        "patches": f"patches_{number}" if patches else 0,
        "light_count": len(lights),
        "leftmost": path.leftmost,
        "rightmost": path.rightmost,
        "lights": f"lights_{number}" if lights else 0,
    }
    return "\n".join(arrays), "{" + ", ".join(f".{name} = {value}" for name, value in fields.items()) + "}"


def _phases(light: Light) -> list[str]:
    return [f"{{{1 + COLOURS.index(colour)}, {float(seconds)!r}}}" for colour, seconds in light.phases]


def _light(light: Light, phases: str, along: float) -> str:
    numbers = ", ".join(repr(float(each)) for each in (along, light.shift, sum(seconds for _, seconds in light.phases)))
    return f"{{{numbers}, {len(light.phases)}, {phases if light.phases else 0}}}"


def _conflict(conflict: Conflict, paths: Sequence[RoadPath], laid: Sequence[tuple[Array, list[Array]]]) -> str:
    def along(path: int, station: float) -> float:
        starts, lengths = laid[path]
        rounds, rest = divmod(station, paths[path].length) if paths[path].closed else (0.0, station)
        return rounds * _along(paths[path].length, starts, lengths[0]) + _along(rest, starts, lengths[0])

    one, other = (
        [str(path), *(repr(along(path, station)) for station in stations)]
        for path, *stations in (
            (conflict.path, conflict.entry, conflict.exit),
            (conflict.other_path, conflict.other_entry, conflict.other_exit),
        )
    )
    return "{" + ", ".join([*one, *other, str(conflict.gives_way).lower()]) + "}"


def _along(station: float, starts: Array, lengths: Array) -> float:
    """How far along the middle of a lane a station is, by its *lengths* on the pieces."""
    piece = max(int(np.searchsorted(starts, station, side="right")) - 1, 0)
    return float(np.polynomial.polynomial.polyval(station - starts[piece], lengths[piece]))


def _slipperiness(lane: LaneBand, starts: Array) -> Array:
    friction = _moved(lane.friction, starts)
    return np.eye(1, friction.shape[1]) - friction


def _array(name: str, items: Sequence[str]) -> str:
    lines = ",\n".join(f"    {item}" for item in items)
    return f"static const {name}[] = {{\n{lines},\n}};\n"


def _numbers(values: Iterable[float]) -> str:
    return "{" + ", ".join(repr(float(value)) for value in values) + "}"


def _common_starts(path: RoadPath) -> Array:
    """Where a piece of anything along *path* begins."""
    lanes = [each for lane in path.lanes for each in (lane.left, lane.right, lane.friction)]
    pieces = [path.x, path.y, path.height, path.bank, path.speed_limit, *lanes]
    starts = np.unique(np.concatenate([piece.starts for piece in pieces]))
    starts = starts[starts < path.length - _SAME]
    return starts[np.diff(starts, prepend=-np.inf) > _SAME]


def _moved(pieces: Piecewise, starts: Array) -> Array:
    """The coefficients of *pieces* (len(starts), order), those that count from *starts*."""
    old = np.searchsorted(pieces.starts, starts + _SAME, side="right") - 1
    by = starts - pieces.starts[old]
    given = pieces.coefficients[old]
    moved = np.zeros_like(given)
    for j in range(given.shape[1]):
        for k in range(j + 1):
            moved[:, k] += given[:, j] * comb(j, k) * by ** (j - k)
    return moved


def _wide(coefficients: Array, count: int) -> Array:
    return np.pad(coefficients, ((0, 0), (0, count - coefficients.shape[1])))


def _alike(*given: Array) -> list[Array]:
    count = max(each.shape[1] for each in given)
    return [_wide(each, count) for each in given]


def _lengths(path: RoadPath, starts: Array) -> tuple[Array, list[Array]]:
    """Lengths along the lanes' middles, as polynomials on pieces; these are halved until all are exact enough."""
    while True:
        pieces = np.diff([*starts, path.length])
        fits = [_fitted(_moved(path.x, starts), _moved(path.y, starts), _middle(lane, starts), pieces)
                for lane in path.lanes]  # fmt: skip
        coarse = np.max([errors for _, errors in fits], axis=0) > _LENGTH_ERROR
        if not np.any(coarse):
            return starts, [along for along, _ in fits]
        starts = np.sort(np.concatenate([starts, (starts + pieces / 2)[coarse]]))


def _middle(lane: LaneBand, starts: Array) -> Array:
    left, right = _alike(_moved(lane.left, starts), _moved(lane.right, starts))
    return (left + right) / 2


def _fitted(x: Array, y: Array, middle: Array, lengths: Array) -> tuple[Array, Array]:
    """The length of the line *middle* beside (x, y) on each piece as a quintic, and its error in the piece's middle."""
    if not np.any(middle):  # stations are lengths
        begins = np.cumsum(lengths) - lengths
        return np.column_stack([begins, np.ones_like(begins)]), np.zeros_like(lengths)

    def per_station(u: Array) -> tuple[Array, Array]:
        """Length per station at *u* (pieces, points), and its derivative."""
        (_, x1, x2, x3), (_, y1, y2, y3), (t, t1, t2, _) = (_derivatives(each, u) for each in (x, y, middle))
        stretch = np.hypot(x1, y1)
        turning = (x1 * y2 - y1 * x2) / stretch**2
        slope = (x1 * x2 + y1 * y2) / stretch
        turning_slope = (x1 * y3 - y1 * x3) / stretch**2 - 2 * turning * slope / stretch
        ahead, ahead_slope = stretch - turning * t, slope - turning_slope * t - turning * t1
        found = np.hypot(ahead, t1)
        return found, (ahead * ahead_slope + t1 * t2) / found

    nodes, weights = np.polynomial.legendre.leggauss(10)
    h = lengths[:, None]

    def covered(end: Array) -> Array:
        sums: Array = (per_station((nodes + 1) / 2 * end)[0] * weights).sum(axis=1)
        return sums * end[:, 0] / 2

    whole, half = covered(h), covered(h / 2)
    rate, slope = per_station(np.hstack([0 * h, h]))
    d0, d1, e0, e1, h = rate[:, 0], rate[:, 1], slope[:, 0], slope[:, 1], lengths
    begins = np.concatenate([[0.0], np.cumsum(whole)[:-1]])
    fit = np.column_stack([
        begins,
        d0,
        e0 / 2,
        (20 * whole - (8 * d1 + 12 * d0) * h - (3 * e0 - e1) * h**2) / (2 * h**3),
        (-30 * whole + (14 * d1 + 16 * d0) * h + (3 * e0 - 2 * e1) * h**2) / (2 * h**4),
        (12 * whole - 6 * (d1 + d0) * h - (e0 - e1) * h**2) / (2 * h**5),
    ])  # fmt: skip
    return fit, np.abs(_derivatives(fit, h[:, None] / 2)[0][:, 0] - begins - half)


def _derivatives(coefficients: Array, u: Array) -> list[Array]:
    """The polynomials (pieces, order) at *u* (pieces, points), and their first three derivatives."""
    found = []
    for _ in range(4):
        value = np.zeros_like(u)
        for column in coefficients.T[::-1]:
            value = value * u + column[:, None]
        found.append(value)
        coefficients = coefficients[:, 1:] * np.arange(1, coefficients.shape[1])
    return found
