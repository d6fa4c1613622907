"""Every type of variable of every FMI version, through FMUs that watch strictly what may be done when."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracle.reference import run_reference
from reference_fmus import build

from dse.cosim.simulator import Simulator
from dse.domain.fmu import FmiInterface
from dse.domain.method import Algorithm, Coupling, Method
from dse.domain.system import Element, SystemStructure, Wire
from dse.fmu.unpack import open_fmu
from dse.system.assembly import resized

CO_SIMULATION, MODEL_EXCHANGE = FmiInterface.CO_SIMULATION, FmiInterface.MODEL_EXCHANGE
KINDS = [(1, CO_SIMULATION), (2, CO_SIMULATION), (3, CO_SIMULATION), (2, MODEL_EXCHANGE), (3, MODEL_EXCHANGE)]
ALL_KINDS = pytest.mark.parametrize(
    ("version", "interface"), KINDS, ids=[f"fmi{version} {interface.value}" for version, interface in KINDS]
)


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reference_fmus")
    known = {}

    def find(name, version, interface=CO_SIMULATION):
        key = name, version, interface
        if key not in known:
            known[key] = open_fmu(build(name, version, interface.value, folder), cache=folder / "cache")
        return known[key]

    return find


def element(name, model, *, inputs=(), outputs=(), start=None, texts=None, conversions=None):
    return Element(
        name,
        model,
        tuple(model.variables[v] for v in inputs),
        tuple(model.variables[v] for v in outputs),
        start or {},
        texts or {},
        conversions or {},
    )


def same_bits(system, record, method=None, **run):
    run = {"stop": 0.5, "step": 0.1} | run
    method = method or Method()
    with Simulator(system, record, method=method) as simulator:
        rows = [simulator.run(**run).copy() for _ in range(3)]  # fresh, proving the reset, after a reset
        assert simulator.reset_is_trusted
    slow = run_reference(system, record, method=method, **run)
    for fast in rows:
        assert fast.tobytes() == slow.tobytes()
    return slow


def is_text(variable):
    return variable.fmi_type in ("String", "Binary")


def chain(model, texts=None, start=None):
    """Two elements, every input of the second wired to the output of the first that shows the like input."""
    inputs = [v.name for v in model.variables.values() if v.causality == "input"]
    ends = [(name.replace("input", "output"), name) for name in inputs]
    numbers = [name.replace("input", "output") for name in inputs if not is_text(model.variables[name])]
    first = element("a", model, outputs=[source for source, _ in ends], start=start, texts=texts)
    second = element("b", model, inputs=inputs, outputs=[*numbers, "text_digest", "sum"])
    wires = tuple(Wire("a", source, "b", target) for source, target in ends)
    record = [f"b.{label}" for name in numbers for label in model.variables[name].labels]
    return SystemStructure("chain", (first, second), wires), [*record, "b.text_digest", "b.sum"]


def limits(model):
    """A start value at the end of the range for every scalar input that is a number."""
    largest = {f"{sign}Int{bits}": 2.0 ** (bits - (not sign)) - 1 for sign in ("", "U") for bits in (8, 16, 32)}
    largest |= {"Int64": 2.0**53, "UInt64": 2.0**53, "Integer": 2.0**31 - 1, "Boolean": 1.0}
    largest |= {"Float64": -1e308, "Real": -1e308, "Float32": 0.1}
    return {
        v.name: 2.0 if v.items else largest[v.fmi_type]
        for v in model.variables.values()
        if v.causality == "input" and v.fmi_type in largest and not v.shape and "array" not in v.name
    }


@ALL_KINDS
def test_every_variable_travels_along_a_wire(opened, version, interface):
    model = opened("Feedthrough", version, interface)
    start = limits(model)
    texts = {"String_input": "Grüße & <Küsse>"}
    if version == 3:
        texts["Binary_input"] = b"\x00\x01\xff\x00"
    system, record = chain(model, texts, start)
    rows = same_bits(system, record)
    shown = dict(zip(record, rows[-1], strict=True))
    for name, value in start.items():
        expected = float(np.float32(value)) if "Float32" in name else value
        assert shown[f"b.{name.replace('input', 'output')}"] == expected
    alone = element("a", model, outputs=["text_digest"], start=start, texts=texts)
    digest = same_bits(SystemStructure("alone", (alone,), ()), ["a.text_digest"])
    assert shown["b.text_digest"] == digest[-1, 0] != 0.0


@ALL_KINDS
def test_texts_that_are_started_differently_are_told_apart(opened, version, interface):
    model = opened("Feedthrough", version, interface)
    digests = set()
    for text in ("", "a", "b", "ab" * 100):
        system = SystemStructure(
            "alone", (element("a", model, outputs=["text_digest"], texts={"String_input": text}),), ()
        )
        digests.add(same_bits(system, ["a.text_digest"])[-1, 0])
    assert len(digests) == 4


def test_single_values_of_an_array_are_wired_and_the_others_stay(opened):
    model = opened("Feedthrough", 3)
    first = element(
        "a",
        model,
        outputs=["Float64_array_output", "Float64_continuous_output"],
        start={"Float64_array_input[1,1]": 10.0, "Float64_continuous_input": 7.0},
    )
    second = element(
        "b",
        model,
        inputs=["Float64_array_input"],
        outputs=["Float64_array_output"],
        start={"Float64_array_input[2,2]": 50.0},
    )
    wires = (
        Wire("a", "Float64_array_output[1,1]", "b", "Float64_array_input[2,3]"),
        Wire("a", "Float64_continuous_output", "b", "Float64_array_input[1,2]"),
    )
    system = SystemStructure("partly", (first, second), wires)
    record = [f"b.{label}" for label in model.variables["Float64_array_output"].labels]
    for method in (Method(), Method(algorithm=Algorithm.GAUSS_SEIDEL), Method(coupling=Coupling.PROPAGATE)):
        # The FMU starts them at 1 … 6; those that nobody gives keep what the FMU's description says.
        assert same_bits(system, record, method)[-1].tolist() == [1.0, 7.0, 3.0, 4.0, 50.0, 10.0]
    given = {"b.Float64_array_input[1,1]": -1.0}
    assert same_bits(system, record, start=given)[-1].tolist() == [-1.0, 7.0, 3.0, 4.0, 50.0, 10.0]


@pytest.mark.parametrize("interface", [CO_SIMULATION, MODEL_EXCHANGE])
def test_structural_parameters_size_the_arrays(opened, interface):
    sizes = {"m": 1.0, "n": 2.0, "r": 2.0}
    model = resized(opened("StateSpace", 3, interface), sizes)
    # x' = (x2, -x1), from (1, 0): y = (cos t, -sin t)
    start = sizes | {"A[1,1]": 0.0, "A[1,2]": 1.0, "A[2,1]": -1.0, "A[2,2]": 0.0, "B[1,1]": 0.0, "B[2,1]": 0.0}
    start |= {"C[1,1]": 1.0, "C[1,2]": 0.0, "C[2,1]": 0.0, "C[2,2]": 1.0, "D[1,1]": 0.0, "D[2,1]": 0.0}
    start |= {"x0[1]": 1.0, "x0[2]": 0.0, "u[1]": 0.0}
    system = SystemStructure("rotation", (element("s", model, outputs=["y"], start=start),), ())
    rows = same_bits(system, ["s.y[1]", "s.y[2]"], stop=1.0)
    times = np.arange(11) * 0.1
    # Both integrate to 1e-6 or better: RK4 inside the FMU, our solver for model exchange.
    assert np.abs(rows - np.column_stack([np.cos(times), -np.sin(times)])).max() < 1e-5


def test_whole_arrays_are_wired_by_name(opened):
    model = opened("Feedthrough", 3)
    first = element(
        "a", model, outputs=["Int32_array_output"], start={f"Int32_array_input[{i}]": i * i for i in (1, 2, 3)}
    )
    second = element("b", model, inputs=["Int32_array_input"], outputs=["Int32_array_output"])
    system = SystemStructure("whole", (first, second), (Wire("a", "Int32_array_output", "b", "Int32_array_input"),))
    assert same_bits(system, [f"b.Int32_array_output[{i}]" for i in (1, 2, 3)])[0].tolist() == [1, 4, 9]


@ALL_KINDS
def test_two_versions_and_interfaces_exchange_what_they_both_know(opened, version, interface):
    source, target = opened("Feedthrough", version, interface), opened("Feedthrough", 3)
    names = {"Real": "Float64_continuous", "Integer": "Int32", "Boolean": "Boolean", "String": "String"}
    first = element(
        "a",
        source,
        outputs=[f"{name}_output" for name in names.values()],
        start={"Float64_continuous_input": 0.1, "Int32_input": -5, "Boolean_input": 1},
        texts={"String_input": "x"},
    )
    second = element(
        "b",
        target,
        inputs=[f"{name}_input" for name in names.values()],
        outputs=["Float64_continuous_output", "Int32_output", "Boolean_output", "text_digest"],
    )
    wires = tuple(Wire("a", f"{name}_output", "b", f"{name}_input") for name in names.values())
    record = ["b.Float64_continuous_output", "b.Int32_output", "b.Boolean_output"]
    system = SystemStructure("mixed", (first, second), wires)
    assert same_bits(system, record)[-1].tolist() == [0.1, -5.0, 1.0]
    untold = replace(system, elements=(replace(first, texts={}), second))
    digests = [same_bits(s, ["b.text_digest"])[-1, 0] for s in (system, untold)]
    assert digests[0] != digests[1]
