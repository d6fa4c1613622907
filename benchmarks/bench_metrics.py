"""Eight metrics and three requirements of the ACC bench over 90 s at 10 ms: time per run.

Run from the top of the repository: ``python -m benchmarks.bench_metrics`` or by its path.
"""

from __future__ import annotations

import time

import numpy as np

from dse.domain.bench import Metric, Requirement
from dse.domain.component import Kind, Type
from dse.expression.parse import parse_expression
from dse.metrics.program import MetricProgram, compile_metrics
from dse.units import parse_unit

ROWS = 9001
TARGET_SECONDS = 0.25e-3
METRICS = {
    "speed_overshoot": "overshoot(world.speed, target = controller.set_speed)",
    "gap_overshoot": "undershoot(world.gap, target = controller.set_gap)",
    "rise_time": "rise_time(world.speed, target = controller.set_speed)",
    "settling_time": "settling_time(world.gap, target = controller.set_gap, band = 2 %)",
    "min_ttc": "minimum(time_to_collision(world.gap, world.closing_speed))",
    "speed_error": "steady_state_error(world.speed, target = controller.set_speed)",
    "comfort": "rms(world.acceleration)",
    "top_speed": "maximum(world.speed)",
}


def seconds_per_run(repeats: int = 2000) -> float:
    """Best of five averages of `MetricProgram.evaluate`."""
    program = _program()
    t = np.linspace(0.0, 90.0, ROWS)
    speed = 19.4 * (1 - np.exp(-t / 8) * np.cos(0.3 * t))
    columns = {
        "world.speed": speed,
        "world.gap": 40 + 110 * np.exp(-t / 12) * np.cos(0.1 * t),
        "world.closing_speed": np.sin(0.2 * t) * np.exp(-t / 30),
        "world.acceleration": np.gradient(speed, t),
    }
    constants = {"controller.set_speed": 19.444, "controller.set_gap": 40.0}
    averages = []
    for _ in range(5):
        start = time.perf_counter()
        for _ in range(repeats):
            program.evaluate(t, columns, constants)
        averages.append((time.perf_counter() - start) / repeats)
    return min(averages)


def _program() -> MetricProgram:
    units = {
        "world.speed": "m/s",
        "world.gap": "m",
        "world.closing_speed": "m/s",
        "world.acceleration": "m/s2",
        "controller.set_speed": "m/s",
        "controller.set_gap": "m",
    }
    types = {name: Type(Kind.REAL, parse_unit(unit)) for name, unit in units.items()}
    percent, second = parse_unit("%"), parse_unit("s")
    return compile_metrics(
        [Metric(name, parse_expression(text)) for name, text in METRICS.items()],
        [
            Requirement("R1", "speed_overshoot", 0.005, None, percent, parse_expression("rise_time < 60 s")),
            Requirement("R2", "gap_overshoot", 0.01, None, percent, parse_expression("settling_time < 60 s")),
            Requirement("R3", "min_ttc", None, 4.0, second),
        ],
        types,
        frozenset(name for name in types if name.startswith("world")),
    )


if __name__ == "__main__":
    measured = seconds_per_run()
    verdict = "ok" if measured < TARGET_SECONDS else "TOO SLOW"
    print(f"metrics: {measured * 1e6:.0f} µs per run of {ROWS} rows, limit {TARGET_SECONDS * 1e6:.0f} µs: {verdict}")
