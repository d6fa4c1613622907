"""Model exchange elements in the kernel and in the master written in Python: the same bits, or the same failure."""

from __future__ import annotations

import numpy as np
import pytest
from cosim.exchange_models import model, system
from hypothesis import HealthCheck, given, settings, strategies as st
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.method import PLAIN, Adaptive, Algorithm, Coupling, Extrapolation, Method
from dse.errors import DseError

BOTH = pytest.mark.parametrize("version", [2, 3])
METHODS = {
    "plain": PLAIN,
    "gauss_seidel": Method(algorithm=Algorithm.GAUSS_SEIDEL),
    "linear": Method(extrapolation=Extrapolation.LINEAR),
    "propagate": Method(coupling=Coupling.PROPAGATE),
    "solve": Method(coupling=Coupling.SOLVE, extrapolation=Extrapolation.LINEAR),
    "adaptive": Method(adaptive=Adaptive(tolerance=1e-3, absolute=1e-3)),
    "multirate": Method(steps={"a": 0.025, "b": 0.2}, extrapolation=Extrapolation.LINEAR),
}


@pytest.fixture(scope="session")
def folder(shelf):
    return shelf.folder


def outcome(run):
    try:
        return run().tobytes()
    except RunFailed as failure:
        return str(failure), failure.element, failure.call, failure.time
    except DseError as refusal:
        return str(refusal)


def same(built, record, method, *, stop=1.0, step=0.1):
    def fast():
        with Simulator(built, record, method=method) as simulator:
            return simulator.run(stop=stop, step=step)

    found = outcome(fast)
    assert found == outcome(lambda: run_reference(built, record, stop=stop, step=step, method=method))
    return found


@BOTH
@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_a_ring_with_events_gives_the_same_bits(shelf, folder, version, method):
    elements = {
        "a": model("oscillator", version, folder),
        "saw": model("sawtooth", version, folder),
        "b": model("sampler", version, folder),
        "gain": shelf.fmu("gain", 5 - version),
    }
    wires = ["b.x -> gain.u", "gain.y -> a.u", "saw.x -> b.u", "saw.resets -> b.n"]
    record = ["a.x", "a.v", "b.x", "b.changes", "saw.x", "gain.y"]
    start = {"a.w": 2.0, "saw.rate": 3.3, "gain.k": -0.7}
    if method.adaptive:
        start.pop("gain.k")
        del elements["gain"]  # it cannot go back to a saved state
        wires = [wire for wire in wires if "gain" not in wire]
        record.remove("gain.y")
    found = same(system(elements, wires, start, record), record, method)
    assert isinstance(found, bytes)


@BOTH
@pytest.mark.parametrize("how", range(1, 10))
def test_failures_are_told_alike(folder, version, how):
    elements = {"e": model("faulty", version, folder)}
    found = same(system(elements, (), {"e.how": how, "e.at": 0.35}, ["e.x"]), ["e.x"], PLAIN)
    assert found[1] == "e"


KINDS = {
    "oscillator": (["x", "v"], ["u"]),
    "sampler": (["x", "dx"], ["u"]),
    "sawtooth": (["x"], []),
    "clocks": (["x", "last"], []),
    "tank": (["h"], []),
}


@st.composite
def rings(draw):
    kinds = {
        name: (draw(st.sampled_from(sorted(KINDS))), draw(st.sampled_from([2, 3])))
        for name in "abc"[: draw(st.integers(1, 3))]
    }
    wires = []
    for name, (kind, _) in kinds.items():
        for port in KINDS[kind][1]:
            source = draw(st.sampled_from([None, *kinds]))
            if source:
                wires.append(f"{source}.{draw(st.sampled_from(KINDS[kinds[source][0]][0]))} -> {name}.{port}")
    return kinds, wires, draw(st.sampled_from(sorted(set(METHODS) - {"multirate"})))


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rings())
def test_any_wiring_gives_the_same_bits_or_the_same_failure(folder, drawn):
    kinds, wires, method = drawn
    record = [f"{name}.{output}" for name, (kind, _) in kinds.items() for output in KINDS[kind][0]]
    built = system({name: model(*kind, folder) for name, kind in kinds.items()}, wires, {}, record)
    same(built, record, METHODS[method])


@BOTH
def test_an_algebraic_loop_through_model_exchange_is_solved_in_event_mode(shelf, folder, version):
    elements = {"e": model("sampler", version, folder), "gain": shelf.fmu("gain", version)}
    wires = ["e.dx -> gain.u", "gain.y -> e.u"]
    built = system(elements, wires, {"gain.k": -0.25, "gain.c": 1.0}, ["e.dx", "e.x"])
    with Simulator(built, ["e.dx", "e.x"], method=Method(coupling=Coupling.SOLVE)) as simulator:
        found = simulator.run(stop=1.0, step=0.1)
    # dx = u and u = 1 - dx / 4, so dx is 0.8 at any time.
    assert np.abs(found[:, 0] - 0.8).max() < 1e-9
    assert np.abs(found[:, 1] - 0.8 * np.arange(11) * 0.1).max() < 1e-9
