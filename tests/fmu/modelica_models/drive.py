"""Instances of handmade models, addressed by the names of variables."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fmpy import extract
from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmu.modelica_models.bench import TOKEN, Handmade

_CLASSES = {(2, False): FMU2Slave, (2, True): FMU2Model, (3, False): FMU3Slave, (3, True): FMU3Model}
_TYPES = {
    2: {"REAL": "Real", "INTEGER": "Integer", "BOOLEAN": "Boolean", "ENUMERATION": "Integer"},
    3: {"REAL": "Float64", "INTEGER": "Int32", "BOOLEAN": "Boolean", "ENUMERATION": "Int64"},
}


@dataclass
class Instance:
    """One instance of *model*; *messages* are what it told its logger."""

    model: Handmade
    version: int
    fmu: Any = None
    messages: list[str] = field(default_factory=list)
    time: float = 0.0
    keep: Any = None

    def create(self, folder: Path, is_exchange: bool = False) -> Instance:
        unpacked = folder / f"{self.model.fmu(folder, self.version).stem}"
        if not unpacked.is_dir():
            extract(str(self.model.fmu(folder, self.version)), str(unpacked))
        self.fmu = _CLASSES[self.version, is_exchange](
            guid=TOKEN, unzipDirectory=str(unpacked), modelIdentifier=self.model.name, instanceName="tested"
        )
        if self.version == 2:
            logger = fmi2CallbackLoggerTYPE(lambda env, name, status, category, text: self._tell(status, text))
            self.keep = fmi2CallbackFunctions(logger=logger)
            self.fmu.instantiate(callbacks=self.keep)
        else:
            self.keep = lambda env, status, category, text: self._tell(status, text)
            self.fmu.instantiate(logMessage=self.keep)
        return self

    def _tell(self, status: int, text: Any) -> None:
        shown = text.decode() if isinstance(text, bytes) else str(text)
        self.messages.append(f"{'warning' if status == 1 else 'error'}: {shown}")

    def enter(self, start_time: float = 0.0, tolerance: float | None = None) -> Instance:
        self.time = start_time
        if self.version == 2:
            self.fmu.setupExperiment(startTime=start_time, tolerance=tolerance)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=start_time, tolerance=tolerance)
        return self

    def ready(self, start_time: float = 0.0, tolerance: float | None = None, **start: float) -> Instance:
        """Through the initialization, with these start values."""
        for name, value in start.items():
            self.set(name, value)
        self.enter(start_time, tolerance).fmu.exitInitializationMode()
        return self

    def _type(self, name: str) -> str:
        return _TYPES[self.version][self.model.kinds.get(name, ("REAL", 0))[0]]

    def set(self, name: str, value: float) -> None:
        getattr(self.fmu, f"set{self._type(name)}")([list(self.model.values).index(name)], [value])

    def get(self, name: str) -> Any:
        return getattr(self.fmu, f"get{self._type(name)}")([list(self.model.values).index(name)])[0]

    def step(self, size: float) -> None:
        """One communication step from where the last one ended."""
        self.fmu.doStep(self.time, size)
        self.time += size

    def run(self, stop: float, size: float) -> Instance:
        """Steps of *size* to *stop*; step k starts at k * size after the present time."""
        first, count = self.time, round((stop - self.time) / size)
        assert math.isclose(first + count * size, stop)
        for k in range(count):
            self.fmu.doStep(first + k * size, size)
        self.time = stop
        return self

    def saved(self) -> bytes:
        """The whole state, as bytes."""
        if self.version == 2:
            state = self.fmu.getFMUstate()
            content = bytes(self.fmu.serializeFMUstate(state))
            self.fmu.freeFMUstate(state)
        else:
            state = self.fmu.getFMUState()
            content = bytes(self.fmu.serializeFMUState(state))
            self.fmu.freeFMUState(state)
        return content

    def load(self, content: bytes) -> None:
        if self.version == 2:
            self.fmu.setFMUstate(self.fmu.deSerializeFMUstate(content))
        else:
            self.fmu.setFMUState(self.fmu.deserializeFMUState(content))


@contextmanager
def instances(folder: Path, version: int) -> Iterator[Any]:
    """A function that makes instances, which are freed in the end."""
    made: list[Instance] = []

    def make(model: Handmade, is_exchange: bool = False) -> Instance:
        made.append(Instance(model, version).create(folder, is_exchange))
        return made[-1]

    try:
        yield make
    finally:
        for each in made:
            each.fmu.freeInstance()
