"""What is known of FMUs decides what the master does with them."""

from __future__ import annotations

import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from oracle.reference import run_reference

from dse.cosim.feasibility import refusals
from dse.cosim.instance_budget import most_runs
from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.facts import Answer, FmuFacts, Question
from dse.domain.method import PLAIN, Adaptive, Coupling, Method
from dse.errors import DseError


def facts(reasons: dict[Question, str] | None = None, instances: int = 0, **answers: Answer) -> FmuFacts:
    """Facts about an FMU, its answers by the questions' names."""
    given = {Question[name.upper()]: answer for name, answer in answers.items()}
    return FmuFacts("0" * 64, "x86_64-test", "thing", 2, "CoSimulation", given, reasons or {}, instances=instances)


@pytest.fixture
def pair(shelf):
    """Two gains of one FMU, one after the other."""
    gain = shelf.fmu("gain")
    return shelf.system({"a": gain, "b": gain}, ["a.y -> b.u"], {"a.c": 1.0, "a.k": 2.0, "b.k": 3.0}, ["b.y"])


def test_an_fmu_known_to_lie_about_its_reset_is_never_reset(shelf):
    system = shelf.system({"liar": shelf.fmu("liar")}, (), {}, ["liar.y"])
    right = run_reference(system, ["liar.y"], stop=1, step=0.5)
    with Simulator(system, ["liar.y"], facts={"liar": facts(resets=Answer.NO)}) as simulator:
        assert (simulator.reset_is_trusted, simulator.reset_differs) == (False, ("liar",))
        for _ in range(3):
            assert simulator.run(stop=1, step=0.5).tobytes() == right.tobytes()


def test_a_reset_known_to_work_is_put_to_the_proof_all_the_same(shelf):
    # The probe has its own inputs; these may reach what those did not.
    system = shelf.system({"liar": shelf.fmu("liar")}, (), {}, ["liar.y"])
    with Simulator(system, ["liar.y"], facts={"liar": facts(resets=Answer.YES)}) as simulator:
        assert [simulator.run(stop=1, step=0.5)[-1, 0] for _ in range(3)] == [2, 2, 2]
        assert simulator.reset_is_trusted is False


@pytest.mark.parametrize("question", ["coexists", "renews"])
def test_two_elements_of_an_fmu_that_bears_one_instance_are_refused_by_name(pair, question):
    known = facts({Question[question.upper()]: "y differs at t = 0.1 s"}, **{question: Answer.NO})
    with pytest.raises(DseError, match=r"a, b: thing does not support several instances in one process: y differs"):
        Simulator(pair, ["b.y"], facts={"a": known, "b": known})


def test_coupling_is_refused_where_outputs_are_known_not_to_follow(pair):
    known = {"a": facts(feeds_through=Answer.NO), "b": facts(feeds_through=Answer.NO)}
    a, b = pair.elements
    declared = replace(pair, elements=(a, replace(b, model=replace(b.model, depends={"y": ("u",)}))))
    solve = Method(coupling=Coupling.SOLVE)
    (problem,) = refusals(declared, solve, known)
    assert problem.what.startswith("b: coupling: solve needs outputs that follow inputs between two steps")
    assert list(refusals(declared, PLAIN, known)) == []
    assert list(refusals(pair, solve, known)) == []  # nobody says that they do


def test_adaptive_steps_are_refused_where_uneven_ones_are_known_to_fail(pair):
    known = facts({Question.VARIES_STEP: "y differs"}, varies_step=Answer.NO)
    (problem,) = refusals(pair, Method(adaptive=Adaptive()), {"a": known})
    assert problem.what == "a: an adaptive step varies, and thing was found not to support that: y differs"


def test_one_element_of_it_is_fine(shelf):
    system = shelf.system({"a": shelf.fmu("gain")}, (), {}, ["a.y"])
    assert list(refusals(system, PLAIN, {"a": facts(coexists=Answer.NO)})) == []


def test_adaptive_steps_are_refused_where_states_are_known_not_to_be_saved(pair):
    known = {"b": facts({Question.SAVES: "after restoring, y differs at t = 0.2 s"}, saves=Answer.NO)}
    (problem,) = refusals(pair, Method(adaptive=Adaptive()), known)
    assert problem.what.startswith("b: an adaptive step needs saved states")
    assert "after restoring, y differs" in problem.what
    assert list(refusals(pair, PLAIN, known)) == []


@pytest.mark.parametrize("answer", [Answer.YES, Answer.UNKNOWN])
def test_what_is_not_known_to_fail_is_not_refused(pair, answer):
    known = facts(coexists=answer, renews=answer, saves=answer, resets=answer, lasts=answer)
    assert list(refusals(pair, Method(adaptive=Adaptive()), {"a": known, "b": known})) == []
    assert most_runs(pair, {"a": known, "b": known}) is None


def test_a_process_makes_half_of_the_instances_that_were_survived(pair):
    known = facts(lasts=Answer.NO, instances=40)
    # 40 instances survived, half of them trusted, two in each run.
    assert most_runs(pair, {"a": known, "b": known}) == 10
    assert most_runs(pair, {"a": known}) == 10


def counted_down(shelf, known: FmuFacts) -> list[int | None]:
    # A copy under a name of its own: what wears out is counted by library and process.
    system = shelf.system({"liar": shelf.fmu("liar", 2, f"-DCOPY={len(shelf.folder.name)}")}, (), {}, ["liar.y"])
    left = []
    with Simulator(system, ["liar.y"], facts={"liar": known}) as simulator:
        left.append(simulator.runs_left)
        for _ in range(4):
            simulator.run(stop=1, step=0.5)
            left.append(simulator.runs_left)
    return left


def test_every_run_on_fresh_instances_is_counted(shelf):
    assert counted_down(shelf, facts(lasts=Answer.NO, resets=Answer.NO, instances=8)) == [4, 3, 2, 1, 0]


def test_runs_on_reset_instances_wear_nothing_out(shelf):
    system = shelf.system({"a": shelf.fmu("linear", 2, "-DCOPY=1")}, (), {"a.y0": 1.0}, ["a.y"])
    with Simulator(system, ["a.y"], facts={"a": facts(lasts=Answer.NO, instances=20)}) as simulator:
        for _ in range(50):
            simulator.run(stop=1, step=0.5)
        assert simulator.reset_is_trusted
        assert simulator.runs_left == 8  # one instance at first, one for the proof


def test_an_fmu_nobody_knows_anything_of_may_be_run_forever(shelf):
    system = shelf.system({"a": shelf.fmu("gain")}, (), {}, ["a.y"])
    with Simulator(system, ["a.y"]) as simulator:
        assert simulator.runs_left is None


SECOND_RUN = """
import pickle, sys
from dse.cosim.simulator import Simulator
system, known = pickle.loads(open(sys.argv[1], "rb").read())
with Simulator(system, ["a.y"], facts={"a": known}) as simulator:
    print(simulator.runs_left)
    simulator.run(stop=1, step=0.5)
    print(simulator.runs_left)
    simulator.run(stop=1, step=0.5)
"""


def test_an_fmu_whose_second_instance_differs_has_a_process_for_every_run(shelf, tmp_path: Path):
    system = shelf.system({"a": shelf.fmu("gain")}, (), {}, ["a.y"])
    known = facts(renews=Answer.NO)
    assert most_runs(system, {"a": known}) == 1
    (tmp_path / "system").write_bytes(pickle.dumps((system, known)))
    command = [sys.executable, "-c", SECOND_RUN, str(tmp_path / "system")]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False, cwd=Path(__file__).parents[2])
    assert done.stdout.split() == ["1", "0"]
    assert "a: a second instance in one process is known to differ from the first" in done.stderr


@pytest.mark.parametrize("version", [2, 3])
def test_after_a_fatal_failure_no_run_is_left(lone, version):
    with Simulator(lone(version), ["car.y"]) as simulator:
        with pytest.raises(RunFailed):
            simulator.run(stop=1, step=0.1, start={"world.mode": 5, "world.at": 0.2})
        assert simulator.runs_left == 0
