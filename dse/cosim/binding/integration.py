"""The memory a model exchange element is integrated in."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding.calls import function_name
from dse.cosim.binding.exchange_layout import DENSE, FUNCTIONS, SAMPLES, STAGES, Exchange
from dse.cosim.binding.library import address
from dse.domain.fmu import FmuModel
from dse.errors import fail

DEFAULT_TOLERANCE = 1e-6
"""Relative, for FMUs whose default experiment names none."""

MOST_STIFF_STATES = 2000
"""An FMU with more states is integrated by the explicit solver only: the other one's matrices are dense."""

_INSTANTIATE: Mapping[int, str] = {2: "fmi2Instantiate", 3: "fmi3InstantiateModelExchange"}
"""The function that makes an instance, by FMI version."""

REALS = frozenset({"Real", "Float64", "Float32"})
"""Types of states and event indicators."""


class Integration:
    """The memory one model exchange element is integrated in; *structure* is what the kernel's element points at.

    *has_inputs*: whether inputs of it are set while it is simulated. Raises DseError for a library that lacks a
    function of model exchange.
    """

    def __init__(self, model: FmuModel, library: ctypes.CDLL, *, has_inputs: bool) -> None:
        exchange = model.exchange
        if exchange is None:
            raise fail(f"{model.identifier}: the FMU is not for model exchange")
        n = values_of(model, exchange.states, exchange.n_states)
        m = values_of(model, exchange.event_indicators, exchange.n_event_indicators)
        self._kept: list[NDArray[Any]] = []
        self.structure = structure = Exchange(
            n_references=len(exchange.states),
            n_states=n,
            n_indicators=m,
            needs_completed_step=exchange.needs_completed_step,
            has_inputs=has_inputs,
            can_be_stiff=0 < n <= MOST_STIFF_STATES,
            n_kept=3 * n + m,
            state_references=self._take(np.array(exchange.states, np.uint32)),
            derivative_references=self._take(np.array(exchange.derivatives, np.uint32)),
            instantiate=address(model, library, _INSTANTIATE[model.version]),
        )
        structure.solver.tolerance = tolerance_of(model)
        for field, call in FUNCTIONS.items():
            if name := function_name(call, model.version):
                setattr(structure, field, address(model, library, name))
        self._lay_out(n, m)

    @property
    def pointer(self) -> int:
        """Address of *structure*."""
        return ctypes.addressof(self.structure)

    def _lay_out(self, n: int, m: int) -> None:
        structure, solver = self.structure, self.structure.solver
        standing = self._doubles(3 * n + m)
        size = ctypes.sizeof(ctypes.c_double)
        solver.to, solver.slope = standing, standing + n * size
        structure.nominals, solver.at_end = standing + 2 * n * size, standing + 3 * n * size
        structure.kept_values = self._doubles(3 * n + m)
        for name in ("from", "trial", "found", "time_slope"):
            setattr(solver, name, self._doubles(n))
        for name in ("low", "high", "seen"):
            setattr(solver, name, self._doubles(m))
        solver.stage[:] = [self._doubles(n) for _ in range(STAGES)]
        solver.dense[:] = [self._doubles(n) for _ in range(DENSE)]
        solver.sample[:] = [self._doubles(m) for _ in range(SAMPLES)]
        if structure.can_be_stiff:
            solver.jacobian, solver.factors = self._doubles(n * n), self._doubles(n * n)
            solver.pivot = self._take(np.zeros(n, np.uint32))

    def _doubles(self, count: int) -> int:
        return self._take(np.zeros(max(1, count), np.float64))

    def _take(self, array: NDArray[Any]) -> int:
        self._kept.append(array)
        return int(array.ctypes.data)


def values_of(model: FmuModel, references: Sequence[int], told: int) -> int:
    """How many values the variables with these *references* have, which structural parameters may have changed.

    As *told* by the description if it does not name them all.
    """
    # FMI 2 counts references for each type anew.
    sizes = {v.reference: v.size for v in model.variables.values() if v.fmi_type in REALS}
    if not references or not all(reference in sizes for reference in references):
        return told
    return sum(sizes[reference] for reference in references)


def tolerance_of(model: FmuModel) -> float:
    """The relative tolerance *model* is integrated with: that of its default experiment, else DEFAULT_TOLERANCE."""
    told = model.experiment.tolerance
    return told if told is not None and math.isfinite(told) and told > 0.0 else DEFAULT_TOLERANCE
