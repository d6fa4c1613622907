"""Runs per second of the co-simulation kernel against a hand-written C program and an FMPy loop, in one sitting.

The four FMUs in benchmarks/kernel, 6000 steps of 10 ms, 10 variables recorded in every step: through FMI calls, and
fused into one library; in one thread and in two. The contenders take turns, so that a machine that slows down slows
them all; medians are shown.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from statistics import median

import numpy as np

from dse.cosim.simulator import Simulator
from dse.domain.component import Causality, Component, CSource, Interface, Kind, Parameter, Port, Type
from dse.domain.fmu import FmuModel
from dse.domain.system import Element, SystemStructure, Wire
from dse.fmu.component_build import build
from dse.fmu.fusion.fuse import fuse
from dse.fmu.toolchain.compiler import find_compiler
from dse.fmu.unpack import open_fmu

SOURCES = Path(__file__).parent / "kernel"
STOP, STEP = 60.0, 0.01
TURNS, RUNS = 41, 60  # short turns: a machine's mood lasts longer than a turn
THREADS = 2
FMPY_RUNS = 2

PARTS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...], Mapping[str, float], float | None]] = {
    # inputs, outputs, parameters with start values, period
    "lead": ((), ("x", "v", "a"), {"x0": 150.0, "speed": 50 / 3.6}, None),
    "radar": (("x", "v", "lead_x", "lead_v"), ("gap", "closing_speed", "detected"), {"range": 120.0}, None),
    "controller": (
        ("gap", "closing_speed", "speed", "detected"),
        ("demand",),
        {"kp_speed": 0.8, "kd_speed": 0.05, "kp_gap": 0.12, "kd_gap": 0.9, "set_speed": 70 / 3.6, "set_gap": 40.0},
        STEP,
    ),
    "vehicle": (("demand",), ("x", "v", "a"), {"lag": 0.4, "mass": 1500.0, "drag": 0.42, "rolling": 0.012}, None),
}
WIRES = (
    "vehicle.x -> radar.x",
    "vehicle.v -> radar.v",
    "lead.x -> radar.lead_x",
    "lead.v -> radar.lead_v",
    "radar.gap -> controller.gap",
    "radar.closing_speed -> controller.closing_speed",
    "vehicle.v -> controller.speed",
    "radar.detected -> controller.detected",
    "controller.demand -> vehicle.demand",
)
RECORD = tuple(f"{part}.{output}" for part, (_, outputs, _, _) in PARTS.items() for output in outputs)
# References that plain.c wants under another name, because part and port would read the same.
RENAMED = {"RADAR_X": "RADAR_EGO_X", "RADAR_V": "RADAR_EGO_V"}


def component(name: str) -> Component:
    inputs, outputs, parameters, period = PARTS[name]
    ports = [
        Port(port, causality, Type(Kind.BOOLEAN if port == "detected" else Kind.REAL))
        for causality, ports in ((Causality.INPUT, inputs), (Causality.OUTPUT, outputs))
        for port in ports
    ]
    source = CSource(
        files=(SOURCES / f"{name}.c",),
        header=SOURCES / f"{name}.h",
        struct=name.capitalize(),
        init=f"{name}_init",
        step_function=f"{name}_step",
        step=period,
    )
    settings = tuple(Parameter(key, Type(Kind.REAL), start) for key, start in parameters.items())
    return Component(name, Interface(name, tuple(ports)), source=source, parameters=settings)


def assemble(models: Mapping[str, FmuModel]) -> SystemStructure:
    ends = [wire.split(" -> ") for wire in WIRES]
    elements = tuple(
        Element(
            name,
            models[name],
            tuple(models[name].variables[port] for port in inputs),
            tuple(models[name].variables[port] for port in outputs),
            {},
        )
        for name, (inputs, outputs, _, _) in PARTS.items()
    )
    return SystemStructure("kernel", elements, tuple(Wire(*a.split("."), *b.split(".")) for a, b in ends))


def gains(number: int) -> dict[str, float]:
    values = {"kp_speed": 0.5 + 0.0005 * number, "kd_speed": 0.05, "kp_gap": 0.12, "kd_gap": 0.9}
    return {f"controller.{name}": value for name, value in values.items()}


def run_kernel(simulator: Simulator) -> tuple[float, list[float]]:
    rows = np.empty((round(STOP / STEP) + 1, len(RECORD)))  # one for all runs, as in plain.c
    began = time.perf_counter()
    for number in range(1, RUNS + 1):
        simulator.run(stop=STOP, step=STEP, start=gains(number), out=rows)
    return time.perf_counter() - began, rows[-1].tolist()


def overhead(simulator: Simulator) -> float:
    """Seconds of a run that has one step: what a run costs outside the loop."""
    began = time.perf_counter()
    for number in range(1000):
        simulator.run(stop=STEP, step=STEP, start=gains(number))
    return (time.perf_counter() - began) / 1000


def run_in_threads(simulators: Sequence[Simulator]) -> float:
    """Runs per second of all *simulators* together, each in a thread of its own."""
    threads = [threading.Thread(target=run_kernel, args=(simulator,)) for simulator in simulators]
    began = time.perf_counter()
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return RUNS * len(simulators) / (time.perf_counter() - began)


def warmed(simulator: Simulator) -> Simulator:
    for number in range(2):  # the second proves the reset
        simulator.run(stop=STOP, step=STEP, start=gains(number))
    assert simulator.reset_is_trusted
    return simulator


def compile_plain(models: Mapping[str, FmuModel], program: Path) -> list[str]:
    macros = {
        f"{part}_{variable.name}".upper(): variable.reference
        for part, model in models.items()
        for variable in model.variables.values()
    }
    flags = [f"-D{RENAMED.get(name, name)}={reference}" for name, reference in macros.items() if name.isidentifier()]
    options = ["-std=c11", "-O2", "-ffp-contract=off"]
    libraries = ["-ldl"] if sys.platform == "linux" else []
    command = [*find_compiler().command, *options, *flags, str(SOURCES / "plain.c"), "-o", str(program), *libraries]
    subprocess.run(command, check=True)
    parts = [text for model in models.values() for text in (str(model.library), model.token)]
    return [str(program), str(RUNS), *parts]


def run_plain(command: list[str]) -> tuple[float, list[float]]:
    printed = subprocess.run(command, check=True, capture_output=True, text=True, encoding="utf-8").stdout.split()
    return float(printed[0]), [float.fromhex(word) for word in printed[1:]]


def run_fmpy(models: Mapping[str, FmuModel]) -> float:
    from fmpy.fmi2 import FMU2Slave

    began = time.perf_counter()
    slaves = {}
    for name, model in models.items():
        slave = FMU2Slave(
            guid=model.token, unzipDirectory=str(model.folder), modelIdentifier=model.identifier, instanceName=name
        )
        slave.instantiate()
        slaves[name] = slave
    plan = []
    for name, slave in slaves.items():
        inputs, outputs, _, _ = PARTS[name]
        reference = {v.name: v.reference for v in models[name].variables.values()}
        sources = {w.split(" -> ")[1]: w.split(" -> ")[0] for w in WIRES}
        truth = [p for p in (*inputs, *outputs) if p == "detected"]
        real_in, real_out = ([p for p in ports if p not in truth] for ports in (inputs, outputs))
        plan.append((name, slave, reference, sources, inputs, outputs, real_in, real_out))
    values: dict[str, float] = {}

    def read() -> None:
        for name, slave, reference, _, _, outputs, _, real in plan:
            found = slave.getReal([reference[p] for p in real])
            values.update(zip((f"{name}.{p}" for p in real), found, strict=True))
            if "detected" in outputs:
                values[f"{name}.detected"] = slave.getBoolean([reference["detected"]])[0]

    def write() -> None:
        for name, slave, reference, sources, inputs, _, real, _ in plan:
            if real:
                slave.setReal([reference[p] for p in real], [values[sources[f"{name}.{p}"]] for p in real])
            if "detected" in inputs:
                slave.setBoolean([reference["detected"]], [values[sources[f"{name}.detected"]]])

    for run in range(FMPY_RUNS):
        for name, slave, reference, *_ in plan:
            if run:
                slave.reset()
            slave.setupExperiment(startTime=0.0, stopTime=STOP)
            if name == "controller":
                chosen = gains(run)
                slave.setReal([reference[key.split(".")[1]] for key in chosen], list(chosen.values()))
            slave.enterInitializationMode()
        for _ in range(4):
            read()
            write()
        for slave in slaves.values():
            slave.exitInitializationMode()
        rows = []
        for k in range(round(STOP / STEP) + 1):
            read()
            rows.append([values[name] for name in RECORD])
            if k == round(STOP / STEP):
                break
            write()
            for slave in slaves.values():
                slave.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
        for slave in slaves.values():
            slave.terminate()
    for slave in slaves.values():
        slave.freeInstance()
    return time.perf_counter() - began


def main() -> None:
    models = {name: open_fmu(build(component(name))) for name in PARTS}
    system = assemble(models)
    library = fuse(system, RECORD)
    rates: dict[str, list[float]] = {name: [] for name in ("kernel", "fused", "plain")}
    scaling: dict[str, list[float]] = {"kernel": [], "fused": []}
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        command = compile_plain(models, Path(folder) / "plain")
        simulators = {
            name: [warmed(stack.enter_context(Simulator(system, RECORD, fused=made))) for _ in range(THREADS)]
            for name, made in (("kernel", None), ("fused", library))
        }
        for turn in range(TURNS):
            seconds, expected = run_plain(command)
            rates["plain"].append(RUNS / seconds)
            for name, (first, *others) in simulators.items():
                seconds, last = run_kernel(first)
                rates[name].append(RUNS / seconds)
                assert last == expected, f"{name} and the plain program must compute the same"
                if turn % 4 == 0:
                    together = run_in_threads([first, *others])
                    scaling[name].append(together / run_in_threads([first]))
        alone = {name: overhead(first) for name, (first, *_) in simulators.items()}
    rates["FMPy"] = [FMPY_RUNS / run_fmpy(models)]
    middle = {name: median(values) for name, values in rates.items()}
    ratio = {name: median(a / b for a, b in zip(rates[name], rates["plain"], strict=True)) for name in simulators}
    print(f"four FMUs, {round(STOP / STEP)} steps, {len(RECORD)} variables recorded")
    shown = (
        ("plain C program", "plain", ""),
        ("kernel", "kernel", f"{ratio['kernel']:.3f} of plain C   (at least 0.95 wanted)"),
        ("fused", "fused", f"{ratio['fused']:.3f} of plain C   (at least 1.05 wanted)"),
        ("FMPy loop", "FMPy", f"1/{middle['kernel'] / middle['FMPy']:.0f} of the kernel   (at most 1/50 wanted)"),
    )
    for title, name, compared in shown:
        print(f"  {title:16}{middle[name]:8.1f} runs/s   {compared}".rstrip())
    for name, values in scaling.items():
        print(f"  {name} in {THREADS} threads {median(values):.2f} times one   (at least 1.8 wanted)")
    for name, seconds in alone.items():
        print(f"  {name}: a run of one step takes {1e6 * seconds:.0f} µs   (at most 100 wanted)")


if __name__ == "__main__":
    main()
