"""One suite over all reference FMUs, as a user's FMU goes: opened from its archive, simulated by the kernel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.method import Coupling, Method
from dse.errors import DseError
from dse.fmu.unpack import open_fmu
from reference_fmus import MODELS, build
from reference_fmus.build import WINDOWS
from reference_fmus.cases import ALL, CASES, INTERFACES, Case, matrices, names_of
from reference_fmus.systems import system_of

Open = Callable[..., FmuModel]
SINGLE = [(version, interface) for version, interface in INTERFACES if interface]
FLOATS = ["Float64_continuous", "Float64_discrete", "Float32_continuous", "Float32_discrete"]
WHOLES = {  # the values next to the ends of each type's range; of 64 bits, what a double holds without loss
    "Int8": (-128, 127),
    "UInt8": (0, 255),
    "Int16": (-32768, 32767),
    "UInt16": (0, 65535),
    "Int32": (-(2**31), 2**31 - 1),
    "UInt32": (0, 2**32 - 1),
    "Int64": (-(2**53), 2**53),
    "UInt64": (0, 2**53),
}


@pytest.fixture(params=["here", pytest.param("wine", marks=pytest.mark.thorough)])
def opened(request: pytest.FixtureRequest, reference_folder: Path) -> Open:
    """Opens a reference FMU as the program does: of this platform, or of Windows."""
    if request.param == "here":
        return lambda name, version, interface: open_fmu(
            build(name, version, interface, reference_folder), cache=reference_folder / "cache"
        )
    cache, folder = request.getfixturevalue("wine_cache"), reference_folder / "windows"

    def of_windows(name: str, version: int, interface: str) -> FmuModel:
        if version == 1:
            pytest.skip("wine is not used for FMI 1.0")
        return open_fmu(build(name, version, interface, folder, WINDOWS), cache=cache)

    return of_windows


def recorded(case: Case) -> list[str]:
    return [f"world.{label}" for label in case.expected(np.array([0.0, case.step]))]


def times_of(case: Case) -> np.ndarray:
    return np.arange(round(case.stop / case.step) + 1) * case.step


def is_same(one: np.ndarray, other: np.ndarray) -> bool:
    return one.shape == other.shape and one.tobytes() == other.tobytes()


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("name", "version", "interface"), ALL, ids=names_of)
def test_a_model_does_what_its_equations_say(name: str, version: int, interface: str, opened: Open) -> None:
    case = CASES[name]
    model = opened(name, version, interface)
    assert model.interface == interface
    record = recorded(case)
    system = system_of({"world": model}, record=record, start={f"world.{k}": x for k, x in case.start.items()})
    with Simulator(system, record) as simulator:
        found = simulator.run(stop=case.stop, step=case.step)
    expected = np.array(list(case.expected(times_of(case)).values())).T
    tolerance = case.co_simulation if interface == "CoSimulation" else case.model_exchange
    assert np.abs(found - expected).max() <= tolerance, case.why


@pytest.mark.parametrize(("name", "version", "interface"), ALL, ids=names_of)
def test_the_kernel_gives_the_bits_of_the_reference_loop(name: str, version: int, interface: str, opened: Open) -> None:
    case = CASES[name]
    record = recorded(case)
    start = {f"world.{k}": x for k, x in case.start.items()}
    system = system_of({"world": opened(name, version, interface)}, record=record, start=start)
    stop = case.step * 30
    with Simulator(system, record) as simulator:
        first, second, third = (simulator.run(stop=stop, step=case.step) for _ in range(3))
        # Reset was put to the proof by the second run: these FMUs are honest.
        assert simulator.reset_is_trusted
    assert is_same(first, second)
    assert is_same(first, third)
    assert is_same(first, run_reference(system, record, stop=stop, step=case.step))


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_that_has_both_interfaces_is_taken_for_co_simulation(name: str, version: int, opened: Open) -> None:
    assert opened(name, version, None).interface is FmiInterface.CO_SIMULATION


@pytest.mark.parametrize(("name", "version", "interface"), [c for c in ALL if c[1] == 2], ids=names_of)
def test_fmi_2_and_fmi_3_agree(name: str, version: int, interface: str, opened: Open) -> None:
    case = CASES[name]
    record = recorded(case)
    found = []
    for each in (2, 3):
        model = opened(name, each, interface)
        system = system_of({"world": model}, record=record, start={f"world.{k}": x for k, x in case.start.items()})
        with Simulator(system, record) as simulator:
            found.append(simulator.run(stop=case.stop, step=case.step))
    # The same C code below; in event mode a step is cut at the event by the master instead of inside.
    assert np.abs(found[0] - found[1]).max() <= 2e-9


# Feedthrough: every type, from starts and over wires


def through(version: int) -> dict[str, tuple[float, ...]]:
    """Labels of inputs (without "_input") of the numbers of this version, and values that are hard on them."""
    scalars: dict[str, tuple[float, ...]] = {
        "Float64_continuous": (-1.5e300, 5e-324),
        "Float64_discrete": (-0.0, 0.1),
        "Int32": WHOLES["Int32"],
        "Boolean": (0, 1),
        "Enumeration": (1, 3 if version == 1 else 7),
        "Float64_array": (),
    }
    if version == 3:
        scalars |= WHOLES
        scalars |= {"Float32_continuous": (-0.5, 2.0**120), "Float32_discrete": (0.0, 2.0**-120)}
    return {name: values for name, values in scalars.items() if values}


ARRAYS = {
    "Float64_array": [[0.5, -2.25, 1e-30], [7.0, 8.125, -9e200]],
    "Int32_array": [-(2**31), 0, 2**31 - 1],
    "Boolean_array": [0, 1],
}


def labelled(name: str, values: object) -> dict[str, float]:
    return {f"{name}[{','.join(str(i + 1) for i in index)}]": float(x) for index, x in np.ndenumerate(np.array(values))}


@pytest.mark.parametrize("which", [0, 1], ids=["low", "high"])
@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
def test_every_number_goes_through_two_fmus_unharmed(version: int, interface: str, which: int, opened: Open) -> None:
    model = opened("Feedthrough", version, interface)
    scalars = {name: values[which] for name, values in through(version).items()}
    start = {f"a.{name}_input": value for name, value in scalars.items()}
    wires = [f"a.{name}_output -> b.{name}_input" for name in scalars]
    record = [f"b.{name}_output" for name in scalars]
    expected = [float(value) for value in scalars.values()]
    for name, values in ARRAYS.items():
        start |= {f"a.{label}": x for label, x in labelled(f"{name}_input", values).items()}
        outputs, inputs = labelled(f"{name}_output", values), labelled(f"{name}_input", values)
        # FMI 3 has the array as one variable, before there is one for each value.
        wires += (
            [f"a.{name}_output -> b.{name}_input"]
            if version == 3
            else [f"a.{y} -> b.{u}" for y, u in zip(outputs, inputs, strict=True)]
        )
        record += [f"b.{label}" for label in outputs]
        expected += list(outputs.values())
    system = system_of({"a": model, "b": model}, wires, record, start)
    with Simulator(system, record) as simulator:
        found = simulator.run(stop=0.3, step=0.1)
        assert is_same(found, simulator.run(stop=0.3, step=0.1))
    assert is_same(found, np.array([expected] * 4))
    assert is_same(found, run_reference(system, record, stop=0.3, step=0.1))


@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
def test_single_values_of_arrays_can_be_wired_across(version: int, interface: str, opened: Open) -> None:
    model = opened("Feedthrough", version, interface)
    matrix = ARRAYS["Float64_array"]
    start = {f"a.{label}": x for label, x in labelled("Float64_array_input", matrix).items()}
    swapped = {"[1,1]": "[2,3]", "[1,2]": "[2,2]", "[1,3]": "[2,1]", "[2,1]": "[1,3]", "[2,2]": "[1,2]"}
    wires = [f"a.Float64_array_output{i} -> b.Float64_array_input{j}" for i, j in swapped.items()]
    wires.append("a.Float64_array_output[2,3] -> b.Float64_array_input[1,1]")
    record = [f"b.{label}" for label in labelled("Float64_array_output", matrix)]
    system = system_of({"a": model, "b": model}, wires, record, start)
    with Simulator(system, record) as simulator:
        found = simulator.run(stop=0.1, step=0.1)
    assert is_same(found, np.array([np.array(matrix)[::-1, ::-1].ravel()] * 2))
    assert is_same(found, run_reference(system, record, stop=0.1, step=0.1))


TEXTS = {"String": "", "String_array[1]": "grüße, “world”\n", "String_array[2]": "x" * 255}
BINARIES = {"Binary": b"\x00\x01\x00\xff", "Binary_array[1]": b"", "Binary_array[2]": bytes(range(200))}
DEFAULTS = {"Binary": b"foo", "Binary_array[1]": b"\x00\xff", "Binary_array[2]": b"\x10"}


def digest(texts: dict[str, bytes]) -> float:
    """What Feedthrough's text_digest must be: FNV-1a over each text and its size, 31 bits."""
    order = [
        "String",
        "Binary",
        "parameter",
        "String_array[1]",
        "Binary_array[1]",
        "String_array[2]",
        "Binary_array[2]",
    ]
    hashed = 2166136261
    for name in order:
        for byte in [*texts[name], len(texts[name]) % 256]:
            hashed = (hashed ^ byte) * 16777619 % 2**32
    return float(hashed & 0x7FFFFFFF)


@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
def test_texts_go_through_two_fmus_unharmed(version: int, interface: str, opened: Open) -> None:
    model = opened("Feedthrough", version, interface)
    binaries = BINARIES if version == 3 else {}
    given = {**TEXTS, **binaries}
    texts: dict[str, str | bytes] = {f"a.{_input(label)}": text for label, text in given.items()}
    texts["b.text_parameter"] = "& of its own"
    wires = [f"a.{_output(label)} -> b.{_input(label)}" for label in given]
    system = system_of({"a": model, "b": model}, wires, ["b.text_digest", "a.text_digest"], texts=texts)
    with Simulator(system, ["b.text_digest", "a.text_digest"]) as simulator:
        found = simulator.run(stop=0.2, step=0.1)
        assert is_same(found, simulator.run(stop=0.2, step=0.1))
    seen = {k: x.encode() for k, x in TEXTS.items()} | DEFAULTS | binaries
    expected = [digest(seen | {"parameter": b"& of its own"}), digest(seen | {"parameter": b"<a & 'b'>"})]
    assert found.tolist() == [expected] * 3
    assert is_same(found, run_reference(system, ["b.text_digest", "a.text_digest"], stop=0.2, step=0.1))


def _input(label: str) -> str:
    stem, bracket, index = label.partition("[")
    return f"{stem}_input{bracket}{index}"


def _output(label: str) -> str:
    return _input(label).replace("_input", "_output")


@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
@pytest.mark.parametrize("coupling", [Coupling.NONE, Coupling.PROPAGATE])
def test_a_value_that_moves_goes_through_a_chain(
    version: int, interface: str, coupling: Coupling, opened: Open
) -> None:
    """Held, values are one step late for each FMU they go through; propagated, they are never late."""
    source, relay = opened("Dahlquist", version, interface), opened("Feedthrough", version, interface)
    wires = [
        "source.x -> a.Float64_continuous_input",
        "a.Float64_continuous_output -> b.Float64_array_input[2,1]",
    ]
    record = ["source.x", "a.Float64_continuous_output", "b.Float64_array_output[2,1]"]
    system = system_of({"b": relay, "a": relay, "source": source}, wires, record)
    method = Method(coupling=coupling)
    with Simulator(system, record, method=method) as simulator:
        found = simulator.run(stop=1.0, step=0.1)
    x = found[:, 0]
    late = [0, 0, 0] if coupling is Coupling.PROPAGATE else [0, 1, 2]
    for column, lag in enumerate(late):
        assert is_same(found[lag:, column], x[: x.size - lag].copy())
        # Initialization settles, so that what is not there yet is the first value.
        assert (found[:lag, column] == x[0]).all()
    assert is_same(found, run_reference(system, record, stop=1.0, step=0.1, method=method))


@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
def test_events_of_one_fmu_reach_another(version: int, interface: str, opened: Open) -> None:
    """A whole number that jumps is a discrete input: FMI 3 takes those in event mode only."""
    wires = ["stair.counter -> relay.Int32_input"]
    record = ["stair.counter", "relay.Int32_output"]
    models = {"stair": opened("Stair", version, interface), "relay": opened("Feedthrough", version, interface)}
    system = system_of(models, wires, record)
    with Simulator(system, record) as simulator:
        found = simulator.run(stop=4.0, step=0.25)
    seconds = np.arange(17) * 0.25
    assert found[:, 0].tolist() == (1 + np.floor(seconds)).tolist()
    assert found[1:, 1].tolist() == found[:-1, 0].tolist()
    assert is_same(found, run_reference(system, record, stop=4.0, step=0.25))


@pytest.mark.parametrize(("n", "m", "r"), [(1, 1, 1), (2, 3, 1), (5, 2, 4), (4, 5, 5)])
@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_structural_parameters_set_the_sizes_of_arrays(interface: str, n: int, m: int, r: int, opened: Open) -> None:
    given = matrices(n, m, r)
    start = {f"world.{k}": x for k, x in given.start().items()} | {"world.n": n, "world.m": m, "world.r": r}
    record = [f"world.y[{i + 1}]" for i in range(r)]
    system = system_of({"world": opened("StateSpace", 3, interface)}, record=record, start=start)
    with Simulator(system, record) as simulator:
        found = simulator.run(stop=1.0, step=0.1)
        assert is_same(found, simulator.run(stop=1.0, step=0.1))
    expected = np.array(list(given.expected(np.arange(11) * 0.1).values())).T
    # As for the system of three states, at most twice as many of them.
    case = CASES["StateSpace"]
    tolerance = case.co_simulation if interface == "CoSimulation" else case.model_exchange
    assert np.abs(found - expected).max() <= 2 * tolerance
    assert is_same(found, run_reference(system, record, stop=1.0, step=0.1))


@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
def test_starts_given_for_one_run_hold_for_that_run_only(version: int, interface: str, opened: Open) -> None:
    system = system_of({"world": opened("Dahlquist", version, interface)}, record=["world.x"])
    with Simulator(system, ["world.x"]) as simulator:
        plain = simulator.run(stop=1.0, step=0.1)
        other = simulator.run(stop=1.0, step=0.1, start={"world.x": 3.0, "world.k": 0.0})
        assert (other == 3.0).all()
        assert is_same(simulator.run(stop=1.0, step=0.1), plain)


# What goes wrong


@pytest.mark.parametrize(("version", "interface"), [one for one in SINGLE if one[0] > 1], ids=names_of)
def test_an_fmu_that_asks_to_end_early_is_told_with_its_time(version: int, interface: str, opened: Open) -> None:
    system = system_of(
        {"stair": opened("Stair", version, interface)}, record=["stair.counter"], start={"stair.last": 4}
    )
    with Simulator(system, ["stair.counter"]) as simulator:
        for _ in range(3):  # fresh, proving the reset, after a reset
            # It asks at t = 3, in the step from 2.8 to 3.2.
            assert simulator.run(stop=10.0, step=0.4)[:, 0].tolist() == [1, 1, 1, 2, 2, 3, 3, 3]
            assert simulator.ended.startswith("stair: ")
            assert "at t = 3 s asked to end the simulation" in simulator.ended
        assert simulator.run(stop=2.0, step=0.4)[-1, 0] == 3
        assert simulator.ended == ""


@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
def test_a_lost_resource_is_told_in_the_fmus_own_words(version: int, interface: str, opened: Open) -> None:
    model = opened("Resource", version, interface)
    file = model.folder / "resources" / "y.txt"
    content = file.read_bytes()
    system = system_of({"reader": model}, record=["reader.y"])
    file.unlink()
    try:
        with Simulator(system, ["reader.y"]) as simulator, pytest.raises(RunFailed) as caught:
            simulator.run(stop=1.0, step=0.1)
    finally:
        file.write_bytes(content)
    assert caught.value.element == "reader"
    assert "y.txt" in str(caught.value)


@pytest.mark.parametrize(("version", "interface"), SINGLE, ids=names_of)
def test_another_models_library_is_refused_at_once(version: int, interface: str, opened: Open) -> None:
    """The token is there so that a description never goes with a library of another version of the model."""
    model = replace(opened("Dahlquist", version, interface), token="another")  # noqa: S106  # FMI's word for an identity
    system = system_of({"world": model}, record=["world.x"])
    with Simulator(system, ["world.x"]) as simulator, pytest.raises(RunFailed) as caught:
        simulator.run(stop=1.0, step=0.1)
    assert caught.value.element == "world"
    assert "wrong" in str(caught.value)


def test_a_text_that_the_fmu_cannot_hold_is_told_in_its_own_words(opened: Open) -> None:
    system = system_of(
        {"relay": opened("Feedthrough", 3, "CoSimulation")},
        record=["relay.text_digest"],
        texts={"relay.String_input": "x" * 256},
    )
    with Simulator(system, ["relay.text_digest"]) as simulator, pytest.raises(RunFailed) as caught:
        simulator.run(stop=1.0, step=0.1)
    assert "longer than 255 bytes" in str(caught.value)


def test_sizes_the_fmu_does_not_have_are_told(opened: Open) -> None:
    model = opened("StateSpace", 3, "CoSimulation")
    with pytest.raises(DseError, match="structural parameter"):
        system_of({"world": model}, start={"world.n": 2.5})
    system = system_of({"world": model}, record=["world.y[1]"], start={"world.n": 6})
    with Simulator(system, ["world.y[1]"]) as simulator, pytest.raises(RunFailed, match="at most 5"):
        simulator.run(stop=1.0, step=0.1)
