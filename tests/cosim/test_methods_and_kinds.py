"""Every algorithm with every kind of element: both versions of FMI, co-simulation and model exchange, all types."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
from oracle.reference import run_reference
from reference_fmus import build

from dse.cosim.simulator import Simulator
from dse.cosim.wiring.wiring import wire_up
from dse.domain.fmu import FmuModel
from dse.domain.method import Adaptive, Algorithm, Coupling, Extrapolation, Method
from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import DseError
from dse.fmu.unpack import open_fmu

METHODS = {
    "jacobi": Method(),
    "propagated": Method(coupling=Coupling.PROPAGATE),
    "solved in turn": Method(Algorithm.GAUSS_SEIDEL, Coupling.SOLVE),
    "along lines": Method(extrapolation=Extrapolation.LINEAR),
    "adaptive": Method(Algorithm.GAUSS_SEIDEL, extrapolation=Extrapolation.LINEAR, adaptive=Adaptive(1e-3, 1e-3)),
    "own steps": Method(steps={"b": 0.05, "c": 0.2}),
}
KINDS = [(2, "CoSimulation"), (2, "ModelExchange"), (3, "CoSimulation"), (3, "ModelExchange")]
BY_KIND = pytest.mark.parametrize(("version", "interface"), KINDS, ids=[f"{i}{v}" for v, i in KINDS])
BY_METHOD = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)


@pytest.fixture(scope="session")
def opened(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("reference")
    return cache(lambda *kind: open_fmu(build(*kind, folder), cache=folder / "cache"))


def same_bits(made, record, method):
    with Simulator(made, record, method=method) as simulator:
        found = [simulator.run(stop=1.0, step=0.1).tobytes() for _ in range(3)]
        assert simulator.reset_is_trusted
    slow = run_reference(made, record, stop=1.0, step=0.1, method=method)
    assert found == [slow.tobytes()] * 3
    return slow


def passed_on(model: FmuModel):
    """Outputs of a Feedthrough with the inputs they follow."""
    named = {v.name: v for v in model.variables.values() if not v.alias_of and not v.is_clocked}
    outputs = [v for v in named.values() if v.causality == "output" and "output" in v.name]
    return [(v, named[name]) for v in outputs if (name := v.name.replace("output", "input")) in named]


def chain(model: FmuModel, names: str) -> SystemStructure:
    """a -> b -> c, as many wires as the FMU has inputs; elements in the order of *names*."""
    pairs = passed_on(model)
    start = {"a": {"Float64_continuous_input": 1.5, "Int32_input": 7.0}}
    return SystemStructure(
        "chain",
        tuple(
            Element(
                name,
                model,
                () if name == "a" else tuple(target for _, target in pairs),
                tuple(source for source, _ in pairs),
                start.get(name, {}),
            )
            for name in names
        ),
        tuple(Wire(a, source.name, b, target.name) for a, b in ("ab", "bc") for source, target in pairs),
    )


@pytest.mark.sampled(5)
@BY_KIND
@BY_METHOD
@pytest.mark.parametrize("names", ["abc", "cab"])
def test_values_of_all_types_go_down_a_chain(opened, version, interface, method, names):
    model = opened("Feedthrough", version, interface)
    # In the second order the description does not tell what depends on what.
    model = model if names == "abc" else replace(model, depends={}, initially_depends={})
    made = chain(model, names)
    record = list(wire_up(made).values)
    found = same_bits(made, record, method)
    for name in names:
        assert found[-1, record.index(f"{name}.Float64_continuous_output")] == 1.5
        assert found[-1, record.index(f"{name}.Int32_output")] == 7.0


@pytest.mark.parametrize("name", sorted(METHODS.keys() - {"adaptive"}))
def test_elements_of_fmi_1_know_every_method_but_those_that_step_back(opened, name):
    model = opened("Feedthrough", 1, "CoSimulation")
    made = chain(model, "abc")
    found = same_bits(made, list(wire_up(made).values), METHODS[name])
    assert found[-1, list(wire_up(made).values).index("c.Float64_continuous_output")] == 1.5
    with pytest.raises(DseError, match="a: an adaptive step takes steps back, but Feedthrough cannot save its state"):
        Simulator(made, [], method=METHODS["adaptive"])


@BY_KIND
@BY_METHOD
def test_what_moves_by_itself_is_the_same_by_every_method(opened, version, interface, method):
    model = opened("BouncingBall", version, interface)
    outputs = tuple(v for v in model.variables.values() if v.causality == "output" and not v.alias_of)
    made = SystemStructure("ball", (Element("b", model, (), outputs, {}),), ())
    found = same_bits(made, [f"b.{v.name}" for v in outputs], replace(method, steps={}))
    plain = same_bits(made, [f"b.{v.name}" for v in outputs], Method())
    # Alone there is no coupling error; what differs is where the integrator's own steps end (tolerance 1e-6).
    assert found == pytest.approx(plain, abs=1e-4)
