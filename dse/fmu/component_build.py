"""Components become FMUs, each by its kind."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path, PurePosixPath

from dse.cache import cache_folder, content_key, keep_file
from dse.domain.component import Component
from dse.domain.fmu import FmuModel
from dse.errors import DseError, Location, Problem, fail
from dse.fmu.fusion.sources import NotOursError, OwnSources, own_sources
from dse.fmu.parallel import in_parallel
from dse.fmu.toolchain.compilation import MODEL_OPTIONS, CompilationError, compile_library, options
from dse.fmu.toolchain.compiler import Compiler, find_compiler_for
from dse.fmu.toolchain.platforms import Platform
from dse.fmu.unpack import open_fmu
from dse.formats import pack_zip
from dse.loading import KINDS, kind_of


def build(component: Component, *, version: int = 2, cache: Path | None = None) -> Path:
    """The FMU archive of *component*, for FMI *version* 2 or 3 if it has to be made; from the cache if it was.

    An existing FMU is returned as it is, whatever its version. Raises DseError: the component has no source, its
    C does not compile or lacks a port, or there is no compiler.
    """
    source, kind = component.source, kind_of(component)
    *others, last = KINDS.names()
    known = f"a source of the kind {', '.join(others)} or {last}"
    if source is None or kind is None:
        what = f"component '{component.name}' has no source, so there is nothing to build"
        raise fail(what, component.where, f"it can be counted and listed only; give it {known}")
    if version not in (2, 3) and not source.is_finished:
        raise fail(f"FMUs are built for FMI 2 and 3, not {version}")
    return kind.build(component, source, version=version, cache=cache)


def build_all(
    components: Iterable[Component],
    *,
    version: int = 2,
    cache: Path | None = None,
    platforms: Collection[Platform] = (),
) -> dict[str, Path]:
    """The archives of all *components* by name, several built at a time; with libraries for other *platforms*, too.

    Raises one DseError with the problems of all that cannot be built.
    """
    wanted = {component.name: component for component in components}

    def make(name: str) -> Path:
        archive = build(wanted[name], version=version, cache=cache)
        return with_platforms(name, archive, platforms, cache=cache) if platforms else archive

    return in_parallel(wanted, make)


# FMUs that were built here get libraries for other platforms, compiled from the sources that they contain.


def with_platforms(name: str, archive: Path, platforms: Iterable[Platform], *, cache: Path | None = None) -> Path:
    """The FMU of *name* in *archive* with libraries for *platforms*, too; from the cache if it was made before.

    In FMI 2, which has one folder for all Macs, a library for several of them is a universal binary. What the FMU has
    already stays as it is. Raises DseError: it was not built here from C or Modelica and lacks a library, its C
    does not compile for a platform, or the ziglang package is not installed.
    """
    model = open_fmu(archive, cache=cache)
    wanted: dict[PurePosixPath, list[Platform]] = {}
    for platform in platforms:
        path = platform.library(model.version, model.identifier)
        if not (model.folder / path).is_file():
            wanted.setdefault(path, []).append(platform)
    if not wanted:
        return archive
    try:
        sources = own_sources(model)
        if not sources.is_model and _CODED in sources.files:
            raise NotOursError("contains code from Simulink as a library for this platform")
    except NotOursError as reason:
        names = ", ".join(platform.name for each in wanted.values() for platform in each)
        raise fail(f"the FMU of '{name}' cannot be built for {names}: it {reason}") from None
    compilers = {platform: find_compiler_for(platform) for each in wanted.values() for platform in each}
    made_by = repr([(compiler.identity, options(compiler)) for compiler in compilers.values()])
    key = content_key([("fmu", model.content_hash.encode()), ("build", made_by.encode())])

    def packed() -> bytes:
        libraries = {
            str(path): _universal([_compiled(name, model, sources, each, compilers[each]) for each in platforms])
            for path, platforms in wanted.items()
        }
        with zipfile.ZipFile(archive) as whole:
            return pack_zip({**{entry: whole.read(entry) for entry in whole.namelist()}, **libraries})

    return keep_file(cache_folder(cache) / "built" / f"{model.identifier}-{key}.fmu", packed)


def _compiled(name: str, model: FmuModel, sources: OwnSources, platform: Platform, compiler: Compiler) -> bytes:
    library, extra = f"{model.identifier}{platform.suffix}", MODEL_OPTIONS if sources.is_model else ()
    try:
        return compile_library(compiler, sources.files, sources.units, sources.include_folder, library, extra)
    except CompilationError as error:
        what = f"component '{name}' does not compile for {platform.name}"
        told = ((f"{what}: {each.message}", each) for each in error.diagnostics)
        raise DseError(
            *(
                Problem(text, Location(f"{model.identifier}.fmu/sources/{each.file}", each.line, each.column))
                if each.file
                else Problem(text)
                for text, each in told
            )
        ) from error


_CODED = "runtime/coded.h"
_FAT, _ENTRY = ">II", ">IIIII"
_ALIGNMENT = 14
"""Of the libraries in a universal binary, as a power of two: a page of the processors with the largest."""


def _universal(libraries: Sequence[bytes]) -> bytes:
    """One file for several processors (``<mach-o/fat.h>``) with *libraries* for a single one each."""
    if len(libraries) == 1:
        return libraries[0]
    header, content = struct.pack(_FAT, 0xCAFEBABE, len(libraries)), b""
    first = 1 << _ALIGNMENT
    for library in libraries:
        processor, variant = struct.unpack_from("<II", library, 4)
        header += struct.pack(_ENTRY, processor, variant, first + len(content), len(library), _ALIGNMENT)
        content += library + bytes(-len(library) % first)
    return header.ljust(first, b"\0") + content
