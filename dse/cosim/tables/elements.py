"""The kernel's elements: FMU libraries loaded, their functions found, memory to log to and to be integrated in."""

from __future__ import annotations

import ctypes
import os
import re
from collections.abc import Iterable, Sequence

import numpy as np

from dse.cosim.binding import layout
from dse.cosim.binding.abilities import Ability, abilities_of, takes_slopes
from dse.cosim.binding.calls import Call
from dse.cosim.binding.integration import Integration
from dse.cosim.binding.library import about, lifecycle, load
from dse.cosim.binding.persistent_memory import borrow, give_back
from dse.cosim.binding.resources import InstanceFolder
from dse.cosim.wiring.wiring import VariableGroup
from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.system import Element


class KernelElements:
    """The kernel's *structures* of *elements*, without groups of variables; there are no instances yet.

    Each library is loaded once; *progress* tells which one, as it may already crash then. Raises DseError if one cannot
    be loaded or lacks a function.
    """

    def __init__(self, elements: Sequence[Element], progress: layout.Progress | None = None) -> None:
        self.elements = tuple(elements)
        self._libraries = {str(e.model.library): _load(index, e, progress) for index, e in enumerate(elements)}
        self.structures, self._logs = borrow(len(elements))
        self._kept: list[object] = []
        self._folders: list[InstanceFolder] = []
        for index, (element, structure) in enumerate(zip(elements, self.structures, strict=True)):
            with about(element.name):
                self._fill(index, element, structure)

    def library(self, index: int) -> ctypes.CDLL:
        """The library of an element."""
        return self._libraries[str(self.elements[index].model.library)]

    def set_between(self, index: int, inputs: Iterable[VariableGroup]) -> None:
        """Which inputs an FMU that asks for inputs within a step may be given."""
        structure = self.structures[index]
        if structure.abilities & Ability.ASKS_BETWEEN:
            array = np.array([variable.reference for group in inputs for variable in group.variables], np.uint32)
            self._kept.append(array)
            structure.intermediate, structure.n_intermediate = array.ctypes.data, len(array)

    def log(self, index: int) -> tuple[str, ...]:
        """What an element has logged since the last call into the kernel began."""
        return expanded(self._logs[index].read(), self.elements[index].model)

    def renew_folders(self) -> None:
        """Before instances are made again: their folders are as they were. Raises DseError if that is not possible."""
        for folder in self._folders:
            folder.renew()

    def release(self) -> None:
        """Give back memory and folders, when there are no instances any more."""
        for folder in self._folders:
            folder.remove()
        give_back(self.structures, self._logs)

    def _fill(self, index: int, element: Element, structure: layout.Element) -> None:
        model, library = element.model, self.library(index)
        able = abilities_of(model, library)
        structure.version, structure.abilities = model.version, able
        structure.takes_slopes = takes_slopes(model, able)
        structure.tolerance = model.experiment.tolerance or 0.0
        structure.name, structure.token = element.name.encode(), model.token.encode()
        self._folders.append(InstanceFolder(model))
        structure.resources = os.fsencode(self._folders[-1].location)
        for call, where in lifecycle(model, library).items():
            setattr(structure, call.name.lower(), where)
        if model.interface is FmiInterface.MODEL_EXCHANGE:
            integration = Integration(model, library, has_inputs=bool(element.inputs))
            self._kept.append(integration)
            structure.exchange = integration.pointer
        structure.stepping = layout.Place(index, Call.DO_STEP)
        structure.log = ctypes.addressof(self._logs[index])


def _load(index: int, element: Element, progress: layout.Progress | None) -> ctypes.CDLL:
    if progress:
        progress.place, progress.step = layout.Place(index, Call.LOAD), -1
    with about(element.name):
        library = load(element.model)
    if progress:
        progress.place.call = Call.IDLE
    return library


# Lines that FMUs log, made readable.


_REFERENCE = re.compile(r"#(?:([ribs])(\d+)#|#)")
_TYPES = {"r": "Real", "i": "Integer", "b": "Boolean", "s": "String"}


def expanded(lines: Sequence[str], model: FmuModel) -> tuple[str, ...]:
    """*lines* with the names of variables in place of FMI 1 and 2's ``#r1365#``, and ``#`` for ``##``."""
    if model.version > 2 or not any("#" in line for line in lines):  # FMI 3 has no such references
        return tuple(lines)
    names: dict[tuple[str, int], str] = {}
    for variable in model.variables.values():
        names.setdefault((variable.fmi_type, variable.reference), variable.name)

    def name(match: re.Match[str]) -> str:
        kind, reference = match.groups()
        if kind is None:
            return "#"
        return names.get((_TYPES[kind], int(reference)), match.group())

    return tuple(_REFERENCE.sub(name, line) for line in lines)
