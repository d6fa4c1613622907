from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linear_fmus import Linear, system
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.cosim.wiring.check import check_system, own_steps
from dse.domain.method import Adaptive, Algorithm, Extrapolation, Method
from dse.errors import DseError

RING = ["a.y0 -> b.u0", "b.y0 -> a.u0"]


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("linear")


def swing(rate: float, **options) -> dict[str, Linear]:
    """x'' = - rate**2 x as two integrators, x and its speed over rate: together a circle of radius 1."""
    return {
        "a": Linear([[0.0]], [[rate]], [[1.0]], (), [1.0], **options),
        "b": Linear([[0.0]], [[-rate]], [[1.0]], (), [0.0], **options),
    }


def run(made, record, method, *, stop, step):
    with Simulator(made, record, method=method) as simulator:
        found = simulator.run(stop=stop, step=step)
        assert simulator.run(stop=stop, step=step).tobytes() == found.tobytes()
    assert run_reference(made, record, stop=stop, step=step, method=method).tobytes() == found.tobytes()
    return found


@pytest.mark.parametrize("extrapolation", Extrapolation)
@pytest.mark.parametrize("algorithm", Algorithm)
@pytest.mark.parametrize("version", [2, 3])
def test_the_error_follows_the_tolerance(folder, version, algorithm, extrapolation):
    made = system(swing(1.0, version=version), RING, folder)
    errors = []
    for tolerance in (1e-2, 1e-3, 1e-4):
        method = Method(algorithm, extrapolation=extrapolation, adaptive=Adaptive(tolerance, tolerance))
        found = run(made, ["a.y0"], method, stop=2, step=0.5)
        errors.append(float(np.abs(found[:, 0] - np.cos(np.arange(5) * 0.5)).max()))
    assert errors[0] > 2 * errors[1] > 4 * errors[2]  # the step goes with the root of the tolerance at least


def test_rows_lie_at_the_run_s_own_communication_points(folder):
    made = system(swing(3.0), RING, folder)
    found = run(made, ["a.y0", "b.y0"], Method(adaptive=Adaptive(1e-3, 1e-3)), stop=2, step=0.5)
    assert found.shape == (5, 2)


def test_what_needs_no_shorter_step_is_simulated_as_with_a_fixed_step_of_half_the_length(folder):
    # A constant: any step will do, and the two halves that are kept are exact.
    made = system({"a": Linear([[0.0]], (), [[1.0]], (), [2.0]), "b": Linear(b=[[0.0]])}, ["a.y0 -> b.u0"], folder)
    assert run(made, ["a.y0"], Method(adaptive=Adaptive()), stop=1, step=0.5).tolist() == [[2], [2], [2]]


def test_a_step_that_would_have_to_be_too_short_fails_by_name(folder):
    made = system(swing(50.0), RING, folder)
    method = Method(adaptive=Adaptive(1e-6, 1e-6, smallest=0.01))
    with Simulator(made, ["a.y0"], method=method) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=1, step=0.1)
    # 0.1 s is halved to 0.0125 s, and halves of that would be too short
    assert str(fast.value) == (
        "a.y0 asks for steps shorter than 0.00625 s at t = 0.0125 s: the tolerance cannot be kept"
    )
    with pytest.raises(RunFailed) as slow:
        run_reference(made, ["a.y0"], stop=1, step=0.1, method=method)
    assert (str(slow.value), slow.value.time) == (str(fast.value), fast.value.time)


@pytest.mark.parametrize("version", [2, 3])
def test_a_step_that_an_fmu_discards_is_made_shorter(folder, version):
    elements = swing(1.0, version=version)
    made = system({**elements, "b": replace(elements["b"], longest=0.1)}, RING, folder)
    method = Method(adaptive=Adaptive(1.0, 1.0))  # everything is good enough for this tolerance
    found = run(made, ["a.y0"], method, stop=1, step=0.5)
    # 0.5 s is halved until it fits at 0.0625 s; Jacobi's error over 1 s is below that size.
    assert found[-1, 0] == pytest.approx(np.cos(1.0), abs=0.0625)
    coarse = Method(adaptive=Adaptive(1.0, 1.0, smallest=0.2))
    with Simulator(made, ["a.y0"], method=coarse) as simulator, pytest.raises(RunFailed) as failed:
        simulator.run(stop=1, step=0.5)
    assert str(failed.value) == f"b: fmi{version}DoStep at t = 0 s returned discard"


def test_why_a_step_cannot_be_adaptive_is_told_all_at_once_and_before_anything_is_loaded(folder):
    made = system(swing(1.0, saves=False), RING, folder)
    rigid = replace(made.elements[1].model.capabilities, can_handle_variable_step=False, can_save_state=True)
    a, b = made.elements
    made = replace(
        made,
        elements=(
            replace(a, model=replace(a.model, library=Path("not there"))),
            replace(b, model=replace(b.model, library=Path("not there"), capabilities=rigid)),
        ),
    )
    with pytest.raises(DseError) as refused:
        check_system(made, Method(adaptive=Adaptive(-1.0), steps={"a": 0.1, "c": 0.1}))
    said = str(refused.value)
    for what in (
        "there is no element 'c' to give a step of its own",
        "the tolerance of an adaptive step cannot be -1",
        "a, c: steps of their own do not go together with an adaptive step",
        "a: an adaptive step takes steps back, but linear cannot save its state",
        "b: an adaptive step varies, but linear takes only steps of one length",
    ):
        assert what in said


def test_an_adaptive_step_needs_something_to_be_judged_by(folder):
    made = system(swing(1.0), RING, folder)
    whole = {name: replace(v, variability="discrete") for name, v in made.elements[0].model.variables.items()}
    a, b = (
        replace(e, model=replace(e.model, variables=whole), outputs=tuple(whole[v.name] for v in e.outputs))
        for e in made.elements
    )
    with pytest.raises(DseError, match="no output that is wired or recorded is a continuous real number"):
        check_system(replace(made, elements=(a, b)), Method(adaptive=Adaptive()))
    check_system(replace(made, elements=(a, made.elements[1])), Method(adaptive=Adaptive()))


@pytest.mark.thorough
def test_a_tolerance_that_takes_for_ever_is_given_up_by_name(folder):
    # A step of 2^-40 of 0.5 s would do: errors of two integrators go with its square.
    made = system(swing(1.0), RING, folder)
    method = Method(adaptive=Adaptive(1e-24, 1e-24, smallest=1e-300))
    with Simulator(made, ["a.y0"], method=method) as simulator, pytest.raises(RunFailed) as failed:
        simulator.run(stop=1, step=0.5)
    assert "asks for more than 1048576 steps between two communication points, at t = " in str(failed.value)


def test_own_steps_are_whole_multiples_or_fractions(folder):
    made = system(swing(1.0), RING, folder)
    a, b = own_steps(made, Method(steps={"a": 0.3, "b": 0.1 / 3}), stop=0.6, step=0.1)
    assert (a.every, a.parts, b.every, b.parts) == (3, 1, 1, 3)
    with pytest.raises(DseError, match="b: cannot make steps of 0 s"):
        check_system(made, Method(steps={"b": 0.0}))
