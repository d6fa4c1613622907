"""Random numbers declared as in the Modelica Standard Library, against the numbers that are published with it."""

from __future__ import annotations

from pathlib import Path

import pytest
from fmpy.fmi1 import FMICallException
from modelica_components import MakeModel
from slaves import run_cs

from dse.domain.fmu import FmuModel
from dse.errors import DseError
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Graph

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
