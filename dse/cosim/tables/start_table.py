"""Start values as the kernel sets them."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.cosim.binding import layout
from dse.cosim.binding.calls import Call
from dse.cosim.tables.groups import GroupMaker, Place
from dse.cosim.tables.starts import Starts, starts_of
from dse.cosim.wiring.wiring import Group
from dse.errors import fail

if TYPE_CHECKING:
    from dse.cosim.tables.tables import Tables

_VALUE = ctypes.sizeof(ctypes.c_double)


class StartTable:
    """Where start values lie, and the system's own; creating one makes *tables* use it."""

    def __init__(self, tables: Tables, extra: Sequence[str]) -> None:
        self._starts = starts_of(tables.wiring.system, extra)
        self.positions = self._starts.positions
        self.extra = frozenset(extra)
        """What runs set and the system does not."""
        self._own = np.array(self._starts.values, np.float64)
        self._values = self._own.copy()
        self._texts, self._bytes = _lent(self._starts.own_texts)
        # Built before it is put to use: a missing accessor must leave the tables as they were.
        self._maker = GroupMaker(tables.wiring.system.elements, tables.libraries)
        self.labels = self._maker.labels
        count = len(tables.elements)
        made = [(self._groups(self._starts, index), self._configuration(index)) for index in range(count)]
        for element, (starts, configuration) in zip(tables.elements, made, strict=True):
            element.starts, element.configuration = starts, configuration
        tables.system.starts = self._values.ctypes.data
        tables.publish(self._maker.made)

    def covers(self, start: Mapping[str, float]) -> bool:
        """Whether *start* gives values to exactly the extra names and otherwise to names the system sets itself."""
        return start.keys() <= self.positions.keys() and self.extra <= start.keys()

    def take(self, start: Mapping[str, float]) -> None:
        """Use the values in *start* from now on, and the system's own for all other names."""
        self._values[:] = self._own
        for name, value in start.items():
            self._values[self.positions[name]] = value
        for name in self._starts.structural & start.keys():
            if start[name] != self._own[self.positions[name]]:
                self._values[:] = self._own
                raise fail(f"{name}: structural parameters cannot be given a value by a run")

    def _groups(self, starts: Starts, index: int) -> layout.Groups:
        texts = ctypes.addressof(self._texts)
        numbers = [self._number_group(index, group) for group in starts.groups[index]]
        return self._maker.together(
            numbers, [self._maker.text_group(index, group, Call.SET, texts) for group in starts.texts[index]]
        )

    def _configuration(self, index: int) -> layout.Groups:
        return self._maker.together([self._number_group(index, group) for group in self._starts.configuration[index]])

    def _number_group(self, index: int, group: Group) -> layout.Group:
        where = Place(self._values.ctypes.data + _VALUE * group.positions[0])
        return self._maker.number_group(index, group, Call.SET, where)


def _lent(texts: Sequence[bytes]) -> tuple[ctypes.Array[layout.Text], Sequence[object]]:
    """A table of texts whose bytes are Python's."""
    kept = [ctypes.create_string_buffer(text, len(text) + 1) for text in texts]
    table = (layout.Text * max(1, len(texts)))()
    for entry, buffer, text in zip(table, kept, texts, strict=False):
        entry.bytes, entry.size = ctypes.addressof(buffer), len(text)
    return table, kept
