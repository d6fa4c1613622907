"""A wired system as the tables the kernel works on."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dse.cosim import layout
from dse.cosim.calls import C_TYPES, FLOATING, Call, Type, function_name
from dse.cosim.library import address, lifecycle, load, resources
from dse.cosim.wiring import Group, Wiring, start_groups
from dse.domain.fmu import FmuModel


class Tables:
    """The kernel's view of a system; owns all memory that *system* points into.

    *staged_groups* are those input groups, element by element, whose values are staged on their way from the outputs.
    Libraries are loaded here, each once. There are no instances yet.
    """

    def __init__(self, wiring: Wiring, progress: memoryview | None) -> None:
        self.wiring = wiring
        self.values = np.zeros(len(wiring.values), np.float64)
        self._previous = np.zeros(len(wiring.values), np.float64)
        self._libraries: dict[str, ctypes.CDLL] = {}
        self._logs = [layout.Log() for _ in wiring.system.elements]
        self._block = _block(progress)
        self.elements = (layout.Element * len(wiring.system.elements))()
        self._outputs = GroupTable(self, wiring.outputs, Call.GET, self.values)
        slots = self._outputs.slots
        self.staged_groups = tuple(tuple(g for g in part if in_place(g, slots) is None) for part in wiring.inputs)
        self._sources = np.array(
            [at for part in self.staged_groups for group in part for at in group.positions], np.int32
        )
        self._staged = np.zeros(self._sources.size, np.float64)
        self._inputs = GroupTable(self, wiring.inputs, Call.SET, self._staged, slots)
        for index in range(len(self.elements)):
            self._fill(index)
        self.system = layout.System(
            elements=ctypes.addressof(self.elements),
            outputs=self._outputs.all,
            inputs=self._inputs.all,
            values=self.values.ctypes.data,
            previous=self._previous.ctypes.data,
            staged=self._staged.ctypes.data,
            sources=self._sources.ctypes.data,
            n_elements=len(self.elements),
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

    def library(self, model: FmuModel) -> ctypes.CDLL:
        """The loaded library of *model*."""
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
        for call, where in lifecycle(model, self.library(model)).items():
            setattr(target, call.name.lower(), where)
        target.stepping_element, target.stepping_call = index, Call.DO_STEP
        target.log = ctypes.addressof(self._logs[index])
        target.outputs, target.inputs = self._outputs.of_element[index], self._inputs.of_element[index]
        target.first_value, target.n_values = self._outputs.spans[index]
        target.first_staged, target.n_staged = self._inputs.spans[index]


class Slot(NamedTuple):
    """Where an output lies as its accessor left it."""

    type: Type
    address: int


def in_place(group: Group, slots: Sequence[Slot]) -> int | None:
    """Where the input *group* finds its values ready to be passed on, one after another; None if nowhere.

    Floating-point values are never passed on in place: the kernel looks at them on the way.
    """
    if group.type in FLOATING:
        return None
    first, size = slots[group.positions[0]].address, ctypes.sizeof(C_TYPES[group.type])
    wanted = [Slot(group.type, first + size * number) for number in range(len(group.positions))]
    return first if [slots[position] for position in group.positions] == wanted else None


class GroupTable:
    """The kernel's structures for each element's *groups*, whose values lie in *values* one after another.

    Groups that find their values in one of the *slots* take them from there and have no place in *values*.
    *of_element* holds the structures element by element, *all* those of the whole system; *spans* says at which
    position each element's values begin and how many they are; *slots* where the accessors leave each value.
    """

    def __init__(
        self,
        tables: Tables,
        groups: Sequence[Sequence[Group]],
        verb: Call,
        values: NDArray[np.float64],
        sources: Sequence[Slot] = (),
    ) -> None:
        self._kept: list[Any] = [values]
        self.of_element: list[layout.Groups] = []
        self.spans: list[tuple[int, int]] = []
        self.slots: list[Slot] = []
        everything: list[layout.Group] = []
        position = 0
        for index, part in enumerate(groups):
            structures = []
            began = position
            for group in part:
                ready = in_place(group, sources) if sources else None
                where = values.ctypes.data + position * values.itemsize if ready is None else ready
                structures.append(self._structure(tables, index, group, verb, where, is_ready=ready is not None))
                position += len(group.variables) if ready is None else 0
            self.spans.append((began, position - began))
            self.of_element.append(self._in_order(structures))
            everything += structures
        self.all = self._in_order(everything)

    def _structure(
        self, tables: Tables, index: int, group: Group, verb: Call, values: int, *, is_ready: bool
    ) -> layout.Group:
        model = tables.wiring.system.elements[index].model
        references = np.array([variable.reference for variable in group.variables], np.uint32)
        self._kept.append(references)
        room = values
        if not is_ready and group.type is not Type.FLOAT64:
            own = (C_TYPES[group.type] * len(group.variables))()
            self._kept.append(own)
            room = ctypes.addressof(own)
        size = ctypes.sizeof(C_TYPES[group.type])
        self.slots += [Slot(group.type, room + size * number) for number in range(len(group.variables))]
        call = verb + group.type
        return layout.Group(
            access=address(model, tables.library(model), function_name(call, model.version)),
            references=references.ctypes.data,
            room=room,
            values=values,
            count=len(group.variables),
            version=model.version,
            type=group.type,
            element=index,
            call=call,
        )

    def _in_order(self, structures: Sequence[layout.Group]) -> layout.Groups:
        ordered = sorted(structures, key=lambda structure: structure.version)
        array = (layout.Group * len(ordered))(*ordered)
        first, size = ctypes.addressof(array), ctypes.sizeof(layout.Group)
        where = [first + size * number for number in range(len(ordered) + 1)]
        truths = [truth for structure in ordered if _is_truth(structure) for truth in _truths(structure)]
        single = (layout.Truth * len(truths))(*truths)
        converted = [
            where[number]
            for number, structure in enumerate(ordered)
            if structure.room != structure.values and not _is_truth(structure)
        ]
        pointers = (ctypes.c_void_p * (len(converted) + 1))(*converted)
        self._kept += [array, single, pointers]
        begin = ctypes.addressof(single)
        return layout.Groups(
            fmi2=first,
            fmi3=where[sum(structure.version == 2 for structure in ordered)],
            end=where[-1],
            converted=ctypes.addressof(pointers),
            truths=begin,
            no_truths=begin + ctypes.sizeof(single),
        )


class StartTable:
    """Where start values lie, and the system's own; creating one makes *tables* use it."""

    def __init__(self, tables: Tables, extra: Sequence[str]) -> None:
        self.positions, own, self.groups = start_groups(tables.wiring.system, extra)
        self._extra = frozenset(extra)
        self._own = np.array(own, np.float64)
        self._values = self._own.copy()
        # Built before it is put to use: a missing accessor must leave the tables as they were.
        self._table = GroupTable(tables, self.groups, Call.SET, self._values)
        tables.system.starts = self._values.ctypes.data
        for element, groups in zip(tables.elements, self._table.of_element, strict=True):
            element.starts = groups

    def covers(self, start: Mapping[str, float]) -> bool:
        """Whether *start* gives values to exactly the extra names and otherwise to names the system sets itself."""
        return start.keys() <= self.positions.keys() and self._extra <= start.keys()

    def take(self, start: Mapping[str, float]) -> None:
        """Use the values in *start* from now on, and the system's own for all other names."""
        self._values[:] = self._own
        for name, value in start.items():
            self._values[self.positions[name]] = value


def _is_truth(structure: layout.Group) -> bool:
    return bool(structure.call == Call.GET + Type.FMI2_BOOLEAN)


def _truths(structure: layout.Group) -> list[layout.Truth]:
    room, value = (ctypes.sizeof(C_TYPES[kind]) for kind in (Type.FMI2_BOOLEAN, Type.FLOAT64))
    numbers = range(structure.count)
    return [layout.Truth(structure.room + room * n, structure.values + value * n) for n in numbers]


def _block(progress: memoryview | None) -> layout.Progress | None:
    if progress is None:
        return None
    block = layout.Progress.from_buffer(progress)
    if ctypes.addressof(block) % ctypes.sizeof(ctypes.c_int64):
        raise ValueError("the progress block must begin at a multiple of 8 bytes")
    return block
