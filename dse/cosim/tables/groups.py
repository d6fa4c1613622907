"""Groups of variables as the kernel has them: what accessors are called with, and where the values lie."""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding import layout
from dse.cosim.binding.calls import AccessorType, Call, function_name
from dse.cosim.binding.library import about, address
from dse.cosim.tables.elements import KernelElements
from dse.cosim.wiring.wiring import VariableGroup
from dse.domain.system import Conversion, Element

VALUE_SIZE = ctypes.sizeof(ctypes.c_double)


class RawValue(NamedTuple):
    """Where an output lies as its accessor left it; type None where that is not what other elements are to be given."""

    type: AccessorType | None
    address: int


class GroupMemory(NamedTuple):
    """Where a group's *values* are: in a table, or, if they are *ready*, in the room of an output; *slopes* or None."""

    values: int
    is_ready: bool = False
    slopes: int | None = None


class GroupMaker:
    """Makes the kernel's groups for elements of a system and keeps all memory they point into.

    *labels* names the values of each group by the group's id.
    """

    def __init__(self, elements: KernelElements) -> None:
        self._elements = elements
        self._kept: list[Any] = []
        self._given_rooms: dict[tuple[int, str], int] = {}
        self.labels: list[tuple[str, ...]] = []
        self.made: list[layout.Groups] = []

    def number_group(self, index: int, group: VariableGroup, verb: Call, memory: GroupMemory) -> layout.Group:
        """Numbers of the element with that *index*."""
        element = self._elements.elements[index]
        count, size = len(group.labels), group.type.size
        conversions = self._conversions([element.conversions.get(v.name) for v in group.variables for _ in v.labels])
        transforms = self._conversions(group.transforms)
        changes = conversions is not None or transforms is not None
        needs_room = not memory.is_ready and (
            group.type is not AccessorType.FLOAT64 or changes or memory.slopes is not None
        )
        return layout.Group(
            **self._call(element, index, group, verb),
            room=self._room(size * count) if needs_room else memory.values,
            n_values=count,
            values=memory.values,
            conversions=conversions,
            transforms=transforms,
            slopes=memory.slopes,
            scratch=self._room(VALUE_SIZE * count)
            if (verb is Call.SET and changes) or memory.slopes is not None
            else None,
            orders=None if memory.slopes is None else self._array(np.ones(len(group.variables), np.int32)),
            given=self._given(index, group, size * count),
        )

    def text_group(self, index: int, group: VariableGroup, verb: Call, texts: int) -> layout.TextGroup:
        """Strings or binaries of the element with that *index*; *texts* is where the table of texts begins."""
        element = self._elements.elements[index]
        count = len(group.labels)
        where = np.array([texts + ctypes.sizeof(layout.Text) * at for at in group.positions], np.uint64)
        return layout.TextGroup(
            **self._call(element, index, group, verb),
            pointers=self._room(ctypes.sizeof(ctypes.c_void_p) * count),
            sizes=self._room(ctypes.sizeof(ctypes.c_size_t) * count),
            texts=self._array(where),
            n_values=count,
            given=self._given(index, group, VALUE_SIZE * count),
        )

    def together(self, numbers: Sequence[layout.Group], texts: Sequence[layout.TextGroup] = ()) -> layout.Groups:
        """These groups in the order the kernel accesses them."""
        ordered = sorted(numbers, key=lambda group: group.version > 2)  # FMI 1 and 2 have one signature
        array = (layout.Group * len(ordered))(*ordered)
        text_array = (layout.TextGroup * len(texts))(*texts)
        first, size = ctypes.addressof(array), ctypes.sizeof(layout.Group)
        where = [first + size * number for number in range(len(ordered) + 1)]
        truths = [truth for group in ordered if _is_truth(group) for truth in _truths(group)]
        single = (layout.Truth * len(truths))(*truths)
        converted = [
            where[number] for number, group in enumerate(ordered) if group.room != group.values and not _is_truth(group)
        ]
        pointers = (ctypes.c_void_p * (len(converted) + 1))(*converted)
        self._kept += [array, text_array, single, pointers]
        begin, begin_text = ctypes.addressof(single), ctypes.addressof(text_array)
        made = layout.Groups(
            fmi2=first,
            fmi3=where[sum(group.version < 3 for group in ordered)],
            end=where[-1],
            converted=ctypes.addressof(pointers),
            truths=begin,
            no_truths=begin + ctypes.sizeof(single),
            texts=begin_text,
            no_texts=begin_text + ctypes.sizeof(text_array),
        )
        self.made.append(made)
        return made

    def _call(self, element: Element, index: int, group: VariableGroup, verb: Call) -> dict[str, Any]:
        model, call = element.model, verb + group.type
        self.labels.append(tuple(f"{element.name}.{label}" for label in group.labels))
        with about(element.name):
            access = address(model, self._elements.library(index), function_name(call, model.version))
        return {
            "access": access,
            "references": self._array(np.array([r for v in group.variables for r in v.references], np.uint32)),
            "count": len(group.variables),
            "version": model.version,
            "type": group.type,
            "place": layout.Place(index, call),
            "id": len(self.labels) - 1,
        }

    def _given(self, index: int, group: VariableGroup, size: int) -> int | None:
        """Room for what a variable that is set in event mode was given last, and when, and to save that: one for all of
        its groups."""
        if not group.is_discrete or not self._elements.elements[index].model.ticks:
            return None
        key = index, group.variables[0].name
        if key not in self._given_rooms:
            self._given_rooms[key] = self._room(2 * (VALUE_SIZE + -(-size // VALUE_SIZE) * VALUE_SIZE))
        return self._given_rooms[key]

    def _conversions(self, wanted: Sequence[Conversion | None]) -> int | None:
        if not any(wanted):
            return None
        array = (layout.Conversion * len(wanted))()
        for structure, conversion in zip(array, wanted, strict=True):
            structure.factor, structure.offset = 1.0, 0.0
            if conversion is not None:
                structure.factor, structure.offset = conversion.factor, conversion.offset
                structure.pairs = self._array(np.array(conversion.items, np.float64))
                structure.n_pairs = len(conversion.items)
        self._kept.append(array)
        return ctypes.addressof(array)

    def _room(self, size: int) -> int:
        return self._array(np.zeros(-(-size // VALUE_SIZE), np.float64))

    def _array(self, array: NDArray[Any]) -> int:
        self._kept.append(array)
        return int(array.ctypes.data)


def raw_values(structure: layout.Group) -> list[RawValue]:
    """Where each value of a group of outputs lies."""
    kind = AccessorType(structure.type)
    known = None if structure.conversions else kind
    return [RawValue(known, structure.room + kind.size * number) for number in range(structure.n_values)]


def in_place(group: VariableGroup, raw: Sequence[RawValue], conversions: Mapping[str, Conversion]) -> int | None:
    """Where the input *group* finds its values ready to be passed on, one after another; None if nowhere.

    Floating-point values are never passed on in place: the kernel looks at them on the way.
    """
    if group.type.is_floating or group.transforms or any(v.name in conversions for v in group.variables):
        return None
    first, size = raw[group.positions[0]].address, group.type.size
    wanted = [RawValue(group.type, first + size * number) for number in range(len(group.positions))]
    return first if [raw[position] for position in group.positions] == wanted else None


def parts_of(group: VariableGroup, names: Collection[str], *, neighbours: bool) -> list[VariableGroup]:
    """Those variables of *group* with the given *names*, with *neighbours* in groups whose values lie side by side."""
    wanted, parts = frozenset(names), list[list[int]]()
    for number, variable in enumerate(group.variables):
        if variable.name in wanted and parts and (parts[-1][-1] == number - 1 or not neighbours):
            parts[-1].append(number)
        elif variable.name in wanted:
            parts.append([number])
    bounds = [0, *accumulate(variable.size for variable in group.variables)]
    made = []
    for part in parts:
        spans = [slice(bounds[number], bounds[number + 1]) for number in part]
        positions = tuple(position for span in spans for position in group.positions[span])
        transforms = tuple(transform for span in spans for transform in group.transforms[span])
        variables = tuple(group.variables[number] for number in part)
        made.append(replace(group, variables=variables, positions=positions, transforms=transforms))
    return made


def _is_truth(structure: layout.Group) -> bool:
    return bool(structure.place.call == Call.GET + AccessorType.FMI2_BOOLEAN and not structure.conversions)


def _truths(structure: layout.Group) -> list[layout.Truth]:
    room = AccessorType.FMI2_BOOLEAN.size
    return [
        layout.Truth(structure.room + room * n, structure.values + VALUE_SIZE * n) for n in range(structure.n_values)
    ]
