from __future__ import annotations

import math
import pickle
from dataclasses import replace

import pytest
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import Variable
from dse.domain.method import Algorithm, Method
from dse.domain.system import Wire
from dse.errors import DseError

BOTH = pytest.mark.parametrize("version", [2, 3])
STEP_ERROR, NAN, INFINITE, STEP_WARNING, STEP_FATAL, _, DISCARD, ENDS, EARLY, NO_INITIALIZATION, HUGE = range(1, 12)


def failure_of(system, *, mode=0, at=0.5, start=None) -> RunFailed:
    start = {"world.mode": mode, "world.at": at} | (start or {})
    with Simulator(system, ["car.y"]) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=1, step=0.1, start=start)
    if mode != STEP_FATAL:
        with pytest.raises(RunFailed) as slow:
            run_reference(system, ["car.y"], stop=1, step=0.1, start=start)
        seen, expected = (
            (failed.value.element, failed.value.time, failed.value.what, failed.value.log) for failed in (slow, fast)
        )
        assert seen == expected
    return fast.value


def test_a_step_that_fails_is_told_with_element_call_time_and_log(lone):
    failure = failure_of(lone(2), mode=STEP_ERROR)
    assert str(failure) == "world: fmi2DoStep at t = 0.5 s returned error: tyre left the road 42"
    assert (failure.element, failure.call, failure.time) == ("world", "fmi2DoStep", 0.5)
    assert failure.log == ("tyre left the road 42",)
    failure = failure_of(lone(3), mode=STEP_ERROR)
    assert str(failure) == "world: fmi3DoStep at t = 0.5 s returned error: tyre left the road"


@BOTH
def test_callbacks_with_an_environment_that_was_never_given_are_of_the_element_that_is_called(shelf, version):
    model = shelf.fmu("faulty", version, "-DASTRAY")
    system = shelf.system(
        {"car": shelf.fmu("gain", version), "world": model}, [], {"world.mode": STEP_ERROR}, ["car.y"]
    )
    with Simulator(system, ["car.y"]) as simulator, pytest.raises(RunFailed) as failed:
        simulator.run(stop=1, step=0.1)
    assert failed.value.log[0].startswith("tyre left the road")


def test_a_step_that_is_told_to_be_over_for_an_unknown_environment_is_over(shelf):
    start = {"e.mode": 7, "e.u": 1.0}  # ALWAYS_CALLS_BACK

    def rows(*flags):
        system = shelf.system({"e": shelf.fmu("stepper", 2, *flags)}, [], start, ["e.y"])
        with Simulator(system, ["e.y"]) as simulator:
            return simulator.run(stop=1, step=0.25).tolist()

    assert rows("-DASTRAY") == rows() == [[0.0], [0.25], [0.5], [0.75], [1.0]]


def test_a_failure_survives_the_way_between_processes(lone):
    failure = failure_of(lone(2), mode=STEP_ERROR)
    copy = pickle.loads(pickle.dumps(failure))  # noqa: S301  # our own bytes
    assert (str(copy), copy.log, copy.fatal) == (str(failure), failure.log, False)


@BOTH
def test_a_warning_is_no_failure(lone, version):
    with Simulator(lone(version), ["car.y"]) as simulator:
        assert simulator.run(stop=1, step=0.1, start={"world.mode": STEP_WARNING}).shape == (11, 1)


@BOTH
def test_a_discarded_step_is_a_failure(lone, version):
    assert str(failure_of(lone(version), mode=DISCARD)) == f"world: fmi{version}DoStep at t = 0.5 s returned discard"


@BOTH
def test_a_failed_initialization_has_no_time(lone, version):
    failure = failure_of(lone(version), mode=NO_INITIALIZATION)
    assert failure.time is None
    assert "no equilibrium found in iteration" in str(failure)


@BOTH
@pytest.mark.parametrize(("mode", "shown"), [(NAN, "nan"), (INFINITE, "-inf")])
def test_a_wired_output_that_is_no_number_is_named(lone, version, mode, shown):
    failure = failure_of(lone(version), mode=mode)
    assert str(failure) == f"world.y became {shown} at t = 0.6 s"
    assert failure.element == "world"


def test_a_wired_output_that_is_no_number_in_the_last_row_is_found_too(lone):
    assert str(failure_of(lone(2), mode=NAN, at=0.85)) == "world.y became nan at t = 1 s"


@pytest.mark.parametrize("algorithm", Algorithm)
def test_what_has_just_become_nan_is_told_before_others_are_given_it(shelf, algorithm):
    # With Gauss and Seidel the root gets it in the same step, and would discard it.
    elements = {"world": shelf.fmu("faulty"), "root": shelf.fmu("gain", 2, "-DROOT")}
    system = shelf.system(elements, ["world.y -> root.u"], {"world.mode": NAN, "world.at": 0.5}, ["root.y"])
    for run in (simulate, run_reference):
        with pytest.raises(RunFailed) as failed:
            run(system, ["root.y"], stop=1, step=0.1, method=Method(algorithm))
        assert failed.value.what.startswith("world.y became nan at t = ")


def simulate(system, record, *, stop, step, method):
    with Simulator(system, record, method=method) as simulator:
        return simulator.run(stop=stop, step=step)


def test_an_output_that_is_only_recorded_may_be_nan(shelf):
    system = shelf.system({"world": shelf.fmu("faulty")}, (), {"world.mode": NAN}, ["world.y"])
    with Simulator(system, ["world.y"]) as simulator:
        found = simulator.run(stop=1, step=0.5)
    assert found.tobytes() == run_reference(system, ["world.y"], stop=1, step=0.5).tobytes()
    assert found[-1, 0] != found[-1, 0]


def test_a_step_cut_short_is_a_failure(lone):
    failure = failure_of(lone(3), mode=EARLY)
    assert "before the end of the step" in str(failure)
    assert failure.time == 0.5


def test_an_integer_that_a_double_cannot_hold_is_refused(lone):
    assert str(failure_of(lone(3), mode=HUGE)).startswith("world.n exceeds 2^53 in magnitude at t = 0.6 s")


@BOTH
def test_a_start_value_that_does_not_fit_its_type_is_refused(lone, version):
    failure = failure_of(lone(version), mode=1.5)
    assert (
        str(failure) == f"world.mode cannot take the value 1.5: it is of type {'Integer' if version == 2 else 'Int32'}"
    )


@pytest.mark.parametrize(
    ("fmi_type", "value"),
    [
        ("Int8", 128),
        ("UInt8", -1),
        ("Int16", -32769),
        ("UInt16", 65536),
        ("Int32", 2**31),
        ("UInt32", 2**32),
        ("Int64", 2**53 + 2),
        ("UInt64", 2**53 + 2),
        ("Boolean", 2),
        ("Int8", float("nan")),
        ("Int64", float("inf")),
    ],
)
def test_what_does_not_fit_an_input_is_refused_while_it_runs(shelf, fmi_type, value):
    elements = {"world": shelf.fmu("gain", 2), "car": shelf.fmu("relay", 3)}
    system = shelf.system(elements, [f"world.y -> car.from_{fmi_type}"], {"world.c": value}, [f"car.to_{fmi_type}"])
    record = [f"car.to_{fmi_type}"]
    with Simulator(system, record) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=1, step=0.1)
    with pytest.raises(RunFailed) as slow:
        run_reference(system, record, stop=1, step=0.1)
    told = (
        f"car.from_{fmi_type} cannot take the value" if math.isfinite(value) else f"world.y became {value} at t = 0 s"
    )
    assert told in str(fast.value)
    assert str(fast.value) == str(slow.value)


@BOTH
def test_a_wrong_token_is_told_with_the_log(lone, version):
    failure = failure_of(lone(version, token="another"))  # noqa: S106  # FMI's word for an identity
    function = "fmi2Instantiate" if version == 2 else "fmi3InstantiateCoSimulation"
    assert str(failure) == f"world: {function} returned no instance: wrong token{' 7' if version == 2 else ''}"


@BOTH
def test_an_algebraic_loop_without_a_solution_is_named_by_its_wires(shelf, version):
    model = shelf.fmu("gain", version)
    start = {"car.c": 1.0, "bus.c": 3.0}  # world.y = car.y = world.y + 1
    wires = ["world.y -> car.u", "car.y -> world.u", "bus.y -> tram.u"]
    system = shelf.system({"world": model, "car": model, "bus": model, "tram": model}, wires, start, ["tram.y"])
    with Simulator(system, ["tram.y"]) as simulator, pytest.raises(RunFailed) as caught:
        simulator.run(stop=1, step=0.1)
    failure = caught.value
    assert (failure.element, failure.time) == ("world", None)
    assert str(failure).startswith(
        "initialization found no solution of the algebraic loop world.y -> car.u, car.y -> world.u: "
        "Newton's method came to a residual of "
    )
    with pytest.raises(RunFailed) as slow:
        run_reference(system, ["tram.y"], stop=1, step=0.1)
    assert str(slow.value) == str(failure)


def test_after_a_fatal_error_the_fmu_is_not_called_again(lone):
    simulator = Simulator(lone(2), ["car.y"])
    for _ in range(2):
        with pytest.raises(RunFailed, match="returned fatal: tyre left the road 42") as caught:
            simulator.run(stop=1, step=0.1, start={"world.mode": STEP_FATAL})
        assert caught.value.fatal
    simulator.close()


def test_a_closed_simulator_does_not_run(lone):
    simulator = Simulator(lone(2), ["car.y"])
    simulator.close()
    simulator.close()
    with pytest.raises(ValueError, match="closed"):
        simulator.run(stop=1, step=0.1)


@pytest.mark.parametrize("step", [0.3, 0.7, 2.0, 0.0, -0.1, float("nan")])
def test_a_stop_time_that_is_no_whole_number_of_steps_is_refused(lone, step):
    with Simulator(lone(2), ["car.y"]) as simulator, pytest.raises(DseError, match="step"):
        simulator.run(stop=1, step=step)


@pytest.mark.parametrize(("stop", "step", "rows"), [(60, 0.01, 6001), (0.3, 0.1, 4), (1, 1 / 3, 4), (2.5, 2.5, 2)])
def test_a_run_has_one_row_more_than_steps(lone, stop, step, rows):
    with Simulator(lone(2), ["car.y", "world.n"]) as simulator:
        assert simulator.run(stop=stop, step=step).shape == (rows, 2)


def test_a_library_without_a_needed_function_is_refused_by_its_name(shelf):
    model = shelf.fmu("counter", 2, "-DNO_INTEGERS")
    with pytest.raises(DseError, match="lacks the function fmi2GetInteger"):
        Simulator(shelf.system({"a": model}, (), {}, ["a.count"]), ["a.count"])
    simulator = Simulator(shelf.system({"a": model}, (), {"a.enable": 1}, ["a.odd"]), ["a.odd"])
    with simulator:
        with pytest.raises(DseError, match="lacks the function fmi2SetInteger"):
            simulator.run(stop=1, step=0.5, start={"a.increment": 1})
        assert simulator.run(stop=1, step=0.5).tolist() == [[0], [0], [0]]


def test_a_library_that_is_none_is_refused(lone, tmp_path):
    with pytest.raises(DseError, match=r"the FMU's library is gone since the FMU was opened \(.*none\.so"):
        Simulator(lone(2, library=tmp_path / "none.so"), ["car.y"])
    broken = tmp_path / "broken.so"
    broken.write_text("not a library", encoding="utf-8")
    with pytest.raises(DseError, match="cannot be loaded"):
        Simulator(lone(2, library=broken), ["car.y"])


def test_names_that_are_not_there_are_refused(lone):
    with pytest.raises(DseError, match=r"no output 'car\.z'"):
        Simulator(lone(2), ["car.z"])
    with Simulator(lone(2), ["car.y"]) as simulator, pytest.raises(DseError, match=r"no variable 'car\.z'"):
        simulator.run(stop=1, step=0.1, start={"car.z": 1.0})


def test_strings_are_ignored_unless_they_are_wired(shelf):
    model = shelf.fmu("gain")
    text = Variable("label", 9, "String", "output", None)
    system = shelf.system({"a": model, "b": model}, ["a.y -> b.u"], {"a.c": 1.0}, ["b.y"])
    a, b = system.elements
    labelled = replace(system, elements=(replace(a, outputs=(*a.outputs, text)), b))
    with Simulator(labelled, ["b.y"]) as simulator:
        assert simulator.run(stop=1, step=1).tolist() == [[1], [1]]
    with pytest.raises(DseError, match=r"a\.label: variables of type String cannot be recorded"):
        Simulator(labelled, ["a.label"])


def test_clocks_cannot_be_wired(shelf):
    model = shelf.fmu("gain", 3)
    system = shelf.system({"a": model, "b": model}, ["a.y -> b.u"], {"a.c": 1.0}, ["b.y"])
    a, b = system.elements
    source, target = Variable("tick", 9, "Clock", "output", None), Variable("tock", 8, "Clock", "input", None)
    wired = replace(
        system,
        elements=(replace(a, outputs=(*a.outputs, source)), replace(b, inputs=(*b.inputs, target))),
        wires=(*system.wires, Wire("a", "tick", "b", "tock")),
    )
    with pytest.raises(DseError, match=r"a\.tick: variables of type Clock cannot be wired"):
        Simulator(wired, ["b.y"])


def test_loose_and_doubled_wires_are_refused(shelf):
    model = shelf.fmu("gain")
    system = shelf.system({"a": model, "b": model}, ["a.y -> b.u"])
    for wires, message in [
        ((), "no wire ends at this connected input"),
        ((*system.wires, Wire("a", "y", "b", "u")), "2 wires end at one input"),
        ((*system.wires, Wire("a", "y", "b", "k")), "not an input"),
        ((Wire("a", "c", "b", "u"),), "not an output"),
    ]:
        with pytest.raises(DseError, match=message):
            Simulator(replace(system, wires=wires), [])
