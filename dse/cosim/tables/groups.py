"""Groups of variables as the kernel has them: what accessors are called with, and where the values lie."""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding import layout
from dse.cosim.binding.calls import C_TYPES, FLOATING, Call, Type, function_name
from dse.cosim.binding.library import about, address
from dse.cosim.wiring.wiring import Group, has_event_mode
from dse.domain.system import Conversion, Element

_VALUE = ctypes.sizeof(ctypes.c_double)


class Slot(NamedTuple):
    """Where an output lies as its accessor left it; type None where that is not what other elements are to be given."""

    type: Type | None
    address: int


class Place(NamedTuple):
    """Where a group's *values* are: in a table, or, if they are *ready*, in the room of an output; *slopes* or None."""

    values: int
    is_ready: bool = False
    slopes: int | None = None


class GroupMaker:
    """Makes the kernel's groups for elements of a system and keeps all memory they point into.

    *libraries* are by the path of a model's library. *labels* names the values of each group by the group's id.
    """

    def __init__(self, elements: Sequence[Element], libraries: Mapping[str, ctypes.CDLL]) -> None:
        self._elements = elements
        self._libraries = libraries
        self._kept: list[Any] = []
        self._given_rooms: dict[tuple[int, str], int] = {}
        self.labels: list[tuple[str, ...]] = []
        self.made: list[layout.Groups] = []

    def number_group(self, index: int, group: Group, verb: Call, place: Place) -> layout.Group:
        """Numbers of the element with that *index*."""
        element = self._elements[index]
        count, size = len(group.labels), ctypes.sizeof(C_TYPES[group.type])
        conversions = self._conversions([element.conversions.get(v.name) for v in group.variables for _ in v.labels])
        transforms = self._conversions(group.transforms)
        changes = conversions is not None or transforms is not None
        needs_room = not place.is_ready and (group.type is not Type.FLOAT64 or changes or place.slopes is not None)
        return layout.Group(
            **self._call(element, index, group, verb),
            room=self._room(size * count) if needs_room else place.values,
            n_values=count,
            values=place.values,
            conversions=conversions,
            transforms=transforms,
            slopes=place.slopes,
            scratch=self._room(_VALUE * count) if (verb is Call.SET and changes) or place.slopes is not None else None,
            orders=None if place.slopes is None else self._array(np.ones(len(group.variables), np.int32)),
            given=self._given(index, group, size * count),
        )

    def text_group(self, index: int, group: Group, verb: Call, texts: int) -> layout.TextGroup:
        """Strings or binaries of the element with that *index*; *texts* is where the table of texts begins."""
        element = self._elements[index]
        count = len(group.labels)
        where = np.array([texts + ctypes.sizeof(layout.Text) * at for at in group.positions], np.uint64)
        return layout.TextGroup(
            **self._call(element, index, group, verb),
            pointers=self._room(ctypes.sizeof(ctypes.c_void_p) * count),
            sizes=self._room(ctypes.sizeof(ctypes.c_size_t) * count),
            texts=self._array(where),
            n_values=count,
            given=self._given(index, group, _VALUE * count),
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

    def _call(self, element: Element, index: int, group: Group, verb: Call) -> dict[str, Any]:
        model, call = element.model, verb + group.type
        self.labels.append(tuple(f"{element.name}.{label}" for label in group.labels))
        with about(element.name):
            access = address(model, self._libraries[str(model.library)], function_name(call, model.version))
        return {
            "access": access,
            "references": self._array(np.array([variable.reference for variable in group.variables], np.uint32)),
            "count": len(group.variables),
            "version": model.version,
            "type": group.type,
            "place": layout.Place(index, call),
            "id": len(self.labels) - 1,
        }

    def _given(self, index: int, group: Group, size: int) -> int | None:
        """Room for what a variable that is set in event mode was given last, and when, and to save that: one for all of
        its groups."""
        if not group.is_discrete or not has_event_mode(self._elements[index].model):
            return None
        key = index, group.variables[0].name
        if key not in self._given_rooms:
            self._given_rooms[key] = self._room(2 * (_VALUE + -(-size // _VALUE) * _VALUE))
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
        return self._array(np.zeros(-(-size // _VALUE), np.float64))

    def _array(self, array: NDArray[Any]) -> int:
        self._kept.append(array)
        return int(array.ctypes.data)


def slots_of(structure: layout.Group) -> list[Slot]:
    """Where each value of a group of outputs lies."""
    kind, size = Type(structure.type), ctypes.sizeof(C_TYPES[Type(structure.type)])
    known = None if structure.conversions else kind
    return [Slot(known, structure.room + size * number) for number in range(structure.n_values)]


def in_place(group: Group, slots: Sequence[Slot], conversions: Mapping[str, Conversion]) -> int | None:
    """Where the input *group* finds its values ready to be passed on, one after another; None if nowhere.

    Floating-point values are never passed on in place: the kernel looks at them on the way.
    """
    if group.type in FLOATING or group.transforms or any(v.name in conversions for v in group.variables):
        return None
    first, size = slots[group.positions[0]].address, ctypes.sizeof(C_TYPES[group.type])
    wanted = [Slot(group.type, first + size * number) for number in range(len(group.positions))]
    return first if [slots[position] for position in group.positions] == wanted else None


def parts_of(group: Group, names: Collection[str], *, neighbours: bool) -> list[Group]:
    """Those variables of *group* with the given *names*, with *neighbours* in groups whose values lie side by side."""
    parts: list[Group] = []
    at = 0
    last = None
    for number, variable in enumerate(group.variables):
        span = slice(at, at + variable.size)
        at += variable.size
        if variable.name not in names:
            continue
        positions, transforms = group.positions[span], group.transforms[span]
        if parts and not (neighbours and last != number - 1):
            before = parts.pop()
            positions, transforms = before.positions + positions, before.transforms + transforms
            parts.append(
                replace(before, variables=(*before.variables, variable), positions=positions, transforms=transforms)
            )
        else:
            parts.append(replace(group, variables=(variable,), positions=positions, transforms=transforms))
        last = number
    return parts


def _is_truth(structure: layout.Group) -> bool:
    return bool(structure.place.call == Call.GET + Type.FMI2_BOOLEAN and not structure.conversions)


def _truths(structure: layout.Group) -> list[layout.Truth]:
    room = ctypes.sizeof(C_TYPES[Type.FMI2_BOOLEAN])
    return [layout.Truth(structure.room + room * n, structure.values + _VALUE * n) for n in range(structure.n_values)]
