"""A wired system as the tables the kernel works on.

All numbers that outputs give lie in one table, *values*, element by element. Inputs that need a place of their own lie
in a second, *staged*, and *sources* has the position in *values* that each comes from. A communication step is then
three loops without a name or a hash: read all outputs into *values*, copy values[sources] to *staged*, write inputs.

Example: a plant with the outputs x and v, and a controller with the inputs speed (from v) and place (from x).

    values    x, v               positions 0 and 1
    staged    speed, place
    sources   1, 0
    x = 5, v = 2: staged becomes values[[1, 0]] = 2, 5, which the controller gets

In the plain loop an input whose output has the same layout is not staged: it is written from where the output lies.

Cost: memory of 8 bytes for each value, and about one copy for each input and step. Why the loop is C:
docs/decisions/0001-kernel-in-c.md; what the other loops add: docs/decisions/0012-algorithms.md.
"""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding import layout
from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import Call
from dse.cosim.tables.elements import KernelElements
from dse.cosim.tables.groups import VALUE_SIZE, GroupMaker, GroupMemory, RawValue, in_place, parts_of, raw_values
from dse.cosim.tables.starts import starts_of
from dse.cosim.wiring.wiring import VariableGroup, Wiring
from dse.domain.system import SystemStructure
from dse.errors import fail


class Tables:
    """The kernel's view of a system; owns all memory that *system* points into.

    *plain* is set if the loop of kernel.c is enough: numbers only, and no element that has to be asked what it wants.
    Otherwise, or if the caller says so, every input is staged. *slopes* lie beside the staged values, per second.
    *labels* names the values of the group with each id. Libraries are loaded here, each once. There are no instances
    yet.
    """

    def __init__(self, wiring: Wiring, progress: memoryview | None, *, plain: bool = True) -> None:
        self.wiring = wiring
        self._block = _block(progress)
        self.elements = KernelElements(wiring.system.elements, self._block)
        structures = self.elements.structures
        self.plain = plain and not wiring.texts and all(map(_is_plain, structures))
        self.values = np.zeros(len(wiring.values), np.float64)
        self._texts = (layout.Text * max(1, len(wiring.texts)))()
        self._maker = GroupMaker(self.elements)
        self.labels = self._maker.labels
        indices = range(len(structures))
        # What belongs to clocks is read and written with them.
        outputs = [self._outputs(index, _free(wiring.outputs[index])) for index in indices]
        text_outputs = [self._text_groups(index, _free(wiring.text_outputs[index]), Call.GET) for index in indices]
        self._stage([raw for part in outputs for group in part for raw in raw_values(group)])
        inputs = [self._inputs(index) for index in indices]
        text_inputs = [self._text_groups(index, _free(wiring.text_inputs[index]), Call.SET) for index in indices]
        together = self._maker.together
        for index, structure in enumerate(structures):
            structure.outputs = together(outputs[index], text_outputs[index])
            structure.inputs = together(inputs[index], text_inputs[index])
            structure.first_value, structure.n_values = _span(wiring.outputs, index)
            structure.first_staged, structure.n_staged = self._spans[index]
            self.elements.set_between(index, (group for group in wiring.inputs[index] if self._moves(index, group)))
        self.system = layout.System(
            elements=ctypes.addressof(structures),
            outputs=together([g for part in outputs for g in part], [g for part in text_outputs for g in part]),
            inputs=together([g for part in inputs for g in part], [g for part in text_inputs for g in part]),
            values=self.values.ctypes.data,
            staged=self.staged.ctypes.data,
            slopes=self.slopes.ctypes.data,
            sources=self.sources.ctypes.data,
            texts=ctypes.addressof(self._texts),
            n_texts=len(wiring.texts),
            n_elements=len(structures),
            n_values=self.values.size,
            n_staged=self.staged.size,
            is_plain=self.plain,
            progress=ctypes.addressof(self._block) if self._block else None,
        )
        self.set_starts(())

    def reading(self, index: int, names: Collection[str]) -> layout.Groups:
        """Groups that read the outputs called *names* (variables, not labels) of an element, texts too."""
        parts = [p for group in self.wiring.outputs[index] for p in parts_of(group, names, neighbours=True)]
        texts = self._text_parts(index, self.wiring.text_outputs[index], names, Call.GET)
        return self._maker.together(self._outputs(index, parts), texts)

    def writing(
        self,
        index: int,
        names: Collection[str],
        staged: NDArray[np.float64],
        first: int,
        slopes: NDArray[np.float64] | None = None,
    ) -> tuple[layout.Groups, tuple[int, ...]]:
        """Groups that write the inputs called *names* of an element, texts too, from *staged* values of the caller's.

        The numbers lie one after another from position *first* on; their *slopes* in a table beside. Returns besides
        the positions in the table of values that they come from, in that order.
        """
        groups: list[layout.Group] = []
        sources: list[int] = []
        for group in self.wiring.inputs[index]:
            for part in parts_of(group, names, neighbours=False):
                groups.append(self._staged_group(index, part, staged, first + len(sources), slopes))
                sources += part.positions
        texts = self._text_parts(index, self.wiring.text_inputs[index], names, Call.SET)
        return self._maker.together(groups, texts), tuple(sources)

    def set_starts(self, extra: Sequence[str]) -> None:
        """Have start values for *extra*, besides those the system sets itself; DseError for unknown names.

        Then the tables are as they were.
        """
        self.starts = StartTable(self.elements, self.wiring.system, extra)
        for structure, (starts, configuration) in zip(self.elements.structures, self.starts.groups, strict=True):
            structure.starts, structure.configuration = starts, configuration
        self.system.starts = self.starts.address
        self.publish()

    def publish(self) -> None:
        """Let the kernel know of all groups that have been made."""
        made = [*self._maker.made, *(groups for pair in self.starts.groups for groups in pair)]
        self._published = (layout.Groups * len(made))(*made)
        self.system.tables = ctypes.addressof(self._published)
        self.system.n_tables = len(made)

    def release(self) -> None:
        """Free what the kernel keeps, and let go of the progress block, so that its memory can be closed."""
        layout.kernel().dse_forget_texts(ctypes.byref(self.system))
        self.system.progress = None
        self._block = None
        self.elements.release()

    def _outputs(self, index: int, groups: Sequence[VariableGroup]) -> list[layout.Group]:
        return [
            self._maker.number_group(
                index, group, Call.GET, GroupMemory(self.values.ctypes.data + VALUE_SIZE * group.positions[0])
            )
            for group in groups
        ]

    def _stage(self, raw: Sequence[RawValue]) -> None:
        """Give each input its place: among the staged values, or where an output lies ready."""
        sources: list[int] = []
        self._spans: list[tuple[int, int]] = []
        self._ready: list[list[int | None]] = []
        for element, part in zip(self.elements.elements, map(_free, self.wiring.inputs), strict=True):
            began = len(sources)
            ready = [in_place(group, raw, element.conversions) if self.plain else None for group in part]
            for group, where in zip(part, ready, strict=True):
                if where is None:
                    sources += group.positions
            self._ready.append(ready)
            self._spans.append((began, len(sources) - began))
        self.sources = np.array(sources, np.int32)
        self.staged, self.slopes = np.zeros(len(sources)), np.zeros(len(sources))

    def _inputs(self, index: int) -> list[layout.Group]:
        groups = []
        position = self._spans[index][0]
        for group, ready in zip(_free(self.wiring.inputs[index]), self._ready[index], strict=True):
            if ready is None:
                groups.append(self._staged_group(index, group, self.staged, position, self.slopes))
                position += len(group.positions)
            else:
                groups.append(self._maker.number_group(index, group, Call.SET, GroupMemory(ready, is_ready=True)))
        return groups

    def _staged_group(
        self,
        index: int,
        group: VariableGroup,
        staged: NDArray[np.float64],
        first: int,
        slopes: NDArray[np.float64] | None,
    ) -> layout.Group:
        at = VALUE_SIZE * first
        slope = slopes.ctypes.data + at if slopes is not None and self._moves(index, group) else None
        return self._maker.number_group(index, group, Call.SET, GroupMemory(staged.ctypes.data + at, slopes=slope))

    def _moves(self, index: int, group: VariableGroup) -> bool:
        """Whether the inputs of *group* can follow slopes."""
        if self.plain or not group.moves or group.has_items(self.elements.elements[index]):
            return False
        return bool(self.elements.structures[index].takes_slopes)

    def _text_groups(self, index: int, groups: Sequence[VariableGroup], verb: Call) -> list[layout.TextGroup]:
        return [self._maker.text_group(index, group, verb, ctypes.addressof(self._texts)) for group in groups]

    def _text_parts(
        self, index: int, groups: Sequence[VariableGroup], names: Collection[str], verb: Call
    ) -> list[layout.TextGroup]:
        parts = [part for group in groups for part in parts_of(group, names, neighbours=False)]
        return self._text_groups(index, parts, verb)


def _free(part: Sequence[VariableGroup]) -> list[VariableGroup]:
    """What does not belong to clocks: these have steps of their own."""
    return [group for group in part if not group.is_clocked]


def _span(parts: Sequence[Sequence[VariableGroup]], index: int) -> tuple[int, int]:
    sizes = [sum(len(group.positions) for group in part) for part in parts]
    return sum(sizes[:index]), sizes[index]


def _is_plain(structure: layout.Element) -> bool:
    return structure.version > 1 and not structure.abilities & Ability.HAS_EVENTS and not structure.exchange


def _block(progress: memoryview | None) -> layout.Progress | None:
    if progress is None:
        return None
    block = layout.Progress.from_buffer(progress)
    if ctypes.addressof(block) % ctypes.sizeof(ctypes.c_int64):
        raise ValueError("the progress block must begin at a multiple of 8 bytes")
    return block


# Start values as the kernel sets them.


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
