"""A wired system as the tables the kernel works on."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.cosim import layout
from dse.cosim.calls import C_TYPES, Call, Type, function_name
from dse.cosim.library import address, lifecycle, load, resources
from dse.cosim.wiring import Group, Wiring, start_groups
from dse.domain.fmu import FmuModel


class Tables:
    """The kernel's view of a system; owns all memory that *system* points into.

    Libraries are loaded here, each once. There are no instances yet.
    """

    def __init__(self, wiring: Wiring, progress: memoryview | None) -> None:
        self.wiring = wiring
        self.values = np.zeros(len(wiring.values), np.float64)
        self._previous = np.zeros(len(wiring.values), np.float64)
        self._sources = np.array(
            [position for groups in wiring.inputs for group in groups for position in group.positions], np.int32
        )
        self._staged = np.zeros(self._sources.size, np.float64)
        self._libraries: dict[str, ctypes.CDLL] = {}
        self._logs = [layout.Log() for _ in wiring.system.elements]
        self._block = _block(progress)
        self.elements = (layout.Element * len(wiring.system.elements))()
        self._outputs = self.groups(wiring.outputs, Call.GET, self.values)
        self._inputs = self.groups(wiring.inputs, Call.SET, self._staged)
        for index in range(len(self.elements)):
            self._fill(index)
        self._connect("outputs", self._outputs, wiring.outputs)
        self._connect("inputs", self._inputs, wiring.inputs)
        self.system = layout.System(
            elements=ctypes.addressof(self.elements),
            outputs=ctypes.addressof(self._outputs.structures),
            inputs=ctypes.addressof(self._inputs.structures),
            values=self.values.ctypes.data,
            previous=self._previous.ctypes.data,
            staged=self._staged.ctypes.data,
            sources=self._sources.ctypes.data,
            n_elements=len(self.elements),
            n_outputs=len(self._outputs.structures),
            n_inputs=len(self._inputs.structures),
            n_values=self.values.size,
            n_staged=self._staged.size,
            sweeps=wiring.sweeps,
            progress=ctypes.addressof(self._block) if self._block else None,
        )
        self.starts = StartTable(self, ())

    def log(self, index: int) -> tuple[str, ...]:
        """What the element with this *index* has logged since the last call into the kernel began."""
        return self._logs[index].read()

    def still_changing(self) -> tuple[str, ...]:
        """The outputs that the last sweep of an initialization changed."""
        changed = self.values.view(np.uint64) != self._previous.view(np.uint64)
        return tuple(name for name, moved in zip(self.wiring.values, changed, strict=True) if moved)

    def add_starts(self, extra: Sequence[str]) -> None:
        """Make room for start values the system does not set itself; DseError for unknown names."""
        self.starts = StartTable(self, extra)

    def release(self) -> None:
        """Let go of the progress block, so that its memory can be closed."""
        self.system.progress = None
        self._block = None

    def groups(self, groups: Sequence[Sequence[Group]], verb: Call, values: NDArray[np.float64]) -> GroupTable:
        """The kernel's structures for each element's *groups*, whose values lie in *values* one after another."""
        flat = [(index, group) for index, part in enumerate(groups) for group in part]
        structures = (layout.Group * len(flat))()
        kept: list[Any] = [values]
        first = 0
        for structure, (index, group) in zip(structures, flat, strict=True):
            model = self.wiring.system.elements[index].model
            references = np.array([variable.reference for variable in group.variables], np.uint32)
            room = (C_TYPES[group.type] * len(group.variables))()
            kept += [references, room]
            call = verb + group.type
            structure.access = address(model, self._library(model), function_name(call, model.version))
            structure.references = references.ctypes.data
            structure.values = values.ctypes.data + first * values.itemsize
            structure.room = structure.values if group.type is Type.FLOAT64 else ctypes.addressof(room)
            structure.count = len(group.variables)
            structure.element, structure.version = index, model.version
            structure.type, structure.call = group.type, call
            structure.direct = model.version if group.type is Type.FLOAT64 else 0
            first += len(group.variables)
        return GroupTable(structures, kept)

    def use_starts(self, table: GroupTable, groups: Sequence[Sequence[Group]]) -> None:
        """Let the elements take their start values from *table*."""
        self._connect("starts", table, groups)

    def _connect(self, side: str, table: GroupTable, groups: Sequence[Sequence[Group]]) -> None:
        for element, part, first in zip(self.elements, groups, _offsets(groups, len), strict=True):
            setattr(element, side, ctypes.addressof(table.structures) + first * ctypes.sizeof(layout.Group))
            setattr(element, f"n_{side}", len(part))

    def _library(self, model: FmuModel) -> ctypes.CDLL:
        key = str(model.library)
        if key not in self._libraries:
            self._libraries[key] = load(model)
        return self._libraries[key]

    def _fill(self, index: int) -> None:
        element, target = self.wiring.system.elements[index], self.elements[index]
        model = element.model
        target.version = model.version
        target.name = element.name.encode()
        target.token = model.token.encode()
        target.resources = resources(model).encode()
        for call, where in lifecycle(model, self._library(model)).items():
            setattr(target, call.name.lower(), where)
        target.stepping_element, target.stepping_call = index, Call.DO_STEP
        target.log = ctypes.addressof(self._logs[index])
        for part, groups in (("value", self.wiring.outputs), ("staged", self.wiring.inputs)):
            setattr(target, f"first_{part}", _offsets(groups, _size)[index])
        target.n_values = _size(self.wiring.outputs[index])
        target.n_staged = _size(self.wiring.inputs[index])


class GroupTable:
    """The kernel's structures for groups of variables, and the memory they point into."""

    def __init__(self, structures: ctypes.Array[layout.Group], kept: list[Any]) -> None:
        self.structures = structures
        self._kept = kept


class StartTable:
    """Where start values lie, and the system's own; creating one makes *tables* use it."""

    def __init__(self, tables: Tables, extra: Sequence[str]) -> None:
        self.positions, own, self.groups = start_groups(tables.wiring.system, extra)
        self._extra = frozenset(extra)
        self._own = np.array(own, np.float64)
        self._values = self._own.copy()
        # Built before it is put to use: a missing accessor must leave the tables as they were.
        self._table = tables.groups(self.groups, Call.SET, self._values)
        tables.use_starts(self._table, self.groups)

    def covers(self, start: Mapping[str, float]) -> bool:
        """Whether *start* gives values to exactly the extra names and otherwise to names the system sets itself."""
        return start.keys() <= self.positions.keys() and self._extra <= start.keys()

    def take(self, start: Mapping[str, float]) -> None:
        """Use the values in *start* from now on, and the system's own for all other names."""
        self._values[:] = self._own
        for name, value in start.items():
            self._values[self.positions[name]] = value


def _size(groups: Sequence[Group]) -> int:
    return sum(len(group.variables) for group in groups)


def _offsets(parts: Sequence[Sequence[Group]], size: Callable[[Sequence[Group]], int]) -> list[int]:
    return [0, *accumulate(size(part) for part in parts)][: len(parts)]


def _block(progress: memoryview | None) -> layout.Progress | None:
    if progress is None:
        return None
    block = layout.Progress.from_buffer(progress)
    if ctypes.addressof(block) % ctypes.sizeof(ctypes.c_int64):
        raise ValueError("the progress block must begin at a multiple of 8 bytes")
    return block
