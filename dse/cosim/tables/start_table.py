"""Start values as the kernel sets them."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence

import numpy as np

from dse.cosim.binding import layout
from dse.cosim.binding.calls import Call
from dse.cosim.tables.elements import KernelElements
from dse.cosim.tables.groups import VALUE_SIZE, GroupMaker, GroupMemory
from dse.cosim.tables.starts import starts_of
from dse.cosim.wiring.wiring import VariableGroup
from dse.domain.system import SystemStructure
from dse.errors import fail


class StartTable:
    """Where the start values of *system* lie, and those with the names *extra*, which runs set and it does not.

    *groups* are those of each element, and those of its structural parameters. *labels* names the values of the group
    with each id. *address* is where the values begin.
    """

    def __init__(self, elements: KernelElements, system: SystemStructure, extra: Sequence[str]) -> None:
        self._starts = starts = starts_of(system, extra)
        self.positions = starts.positions
        self.extra = frozenset(extra)
        self._own = np.array(starts.values, np.float64)
        self._values = self._own.copy()
        self.address = int(self._values.ctypes.data)
        self._texts, self._bytes = _lent(starts.own_texts)
        self._maker = GroupMaker(elements)
        self.labels = self._maker.labels
        self.groups = [self._groups(index) for index in range(len(system.elements))]

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

    def _groups(self, index: int) -> tuple[layout.Groups, layout.Groups]:
        texts = ctypes.addressof(self._texts)
        numbers, structural = (
            [self._number_group(index, group) for group in groups[index]]
            for groups in (self._starts.groups, self._starts.configuration)
        )
        text_groups = [self._maker.text_group(index, group, Call.SET, texts) for group in self._starts.texts[index]]
        return self._maker.together(numbers, text_groups), self._maker.together(structural)

    def _number_group(self, index: int, group: VariableGroup) -> layout.Group:
        where = GroupMemory(self.address + VALUE_SIZE * group.positions[0])
        return self._maker.number_group(index, group, Call.SET, where)


def _lent(texts: Sequence[bytes]) -> tuple[ctypes.Array[layout.Text], Sequence[object]]:
    """A table of texts whose bytes are Python's."""
    kept = [ctypes.create_string_buffer(text, len(text) + 1) for text in texts]
    table = (layout.Text * max(1, len(texts)))()
    for entry, buffer, text in zip(table, kept, texts, strict=False):
        entry.bytes, entry.size = ctypes.addressof(buffer), len(text)
    return table, kept
