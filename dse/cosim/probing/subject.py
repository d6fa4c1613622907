"""One instance of the FMU under experiment, and the runs it makes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager
from ctypes import byref, c_bool, c_byte, c_double, c_int, c_size_t, c_void_p
from math import inf

from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import Call
from dse.cosim.binding.layout import Element as ElementLayout
from dse.cosim.binding.library import load
from dse.cosim.clock import end_of
from dse.cosim.probing.excitation import Excitation, watched
from dse.cosim.probing.instance import FmuInstance
from dse.cosim.probing.journal import Journal
from dse.cosim.probing.steps import leave_event_mode, make_step
from dse.cosim.wiring.wiring import is_discrete_input
from dse.domain.fmu import FmuModel

Row = tuple[bytes, ...]
"""The bits of all outputs at one communication point, in the order of `labels`."""

Trajectory = list[Row]
"""Row k is at communication point k."""


class Subject(FmuInstance, AbstractContextManager["Subject"]):
    """An instance of *model*; leaving its with block frees it. Raises RunFailed if the FMU reports an error."""

    def __init__(self, model: FmuModel, journal: Journal, name: str = "fmu") -> None:
        self._journal = journal
        load(model)
        journal.note("instantiating")
        super().__init__(name, model)
        self._state = c_void_p.from_buffer(self.part, ElementLayout.saved.offset)  # freed with the instance
        has_events = Ability.HAS_EVENTS in self.able
        self._in_events = [v for v in self.element.inputs if has_events and is_discrete_input(v, model)]
        self._in_steps = [v for v in self.element.inputs if v not in self._in_events]
        self._given: dict[str, bytes] = {}
        """What inputs that are set in event mode were given last, by name."""
        self._saved = inf, self._given

    def __exit__(self, *_: object) -> None:
        self._journal.note("freeing the instance")
        self.close()

    # ---- whole runs ----

    def run(self, drive: Excitation) -> Trajectory:
        """A whole simulation."""
        return list(self.stages(drive))

    def stages(self, drive: Excitation) -> Iterator[Row]:
        """A whole simulation, one row at a time; it is terminated after the last one."""
        self.initialize(drive)
        yield self.read(0.0)
        for k in range(drive.steps):
            yield self.step(drive, k)
        self.terminate(drive)

    def initialize(self, drive: Excitation) -> None:
        """Initialize with the start values of *drive*."""
        self._journal.note("initializing")
        stop, version = end_of(drive.stop, drive.step, drive.steps), self.model.version
        inputs = drive.inputs(self.model, 0)
        self.part.next_event = inf
        told = self.model.experiment.tolerance or 0.0
        if version == 2:  # FMI 2
            times = c_int(told > 0.0), c_double(told), c_double(0.0), c_int(1), c_double(stop)
            self.call(Call.SETUP_EXPERIMENT, None, *times)
        self.set_numbers(self.model.variables.values(), drive.parameters(self.model), None)
        if version == 1:
            self.set_numbers(self.element.inputs, inputs, None)
            self.call(Call.ENTER_INITIALIZATION, None, c_double(0.0), c_byte(1), c_double(stop))
            self._read(None)
            return
        asked = c_bool(told > 0.0), c_double(told), c_double(0.0), c_bool(True), c_double(stop)
        self.call(Call.ENTER_INITIALIZATION, None, *(asked if version == 3 else ()))
        self.set_numbers(self.element.inputs, inputs, None)
        self._given = {v.name: bytes(self.passed(v, inputs, None)) for v in self._in_events}
        self._read(None)
        if self.part.exchange:
            self.ask_kernel("exchange_start", None)
            return
        self.call(Call.EXIT_INITIALIZATION, None)
        if Ability.HAS_EVENTS in self.able:
            leave_event_mode(self, None)

    def terminate(self, drive: Excitation) -> None:
        """End the simulation."""
        self._journal.note("terminating")
        self.call(Call.TERMINATE, drive.stop)

    def reset(self) -> None:
        """Have the FMU go back to what it was like fresh."""
        self._journal.note("resetting")
        self.ask_kernel("reset", None)

    # ---- steps ----

    def step(self, drive: Excitation, k: int, *, may_roll_back: bool = False) -> Row:
        """Step from communication point *k* to the next one; the outputs there."""
        self.write(drive, k)
        self.advance(drive, k, 1.0, may_roll_back=may_roll_back)
        return self.read((k + 1) * drive.step)

    def advance(self, drive: Excitation, k: float, part: float, *, may_roll_back: bool = False) -> None:
        """Step from *k* steps after the start over *part* of a step."""
        time = k * drive.step
        self._journal.note(f"stepping at t = {time:.10g} s")
        make_step(self, time, part * drive.step, may_roll_back=may_roll_back)

    def write(self, drive: Excitation, k: float) -> None:
        """Set all inputs to what they are *k* steps after the start; discrete ones that change are an event."""
        time, inputs = k * drive.step, drive.inputs(self.model, k)
        self._journal.note(f"setting inputs at t = {time:.10g} s")
        self.set_numbers(self._in_steps, inputs, time)
        given = {v.name: bytes(self.passed(v, inputs, time)) for v in self._in_events}
        if changed := [v for v in self._in_events if self._given[v.name] != given[v.name]]:
            self.call(Call.ENTER_EVENT_MODE, time)
            self.set_numbers(changed, inputs, time)
            self._given = given
            leave_event_mode(self, time)

    def read(self, time: float) -> Row:
        """All outputs."""
        self._journal.note(f"reading outputs at t = {time:.10g} s")
        return self._read(time)

    def _read(self, time: float | None) -> Row:
        return tuple(bits for variable in self.element.outputs for bits in self.bits(variable, time))

    # ---- states ----

    def save(self) -> None:
        """Keep the state, for `restore`."""
        self._journal.note("saving the state")
        self.call(Call.GET_STATE, None, byref(self._state))
        self._saved = self.part.next_event, dict(self._given)
        if self.part.exchange:
            self.kernel.dse_exchange_save(byref(self.system))

    def restore(self) -> None:
        """Go back to the state that was kept."""
        self._journal.note("restoring the state")
        self.call(Call.SET_STATE, None, self._state)
        self.part.next_event, self._given = self._saved
        if self.part.exchange:
            self.kernel.dse_exchange_restore(byref(self.system))

    def through_bytes(self) -> None:
        """Turn the state that was kept into bytes and back."""
        self._journal.note("serializing the state")
        kind, read = ("FMUstate", "DeSerialize") if self.model.version == 2 else ("FMUState", "Deserialize")  # FMI 2
        prefix, size = f"fmi{self.model.version}", c_size_t()
        self.call(f"{prefix}Serialized{kind}Size", None, self._state, byref(size))
        room = (c_byte * size.value)()
        self.call(f"{prefix}Serialize{kind}", None, self._state, byref(room), size)
        self._journal.note("deserializing the state")
        self.call(Call.FREE_STATE, None, byref(self._state))
        self._state.value = None
        self.call(f"{prefix}{read}{kind}", None, byref(room), size, byref(self._state))


def labels(model: FmuModel) -> tuple[str, ...]:
    """The names of the values in a row."""
    return tuple(label for variable in watched(model) for label in variable.labels)


def difference(model: FmuModel, drive: Excitation, expected: Trajectory, found: Trajectory) -> str:
    """Where two runs differ first, in words; "" if they are equal bit for bit."""
    names = labels(model)
    for k, (right, wrong) in enumerate(zip(expected, found, strict=False)):
        different = [name for name, a, b in zip(names, right, wrong, strict=True) if a != b]
        if different:
            others = f" and {len(different) - 1} more" if len(different) > 1 else ""
            return f"{different[0]}{others} differ{'' if others else 's'} at t = {k * drive.step:.10g} s"
    return "" if len(expected) == len(found) else f"it made {len(found) - 1} steps instead of {len(expected) - 1}"
