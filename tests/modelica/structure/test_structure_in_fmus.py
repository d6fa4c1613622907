"""What only shows in a whole FMU: failures by name at run time, and values of index-reduced models."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from modelica_components import Built
from slaves import Slave, instance, run_cs

GEAR = """model Geared
  parameter Real start_1 = 3;
  parameter Real ratio = 3;
  Real w1(start = start_1, fixed = true);
  Real w2(start = 1, fixed = true);
  Real t;
equation
  2 * der(w1) = 1 - t;
  5 * der(w2) = ratio * t;
  w1 = ratio * w2;
end Geared;
"""

NETWORK = """model Bridge "Wheatstone's bridge with a capacitor across and one over the source"
  parameter Real R[4] = {1, 2, 3, 4};
  parameter Real C = 0.1;
  Real a(start = 0), b(start = 0), u, across(start = 0, fixed = true), stored, i, j, k;
equation
  u = 10 + time;
  across = a - b;
  C * der(across) = i;
  (u - a) / R[1] = a / R[2] + i;
  (u - b) / R[3] + i = b / R[4];
  stored = u;
  j = C * der(stored);
  k = j + (u - a) / R[1] + (u - b) / R[3];
end Bridge;
"""


def file(folder: Path, text: str) -> Path:
    path = folder / f"{text.split()[1]}.mo"
    path.write_text(text, encoding="utf-8")
    return path


def failure(slave: Slave, steps: int, given: dict[str, float]) -> str:
    """The messages of a run that must fail."""
    with pytest.raises(Exception, match="error"):  # noqa: PT012 (the loop is one run)
        slave.start(given, 1e-6)
        for k in range(steps):
            slave.fmu.doStep(k * 0.05, 0.05)
    return "\n".join(slave.messages)


@pytest.mark.parametrize("version", [2, 3])
def test_one_condition_too_many_is_checked_at_the_start(tmp_path: Path, built: Built, version: int) -> None:
    model = built(file(tmp_path, GEAR), version)
    rows = run_cs(model, ["w1", "w2"], 10, 0.1, {}, {}, 1e-9)
    inertia = 2 + 5 / 9
    assert rows[-1]["w1"] == pytest.approx(3 + 1 / inertia, rel=1e-9)
    assert rows[-1]["w2"] == pytest.approx(rows[-1]["w1"] / 3, rel=1e-12)
    with instance(model) as slave:
        told = failure(slave, 1, {"start_1": 3.5})
    assert "one condition too many" in told


def test_a_bridge_of_resistors_and_capacitors_agrees_with_its_closed_form(tmp_path: Path, built: Built) -> None:
    model = built(file(tmp_path, NETWORK), 2)
    rows = run_cs(model, ["across", "k", "a", "b"], 10, 0.1, {}, {}, 1e-10)
    # Thevenin's source of the bridge: a share of the source through both pairs in parallel.
    share, resistance = 2 / 3 - 4 / 7, 1 * 2 / 3 + 3 * 4 / 7
    lag = resistance * 0.1
    for step, row in enumerate(rows):
        t = 0.1 * step
        decay = math.exp(-t / lag)
        across = share * (10 * (1 - decay) + t - lag * (1 - decay))
        assert row["across"] == pytest.approx(across, abs=1e-8)
        u, i = 10 + t, (share * (10 + t) - across) / resistance
        a = (u / 1 - i) / (1 / 1 + 1 / 2)
        b = (u / 3 + i) / (1 / 3 + 1 / 4)
        assert row["a"] == pytest.approx(a, abs=1e-7)
        assert row["b"] == pytest.approx(b, abs=1e-7)
        assert row["k"] == pytest.approx(0.1 + (u - a) + (u - b) / 3, abs=1e-6)
