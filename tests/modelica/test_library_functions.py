"""Tables and random numbers declared as in the Modelica Standard Library.

Tables are compared with look-ups written here, random numbers with those that are published with the library.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from modelica_components import MakeModel
from slaves import run_cs
from workspaces import written

from dse.domain.fmu import FmuModel
from dse.errors import DseError
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Graph
from dse.modelica.frontend.library_functions import with_tables

TABLES = Path(__file__).parent / "tables"
CURVE = ([0.0, 1.0, 2.0, 4.0], [1.0, 3.0, 2.0, 6.0])
# Where the table jumps, the first point belongs to what is before.
JUMPS = ([0.0, 0.5, 0.5 + 1e-12, 0.8, 1.0], [0.0, 1.0, 3.0, 2.0, 1.0])


def line(u: float) -> float:
    """Straight lines, continued by those at the ends."""
    if u < 0:
        return 1 + 2 * u
    return 6 + 2 * (u - 4) if u > 4 else float(np.interp(u, *CURVE))


def stairs(t: float) -> float:
    return JUMPS[1][max(k for k, at in enumerate(JUMPS[0]) if at <= max(t, 0.0))]


def expected(t: float) -> dict[str, float]:
    u = 5 * t - 1
    return {
        "line": line(u),
        "held": float(np.interp(u, *CURVE)),
        "periodic": float(np.interp(u % 4, *CURVE)),
        "stepped": CURVE[1][max(k for k, at in enumerate(CURVE[0]) if at <= u)] if 0 <= u <= 4 else line(u),
        "ended": 5.0 * min(t, 0.5) if t < 0.5 - 1e-9 else 7.0,
        "mu": 0.5,
        "slid": 0.5,
        "width": 4,
        "course": float(np.interp(t, *JUMPS)) if t <= 1 else 1 - 5 * (t - 1),
        "stairs": stairs(t),
        "repeated": float(np.interp(t % 1, *JUMPS)),
        "late": 0.0 if t < 0.35 else float(np.interp(t - 0.22, *JUMPS)),
    }


@pytest.mark.thorough
def test_tables_follow_their_points(made: MakeModel) -> None:
    """The area is exact: one period is 0.25 + 0.75 + 0.3, from the trapezoids."""
    model = made(TABLES / "LookUps.mo", (TABLES,))
    names = [*expected(0.0), "area"]
    rows = run_cs(model, names, 31, 0.07, {}, {}, 1e-9)
    for k, row in enumerate(rows):
        for name, value in expected(k * 0.07).items():
            assert row[name] == pytest.approx(value, abs=1e-8), (name, k * 0.07)
    whole, rest = divmod(31 * 0.07, 1)
    assert rows[31]["area"] == pytest.approx(1.3 * whole + rest**2, abs=1e-6)


ROWS, COLUMNS = [1.0, 2.0, 4.0], [1.0, 2.0, 4.0]
HEIGHTS = np.array([[1.0, 3.0, 5.0], [2.0, 4.0, 9.0], [0.0, 1.0, 2.0]])


def cell(at: float, axis: list[float]) -> int:
    return int(np.clip(np.searchsorted(axis, at, side="right") - 1, 0, len(axis) - 2))


def plane(x: float, y: float) -> float:
    """Bilinear in the cell of the point, or in the nearest one."""
    i, k = cell(x, ROWS), cell(y, COLUMNS)
    p, q = (x - ROWS[i]) / (ROWS[i + 1] - ROWS[i]), (y - COLUMNS[k]) / (COLUMNS[k + 1] - COLUMNS[k])
    return float(np.array([1 - p, p]) @ HEIGHTS[i : i + 2, k : k + 2] @ np.array([1 - q, q]))


def step(x: float, y: float) -> float:
    return float(HEIGHTS[np.searchsorted(ROWS, x, side="right") - 1, np.searchsorted(COLUMNS, y, side="right") - 1])


def test_tables_over_two_inputs_follow_their_points(made: MakeModel) -> None:
    model = made(TABLES / "Surfaces.mo", (TABLES,))
    names = ["lines", "held", "periodic", "stepped", "steps_held", "slope", "span"]
    are_inside = set()
    for k, row in enumerate(run_cs(model, names, 14, 0.07, {}, {}, 1e-9)):
        x, y = 5 * k * 0.07, 5 - 6 * k * 0.07
        held = (float(np.clip(x, 1, 4)), float(np.clip(y, 1, 4)))
        is_inside = held == (x, y)
        are_inside.add(is_inside)
        wanted = {
            "lines": plane(x, y),
            "held": plane(*held),
            "periodic": plane(1 + (x - 1) % 3, 1 + (y - 1) % 3),
            "stepped": step(x, y) if is_inside else plane(x, y),
            "steps_held": step(*held),
            "slope": (plane(x + 5e-6, y - 6e-6) - plane(x - 5e-6, y + 6e-6)) / 2e-6,
            "span": 3.0,
        }
        assert row == pytest.approx(wanted, abs=1e-6), k
    assert are_inside == {True, False}


def test_the_lines_of_a_rewritten_text_stay_where_they_are() -> None:
    text = (TABLES / "Modelica" / "package.mo").read_text(encoding="utf-8")
    new = with_tables(text)
    lines, others = text.split("\n"), new.split("\n")
    assert len(lines) == len(others)
    kept = [k for k, line in enumerate(lines) if "final parameter Real first" in line or "block Course" in line]
    assert [
        k for k, line in enumerate(others) if "final parameter Real first" in line or "block Course" in line
    ] == kept
    assert "tableID" not in new.replace("input Types.", "")


def test_the_first_true_element_is_found(made: MakeModel, tmp_path: Path) -> None:
    function = (
        "package V function firstTrueIndex input Boolean b[:]; output Integer index; algorithm index := 0;"
        " for i in 1:size(b, 1) loop if b[i] then index := i; return; end if; end for; end firstTrueIndex; end V;"
    )
    root = written(tmp_path / "library", {"V.mo": function})
    file = tmp_path / "First.mo"
    file.write_text(
        "model First output Real y = V.firstTrueIndex({time > 0.25 and time < 0.75, time > 0.15}); end First;",
        encoding="utf-8",
    )
    rows = run_cs(made(file, (root,)), ["y"], 9, 0.1, {}, {}, 1e-6)
    assert [row["y"] for row in rows] == [0, 0, 2, 1, 1, 1, 1, 1, 2, 2]


def test_a_text_without_tables_is_kept() -> None:
    other = "function getNextTimeEvent input Real x; output Real y; algorithm y := 2*x; end getNextTimeEvent;"
    for text in ("model M Real x = 1; end M;", f"{other} // ExternalCombiTimeTable"):
        assert with_tables(text) == text


def test_a_smooth_table_gives_no_number(made: MakeModel, tmp_path: Path) -> None:
    file = tmp_path / "Smooth.mo"
    file.write_text(
        "model Smooth Modelica.Blocks.Tables.Curve a(table = [0, 1; 1, 2; 3, 5], u = time,"
        " smoothness = Modelica.Blocks.Types.Smoothness.ContinuousDerivative); output Real y = a.y; end Smooth;",
        encoding="utf-8",
    )
    with pytest.raises(FMICallException, match="error"):
        run_cs(made(file, (TABLES,)), ["y"], 1, 0.1, {}, {}, 1e-6)


RANDOM = Path(__file__).parent / "random"
# The reference results of Random.Examples.GenerateRandomNumbers and of Blocks.Examples.Noise.ImpureGenerator. The
# documentation of hashString has its values for "this is a test" and "Controller.noise1".
R64 = [0.31359251787761722, 0.51103450342260148, 0.042445753889600313, 0.68603063460100111]
R128 = [0.46115405725007419, 0.031701476952007923, 0.91922647628167886, 0.54448098466791572]
R1024 = [0.31155928686346324, 0.059952099583051865, 0.94680043997287422, 0.037924779795383334]
HIDDEN = [0.018660680846204425, 0.18502447944342726, 0.34165798899941757, 0.71708009780134219]
NAMES = ["r64", "r128", "r1024", "hidden", "hash", "name", "noise1.y"]


@pytest.mark.parametrize(("count", "published"), [(2, R64), (4, R128), (33, R1024)])
def test_generators_give_the_published_numbers(count: int, published: list[float]) -> None:
    graph = Graph()
    seeds = graph.array([graph.of(614657.0), graph.of(30020.0)], (2,))
    state = [graph.call("random_start", [graph.of(float(k)), seeds]) for k in range(1, count + 1)]
    found = []
    for _ in published:
        numbers = graph.array([graph.of(value) for value in evaluate(state, {})], (count,))
        drawn = [graph.call("random", [graph.of(float(k)), graph.of(float(count)), numbers]) for k in range(count + 1)]
        found += evaluate(drawn[:1], {})
        state = drawn[1:]
    assert found == published


@pytest.fixture(scope="module")
def draws(made: MakeModel) -> FmuModel:
    return made(RANDOM / "Controller.mo", (RANDOM,))


@pytest.mark.thorough
def test_models_draw_the_published_numbers_again_and_again(draws: FmuModel) -> None:
    rows = run_cs(draws, NAMES, 3, 0.1, {}, {}, 1e-6)
    assert rows == run_cs(draws, NAMES, 3, 0.1, {}, {}, 1e-6)
    # A tick at a communication point belongs to the step that starts there; both begin with the first number.
    for name, published in (("r64", R64), ("r128", R128), ("r1024", R1024)):
        assert [row[name] for row in rows] == [published[0], *published[:3]]
    assert [row["hidden"] for row in rows] == [HIDDEN[0], *HIDDEN[:3]]
    assert {(row["hash"], row["name"]) for row in rows} == {(1827717433, -1025762750)}
    other = run_cs(draws, NAMES, 3, 0.1, {"local_seed": 614658, "globalSeed.fixedSeed": 1}, {}, 1e-6)
    for name in ("r64", "r128", "r1024", "hidden", "noise1.y"):
        assert rows[0][name] != other[0][name]


@pytest.mark.thorough
def test_a_seed_by_the_clock_ends_the_run(draws: FmuModel) -> None:
    with pytest.raises(FMICallException, match="fmi2ExitInitializationMode"):
        run_cs(draws, NAMES, 1, 0.1, {"globalSeed.useAutomaticSeed": 1}, {}, 1e-6)


@pytest.mark.thorough
def test_two_blocks_with_one_hidden_state_are_refused(made: MakeModel, tmp_path: Path) -> None:
    text = "model Two inner Modelica.Noise.GlobalSeed globalSeed; Modelica.Noise.Impure a; Modelica.Noise.Impure b;"
    (tmp_path / "Two.mo").write_text(f"{text} output Real y = a.y + b.y; end Two;", encoding="utf-8")
    with pytest.raises(DseError, match="impureRandom in several blocks"):
        made(tmp_path / "Two.mo", (RANDOM,))


@pytest.mark.thorough
def test_a_draw_from_a_hidden_state_at_no_instant_is_refused(made: MakeModel, tmp_path: Path) -> None:
    text = "model One inner Modelica.Noise.GlobalSeed globalSeed; output Real y; equation\n"
    text += "y = Modelica.Math.Random.Utilities.impureRandom(globalSeed.id); end One;"
    (tmp_path / "One.mo").write_text(text, encoding="utf-8")
    with pytest.raises(DseError, match=r"One.mo:2:\d+: .*impureRandom.* may only be called from .* a `when`"):
        made(tmp_path / "One.mo", (RANDOM,))
