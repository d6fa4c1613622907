"""FMU libraries in this process: loaded once, never unloaded in a simulation (some FMUs crash when they are)."""

from __future__ import annotations

import ctypes
import filecmp
import os
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from dse.cosim.binding.calls import FUNCTIONS, Call, function_name
from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.system import SystemStructure
from dse.errors import DseError, FreshProcessNeeded, Problem, fail, raise_if_any
from dse.sandbox import is_inside

_ALWAYS = frozenset({
    Call.INSTANTIATE, Call.FREE_INSTANCE, Call.RESET, Call.SETUP_EXPERIMENT, Call.ENTER_INITIALIZATION,
    Call.EXIT_INITIALIZATION, Call.DO_STEP, Call.TERMINATE,
})  # fmt: skip
_NOT_OF_EXCHANGE = frozenset({Call.INSTANTIATE, Call.DO_STEP, Call.ENTER_EVENT_MODE, Call.UPDATE_DISCRETE_STATES})

_occupied: set[Path] = set()
_brought: dict[str, Path] = {}
"""Helper libraries of FMUs by their names."""
_loaded: dict[tuple[Path, int, int], ctypes.CDLL] = {}
"""Libraries by path, number and time of their file; with each, ctypes has the functions that were looked up."""


@contextmanager
def about(element: str) -> Iterator[None]:
    """Problems that are found inside are said to be those of *element*."""
    try:
        yield
    except DseError as error:
        raise type(error)(*(replace(p, what=f"{element}: {p.what}") for p in error.problems)) from error


def load(model: FmuModel) -> ctypes.CDLL:
    """The library of *model*; DseError if the system cannot load it.

    FreshProcessNeeded if it would be given a library of another FMU in place of one that lies beside it.
    """
    if not model.library.is_file():
        what = f"{model.identifier}: the FMU's library is gone since the FMU was opened ({model.library})"
        raise fail(what, hint="run the command again: what is missing in the cache is made again")
    if model.is_live and is_inside() and "DSE_LIVE_SOCKET" not in os.environ:
        what = f"{model.identifier}: it exchanges datagrams with another process, and a sandbox has no network"
        raise fail(what, hint="leave --sandbox out only if you trust all FMUs of the run")
    state = model.library.stat()
    key = model.library, state.st_ino, state.st_mtime_ns
    if key not in _loaded or model.host.command:
        _loaded[key] = _newly_loaded(model)
    return _loaded[key]


def _newly_loaded(model: FmuModel) -> ctypes.CDLL:
    path = str(model.library.resolve())
    _bring(model)
    try:
        if sys.platform == "win32":
            # The FMU's own DLLs lie beside its library.
            with os.add_dll_directory(str(model.library.resolve().parent)):
                return ctypes.CDLL(path, winmode=0)
        return _hosted(_Bridge(path), model) if model.host.command else ctypes.CDLL(path)
    except OSError as error:
        reason = str(error).replace(f"{model.folder.resolve()}{os.sep}", "")
        raise fail(f"{model.identifier}: the FMU's library cannot be loaded: {reason}") from error


def unload(library: ctypes.CDLL) -> None:
    """Unload *library*, of which nothing may be used afterwards. For `dse probe`: simulations never unload one."""
    for key in [key for key, loaded in _loaded.items() if loaded is library]:
        del _loaded[key]
    handle = library._handle  # noqa: SLF001  # ctypes offers no other way
    if sys.platform == "win32":
        from _ctypes import FreeLibrary

        FreeLibrary(handle)
    else:
        from _ctypes import dlclose

        dlclose(handle)


class _Bridge(ctypes.CDLL):
    """A bridge has all functions of FMI; of those that the library behind it lacks it has none to offer."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("fmi") and not self.dse_bridge_has(name.encode()):
            raise AttributeError(name)
        return super().__getattr__(name)


def _hosted(bridge: _Bridge, model: FmuModel) -> _Bridge:
    """*bridge*, its host started, unless it was; OSError that says why that cannot load the library."""
    if model.host.is_wine and is_inside():
        what = f"{model.identifier}: an FMU for Windows cannot be run in a sandbox, as wine has a server outside of it"
        raise fail(what, hint="export it for this platform; leave --sandbox out only if you trust it")
    environment = {**os.environ, **model.host.settings}
    opening = bridge.dse_bridge_open
    opening.restype = ctypes.c_int64
    error = opening(_texts(model.host.command), _texts(f"{name}={value}" for name, value in environment.items()))
    if error > 0:
        missing = bytes((ctypes.c_char * _LONGEST_NAME).in_dll(bridge, "dse_bridge_missing").value)
        if not model.host.is_wine:
            raise OSError(missing.decode("utf-8", "replace"))
        why = f"it needs {missing.decode('ascii', 'replace')}, which is not there" if missing else "no library"
        raise OSError(f"{why} (error {error} of Windows)")
    if error < 0:
        host = "wine" if model.host.is_wine else "its process"
        raise OSError(f"{host} ended before it was there (exit code {-1 - error})")
    return bridge


_LONGEST_NAME = 260


def _texts(texts: Iterable[str]) -> Any:
    """An array of C strings that ends with NULL."""
    encoded = [os.fsencode(text) for text in texts]
    return (ctypes.c_char_p * (len(encoded) + 1))(*encoded)


def _bring(model: FmuModel) -> None:
    """Note the libraries beside that of *model* that it needs: a process takes only the first one of each name."""
    needed = _needed(model.library.resolve())
    for path in needed:
        before = _brought.get(path.name, path)
        if before != path and not filecmp.cmp(before, path, shallow=False):
            raise FreshProcessNeeded(
                Problem(
                    f"{model.identifier}: it would compute with another FMU's {path.name} than its own, as that one "
                    f"was loaded before",
                    hint="a process loads only one library of each name: FMUs whose helper libraries have the same "
                    "name but differ cannot be simulated together",
                )
            )
    for path in needed:
        _brought.setdefault(path.name, path)


def _needed(library: Path) -> list[Path]:
    """Libraries in the same folder whose names *library*, or one of them, holds."""
    beside = [path for path in sorted(library.parent.iterdir()) if _is_library(path) and path != library]
    needed: list[Path] = []
    asking = [library] if beside else []
    while asking:
        content = asking.pop().read_bytes()
        found = [path for path in beside if path not in needed and os.fsencode(path.name) in content]
        needed += found
        asking += found
    return needed


def _is_library(path: Path) -> bool:
    return path.is_file() and (".so" in path.suffixes or path.suffix in (".dll", ".dylib"))


def address(model: FmuModel, library: ctypes.CDLL, name: str) -> int:
    """Address of the FMI function called *name*; DseError if the library does not export it."""
    found = find(model, library, name)
    if found is None:
        raise fail(f"{model.identifier}: the FMU's library lacks the function {_prefix(model)}{name}")
    return found


def find(model: FmuModel, library: ctypes.CDLL, name: str) -> int | None:
    """Address of the FMI function called *name*, None if the library does not export it."""
    try:
        return ctypes.cast(getattr(library, _prefix(model) + name), ctypes.c_void_p).value
    except (AttributeError, UnicodeDecodeError):  # the latter where the library's path is no UTF-8
        return None


def lifecycle(model: FmuModel, library: ctypes.CDLL) -> dict[Call, int]:
    """Addresses of the functions that create, initialize, step and end an instance.

    What every FMU must have is looked for in vain only with a DseError; all else is left out if it is not there.
    """
    found = {}
    for call in FUNCTIONS:
        name = function_name(call, model.version)
        if not name or (model.interface is FmiInterface.MODEL_EXCHANGE and call in _NOT_OF_EXCHANGE):
            continue
        where = address(model, library, name) if call in _ALWAYS else find(model, library, name)
        if where is not None:
            found[call] = where
    return found


def _prefix(model: FmuModel) -> str:
    return model.prefix or (f"{model.identifier}_" if model.version == 1 else "")


def occupy(system: SystemStructure) -> frozenset[Path]:
    """Claim the libraries that can be instantiated only once per process, until :func:`vacate`; DseError if taken."""
    once = Counter(e.model.library for e in system.elements if e.model.capabilities.once_per_process)
    raise_if_any(
        Problem(
            f"{library.stem} can be instantiated only once per process",
            hint="`isolate: true` in the source of its component gives each instance a process of its own",
        )
        for library, count in once.items()
        if count > 1 or library in _occupied
    )
    _occupied.update(once)
    return frozenset(once)


def vacate(libraries: frozenset[Path]) -> None:
    """Give back what :func:`occupy` claimed."""
    _occupied.difference_update(libraries)
