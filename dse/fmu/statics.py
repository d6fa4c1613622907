"""Whether C components built here keep anything outside of their instances: static variables, which all share."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_content
from dse.domain.fmu import FmuModel
from dse.errors import DseError
from dse.fmu.fusion.sources import NotOursError, OwnSources, own_sources
from dse.fmu.toolchain.compilation import CompilationError, compile_assembly
from dse.fmu.toolchain.compiler import find_compiler


def shares_nothing(model: FmuModel, *, cache: Path | None = None) -> bool:
    """Whether instances of *model* have no variables in common.

    False as well if that cannot be found out: it was not built by this version of dse, or there is no compiler.
    """
    key = (model.content_hash, model.folder, cache)
    if key not in _known:  # a component is part of many configurations
        _known[key] = _shares_nothing(model, cache)
    return _known[key]


_known: dict[tuple[str, Path, Path | None], bool] = {}


def _shares_nothing(model: FmuModel, cache: Path | None) -> bool:
    try:
        sources = own_sources(model)
    except (NotOursError, OSError):
        return False
    if sources.is_model:
        return True  # what is made from Modelica has everything in its instance
    kept = cache_folder(cache) / "statics" / content_key(sorted(sources.files.items()))
    try:
        return not keep_content(kept, lambda: "\n".join(sorted(_statics(sources))).encode())
    except (DseError, CompilationError):
        return False


def _statics(sources: OwnSources) -> set[str]:
    compiler = find_compiler()
    folder = f"-I{sources.include_folder}"
    units = (compile_assembly(compiler, sources.files, unit, (folder,)) for unit in sources.units[1:])
    return {name for text in units for name in static_names(text)}


_SECTION = re.compile(r"^\s*\.(?:section\s+(?P<named>\S+)|(?P<short>data|bss|tdata|tbss|text|const|cstring)\b)")
_WRITABLE = re.compile(r"^(?:__DATA,__(?:data|bss|common|thread_\w+)|\.?t?(?:data|bss)(?!\.rel\.ro)(?:[.$].*)?)$")
_LABEL = re.compile(r"^(?P<name>[A-Za-z_][\w.$]*):")
_SPACE = re.compile(r"^\s*\.(?:l?comm|zerofill\s+\w+,\w+,|tbss)\s*(?P<name>[A-Za-z_][\w.$]*)")


def static_names(assembly: str) -> Iterator[str]:
    """Names of the variables in *assembly* (of gcc or clang) that are not constant and not on the stack."""
    writable = False
    for line in assembly.splitlines():
        if section := _SECTION.match(line):
            name = section["named"] or section["short"]
            # Flags follow after a comma; on macOS the name itself has one.
            name = ",".join(name.split(",")[: 2 if name.startswith("__") else 1])
            writable = _WRITABLE.match(name) is not None
        if (space := _SPACE.match(line)) or (writable and (space := _LABEL.match(line))):
            yield space["name"]
