"""One instance of the FMU under experiment, and the runs it makes."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from contextlib import AbstractContextManager
from ctypes import CDLL

from dse.cosim.binding.library import load
from dse.cosim.clock import end_of
from dse.cosim.oracle.element import ReferenceElement, Value
from dse.cosim.probing.drive import Drive, driven, watched
from dse.cosim.probing.journal import Journal
from dse.domain.fmu import FmuModel
from dse.domain.system import Element

Row = tuple[bytes, ...]
"""The bits of all outputs at one communication point, in the order of `labels`."""

Trajectory = list[Row]
"""Row k is at communication point k."""


class Subject(AbstractContextManager["Subject"]):
    """An instance of *model*; leaving its with block frees it. Raises RunFailed if the FMU reports an error."""

    def __init__(self, model: FmuModel, journal: Journal, name: str = "fmu") -> None:
        self.model = model
        self.library: CDLL = load(model)
        self._journal = journal
        self._labels = labels(model)
        self._outputs = tuple(variable.name for variable in watched(model))
        journal.note("instantiating")
        self._part = ReferenceElement(Element(name, model, driven(model), watched(model), {}), self.library)

    def __exit__(self, *_: object) -> None:
        self._journal.note("freeing the instance")
        self._part.close()

    def run(self, drive: Drive) -> Trajectory:
        """A whole simulation."""
        return list(self.stages(drive))

    def stages(self, drive: Drive) -> Iterator[Row]:
        """A whole simulation, one row at a time; it is terminated after the last one."""
        self.initialize(drive)
        yield self.read(0.0)
        for k in range(drive.steps):
            yield self.step(drive, k)
        self.terminate(drive)

    def initialize(self, drive: Drive) -> None:
        """Initialize with the start values of *drive*."""
        self._journal.note("initializing")
        stop = end_of(drive.stop, drive.step, drive.steps)
        self._part.set_up(stop, drive.parameters(self.model))
        self._part.write(drive.inputs(self.model, 0), None)
        self._part.read(self._outputs, None)
        self._part.leave_initialization()

    def step(self, drive: Drive, k: int, *, may_roll_back: bool = False) -> Row:
        """Step from communication point *k* to the next one; the outputs there."""
        self.write(drive, k)
        self.advance(drive, k, 1.0, may_roll_back=may_roll_back)
        return self.read((k + 1) * drive.step)

    def advance(self, drive: Drive, k: float, part: float, *, may_roll_back: bool = False) -> None:
        """Step from *k* steps after the start over *part* of a step."""
        time = k * drive.step
        self._journal.note(f"stepping at t = {time:.10g} s")
        self._part.step(time, part * drive.step, {}, may_roll_back)

    def write(self, drive: Drive, k: float) -> None:
        """Set all inputs to what they are *k* steps after the start."""
        time = k * drive.step
        self._journal.note(f"setting inputs at t = {time:.10g} s")
        self._part.write(drive.inputs(self.model, k), time)

    def read(self, time: float) -> Row:
        """All outputs."""
        self._journal.note(f"reading outputs at t = {time:.10g} s")
        values = self._part.read(self._outputs, time)
        return tuple(_bits(values[label]) for label in self._labels)

    def terminate(self, drive: Drive) -> None:
        """End the simulation."""
        self._journal.note("terminating")
        self._part.terminate(drive.stop)

    def reset(self) -> None:
        """Have the FMU go back to what it was like fresh."""
        self._journal.note("resetting")
        self._part.reset()

    def save(self) -> None:
        """Keep the state, for `restore`."""
        self._journal.note("saving the state")
        self._part.save()

    def restore(self) -> None:
        """Go back to the state that was kept."""
        self._journal.note("restoring the state")
        self._part.restore()

    def through_bytes(self) -> None:
        """Turn the state that was kept into bytes and back."""
        self._journal.note("serializing the state")
        content = self._part.serialized()
        self._journal.note("deserializing the state")
        self._part.deserialize(content)


def labels(model: FmuModel) -> tuple[str, ...]:
    """The names of the values in a row."""
    return tuple(label for variable in watched(model) for label in variable.labels)


def difference(model: FmuModel, drive: Drive, expected: Trajectory, found: Trajectory) -> str:
    """Where two runs differ first, in words; "" if they are equal bit for bit."""
    names = labels(model)
    for k, (right, wrong) in enumerate(zip(expected, found, strict=False)):
        different = [name for name, a, b in zip(names, right, wrong, strict=True) if a != b]
        if different:
            others = f" and {len(different) - 1} more" if len(different) > 1 else ""
            return f"{different[0]}{others} differ{'' if others else 's'} at t = {k * drive.step:.10g} s"
    return "" if len(expected) == len(found) else f"it made {len(found) - 1} steps instead of {len(expected) - 1}"


def _bits(value: Value) -> bytes:
    return value if isinstance(value, bytes) else struct.pack("<d", value)
