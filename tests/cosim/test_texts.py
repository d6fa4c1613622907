"""Strings and binaries on wires, and what FMUs log."""

from __future__ import annotations

import sys
from dataclasses import replace

import pytest
from oracle.reference import run_reference
from private_memory import keeps

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import Variable
from dse.domain.system import Wire
from dse.errors import DseError

BOTH = pytest.mark.parametrize("version", [2, 3])
ECHO, LARGE, NOTHING, LOGS, LOGS_FROM_THREADS = range(5)
MIB = 2**20


def pair(shelf, version, wire="a.said -> b.given", **start):
    model = shelf.fmu("speaker", version)
    values = {f"a.{name}": value for name, value in start.items()}
    return shelf.system({"a": model, "b": model}, [wire], values, ["b.heard"])


def outcome(run):
    try:
        return run().tobytes()
    except RunFailed as failure:
        return str(failure), failure.element, failure.call, failure.time


def same(system, **run):
    run = {"stop": 0.2, "step": 0.1} | run
    with Simulator(system, ["b.heard"]) as simulator:
        fast = outcome(lambda: simulator.run(**run))
    assert outcome(lambda: run_reference(system, ["b.heard"], **run)) == fast
    return fast


@BOTH
@pytest.mark.parametrize("size", [0, 1, 255, 16 * MIB])
def test_texts_of_any_length_travel_up_to_a_limit(shelf, version, size):
    system = pair(shelf, version, mode=LARGE, size=size)
    with Simulator(system, ["b.heard"]) as simulator:
        assert simulator.run(stop=0.2, step=0.1)[-1, 0] == size
    assert isinstance(same(system), bytes)


@BOTH
def test_a_text_beyond_the_limit_is_refused_by_name(shelf, version):
    what, element, call, time = same(pair(shelf, version, mode=LARGE, size=16 * MIB + 1))
    assert what == "a.said is larger than 16 MiB"
    assert (element, call, time) == ("a", f"fmi{version}GetString", None)


def test_binaries_travel_with_their_zeros(shelf):
    system = pair(shelf, 3, "a.bytes -> b.taken")
    with Simulator(system, ["b.heard"]) as simulator:
        assert simulator.run(stop=0.1, step=0.1)[-1, 0] == 3
    assert isinstance(same(system), bytes)
    what, *_ = same(pair(shelf, 3, "a.bytes -> b.taken", mode=LARGE, size=16 * MIB + 1))
    assert what == "a.bytes is larger than 16 MiB"


@BOTH
def test_an_fmu_that_gives_no_text_at_all_is_named(shelf, version):
    what, element, call, _ = same(pair(shelf, version, mode=NOTHING))
    assert what == "a.said was not given: the FMU returned a null pointer"
    assert (element, call) == ("a", f"fmi{version}GetString")


def test_texts_and_numbers_are_not_wired_to_each_other(shelf):
    with pytest.raises(DseError, match=r"a\.said -> b\.mode: a string cannot be wired to a number"):
        Simulator(pair(shelf, 2, "a.said -> b.mode"), ["b.heard"])
    with pytest.raises(DseError, match=r"a\.bytes -> b\.given: a binary cannot be wired to a string"):
        Simulator(pair(shelf, 3, "a.bytes -> b.given"), ["b.heard"])
    system = pair(shelf, 3)
    scaled = replace(system, wires=(Wire("a", "said", "b", "given", factor=2.0),))
    with pytest.raises(DseError, match="a string takes no factor, offset or items"):
        Simulator(scaled, ["b.heard"])


def test_start_values_of_the_wrong_kind_are_refused_all_at_once(shelf):
    system = pair(shelf, 3)
    a, b = system.elements
    wrong = replace(a, start={"said": 1.0}, texts={"mode": "x", "given": b"x", "nowhere": "x"})
    with pytest.raises(DseError) as refused:
        Simulator(replace(system, elements=(wrong, b)), ["b.heard"])
    text = str(refused.value)
    for part in ("a.said: variables of type String cannot be given a number", "a.mode", "a.given", "a.nowhere"):
        assert part in text


def test_arrays_must_be_told_wholly(shelf):
    model = shelf.fmu("relay", 3)
    row = Variable("row", 0, "Float64", "input", None, shape=(3,))
    system = shelf.system({"a": replace(model, variables={**model.variables, "row": row})}, (), {}, ["a.to_Int32"])
    (a,) = system.elements
    with pytest.raises(DseError, match=r"a\.row\[1\]: the FMU does not give the start values of the array"):
        Simulator(replace(system, elements=(replace(a, start={"row[2]": 1.0}),)), ["a.to_Int32"])


def test_references_in_log_lines_become_names(shelf):
    system = pair(shelf, 2, mode=LOGS)
    with Simulator(system, ["b.heard"]) as simulator, pytest.raises(RunFailed) as failed:
        simulator.run(stop=0.1, step=0.1)
    assert failed.value.log == ("the size size is #1, not #r99# 7",)


@BOTH
def test_lines_from_other_threads_are_kept_whole(shelf, version):
    system = pair(shelf, version, mode=LOGS_FROM_THREADS)
    with Simulator(system, ["b.heard"]) as simulator:
        for _ in range(3):
            with pytest.raises(RunFailed) as failed:
                simulator.run(stop=0.1, step=0.1)
            assert len(failed.value.log) == 16
            assert all(line.startswith("from afar") for line in failed.value.log)


@pytest.mark.skipif(sys.platform != "linux", reason="reserved memory is told by Linux")
def test_texts_leave_no_memory_behind(shelf):
    system = pair(shelf, 3, mode=LARGE, size=MIB)

    def use():
        for _ in range(5):
            with Simulator(system, ["b.heard"]) as simulator:
                simulator.run(stop=0.1, step=0.1)

    assert not keeps(use, 4 * MIB)  # one text kept by each would be 10 MiB
