"""A Modelica component as an FMU: front-end, flattening, sorting, C, one object that outlives new start values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_content, keep_file
from dse.csolve import headers
from dse.domain.component import Component, ModelicaCompiler, ModelicaSource
from dse.errors import DseError, Problem, fail
from dse.fmu import (
    LANGUAGE_OPTIONS,
    MODEL_OPTIONS,
    SLOT_TABLE,
    CompilationError,
    Compiler,
    SlotTable,
    compile_object,
    describe_sources,
    link_library,
    model_identifier,
    options,
    this_platform,
    with_compiler,
)
from dse.formats import pack_zip
from dse.modelica.description import Described, describe_model, documentation
from dse.modelica.emit.constant_data import slot_rows
from dse.modelica.emit.model import DEFAULT_TOLERANCE, emit
from dse.modelica.frontend.sources import Keep, ModelSources, library_contents, read_sources
from dse.modelica.openmodelica import build_with_omc, find_omc, omc_version
from dse.modelica.translate import Translated, TranslationError, translate

_DSE = Path(__file__).parents[1]
_RUNTIME = _DSE / "fmu" / "runtime"
_FOR_C = ("fused_", "c_component", "datagram.h", "udp")
_NOT_FOR = {2: (*_FOR_C, "fmi3"), 3: (*_FOR_C, "fmi2")}
"""How files of the runtime begin that an FMU of a version has no use for."""


def build_modelica(component: Component, source: ModelicaSource, version: int, cache: Path | None) -> Path:
    """The FMU archive of *component*, from the cache if it was built before. Raises DseError.

    With the compiler ``auto``, what dse cannot translate is given to OpenModelica, if this machine has it.
    """
    sources = _read(component, source, cache)
    omc = find_omc() if source.compiler is not ModelicaCompiler.RUMOCA else None
    if source.compiler is ModelicaCompiler.OMC:
        if omc is None:
            raise _without_omc(component)
        return _by_omc(component, source, sources, omc, version, cache)
    try:
        return _by_dse(component, source, sources, version, cache)
    except TranslationError as refusal:
        if omc is None:
            raise _mentioning_omc(refusal, source) from refusal
        try:
            return _by_omc(component, source, sources, omc, version, cache)
        except DseError as error:
            raise DseError(*refusal.problems, *error.problems) from error


def check_modelica(component: Component, source: ModelicaSource, cache: Path | None = None) -> tuple[Problem, ...]:
    """Who translates the model, if it is not dse.

    Raises DseError with everything that is wrong with the model and its component, as `build_modelica` would. No C
    compiler is needed, and OpenModelica is not run. What was found right is noted in the cache.
    """
    sources = _read(component, source, cache)
    if source.compiler is ModelicaCompiler.OMC:
        if find_omc() is None:
            raise _without_omc(component)
        return (Problem(f"component '{component.name}': translated by OpenModelica's omc, as asked", component.where),)
    note = cache_folder(cache) / "checked" / content_key(_identity(component, source, sources, 0))

    def checked() -> bytes:
        translate(component, sources, _keeping(cache))
        return b""

    try:
        keep_content(note, checked)
    except TranslationError as refusal:
        if source.compiler is ModelicaCompiler.AUTO and find_omc() is not None:
            what = f"component '{component.name}': translated by OpenModelica's omc, because dse refuses the model: "
            first = refusal.problems[0]
            return (replace(first, what=what + first.what),)
        raise _mentioning_omc(refusal, source) from refusal
    return ()


def _without_omc(component: Component) -> DseError:
    what = f"component '{component.name}': its compiler is omc, which is not on PATH"
    return fail(what, component.where, "install OpenModelica, or set compiler: auto")


def _mentioning_omc(refusal: TranslationError, source: ModelicaSource) -> DseError:
    if source.compiler is not ModelicaCompiler.AUTO:
        return DseError(*refusal.problems)
    first, *others = refusal.problems
    hint = "; ".join(filter(None, (first.hint, "if OpenModelica's omc were on PATH, it would be tried")))
    return DseError(replace(first, hint=hint), *others)


def _by_omc(
    component: Component, source: ModelicaSource, sources: ModelSources, omc: str, version: int, cache: Path | None
) -> Path:
    if version != 2:
        what = f"component '{component.name}': omc writes FMI 2.0, not {version}"
        raise fail(what, component.where, "build it for FMI 2")
    keyed = [*_identity(component, source, sources, version), ("omc", omc_version(omc).encode())]
    target = cache_folder(cache) / "built" / f"{model_identifier(component.name)}-{content_key(keyed)}.fmu"
    return keep_file(target, lambda: build_with_omc(component, source, sources, omc))


def _by_dse(
    component: Component, source: ModelicaSource, sources: ModelSources, version: int, cache: Path | None
) -> Path:
    platform = this_platform()
    identity = _identity(component, source, sources, version)
    token = "{" + content_key(identity) + "}"
    named = model_identifier(component.name)
    library = platform.library(version, named)

    def made(compiler: Compiler) -> Path:
        machine = ("build", repr((compiler.identity, options(compiler), MODEL_OPTIONS, platform.name)).encode())
        target = cache_folder(cache) / "built" / f"{named}-{content_key([*identity, machine])}.fmu"
        return keep_file(target, lambda: packed(compiler))

    def packed(compiler: Compiler) -> bytes:
        translated = translate(component, sources, _keeping(cache))
        contents = _contents(component, source, translated, named, token, version)
        return pack_zip({**contents, str(library): _compiled(compiler, contents, version, library.name, cache)})

    try:
        return with_compiler(cache, made)
    except CompilationError as error:
        said = "; ".join(f"{d.file}:{d.line}: {d.message}" if d.file else d.message for d in error.diagnostics[:3])
        what = f"component '{component.name}': the C made from {source.model} does not compile: {said}"
        raise fail(what, component.where, "this is a mistake of dse: please report it with the model") from error


def _keeping(cache: Path | None) -> Keep:
    def keep(asked: Sequence[tuple[str, bytes]], make: Callable[[], bytes]) -> bytes:
        key = content_key([*asked, ("implementation", _implementation().encode())])
        return keep_content(cache_folder(cache) / "modelica" / f"{key}.json", make)

    return keep


def _read(component: Component, source: ModelicaSource, cache: Path | None) -> ModelSources:
    keep = _keeping(cache)
    return read_sources(component.name, source.model, source.files, source.roots, component.where, keep)


def _contents(
    component: Component, source: ModelicaSource, translated: Translated, named: str, token: str, version: int
) -> dict[str, bytes]:
    """Every file of the FMU but its library, by path; the same for the same component on every machine."""
    tolerance = source.tolerance or DEFAULT_TOLERANCE
    generated = emit(translated.solved, translated.variables, token, source.solver, tolerance, translated.names)
    files = (f"runtime/fmi{version}.c", "runtime/start.c")
    described = Described(
        name=component.name,
        identifier=named,
        title=component.title or translated.description,
        token=token,
        tolerance=tolerance,
        variables=translated.variables,
        indicators=len(translated.solved.flat.relations) + len(translated.solved.selections),
        files=files,
        dependencies=translated.solved.dependencies,
    )
    contents = {
        **{
            f"sources/runtime/{name}": content
            for name, content in _runtime().items()
            if name in headers() or not name.startswith(_NOT_FOR[version])
        },
        **{f"sources/runtime/{name}": content for name, content in generated.items()},
        f"sources/{SLOT_TABLE}": SlotTable("", slot_rows(translated.variables)).to_bytes(),
        "modelDescription.xml": describe_model(described, version),
    }
    settings = f"solver {source.solver.value}, relative tolerance {tolerance:g}"
    contents["documentation/index.html"] = documentation(
        component.title or component.name, source.model, translated.files, settings, translated.solved.notes
    )
    if version == 3:
        contents["sources/buildDescription.xml"] = describe_sources(
            named, files, "runtime", (*LANGUAGE_OPTIONS, *MODEL_OPTIONS)
        )
    return contents


def _compiled(
    compiler: Compiler, contents: Mapping[str, bytes], version: int, library: str, cache: Path | None
) -> bytes:
    """The library. The model's object is kept, so that new start values cost a link only."""
    prefix = "sources/runtime/"
    files = {name.removeprefix(prefix): text for name, text in contents.items() if name.startswith(prefix)}
    start = {"start.c": files.pop("start.c")}
    keyed = [*sorted(files.items()), ("build", repr((compiler.identity, options(compiler), MODEL_OPTIONS)).encode())]
    kept = cache_folder(cache) / "objects" / f"{content_key(keyed)}.o"
    model = keep_content(kept, lambda: compile_object(compiler, files, f"fmi{version}.c", MODEL_OPTIONS))
    return link_library(compiler, {"model.o": model, "start.o": compile_object(compiler, start, "start.c")}, library)


def _identity(
    component: Component, source: ModelicaSource, sources: ModelSources, version: int
) -> list[tuple[str, bytes]]:
    """Everything the FMU is made of, without places on this machine."""
    declared = (
        component.name,
        component.title,
        tuple((port.name, str(port.causality), str(port.type)) for port in component.interface.ports),
        tuple(replace(parameter, where=None) for parameter in component.parameters),
        sorted(component.names.items()),
        source.model,
        source.solver.value,
        source.tolerance,
        version,
    )
    return [
        ("component", repr(declared).encode()),
        *sorted(sources.contents.items()),
        *((f"library/{name}", content) for name, content in library_contents(sources)),
        ("implementation", _implementation().encode()),
    ]


@lru_cache(maxsize=1)
def _runtime() -> dict[str, bytes]:
    return {**{path.name: path.read_bytes() for path in sorted(_RUNTIME.glob("*.[ch]"))}, **headers()}


@lru_cache(maxsize=1)
def _implementation() -> str:
    """A name of the program that translates: other code may write another FMU."""
    kinds = ("*.py", "*.mo")
    files = [path for room in ("fmu", "modelica") for kind in kinds for path in sorted((_DSE / room).rglob(kind))]
    code = ((path.relative_to(_DSE).as_posix(), path.read_bytes()) for path in files)
    return content_key([*code, *_runtime().items()])
