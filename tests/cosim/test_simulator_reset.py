from __future__ import annotations

import sys
from pathlib import Path

import pytest
from oracle.reference import run_reference
from private_memory import keeps

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.method import PLAIN, Algorithm, Coupling, Method
from dse.errors import DseError

BOTH = pytest.mark.parametrize("version", [2, 3])


@BOTH
def test_a_reset_that_works_is_trusted_after_the_second_run(shelf, version):
    system = shelf.system({"a": shelf.fmu("linear", version)}, (), {"a.y0": 1.0, "a.a": 0.5}, ["a.y"])
    with Simulator(system, ["a.y"]) as simulator:
        trust = []
        for _ in range(3):
            simulator.run(stop=1, step=0.1)
            trust.append(simulator.reset_is_trusted)
    assert trust == [None, True, True]
    assert simulator.reset_differs == ()


@BOTH
def test_a_reset_that_keeps_state_is_found_out_and_results_are_right_anyway(shelf, version):
    elements = {
        "good": shelf.fmu("linear", version),
        "liar": shelf.fmu("liar", version),
        "follower": shelf.fmu("linear", version),
    }
    system = shelf.system(elements, ["liar.y -> follower.u"], {"good.y0": 2.0, "follower.b": 1.0}, ["good.y"])
    record = ["good.y", "liar.y"]
    right = run_reference(system, record, stop=1, step=0.1)
    with Simulator(system, record) as simulator:
        for _ in range(4):
            assert simulator.run(stop=1, step=0.1).tobytes() == right.tobytes()
        assert simulator.reset_is_trusted is False
        assert simulator.reset_differs == ("liar",)


@BOTH
def test_what_another_run_has_set_is_never_left_to_a_reset(shelf, version):
    model = shelf.fmu("gain", version, "-DKEEPS_PARAMETERS")
    system = shelf.system({"a": model}, (), {"a.c": 1.0}, ["a.y"])
    with Simulator(system, ["a.y"]) as simulator:

        def last(**start):
            return simulator.run(stop=0.2, step=0.1, start={f"a.{k}": v for k, v in start.items()})[-1, 0]

        # y = k u + c: the proof of the second run cannot see that k stays, as it is set again.
        assert [last(k=k, u=1.0) for k in (5.0, 5.0, 6.0)] == [6, 6, 7]
        assert [last(u=1.0), last(k=3.0, u=1.0), last(), last()] == [2, 4, 1, 1]
        assert simulator.reset_is_trusted is True
        assert last(c=8.0) == 8  # the system's own are set by every run


@BOTH
def test_an_fmu_that_refuses_to_reset_is_made_anew(lone, version):
    system = lone(version)
    with Simulator(system, ["car.y"]) as simulator:
        runs = [simulator.run(stop=1, step=0.1, start={"world.mode": 12}).tobytes() for _ in range(3)]
        assert simulator.reset_is_trusted is False
        assert simulator.reset_differs == ("world",)
    assert len(set(runs)) == 1


def test_fresh_instances_that_differ_from_each_other_are_no_results(shelf):
    good, counting = shelf.fmu("gain"), shelf.fmu("gain", 2, "-DCOUNTS")
    system = shelf.system({"good": good, "odd": counting}, ["odd.y -> good.u"], {}, ["good.y"])
    with Simulator(system, ["good.y"]) as simulator:
        assert simulator.run(stop=0.2, step=0.1)[-1, 0] == 0
        assert simulator.runs_left is None
        for _ in range(2):
            with pytest.raises(RunFailed, match="odd: the outputs of two fresh instances differ"):
                simulator.run(stop=0.2, step=0.1)
        assert simulator.runs_left == 0


def test_resets_can_be_declined_from_the_start(shelf):
    system = shelf.system({"liar": shelf.fmu("liar")}, (), {}, ["liar.y"])
    with Simulator(system, ["liar.y"]) as simulator:
        simulator.reset_is_trusted = False
        assert [simulator.run(stop=1, step=0.5)[-1, 0] for _ in range(3)] == [2, 2, 2]


@BOTH
def test_an_fmu_for_one_instance_per_process_never_has_two(shelf, version):
    model = shelf.fmu("linear", version, "-DONCE")  # its second instance would be NULL
    system = shelf.system({"a": model}, (), {"a.y0": 1.0}, ["a.y"])
    with Simulator(system, ["a.y"]) as simulator:
        for _ in range(3):
            assert simulator.run(stop=1, step=0.5)[:, 0].tolist() == [1, 1, 1]
        with pytest.raises(DseError, match="only once per process"):
            Simulator(system, ["a.y"])
        with pytest.raises(DseError, match="only once per process"):
            run_reference(system, ["a.y"], stop=1, step=0.5)
    assert run_reference(system, ["a.y"], stop=1, step=0.5)[:, 0].tolist() == [1, 1, 1]


def test_an_fmu_for_one_instance_per_process_cannot_be_two_elements(shelf):
    model = shelf.fmu("linear", 2, "-DONCE")
    with pytest.raises(DseError, match="only once per process"):
        Simulator(shelf.system({"a": model, "b": model}, (), {}, ["a.y"]), ["a.y"])


@BOTH
def test_a_failed_run_does_not_spoil_the_next(lone, version):
    system = lone(version)
    with Simulator(system, ["car.y"]) as simulator:
        right = simulator.run(stop=1, step=0.1).tobytes()
        for mode in (1, 2, 7, 10, 13):
            with pytest.raises(Exception, match="world"):
                simulator.run(stop=1, step=0.1, start={"world.mode": mode, "world.at": 0.5})
            assert simulator.run(stop=1, step=0.1).tobytes() == right
        simulator.run(stop=1, step=0.1)
        assert simulator.reset_is_trusted is True


@pytest.mark.thorough
@pytest.mark.sampled(4)
@pytest.mark.skipif(sys.platform != "linux", reason="reserved memory is told by Linux")
@pytest.mark.parametrize("method", [PLAIN, Method(Algorithm.GAUSS_SEIDEL, Coupling.SOLVE)], ids=["plain", "by plan"])
@pytest.mark.parametrize("trust", [None, False], ids=["reset", "made anew"])
def test_five_thousand_runs_leave_memory_and_open_files_as_they_were(shelf, trust, method):
    system = shelf.system({"a": shelf.fmu("linear", 2), "b": shelf.fmu("linear", 3)}, ["a.y -> b.u"], {"b.b": 1.0})

    def use(runs: int = 5000) -> None:
        with Simulator(system, ["a.y"], method=method) as simulator:
            simulator.reset_is_trusted = trust
            for number in range(runs):
                simulator.run(stop=1, step=0.1, start={"a.y0": float(number)} if number % 4 < 2 else {"a.a": 1.0})

    use(500)  # what is allocated once and kept
    files = len(list(Path("/proc/self/fd").iterdir()))
    # One instance (300 bytes) or one table of starts lost per run would be 1.5 MiB and more; Python itself takes its
    # memory in pieces of 1 MiB.
    assert not keeps(use, 1 << 20)
    assert len(list(Path("/proc/self/fd").iterdir())) == files
