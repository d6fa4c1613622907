"""Linear systems x' = A x + B u, y = C x + D u as FMUs, and systems of them whose solution is known."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Kind
from dse.domain.fmu import Capabilities, FmuModel, Variable
from dse.domain.system import Element, SystemStructure, Wire
from dse.fmu.toolchain.compiler import find_compiler

STATES, INPUTS, OUTPUTS = 4, 3, 3
_FIRST = {"u": 0, "y": 8, "x": 16, "A": 32, "B": 48, "C": 64, "D": 80}
PARTS_REFERENCE = 96


@dataclass(frozen=True)
class Linear:
    """One element: matrices as nested lists, smaller ones stand in the upper left corner.

    *tells* says whether the description tells which outputs depend directly on which inputs; *takes_slopes* whether
    it can interpolate inputs; *saves* whether it can save its state; *parts* the Runge-Kutta steps in one doStep; steps
    over *longest* (seconds; 0: none) are discarded.
    """

    a: Sequence[Sequence[float]] = ()
    b: Sequence[Sequence[float]] = ()
    c: Sequence[Sequence[float]] = ()
    d: Sequence[Sequence[float]] = ()
    x: Sequence[float] = ()
    version: int = 2
    tells: bool = True
    takes_slopes: bool = False
    saves: bool = True
    parts: int = 1
    longest: float = 0.0

    def matrices(self) -> tuple[NDArray[np.float64], ...]:
        """A, B, C and D in full size."""
        shapes = ((STATES, STATES), (STATES, INPUTS), (OUTPUTS, STATES), (OUTPUTS, INPUTS))
        return tuple(_filled(m, shape) for m, shape in zip((self.a, self.b, self.c, self.d), shapes, strict=True))


def system(
    elements: Mapping[str, Linear], wires: Sequence[str], folder: Path, factors: Mapping[str, float] | None = None
) -> SystemStructure:
    """Elements by name and wires as ``a.y0 -> b.u1``; *factors* are those of wires that are not 1."""
    ends = [wire.split(" -> ") for wire in wires]
    targets = {target for _, target in ends}
    built = []
    for name, linear in elements.items():
        model = _model(linear, folder)
        a, b, c, d = linear.matrices()
        start = {"parts": float(linear.parts), "longest": linear.longest}
        for letter, matrix in (("A", a), ("B", b), ("C", c), ("D", d)):
            start |= {f"{letter}{i}": float(v) for i, v in enumerate(matrix.ravel()) if v != 0.0}
        start |= {f"x{i}": float(v) for i, v in enumerate(linear.x)}
        inputs = tuple(model.variables[f"u{i}"] for i in range(INPUTS) if f"{name}.u{i}" in targets)
        outputs = tuple(model.variables[f"y{i}"] for i in range(OUTPUTS))
        built.append(Element(name, model, inputs, outputs, start))
    return SystemStructure(
        "linear",
        tuple(built),
        tuple(
            Wire(*source.split("."), *target.split("."), factor=(factors or {}).get(wire, 1.0))
            for wire, (source, target) in zip(wires, ends, strict=True)
        ),
    )


def closed_form(
    elements: Mapping[str, Linear], wires: Sequence[str], step: float, count: int
) -> dict[str, NDArray[np.float64]]:
    """All outputs at *count* times from 0 in steps of *step* if the elements were one system x' = M x.

    x(t + step) = exp(M step) x(t) (Moler and Van Loan, 2003); rounding adds up to some 1e-13 in a thousand steps.
    """
    from scipy.linalg import block_diag, expm

    names = list(elements)
    parts = [element.matrices() for element in elements.values()]
    a, b, c, d = (block_diag(*(part[i] for part in parts)) for i in range(4))
    wired = np.zeros((INPUTS * len(names), OUTPUTS * len(names)))
    for wire in wires:
        (source, y), (target, u) = (end.split(".") for end in wire.split(" -> "))
        wired[INPUTS * names.index(target) + int(u[1:]), OUTPUTS * names.index(source) + int(y[1:])] = 1.0
    show = np.linalg.solve(np.eye(len(d)) - d @ wired, c)  # y = C x + D W y
    x = np.concatenate([np.pad(np.array(e.x, float), (0, STATES - len(e.x))) for e in elements.values()])
    onward = expm((a + b @ wired @ show) * step)
    rows = np.empty((count, len(d)))
    for row in rows:
        row[:] = show @ x
        x = onward @ x
    return {f"{name}.y{i}": rows[:, OUTPUTS * e + i] for e, name in enumerate(names) for i in range(OUTPUTS)}


def _filled(matrix: Sequence[Sequence[float]], shape: tuple[int, int]) -> NDArray[np.float64]:
    full = np.zeros(shape)
    for i, row in enumerate(matrix):
        full[i, : len(row)] = row
    return full


def _model(linear: Linear, folder: Path) -> FmuModel:
    library = _library(linear.version, folder)
    d = linear.matrices()[3]
    depends = {f"y{i}": tuple(f"u{j}" for j in range(INPUTS) if d[i, j] != 0.0) for i in range(OUTPUTS)}
    return FmuModel(
        archive=library,
        folder=folder,
        library=library,
        version=linear.version,
        identifier="linear",
        token="",
        variables=_variables(linear.version),
        capabilities=Capabilities(
            can_handle_variable_step=True,
            can_save_state=linear.saves,
            can_interpolate_inputs=linear.takes_slopes and linear.version == 2,
        ),
        depends=depends if linear.tells else {},
        initially_depends=depends if linear.tells else {},
    )


@cache
def _variables(version: int) -> dict[str, Variable]:
    kind = "Real" if version == 2 else "Float64"
    sizes = {"u": INPUTS, "y": OUTPUTS, "x": STATES, "A": 16, "B": 12, "C": 12, "D": 9}
    causality = {"u": "input", "y": "output"}
    named = {
        f"{letter}{i}": Variable(f"{letter}{i}", first + i, kind, causality.get(letter, "parameter"), Kind.REAL)
        for letter, first in _FIRST.items()
        for i in range(sizes[letter])
    }
    single = {"parts": PARTS_REFERENCE, "longest": PARTS_REFERENCE + 1}
    return named | {name: Variable(name, at, kind, "parameter", Kind.REAL) for name, at in single.items()}


def _library(version: int, folder: Path) -> Path:
    library = folder / f"linear_fmi{version}{'.dll' if sys.platform == 'win32' else '.so'}"
    if not library.exists():
        fpic = [] if sys.platform == "win32" else ["-fPIC"]
        source = str(Path(__file__).with_name("linear.c"))
        command = [*find_compiler().command, "-std=c11", "-O2", "-ffp-contract=off", "-Wall", "-Werror", *fpic]
        subprocess.run([*command, "-shared", f"-DFMI={version}", source, "-o", str(library)], check=True)
    return library
