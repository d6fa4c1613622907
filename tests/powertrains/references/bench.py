"""Runs test models of this folder as co-simulation FMUs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from cycle import DURATION, acceleration, speed
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from numpy.typing import NDArray

from dse.domain.component import NO_INTERFACE, Component, ModelicaSource, Solver
from dse.domain.fmu import FmuModel
from dse.fmu.component_build import build
from dse.fmu.unpack import open_fmu

Rows = NDArray[np.float64]
_TESTS = Path(__file__).parent.parent
LIBRARY = _TESTS.parent.parent / "components" / "AdasPowertrain"


@lru_cache
def opened(model: str, cache: Path, solver: Solver = Solver.EXPLICIT) -> FmuModel:
    """The FMU of a model in the library or in a file beside this folder, by its full name."""
    package = model.partition(".")[0]
    own = () if package == LIBRARY.name else (_TESTS / f"{package}.mo",)
    component = Component(
        model.replace(".", "_"), NO_INTERFACE, source=ModelicaSource(model, (*own, LIBRARY), solver=solver)
    )
    return open_fmu(build(component, cache=cache), cache=cache)


class Bench:
    """One instance of an FMU; `close` it."""

    def __init__(self, model: FmuModel, tolerance: float, starts: Mapping[str, float] | None = None) -> None:
        self._model, self.messages = model, list[str]()
        logger = fmi2CallbackLoggerTYPE(lambda env, name, status, category, text: self._tell(text))
        self._callbacks = fmi2CallbackFunctions(logger=logger)
        self._fmu: Any = FMU2Slave(
            guid=model.token, unzipDirectory=str(model.folder), modelIdentifier=model.identifier, instanceName="bench"
        )
        self._fmu.instantiate(callbacks=self._callbacks)
        self._fmu.setupExperiment(tolerance=tolerance, startTime=0.0)
        self.set(starts or {})
        self._fmu.enterInitializationMode()
        self.set(starts or {})
        self._fmu.exitInitializationMode()

    def set(self, values: Mapping[str, float]) -> None:
        """Real variables by name."""
        if values:
            self._fmu.setReal([self._model.variables[name].reference for name in values], list(values.values()))

    def get(self, names: Sequence[str]) -> list[float]:
        """Values of real variables."""
        return list(self._fmu.getReal([self._model.variables[name].reference for name in names]))

    def whole(self, name: str) -> int:
        """Value of an Integer variable."""
        return int(self._fmu.getInteger([self._model.variables[name].reference])[0])

    def step(self, time: float, width: float) -> None:
        """From *time* on."""
        try:
            self._fmu.doStep(time, width)
        except FMICallException as error:
            raise AssertionError(self.messages) from error

    def close(self) -> None:
        self._fmu.terminate()
        self._fmu.freeInstance()

    def _tell(self, text: bytes | str) -> None:
        self.messages.append(text.decode() if isinstance(text, bytes) else str(text))


def run(
    model: FmuModel, names: Sequence[str], times: Rows, tolerance: float,
    starts: Mapping[str, float] | None = None,
) -> Rows:  # fmt: skip
    """Values of *names* at *times*, which begin at 0; no inputs."""
    bench = Bench(model, tolerance, starts)
    rows = [bench.get(names)]
    for now, then in pairwise(map(float, times)):
        bench.step(now, then - now)
        rows.append(bench.get(names))
    bench.close()
    assert not bench.messages
    return np.array(rows)


def on_cycle(model: FmuModel, names: Sequence[str], within: float) -> Rows:
    """Values of *names* every 0.2 s of the speed cycle, which the first of them follows *within* some m/s."""
    bench = Bench(model, 1e-6)
    rows = [bench.get(names)]
    for k in range(round(DURATION / 0.2)):
        then = 0.2 * (k + 1)
        bench.set({"target": speed(then), "target_acceleration": acceleration(then)})
        bench.step(0.2 * k, 0.2)
        rows.append(bench.get(names))
        assert abs(rows[-1][0] - speed(then)) < within
    bench.close()
    return np.array(rows)


def lacking(rows: Rows) -> float:
    """Largest part of the energy moved that columns in, out, loss and stored do not account for."""
    entered, left, lost, stored = rows.T
    return float(np.abs(entered - left - lost - (stored - stored[0])).max() / max(np.abs(entered).max(), left.max()))
