"""Runs, and what every function and operator of metrics makes of them; the report's page is tested with the same file.

``python tests/metric_program_cases.py`` writes the file anew.
"""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Metric, Requirement
from dse.domain.component import Kind, Type
from dse.errors import Location
from dse.expression.parse import parse_expression
from dse.metrics import MetricProgram, compile_metrics, program_as_data
from dse.units import DIMENSIONLESS, parse_unit

FILE = Path(__file__).with_suffix(".json")
HERE = Location("bench.yaml", 1, 1)
Floats = NDArray[np.float64]


def _real(unit: str = "") -> Type:
    return Type(Kind.REAL, parse_unit(unit))


SIGNALS = {
    "a.x": _real("m"),
    "a.v": _real("m/s"),
    "a.seen": Type(Kind.BOOLEAN),
    "a.mode": Type(Kind.ENUMERATION, items=("off", "on", "lost")),
}
CONSTANTS = {
    "c.target": _real("m"),
    "c.band": _real(),
    "c.share": _real(),
    "c.window": _real("s"),
    "c.brake": _real("m/s2"),
    "c.active": Type(Kind.BOOLEAN),
}
VALUES = (
    {"c.target": 20.0, "c.band": 0.1, "c.share": 0.83, "c.window": 0.71, "c.brake": 4.0, "c.active": 1.0},
    {"c.target": 7.3, "c.band": -0.1, "c.share": 0.0, "c.window": 0.0, "c.brake": 0.5, "c.active": 0.0},
    {"c.target": 0.0, "c.band": 0.02, "c.share": 1.0, "c.window": "Infinity", "c.brake": -1.0, "c.active": 1.0},
    {"c.target": -3.0, "c.band": 0.5, "c.share": 1.5, "c.window": 3.0, "c.brake": 40.0, "c.active": 0.0},
    {"c.target": 4.0, "c.band": 0.25, "c.share": 0.25, "c.window": 2.0, "c.brake": 0.0, "c.active": 1.0},
    {"c.target": "NaN", "c.band": "NaN", "c.share": "NaN", "c.window": "NaN", "c.brake": "NaN", "c.active": 1.0},
)

_OF_X = (
    *("minimum(a.x)", "maximum(a.x)", "initial(a.x)", "final(a.x)", "mean(a.x)", "rms(a.x)", "integral(a.x)"),
    *("overshoot(a.x, c.target)", "undershoot(a.x, c.target)", "rise_time(a.x, c.target)"),
    *("reach_time(a.x, c.target)", "reach_time(a.x, c.target, c.band)"),
    *("reach_time(a.x, c.target - 4 m)", "reach_time(-a.x, 4 m - c.target)"),
    *("settling_time(a.x, c.target)", "settling_time(a.x, c.target, c.band)"),
    *("steady_state_error(a.x, c.target)", "steady_state_error(a.x, c.target, c.window)"),
    *("steady_state_error(a.x, c.target, 0.26 s)", "steady_state_error(a.x, 1 m, 0 s)"),
    *("percentile(a.x, c.share)", "percentile(a.x, 5 %)", "percentile(a.x, 95 %)"),
    *("minimum(rolling_mean(a.x, c.window))", "duration(rolling_mean(a.x, 0.2 s) > 0 m)"),
    *("final(rolling_mean(a.x, 0.5 s))", "final(rolling_mean(a.x, 2.99 s))", "rms(rolling_mean(a.x, 0.5 s))"),
    *("at_first(a.x, a.seen)", "at_first(time, a.x > c.target)", "initial(time)"),
    *("duration(a.seen)", "duration(a.x > c.target)", "occurrences(a.seen)", "occurrences(not a.seen)"),
    "driver_gap(a.x, a.v, a.seen, c.window, c.brake, 12.65 m/s3)",
    *("minimum(time_to_collision(a.x, a.v))", "mean(time_to_collision(a.x, a.v))"),
)
_OTHERS = (
    *("-c.target", "c.target / (c.brake * 1 s2)", "abs(c.target)", "floor(c.band * 30)", "sqrt(c.target * 1 m)"),
    *("2 ^ c.band", "c.band ^ 2", "c.band ^ -1", "1 ^ c.band", "(-1) ^ (1 / (c.band - c.band))"),
    "(-1) ^ (-1 / (c.band - c.band))",
    *("min(c.target, 1 m, 8 m)", "max(c.target, 1 m, 8 m)", "if c.active then c.target else 2 m"),
    *("if c.target > 1 m xor c.active then 1 else 2", "if c.active implies c.band < 1 % then 1 else 2"),
    *("if c.band != 0.5 then 1 else 2", "if c.band == 0.5 or c.active then 1 else 2"),
    *("mean(sqrt(abs(a.x) * 1 m) - floor(a.x / 1 m) * 1 m)", "mean(sqrt(a.x * 1 m))", "mean((a.x / 1 m) ^ 3)"),
    *("mean(min(a.x, c.target))", "mean(max(a.x, -a.x, 3 m))", "mean(a.x * a.v)", "rms(a.x / a.v)"),
    *("maximum(if a.seen then a.x else c.target)", "mean(if c.active then a.x else 2 m)", "final(a.v + a.x / 1 s)"),
    *("duration(a.mode == on)", "duration(a.mode != on)", "duration(a.x != 5 m)", "duration(a.x <= a.v * 1 s)"),
    *("duration(a.x >= 1 m and a.seen)", "duration(a.x < 1 m or a.seen)", "duration(a.seen xor a.x > 5 m)"),
    *("duration(a.seen implies a.x between 2 m and 9 m)", "duration(a.seen iff a.mode == on)", "duration(time > 1 s)"),
)
_WINDOWS = ((0.3, 1.15), (64.2, 1e6))
_BOUNDS = ({"at_most": 5.0}, {"at_least": 5.0}, {"at_most": 9.0, "at_least": 2.0})
_CONDITIONS = ("", "duration(a.seen) > 0 s", "c.active", "m1 > 3 m", "not m9 > 1 s")

# level, slope, swing, stride, phase and modulus of level + slope·i + swing·((i·stride + phase) mod modulus)/modulus
# for row i; a run may have *holes*, values of single rows.
_RECIPES = {
    "time": [0.0, 0.01, 0.004, 7, 0, 11],
    "a.x": [2.0, 0.06, 3.0, 37, 5, 101],
    "a.v": [9.0, -0.04, 5.0, 53, 9, 97],
    "a.seen": [0.0, 0.0, 2.0, 1, 3, 31],
    "a.mode": [0.0, 0.0, 3.0, 3, 1, 17],
}
RUNS: tuple[dict[str, Any], ...] = (
    {"rows": 1, "values": 0},
    {"rows": 2, "values": 0},
    {"rows": 7, "values": 1},
    {"rows": 137, "values": 0},
    {"rows": 300, "values": 1, "a.x": [21.0, -0.06, 1.0, 37, 5, 101], "a.seen": [0.0, 0.0, 2.0, 1, 20, 31]},
    {"rows": 300, "values": 0, "a.x": [21.0, -0.06, 1.0, 37, 5, 101], "a.v": [0.4, 0.0, 0.1, 53, 9, 97]},
    {"rows": 300, "values": 2, "a.x": [-9.0, 0.06, 2.0, 37, 5, 101], "time": [64.0, 0.01, 0.0, 1, 0, 2]},
    {"rows": 300, "values": 3, "a.x": [-8.0, 0.03, 2.0, 37, 5, 101], "time": [0.0, 0.01, 0.0, 1, 0, 2]},
    {"rows": 2001, "values": 0, "a.x": [0.0, 0.01, 0.5, 37, 5, 101]},
    {"rows": 137, "values": 0, "holes": {"a.x": {"40": "NaN", "90": "Infinity"}, "a.v": {"20": "NaN"}}},
    {"rows": 137, "values": 3, "holes": {"time": {"50": 0.5, "51": 0.5}, "a.x": {"0": "NaN", "136": "-Infinity"}}},
    {"rows": 60, "values": 5, "a.x": ["NaN", 0.0, 0.0, 1, 0, 2], "holes": {"a.v": {"20": "NaN"}}},
    {
        "rows": 129,
        "values": 4,
        "a.x": [-2.0, 0.0, 8.0, 3, 7, 8],
        "a.v": [-2.0, 0.0, 8.0, 5, 3, 8],
        "time": [64.0, 0.25, 0.0, 1, 0, 2],
    },
    {"rows": 60, "values": 2, "a.x": [0.0, 0.0, 0.0, 1, 0, 2], "a.seen": [0.0, 0.0, 0.0, 1, 0, 2]},
)


def case_program() -> MetricProgram:
    """All expressions as metrics m0, m1, …; each kind of requirement on some of them."""
    texts = [(text, None) for text in (*_OF_X, *_OTHERS)] + [(t, over) for over in _WINDOWS for t in _OF_X[::2]]
    metrics = [
        Metric(f"m{number}", parse_expression(text, HERE), DIMENSIONLESS, over=over)
        for number, (text, over) in enumerate(texts)
    ]
    requirements = [
        Requirement(
            f"R{number}",
            metric=metric,
            unit=parse_unit("m"),
            exercised_when=parse_expression(condition, HERE) if condition else None,
            **bounds,
        )
        for number, (bounds, metric, condition) in enumerate(product(_BOUNDS, ("m0", "m3", "m16"), _CONDITIONS))
    ]
    return compile_metrics(metrics, requirements, SIGNALS | CONSTANTS, frozenset(SIGNALS))


def case_results(program: MetricProgram, case: dict[str, Any]) -> dict[str, Any]:
    """What *program* makes of a *case* of the file, as the file has it."""
    holes = case["holes"]
    columns = {
        name: _column(recipe, case["rows"], holes.get(name, {}), whole=name in ("a.seen", "a.mode"))
        for name, recipe in case["recipes"].items()
    }
    values = {name: float(value) for name, value in case["values"].items()}
    metrics, judgements = program.evaluate(columns.pop("time"), columns, values)
    return {
        "metrics": [_written(value) for value in metrics.values()],
        "verdicts": [VERDICTS.index(judgement.verdict) for judgement in judgements],
        "margins": [_written(judgement.margin) for judgement in judgements],
    }


def metric_program_cases() -> dict[str, Any]:
    """What the file holds."""
    program = case_program()
    cases = [
        {
            "rows": run["rows"],
            "recipes": {name: run.get(name, recipe) for name, recipe in _RECIPES.items()},
            "holes": run.get("holes", {}),
            "values": VALUES[run["values"]],
        }
        for run in RUNS
    ]
    return {
        "program": program_as_data(program),
        "cases": [case | case_results(program, case) for case in cases],
    }


def _column(recipe: list[Any], rows: int, holes: dict[str, Any], *, whole: bool) -> Floats:
    """Of operations that every language rounds alike; *whole* numbers are floored."""
    level, slope, swing, stride, phase, modulus = map(float, recipe)
    row = np.arange(rows, dtype=np.float64)
    column = level + slope * row + swing * (np.mod(row * stride + phase, modulus) / modulus)
    for place, value in holes.items():
        column[int(place)] = float(value)
    return np.floor(column) if whole else column


def _written(value: float) -> float | str:
    return value if np.isfinite(value) else {np.inf: "Infinity", -np.inf: "-Infinity"}.get(value, "NaN")


if __name__ == "__main__":
    FILE.write_text(json.dumps(metric_program_cases()) + "\n", encoding="utf-8")
