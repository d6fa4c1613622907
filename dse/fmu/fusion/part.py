"""One component as objects that can stand beside others in a library: every name they define has a prefix."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_content, keep_files
from dse.fmu.fusion.layout import InstanceLayout, layout_unit, read_layout
from dse.fmu.fusion.sources import OwnSources, is_runtime, runtime_file
from dse.fmu.toolchain.compilation import MODEL_OPTIONS, compile_assembly, compile_object, options
from dse.fmu.toolchain.compiler import Compiler


@dataclass(frozen=True, slots=True)
class Part:
    """*prefix* stands before every name; *objects* are files."""

    prefix: str
    objects: tuple[Path, ...]
    layout: InstanceLayout


_LAYOUT = "layout.o"


def build_part(sources: OwnSources, compiler: Compiler, cache: Path | None) -> Part:
    """The part made of *sources*, from the cache if it was made before. Raises CompilationError, LookupError."""
    staged, units = _staged(sources), _units(sources)
    keyed = [
        *sorted({**staged, **units}.items()),
        ("build", repr((sources.version, compiler.identity, options(compiler), MODEL_OPTIONS)).encode()),
    ]
    key = content_key(keyed)
    prefix = f"c{key[:16]}_"

    def objects() -> dict[str, bytes]:
        names = _defined_names(sources, compiler, {**staged, **units, _NAMES: b""}, cache)
        files = {**staged, **units, _NAMES: _renaming(names, prefix)}
        return {
            _LAYOUT if unit == _LAYOUT_UNIT else f"{prefix}{number}.o": compile_object(
                compiler, files, unit, _extra(sources, unit)
            )
            for number, unit in enumerate(units)
        }

    folder = keep_files(cache_folder(cache) / "fused" / "parts" / key, objects)
    layout = read_layout(sources, (folder / _LAYOUT).read_bytes())
    return Part(prefix, tuple(sorted(folder.glob(f"{prefix}*.o"))), layout)


_NAMES = "fused/names.h"
_MAIN = "fused/component.c"
_LAYOUT_UNIT = "fused/layout.c"


def _staged(sources: OwnSources) -> dict[str, bytes]:
    return {**sources.files, "fused/fused_part.h": runtime_file("fused_part.h")}


def _units(sources: OwnSources) -> dict[str, bytes]:
    """What is compiled, by path: each of the FMU's own units, seen through the prefix."""
    main, *others = sources.units
    head = f'#include "names.h"\n#define DSE_FMI {sources.version}\n'
    units = {_MAIN: f'{head}#include "../{main}"\n#include "fused_part.h"\n'}
    units |= {f"fused/unit_{n}.c": f'#include "names.h"\n#include "../{unit}"\n' for n, unit in enumerate(others)}
    units[_LAYOUT_UNIT] = layout_unit(sources)
    return {name: text.encode() for name, text in units.items()}


def _extra(sources: OwnSources, unit: str) -> tuple[str, ...]:
    # The options of the FMU's own library, unit by unit: other ones could mean other bits.
    folder = f"-I{sources.include_folder}"
    if unit == _LAYOUT_UNIT:
        return folder, "-O0", "-fno-lto"  # no code, and an array that stands in the object as it is
    return (folder, *MODEL_OPTIONS) if sources.is_model and unit == _MAIN else (folder,)


_DEFINED = re.compile(r"^\s*\.(?:globl|global|weak|weak_definition|comm)\s+([A-Za-z_]\w*)", re.MULTILINE)


def _defined_names(sources: OwnSources, compiler: Compiler, files: Mapping[str, bytes], cache: Path | None) -> set[str]:
    """Every name that other units could see. The compiler's assembler text tells them the same way everywhere."""

    def defined(unit: str) -> set[str]:
        found = _DEFINED.findall(compile_assembly(compiler, files, unit, _extra(sources, unit)))
        return {name.removeprefix("_") for name in found} if sys.platform == "darwin" else set(found)

    # The unit with the FMI functions defines the same names for every component: one of each kind is looked at.
    runtime = [(name, text) for name, text in sorted(sources.files.items()) if is_runtime(name)]
    about = repr((sources.version, sources.is_model, compiler.identity, options(compiler)))
    key = content_key([*runtime, (_MAIN, files["fused/fused_part.h"]), ("build", about.encode())])
    kept = cache_folder(cache) / "fused" / "names" / key
    names = keep_content(kept, lambda: "\n".join(sorted(defined(_MAIN))).encode()).decode().split()
    return {*names}.union(*(defined(unit) for unit in _units(sources) if unit not in (_MAIN, _LAYOUT_UNIT)))


def _renaming(names: Iterable[str], prefix: str) -> bytes:
    lines = (f"#define {name} {prefix}{name}" for name in sorted(names))
    return "\n".join((f'#define DSE_PREFIX "{prefix}"', *lines, "")).encode()
