"""A wired system as the tables the kernel works on."""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding import layout
from dse.cosim.binding.abilities import Ability, abilities_of, takes_slopes
from dse.cosim.binding.calls import Call
from dse.cosim.binding.integration import Integration
from dse.cosim.binding.lasting import borrow, give_back
from dse.cosim.binding.library import about, lifecycle, load, resources
from dse.cosim.binding.log import expanded
from dse.cosim.tables.groups import GroupMaker, Place, Slot, in_place, parts_of, slots_of
from dse.cosim.tables.start_table import StartTable
from dse.cosim.wiring.wiring import Group, Wiring
from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.system import Element

_VALUE = ctypes.sizeof(ctypes.c_double)


class Tables:
    """The kernel's view of a system; owns all memory that *system* points into.

    *plain* is set if the loop of kernel.c is enough: numbers only, and no element that has to be asked what it wants.
    Otherwise, or if the caller says so, every input is staged: *staged_at* says where. *slopes* lie beside the staged
    values, per second. *labels* names the values of the group with each id. Libraries are loaded here, each once.
    There are no instances yet.
    """

    def __init__(self, wiring: Wiring, progress: memoryview | None, *, plain: bool = True) -> None:
        self.wiring = wiring
        elements = wiring.system.elements
        self.values = np.zeros(len(wiring.values), np.float64)
        self.elements, self._logs = borrow(len(elements))
        self._block = _block(progress)
        self.libraries = {str(e.model.library): self._load(index, e) for index, e in enumerate(elements)}
        self.abilities = tuple(abilities_of(e.model, self.libraries[str(e.model.library)]) for e in elements)
        are_plain = (_is_plain(e.model, able) for e, able in zip(elements, self.abilities, strict=True))
        self.plain = plain and not wiring.texts and all(are_plain)
        self._integrations: list[Integration] = []
        self._intermediate: list[NDArray[np.uint32]] = []
        self._texts = (layout.Text * max(1, len(wiring.texts)))()
        self._maker = GroupMaker(elements, self.libraries)
        self.labels = self._maker.labels
        outputs = [self._outputs(index, wiring.outputs[index]) for index in range(len(elements))]
        self.sources, self.staged_at, self._spans = self._stage(
            [slot for part in outputs for g in part for slot in slots_of(g)]
        )
        self.staged = np.zeros(self.sources.size, np.float64)
        self.slopes = np.zeros(self.sources.size, np.float64)
        inputs = [self._inputs(index) for index in range(len(elements))]
        text_outputs = [self._text_groups(i, wiring.text_outputs[i], Call.GET) for i in range(len(elements))]
        text_inputs = [self._text_groups(i, wiring.text_inputs[i], Call.SET) for i in range(len(elements))]
        for index, element in enumerate(self.elements):
            element.outputs = self._maker.together(outputs[index], text_outputs[index])
            element.inputs = self._maker.together(inputs[index], text_inputs[index])
            self._fill(index)
        together = self._maker.together
        self.system = layout.System(
            elements=ctypes.addressof(self.elements),
            outputs=together([g for part in outputs for g in part], [g for part in text_outputs for g in part]),
            inputs=together([g for part in inputs for g in part], [g for part in text_inputs for g in part]),
            values=self.values.ctypes.data,
            staged=self.staged.ctypes.data,
            slopes=self.slopes.ctypes.data,
            sources=self.sources.ctypes.data,
            texts=ctypes.addressof(self._texts),
            n_texts=len(wiring.texts),
            n_elements=len(self.elements),
            n_values=self.values.size,
            n_staged=self.staged.size,
            is_plain=self.plain,
            progress=ctypes.addressof(self._block) if self._block else None,
        )
        self.starts = StartTable(self, ())

    def reading(self, index: int, names: Collection[str]) -> layout.Groups:
        """Groups that read the outputs called *names* (variables, not labels) of an element, texts too."""
        groups = []
        for group in self.wiring.outputs[index]:
            for part in parts_of(group, names, neighbours=True):
                where = Place(self.values.ctypes.data + _VALUE * part.positions[0])
                groups.append(self._maker.number_group(index, part, Call.GET, where))
        return self._known(groups, self._text_parts(index, self.wiring.text_outputs[index], names, Call.GET))

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
                at = _VALUE * (first + len(sources))
                moves = slopes is not None and self._moves(index, part)
                slope = slopes.ctypes.data + at if slopes is not None and moves else None
                where = Place(staged.ctypes.data + at, slopes=slope)
                groups.append(self._maker.number_group(index, part, Call.SET, where))
                sources += part.positions
        texts = self._text_parts(index, self.wiring.text_inputs[index], names, Call.SET)
        return self._known(groups, texts), tuple(sources)

    def log(self, index: int) -> tuple[str, ...]:
        """What the element with this *index* has logged since the last call into the kernel began."""
        return expanded(self._logs[index].read(), self.wiring.system.elements[index].model)

    def add_starts(self, extra: Sequence[str]) -> None:
        """Make room for start values the system does not set itself; DseError for unknown names."""
        self.starts = StartTable(self, extra)

    def release(self) -> None:
        """Free what the kernel keeps, and let go of the progress block, so that its memory can be closed."""
        layout.kernel().dse_forget_texts(ctypes.byref(self.system))
        self.system.progress = None
        self._block = None
        give_back(self.elements, self._logs)

    def publish(self, starts: Sequence[layout.Groups]) -> None:
        """Let the kernel know of all groups that have been made, and of those of start values."""
        self._start_groups = tuple(starts)
        made = [*self._maker.made, *self._start_groups]
        self._published = (layout.Groups * (2 * len(made)))(*made)
        self.system.tables = ctypes.addressof(self._published)
        self.system.n_tables = len(made)

    def text(self, position: int) -> bytes:
        """The string or binary at that *position* of ``wiring.texts`` as it was read last."""
        text = self._texts[position]
        return ctypes.string_at(text.bytes, text.size) if text.bytes else b""

    def _known(self, groups: Sequence[layout.Group], texts: Sequence[layout.TextGroup]) -> layout.Groups:
        made = self._maker.together(groups, texts)
        if self.system.n_tables < len(self._published):
            self._published[self.system.n_tables] = made
            self.system.n_tables += 1
        else:
            self.publish(self._start_groups)
        return made

    def _outputs(self, index: int, groups: Sequence[Group]) -> list[layout.Group]:
        base = self.values.ctypes.data
        return [
            self._maker.number_group(index, group, Call.GET, Place(base + _VALUE * group.positions[0]))
            for group in groups
        ]

    def _stage(self, slots: Sequence[Slot]) -> tuple[NDArray[np.int32], Mapping[str, int], Sequence[tuple[int, int]]]:
        sources: list[int] = []
        staged_at: dict[str, int] = {}
        spans: list[tuple[int, int]] = []
        self._ready: list[list[int | None]] = []
        for element, part in zip(self.wiring.system.elements, self.wiring.inputs, strict=True):
            began = len(sources)
            ready = [in_place(group, slots, element.conversions) if self.plain else None for group in part]
            for group, where in zip(part, ready, strict=True):
                if where is None:
                    staged_at |= {f"{element.name}.{label}": len(sources) + i for i, label in enumerate(group.labels)}
                    sources += group.positions
            self._ready.append(ready)
            spans.append((began, len(sources) - began))
        return np.array(sources, np.int32), staged_at, spans

    def _inputs(self, index: int) -> list[layout.Group]:
        groups = []
        position = self._spans[index][0]
        for group, ready in zip(self.wiring.inputs[index], self._ready[index], strict=True):
            if ready is None:
                slope = self.slopes.ctypes.data + _VALUE * position if self._moves(index, group) else None
                where = Place(self.staged.ctypes.data + _VALUE * position, slopes=slope)
                position += len(group.positions)
            else:
                where = Place(ready, is_ready=True)
            groups.append(self._maker.number_group(index, group, Call.SET, where))
        return groups

    def _moves(self, index: int, group: Group) -> bool:
        """Whether the inputs of *group* can follow slopes."""
        able = self.abilities[index]
        if self.plain or not group.moves:
            return False
        element = self.wiring.system.elements[index]
        if any(element.conversions[v.name].items for v in group.variables if v.name in element.conversions):
            return False
        if any(transform is not None and transform.items for transform in group.transforms):
            return False
        return takes_slopes(element.model, able)

    def _text_groups(self, index: int, groups: Sequence[Group], verb: Call) -> list[layout.TextGroup]:
        return [self._maker.text_group(index, group, verb, ctypes.addressof(self._texts)) for group in groups]

    def _text_parts(
        self, index: int, groups: Sequence[Group], names: Collection[str], verb: Call
    ) -> list[layout.TextGroup]:
        parts = [part for group in groups for part in parts_of(group, names, neighbours=False)]
        return self._text_groups(index, parts, verb)

    def _load(self, index: int, element: Element) -> ctypes.CDLL:
        # Noted, as a library may already crash when it is loaded.
        if self._block:
            self._block.place, self._block.step = layout.Place(index, Call.LOAD), -1
        with about(element.name):
            library = load(element.model)
        if self._block:
            self._block.place.call = Call.IDLE
        return library

    def _fill(self, index: int) -> None:
        element, target = self.wiring.system.elements[index], self.elements[index]
        model, able = element.model, self.abilities[index]
        target.version, target.abilities = model.version, able
        target.name = element.name.encode()
        target.token = model.token.encode()
        target.resources = resources(model).encode()
        with about(element.name):
            functions = lifecycle(model, self.libraries[str(model.library)])
        for call, where in functions.items():
            setattr(target, call.name.lower(), where)
        if _is_exchange(model):
            integration = Integration(model, self.libraries[str(model.library)], has_inputs=bool(element.inputs))
            self._integrations.append(integration)
            target.exchange = integration.pointer
        target.stepping = layout.Place(index, Call.DO_STEP)
        target.log = ctypes.addressof(self._logs[index])
        target.first_value, target.n_values = _span(self.wiring.outputs, index)
        target.first_staged, target.n_staged = self._spans[index]
        target.takes_slopes = takes_slopes(model, able)
        if able & Ability.ASKS_BETWEEN:
            moving = [v.reference for g in self.wiring.inputs[index] if self._moves(index, g) for v in g.variables]
            self._intermediate.append(np.array(moving, np.uint32))
            target.intermediate, target.n_intermediate = self._intermediate[-1].ctypes.data, len(moving)


def _span(parts: Sequence[Sequence[Group]], index: int) -> tuple[int, int]:
    sizes = [sum(len(group.positions) for group in part) for part in parts]
    return sum(sizes[:index]), sizes[index]


def _is_plain(model: FmuModel, able: Ability) -> bool:
    return model.version > 1 and Ability.HAS_EVENTS not in able and not _is_exchange(model)


def _is_exchange(model: FmuModel) -> bool:
    return model.interface is FmiInterface.MODEL_EXCHANGE


def _block(progress: memoryview | None) -> layout.Progress | None:
    if progress is None:
        return None
    block = layout.Progress.from_buffer(progress)
    if ctypes.addressof(block) % ctypes.sizeof(ctypes.c_int64):
        raise ValueError("the progress block must begin at a multiple of 8 bytes")
    return block
