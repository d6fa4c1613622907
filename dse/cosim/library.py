"""FMU libraries in this process: loaded once, never unloaded (some FMUs crash when they are)."""

from __future__ import annotations

import ctypes
import os
import sys
from collections import Counter
from pathlib import Path

from dse.cosim.calls import Call, function_name
from dse.domain.fmu import FmuModel
from dse.domain.system import SystemStructure
from dse.errors import Problem, fail, raise_if_any

LIFECYCLE = tuple(call for call in Call if Call.IDLE < call < Call.GET)

_occupied: set[Path] = set()


def load(model: FmuModel) -> ctypes.CDLL:
    """The library of *model*; DseError if the system cannot load it."""
    if not model.library.is_file():
        raise fail(f"{model.identifier}: the FMU has no library for this platform ({model.library.name})")
    path = str(model.library.resolve())
    try:
        if sys.platform == "win32":
            # The FMU's own DLLs lie beside its library.
            with os.add_dll_directory(str(model.library.resolve().parent)):
                return ctypes.CDLL(path, winmode=0)
        return ctypes.CDLL(path)
    except OSError as error:
        raise fail(f"{model.identifier}: the FMU's library cannot be loaded: {error}") from error


def address(model: FmuModel, library: ctypes.CDLL, name: str) -> int:
    """Address of the FMI function called *name*; DseError if the library does not export it."""
    try:
        found = ctypes.cast(getattr(library, name), ctypes.c_void_p).value
    except AttributeError:
        found = None
    if found is None:
        raise fail(f"{model.identifier}: the FMU's library lacks the function {name}")
    return found


def lifecycle(model: FmuModel, library: ctypes.CDLL) -> dict[Call, int]:
    """Addresses of the functions that create, initialize, step and end an instance."""
    names = {call: function_name(call, model.version) for call in LIFECYCLE}
    return {call: address(model, library, name) for call, name in names.items() if name}


def resources(model: FmuModel) -> str:
    """The FMU's resources as its standard wants them: a file URI for FMI 2, a path ending in a separator for FMI 3."""
    folder = (model.folder / "resources").resolve()
    return folder.as_uri() if model.version == 2 else str(folder) + os.sep


def occupy(system: SystemStructure) -> frozenset[Path]:
    """Claim the libraries that can be instantiated only once per process, until :func:`vacate`; DseError if taken."""
    once = Counter(e.model.library for e in system.elements if e.model.once_per_process)
    raise_if_any(
        Problem(
            f"{library.stem} can be instantiated only once per process",
            hint="use it in one element and close the simulator before the next one is made",
        )
        for library, count in once.items()
        if count > 1 or library in _occupied
    )
    _occupied.update(once)
    return frozenset(once)


def vacate(libraries: frozenset[Path]) -> None:
    """Give back what :func:`occupy` claimed."""
    _occupied.difference_update(libraries)
