"""The C sources inside an FMU that was built here: all it takes to build its component into another library."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from dse.csolve import headers
from dse.domain.fmu import FmuModel

_RUNTIME = Path(__file__).parent.parent / "runtime"
_MODEL = "runtime/model.h"
_GENERATED = frozenset({_MODEL, "runtime/start.c"})


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table of slots in model.h; its place in the table is the value reference.

    *member* is a member of the component's struct, or with *is_model* the place among a model's values. *kind* and
    *settable* are the names that slot.h has for them, without their ``DSE_``; *items* counts those of an enumeration.
    """

    member: str
    kind: str
    settable: str
    items: int


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
            raise NotOursError("was built by another version of dse")
    text = files[_MODEL].decode()
    is_model = "#define DSE_MODEL 1" in text
    written = () if is_model else sorted(name for name in files if name.startswith("component/") and name[-2:] == ".c")
    header = re.search(r'^#include "\.\./(component/[^"]+)"$', text, re.MULTILINE)
    return OwnSources(
        version=model.version,
        files=files,
        units=(main, *(("runtime/start.c",) if is_model else written)),
        include_folder=posixpath.dirname(header[1]) if header else "runtime",
        rows=_rows(text),
        is_model=is_model,
    )


_TABLE = re.compile(r"^static const struct dse_slot dse_slots\[\] = \{$(.*?)^\};$", re.MULTILINE | re.DOTALL)
_COUNT = re.compile(r"^#define DSE_SLOT_COUNT (\d+)u$", re.MULTILINE)
_ROW = re.compile(r"DSE_(?:SLOT|VALUE)\(([\w.]+), (?:DSE_)?(\w+), (?:DSE_)?(\w+), (\d+)\)")


def _rows(text: str) -> tuple[Row, ...]:
    table, count = _TABLE.search(text), _COUNT.search(text)
    if table is None or count is None:
        raise NotOursError("was built by another version of dse")
    found = [Row(member, kind, settable, int(items)) for member, kind, settable, items in _ROW.findall(table[1])]
    return tuple(found[: int(count[1])])  # without ports there is a row that no reference reaches


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
