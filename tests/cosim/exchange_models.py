"""The models of fmus_me as FMUs for model exchange."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.cosim.simulator import Simulator
from dse.domain.component import Kind
from dse.domain.fmu import Capabilities, Exchange, Experiment, FmiInterface, FmuModel, Variable
from dse.domain.system import Element, SystemStructure, Wire
from dse.fmu.toolchain.compiler import find_compiler

_SOURCES = Path(__file__).parent / "fmus_me"

# Reals and whole numbers in the order of their references.
_VARIABLES: Mapping[str, tuple[str, str]] = {
    "oscillator": ("x v dx dv w u seen", ""),
    "stiff": ("x y dx dy k evaluations", "directions"),
    "relay": ("x dx band", "direction switches"),
    "tank": ("h dh k", "empty"),
    "clocks": ("x dx period other_period event last", "ticks other_ticks state_events events"),
    "sawtooth": ("x dx rate", "resets"),
    "ender": ("x dx at", "how"),
    "told": ("x dx", ""),
    "stepper": ("x dx limit", "still"),
    "stateless": ("now on_from on_until period", "on ticks"),
    "scales": ("x y dx dy", ""),
    "sampler": ("x dx u", "n changes last"),
    "graze": ("x dx middle half", "crossings below"),
    "faulty": ("x dx at", "how"),
    "rod": (" ".join([*(f"x[{i + 1}]" for i in range(40)), *(f"dx[{i + 1}]" for i in range(40)), "k"]), "directions"),
}
_STATES = {"oscillator": 2, "stiff": 2, "scales": 2, "stateless": 0, "rod": 40}
_INDICATORS = {"relay": 1, "tank": 1, "clocks": 1, "sawtooth": 1, "stateless": 2, "graze": 1, "faulty": 1}
_INPUTS = {"oscillator": {"u"}, "sampler": {"u", "n"}}
_PARAMETERS = {
    *("w", "k", "band", "period", "other_period", "event", "rate", "at", "how", "limit", "on_from", "on_until"),
    *("middle", "half"),
}


def compile_model(name: str, version: int, folder: Path, *flags: str) -> Path:
    """The library of the model called *name* for FMI *version*, in *folder*; compiled when it is not there."""
    key = "_".join([name, f"fmi{version}", *(flag.strip("-").replace("=", "") for flag in flags)])
    library = folder / f"me_{key}{'.dll' if sys.platform == 'win32' else '.so'}"
    if not library.exists():
        fpic = [] if sys.platform == "win32" else ["-fPIC", "-lm"]
        command = [*find_compiler().command, "-std=c11", "-O1", "-ffp-contract=off", "-Wall", "-Werror", *flags]
        source = str(_SOURCES / f"{name}.c")
        subprocess.run([*command, "-shared", f"-DFMI={version}", source, "-o", str(library), *fpic], check=True)
    return library


def model(
    name: str, version: int, folder: Path, *flags: str, tolerance: float | None = None, n_states: int | None = None
) -> FmuModel:
    """The model called *name*; its default experiment asks for *tolerance*."""
    reals, wholes = (names.split() for names in _VARIABLES[name])
    states = _STATES.get(name, 1)
    return FmuModel(
        archive=folder / name,
        folder=folder,
        library=compile_model(name, version, folder, *flags),
        version=version,
        identifier=name,
        token="the token",  # noqa: S106  # FMI's word for an identity
        variables={
            v.name: v
            for names, types, kind in (
                (reals, ("Real", "Float64"), Kind.REAL),
                (wholes, ("Integer", "Int32"), Kind.INTEGER),
            )
            for v in _named(name, names, types[version - 2], kind)
        },
        capabilities=Capabilities(
            can_handle_variable_step=True,
            can_save_state=True,
            provides_directional_derivatives="-DDIRECTIONAL" in flags,
        ),
        interface=FmiInterface.MODEL_EXCHANGE,
        exchange=Exchange(
            tuple(range(states)),
            tuple(range(states, 2 * states)),
            states if n_states is None else n_states,
            0 if "-DINDICATORS=0" in flags else _INDICATORS.get(name, 0),
        ),
        experiment=Experiment(tolerance=tolerance),
    )


def rod_of_arrays(folder: Path, *flags: str, tolerance: float) -> FmuModel:
    """The rod in FMI 3.0, its states one array and its derivatives another."""
    scalars = model("rod", 3, folder, *flags, tolerance=tolerance)
    arrays = {
        name: Variable(name, reference, "Float64", "output", Kind.REAL, shape=(40,), sized_by=("",))
        for name, reference in (("x", 0), ("dx", 40))
    }
    others = {name: v for name, v in scalars.variables.items() if name in ("k", "directions")}
    return replace(scalars, variables=arrays | others, exchange=Exchange((0,), (40,), 40, 0))


def _named(model: str, names: Sequence[str], fmi_type: str, kind: Kind) -> list[Variable]:
    inputs = _INPUTS.get(model, set())
    return [
        Variable(
            name,
            reference,
            fmi_type,
            "input" if name in inputs else "parameter" if name in _PARAMETERS else "output",
            kind,
            variability="continuous" if kind is Kind.REAL and name not in _PARAMETERS else "discrete",
        )
        for reference, name in enumerate(names)
    ]


def system(
    elements: Mapping[str, FmuModel],
    wires: Sequence[str] = (),
    start: Mapping[str, float] | None = None,
    record: Sequence[str] = (),
) -> SystemStructure:
    """Elements by name; wires as "a.y -> b.u"; start by "element.variable"; what is recorded becomes an output."""
    ends = [tuple(wire.split(" -> ")) for wire in wires]
    sources, targets = {source for source, _ in ends} | set(record), {target for _, target in ends}
    built = [
        Element(
            name,
            fmu,
            tuple(v for v in fmu.variables.values() if {f"{name}.{label}" for label in v.labels} & targets),
            tuple(v for v in fmu.variables.values() if {f"{name}.{label}" for label in v.labels} & sources),
            {key.split(".", 1)[1]: x for key, x in (start or {}).items() if key.split(".", 1)[0] == name},
        )
        for name, fmu in elements.items()
    ]
    joined = tuple(Wire(*source.split(".", 1), *target.split(".", 1)) for source, target in ends)
    return SystemStructure("test", tuple(built), joined)


def simulated(
    fmu: FmuModel, record: Sequence[str], *, stop: float, step: float, start: Mapping[str, float] | None = None
) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """The communication points of a run of one element, and what is recorded by the variables' names."""
    names = [f"e.{name}" for name in record]
    alone = system({"e": fmu}, (), {f"e.{name}": value for name, value in (start or {}).items()}, names)
    with Simulator(alone, names) as simulator:
        rows = simulator.run(stop=stop, step=step)
    return np.arange(len(rows)) * step, dict(zip(record, rows.T, strict=True))
