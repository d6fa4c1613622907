"""FMUs that hold sources instead of a library for this platform are compiled, and kept in the cache."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator, Mapping
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_files
from dse.errors import DseError, Location, Problem
from dse.fmu.reading.build_description import Recipe, read_recipe
from dse.fmu.reading.description import Description
from dse.fmu.toolchain.compilation import CompilationError, compile_foreign, foreign_options
from dse.fmu.toolchain.compiler import Compiler, with_compiler
from dse.fmu.toolchain.platforms import this_platform
from dse.scratch import ScratchFolder

_HEADERS = {
    2: ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    3: ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
_HEADERS_FOLDER = "dse_fmi_headers"
_MOST_TOLD = 20


def build_from_sources(folder: Path, description: Description, name: str, cache: Path | None) -> Path:
    """The library for this platform, made of the sources of the unpacked FMU in *folder*, called *name*.

    It is compiled once for the same sources and the same compiler. Raises DseError: the description of the build
    cannot be used, there is no compiler, or what the compiler refuses, located in the sources.
    """
    recipe = read_recipe(folder, description, name)
    files = _staged(folder / "sources", description.version)
    library = f"{description.identifier}{this_platform().suffix}"
    units = {unit.path: (*unit.options, *_common_options(description.version)) for unit in recipe.units}

    def made(compiler: Compiler) -> Path:
        target = cache_folder(cache) / "compiled" / _key(files, recipe, compiler)
        return keep_files(target, lambda: {library: compiled(compiler)}) / library

    def compiled(compiler: Compiler) -> bytes:
        with ScratchFolder() as scratch:
            sources = Path(scratch)
            for path, content in files.items():
                (sources / path).parent.mkdir(parents=True, exist_ok=True)
                (sources / path).write_bytes(content)
            return compile_foreign(compiler, sources, units, recipe.libraries, library)

    try:
        return with_compiler(cache, made)
    except CompilationError as error:
        raise DseError(*_problems(error, name)) from error


def _common_options(version: int) -> tuple[str, ...]:
    """In a library the functions have no prefix, though sources may ask for one, as static linking needs it."""
    return (
        f"-DFMI{version}_OVERRIDE_FUNCTION_PREFIX",
        "-DDISABLE_PREFIX",  # the same in FMUs that follow an old example
        "-I.",
        f"-I{_HEADERS_FOLDER}",
    )


def _staged(sources: Path, version: int) -> Mapping[str, bytes]:
    """Every file of the sources, and FMI's own headers, which an FMU need not hold."""
    files = {path.relative_to(sources).as_posix(): path.read_bytes() for path in sources.rglob("*") if path.is_file()}
    headers = _standard_headers(version)
    for path, content in files.items():
        header = path.rpartition("/")[2]
        # Older editions put the prefix that static linking needs before every name, and cannot be told not to.
        if header == f"fmi{version}Functions.h" and b"OVERRIDE_FUNCTION_PREFIX" not in content:
            files[path] = headers[header]
    return {**files, **{f"{_HEADERS_FOLDER}/{name}": content for name, content in headers.items()}}


def _standard_headers(version: int) -> Mapping[str, bytes]:
    # FMPy carries the headers of the standard; it is found without being imported.
    found = importlib.util.find_spec("fmpy")
    folders = [Path(folder) / "c-code" for folder in (found.submodule_search_locations or ())] if found else []
    return {name: (folder / name).read_bytes() for folder in folders for name in _HEADERS[version]}


def _key(files: Mapping[str, bytes], recipe: Recipe, compiler: Compiler) -> str:
    units = [(unit.path, unit.options) for unit in recipe.units]
    made = repr((compiler.identity, foreign_options(compiler), units, recipe.libraries, this_platform().name))
    return content_key([*sorted(files.items()), ("build", made.encode())])


def _problems(error: CompilationError, name: str) -> Iterator[Problem]:
    for one in error.diagnostics[:_MOST_TOLD]:
        where = Location(f"{name}/sources/{one.file}", one.line, one.column) if one.file else Location(name)
        yield Problem(f"its sources do not compile: {one.message}", where)
