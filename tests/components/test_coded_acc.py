"""The paper's controller in the shape of Simulink's coder: the same study as with the one written by hand."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import dse

pytestmark = pytest.mark.usefixtures("kept_cache")
pytest.importorskip("clang.cindex")

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def bench() -> dse.Bench:
    return dse.open(ROOT).benches["acc_coded"]


@pytest.mark.thorough
@pytest.mark.parametrize("fuse", [False, pytest.param(True, marks=pytest.mark.thorough)])
@pytest.mark.parametrize(
    "gains",
    [{"controller.kp_speed": 3.0, "controller.kd_gap": 0.2}, pytest.param({}, marks=pytest.mark.thorough)],
)
def test_a_run_is_the_same_to_the_last_bit(bench: dse.Bench, gains: dict[str, float], fuse: bool) -> None:
    found = {each.choices["controller"]: bench.simulate(each, set=gains, fuse=fuse) for each in bench.design.list(2)}
    one, other = found["pd_acc"], found["pd_acc_coded"]
    assert repr(one.metrics) == repr(other.metrics)  # as text: what is undefined is NaN
    assert one.verdicts == other.verdicts
    assert [*one.waveforms] == [*other.waveforms] != []
    assert all(one.waveforms[name].tobytes() == other.waveforms[name].tobytes() for name in one.waveforms)
    assert (one.verdicts["R2"] == "pass") is (not gains)


@pytest.mark.thorough
@pytest.mark.parametrize("fuse", [False, True])
def test_the_study_of_the_paper_has_the_same_metrics_and_verdicts(tmp_path: Path, fuse: bool) -> None:
    """Every fourth level of it, with both controllers side by side and on the paper's own bench."""
    for name in ("components", "designs", "testbenches"):
        shutil.copytree(ROOT / name, tmp_path / name)
    for study in (tmp_path / "testbenches").glob("acc_gains*.pet.yaml"):
        study.write_text(study.read_text("utf-8").replace("levels: 33", "levels: 9"), "utf-8")
    ws = dse.open(tmp_path)
    paper = ws.studies["acc_gains"].explore(tmp_path / "paper", workers=1, fuse=fuse, fresh=True).to_pandas()
    both = ws.studies["acc_gains_coded"].explore(tmp_path / "both", workers=1, fuse=fuse, fresh=True).to_pandas()
    shared = [name for name in paper if name in both and name not in ("configuration", "controller")]
    assert len(shared) > 15
    assert {"R1.verdict", "R2.verdict", "R2.margin", "final_gap", "controller.kd_gap"} < set(shared)
    assert {*paper["R1.verdict"]} >= {"pass", "fail"}
    for controller in ("pd_acc", "pd_acc_coded"):
        mine = both[both["controller"] == controller][shared].reset_index(drop=True)
        assert mine.equals(paper[shared].reset_index(drop=True)), controller
