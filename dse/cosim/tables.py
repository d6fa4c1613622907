"""A wired system as the tables the kernel works on."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.cosim import layout
from dse.cosim.calls import C_TYPES, Call, function_name
from dse.cosim.library import address, lifecycle, load, resources
from dse.cosim.wiring import Group, Wiring, start_groups
from dse.domain.fmu import FmuModel
from dse.domain.system import Element


class Tables:
    """The kernel's view of a system; owns all memory that *system* points into.

    Libraries are loaded here, each once. There are no instances yet.
    """

    def __init__(self, wiring: Wiring, progress: memoryview | None) -> None:
        self.wiring = wiring
        self.libraries: dict[str, ctypes.CDLL] = {}
        self.values = np.zeros(len(wiring.values), np.float64)
        self._previous = np.zeros(len(wiring.values), np.float64)
        self._finite = np.array(wiring.finite, np.int32)
        self._logs = [layout.Log() for _ in wiring.system.elements]
        self._block = _block(progress)
        self._kept: list[Any] = []
        self.elements = (layout.Element * len(wiring.system.elements))()
        for index in range(len(wiring.system.elements)):
            self._fill(index)
        self.system = layout.System(
            elements=ctypes.cast(self.elements, ctypes.POINTER(layout.Element)),
            n_elements=len(self.elements),
            values=self.values.ctypes.data,
            previous=self._previous.ctypes.data,
            n_values=self.values.size,
            finite=self._finite.ctypes.data,
            n_finite=self._finite.size,
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

    def groups(
        self, element: Element, groups: Sequence[Group], verb: str, *, into_table: bool
    ) -> tuple[Any, list[Any]]:
        """The kernel's structures for *groups* and the arrays they point into."""
        model = element.model
        library = self._library(model)
        kept: list[Any] = []
        structures = (layout.Group * len(groups))()
        for structure, group in zip(structures, groups, strict=True):
            references = np.array([variable.reference for variable in group.variables], np.uint32)
            positions = np.array(group.positions, np.int32)
            room = (C_TYPES[group.type] * len(group.variables))()
            kept += [references, positions, room]
            name = function_name(Call[verb] + group.type, model.version)
            structure.access = address(model, library, name)
            structure.references = references.ctypes.data
            structure.sources = None if into_table else positions.ctypes.data
            structure.room = ctypes.addressof(room)
            structure.count = len(group.variables)
            structure.first = group.positions[0]
            structure.type = group.type
        return structures, [structures, *kept]

    def release(self) -> None:
        """Let go of the progress block, so that its memory can be closed."""
        self.system.progress = None
        self._block = None

    def _library(self, model: FmuModel) -> ctypes.CDLL:
        key = str(model.library)
        if key not in self.libraries:
            self.libraries[key] = load(model)
        return self.libraries[key]

    def _fill(self, index: int) -> None:
        element, target = self.wiring.system.elements[index], self.elements[index]
        model = element.model
        target.version = model.version
        target.name = element.name.encode()
        target.token = model.token.encode()
        target.resources = resources(model).encode()
        for call, where in lifecycle(model, self._library(model)).items():
            setattr(target, call.name.lower(), where)
        target.log = ctypes.pointer(self._logs[index])
        for side, verb in (("inputs", "SET"), ("outputs", "GET")):
            groups: tuple[Group, ...] = getattr(self.wiring, side)[index]
            structures, kept = self.groups(element, groups, verb, into_table=verb == "GET")
            setattr(target, side, structures)
            setattr(target, f"n_{side}", len(groups))
            self._kept.append(kept)
        part = self.wiring.part(index)
        target.first, target.count = part.start, len(part)


class StartTable:
    """Where start values lie, and the system's own; creating one makes *tables* use it."""

    def __init__(self, tables: Tables, extra: Sequence[str]) -> None:
        system = tables.wiring.system
        self.positions, own, self.groups = start_groups(system, extra)
        self.extra = frozenset(extra)
        self._own = np.array(own, np.float64)
        # All built before any is put to use: a missing accessor must leave the tables as they were.
        self._built = [
            tables.groups(element, groups, "SET", into_table=False)
            for element, groups in zip(system.elements, self.groups, strict=True)
        ]
        for target, (structures, _) in zip(tables.elements, self._built, strict=True):
            target.starts, target.n_starts = structures, len(structures)

    def covers(self, start: Mapping[str, float]) -> bool:
        """Whether *start* gives values to exactly the extra names and otherwise to names the system sets itself."""
        return start.keys() <= self.positions.keys() and self.extra <= start.keys()

    def values(self, start: Mapping[str, float]) -> NDArray[np.float64]:
        """The table of start values with those in *start* in place of the system's own."""
        table = self._own.copy()
        for name, value in start.items():
            table[self.positions[name]] = value
        return table


def _block(progress: memoryview | None) -> layout.Progress | None:
    if progress is None:
        return None
    block = layout.Progress.from_buffer(progress)
    if ctypes.addressof(block) % ctypes.sizeof(ctypes.c_int64):
        raise ValueError("the progress block must begin at a multiple of 8 bytes")
    return block
