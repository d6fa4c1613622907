"""The C sources inside an FMU that was built here: all it takes to build its component into another library."""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from dse.csolve import headers
from dse.domain.fmu import FmuModel
from dse.fmu.slot_table import PARTNER, SLOT_TABLE, Row, SlotTable

_RUNTIME = Path(__file__).parent.parent / "runtime"
_MODEL = "runtime/model.h"
_GENERATED = frozenset({_MODEL, "runtime/start.c"})
_OLDER = "was built by another version of dse"


@dataclass(frozen=True, slots=True)
class OwnSources:
    """*files* by path below ``sources/``; *units* are compiled, of which the first holds the FMI functions.

    *is_model* tells C made from Modelica from a component that was written in C.
    """

    version: int
    files: Mapping[str, bytes]
    units: tuple[str, ...]
    include_folder: str
    rows: tuple[Row, ...]
    is_model: bool


class NotOursError(Exception):
    """The FMU cannot be built once more; says why, to be put after the FMU's name."""


def own_sources(model: FmuModel) -> OwnSources:
    """The sources of *model*. Raises NotOursError unless this version of dse built it from C or Modelica."""
    folder = model.folder / "sources"
    files = {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()
    }
    main = f"runtime/fmi{model.version}.c"
    if _MODEL not in files or main not in files:
        raise NotOursError("was not built by dse from C or Modelica")
    ours = _runtime()
    for name, content in files.items():
        if is_runtime(name) and ours.get(name) != content:
            raise NotOursError(_OLDER)
    if SLOT_TABLE not in files:
        raise NotOursError(_OLDER)
    if (model.folder / PARTNER).is_file():
        raise NotOursError("has a process of its own do its work")
    if model.is_live:
        raise NotOursError("exchanges datagrams with another process")
    try:
        table = SlotTable.from_bytes(files[SLOT_TABLE])
    except (ValueError, KeyError, TypeError):
        raise NotOursError(_OLDER) from None
    is_model = not table.header
    written = () if is_model else sorted(name for name in files if name.startswith("component/") and name[-2:] == ".c")
    return OwnSources(
        version=model.version,
        files=files,
        units=(main, *(("runtime/start.c",) if is_model else written)),
        include_folder="runtime" if is_model else posixpath.dirname(table.header),
        rows=table.rows,
        is_model=is_model,
    )


@lru_cache(maxsize=1)
def _runtime() -> dict[str, bytes]:
    ours = {path.name: path.read_bytes() for path in sorted(_RUNTIME.glob("*.[ch]"))}
    return {f"runtime/{name}": content for name, content in {**ours, **headers()}.items()}


def is_runtime(name: str) -> bool:
    """Whether the file is one of the C runtime, the same for every component."""
    return name.startswith("runtime/") and name not in _GENERATED


def runtime_file(name: str) -> bytes:
    """A file of the C runtime."""
    return _runtime()[f"runtime/{name}"]
