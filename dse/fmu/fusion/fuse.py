"""Systems whose components were all built here become libraries with the connections compiled in."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_file
from dse.domain.fmu import FmiInterface, Variable
from dse.domain.fused import FusedLibrary
from dse.domain.method import PLAIN, Method
from dse.domain.system import Element, SystemStructure
from dse.errors import Problem, fail, raise_if_any
from dse.fmu.fusion.loop import FusedElement, loop_text
from dse.fmu.fusion.part import Part, build_part
from dse.fmu.fusion.sources import NotOursError, OwnSources, own_sources, runtime_file
from dse.fmu.parallel import Tell, in_parallel
from dse.fmu.toolchain.compilation import CompilationError, compile_object, link_library, options
from dse.fmu.toolchain.compiler import Compiler, with_compiler
from dse.fmu.toolchain.platforms import this_platform


@dataclass(frozen=True, slots=True)
class Wanted:
    """A system to be fused, with what is recorded (``element.fmi_variable``, in this order) and its method."""

    system: SystemStructure
    record: tuple[str, ...]
    method: Method = PLAIN


def fuse(
    system: SystemStructure, record: Sequence[str], method: Method = PLAIN, *, cache: Path | None = None
) -> FusedLibrary:
    """One library that simulates *system* by *method* and records *record*; see `fuse_all`."""
    return fuse_all({system.name: Wanted(system, tuple(record), method)}, cache=cache)[system.name]


def fuse_all(
    wanted: Mapping[str, Wanted], *, cache: Path | None = None, tell: Tell | None = None
) -> dict[str, FusedLibrary]:
    """A library for each of *wanted*, by the same keys; *tell* is told how many are made.

    They compute the same numbers, bit for bit, as the FMUs do. From the cache if they were made before; a component
    that several systems share is compiled once. Raises one DseError naming all that cannot be fused: a component that
    is an existing FMU or made by OpenModelica, a method that differs from the plain one in more than its algorithm,
    arrays, strings, conversions.
    """
    sources = _sources(wanted.values())

    def made(compiler: Compiler) -> dict[str, FusedLibrary]:
        parts = in_parallel(sources, lambda library: _part(library, sources[library], compiler, cache))
        return in_parallel(wanted, lambda key: _library(wanted[key], sources, parts, compiler, cache), tell)

    return with_compiler(cache, made)


_REPORT = "this is a mistake of dse: please report it with the components; without --fuse they can be simulated"


def _sources(wanted: Iterable[Wanted]) -> dict[Path, OwnSources]:
    """The sources of every FMU by its library; DseError for all that cannot be fused."""
    problems: list[Problem] = []
    found: dict[Path, OwnSources | str] = {}
    for each in wanted:
        problems += fusion_problems(each.system, each.record, each.method)
        for element in each.system.elements:
            library = element.model.library
            if library not in found:
                try:
                    found[library] = own_sources(element.model)
                except NotOursError as reason:
                    found[library] = str(reason)
            sources = found[library]
            if isinstance(sources, str):
                problems.append(not_ours(element, sources))
                continue
            variables = (*element.inputs, *element.outputs)
            problems += [unknown_place(element, v) for v in variables if v.reference >= len(sources.rows)]
    raise_if_any(dict.fromkeys(problems))
    return {library: sources for library, sources in found.items() if not isinstance(sources, str)}


def _part(library: Path, sources: OwnSources, compiler: Compiler, cache: Path | None) -> Part:
    try:
        return build_part(sources, compiler, cache)
    except CompilationError as error:
        raise fail(f"{library.stem}: cannot be fused: {_diagnostics_text(error)}", hint=_REPORT) from error
    except LookupError as error:
        raise fail(f"{library.stem}: cannot be fused: {error}", hint=_REPORT) from error


def _library(
    wanted: Wanted,
    sources: Mapping[Path, OwnSources],
    parts: Mapping[Path, Part],
    compiler: Compiler,
    cache: Path | None,
) -> FusedLibrary:
    system = wanted.system
    elements, used = _elements(system, sources, parts)
    files = {name: runtime_file(name) for name in ("fused_values.h", "csolve/fused_abi.h")}
    algorithm = wanted.method.algorithm
    files["loop.c"] = loop_text(system, wanted.record, elements, algorithm).encode()
    platform = this_platform()
    keyed = [*sorted(files.items()), ("build", repr((compiler.identity, options(compiler), platform.name)).encode())]
    target = cache_folder(cache) / "fused" / f"{_stem(system.name)}-{content_key(keyed)}{platform.suffix}"

    def linked() -> bytes:
        objects = {path.name: path.read_bytes() for path in used}
        objects["loop.o"] = compile_object(compiler, files, "loop.c")
        return link_library(compiler, objects, target.name)

    try:
        keep_file(target, linked)
    except CompilationError as error:
        raise fail(f"{system.name}: cannot be fused: {_diagnostics_text(error)}", hint=_REPORT) from error
    prefixes = {element.name: parts[element.model.library].prefix for element in system.elements}
    return FusedLibrary(target, system, wanted.record, prefixes, algorithm)


def fused_elements(
    wanted: Sequence[Wanted], compiler: Compiler, cache: Path | None
) -> tuple[list[list[FusedElement]], list[Path]]:
    """The elements of a loop over each of *wanted*, and the objects that *compiler* makes of all their components.

    Raises one DseError naming all that cannot be fused.
    """
    sources = _sources(wanted)
    parts = in_parallel(sources, lambda library: _part(library, sources[library], compiler, cache))
    found = [_elements(each.system, sources, parts) for each in wanted]
    used = {path.name: path for _, objects in found for path in objects}
    return [elements for elements, _ in found], [used[name] for name in sorted(used)]


def _elements(
    system: SystemStructure, sources: Mapping[Path, OwnSources], parts: Mapping[Path, Part]
) -> tuple[list[FusedElement], list[Path]]:
    libraries = [element.model.library for element in system.elements]
    elements = [
        FusedElement(parts[library].prefix, parts[library].layout, sources[library].is_model) for library in libraries
    ]
    used = {path for library in libraries for path in parts[library].objects}
    return elements, sorted(used, key=lambda path: path.name)


def _diagnostics_text(error: CompilationError) -> str:
    return "; ".join(f"{d.file}:{d.line}: {d.message}" if d.file else d.message for d in error.diagnostics[:3])


def _stem(name: str) -> str:
    return re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")[:60] or "system"


# What a fused loop cannot do, told by name before anything is compiled.


_AGAIN = "build it again"
_FROM_SOURCE = "components that are existing FMUs can only be simulated through FMI: leave out --fuse"
_PLAIN_ONLY = "simulate it without --fuse"


def fusion_problems(system: SystemStructure, record: Sequence[str], method: Method) -> list[Problem]:
    """Everything of *system*, *record* and *method* that cannot be compiled into one loop."""
    problems = []
    if not method.is_plain_but_for_order:
        what = "a fused loop supports only one fixed step, inputs held, no coupling, no bonds"
        problems.append(Problem(f"{system.name}: {what}", hint=_PLAIN_ONLY))
    for element in system.elements:
        problems += _element_problems(element)
    problems += _wire_problems(system)
    outputs = {f"{e.name}.{v.name}" for e in system.elements for v in e.outputs}
    problems += [Problem(f"there is no output '{name}' to record") for name in record if name not in outputs]
    return problems


def _element_problems(element: Element) -> Iterable[Problem]:
    if element.model.interface is not FmiInterface.CO_SIMULATION or element.model.version not in (2, 3):
        what = f"{element.name}: only FMUs for co-simulation of FMI 2 and 3 can be fused"
        yield Problem(what, hint=_FROM_SOURCE)
    for variable in (*element.inputs, *element.outputs):
        name = f"{element.name}.{variable.name}"
        if variable.shape:
            yield Problem(f"{name}: arrays cannot be fused", hint=_PLAIN_ONLY)
        if variable.kind is None:
            yield Problem(f"{name}: variables of type {variable.fmi_type} cannot be fused", hint=_PLAIN_ONLY)
        if variable.name in element.conversions:
            yield Problem(f"{name}: a variable with a conversion cannot be fused", hint=_PLAIN_ONLY)


def _wire_problems(system: SystemStructure) -> Iterable[Problem]:
    counted: dict[str, int] = {}
    outputs = {f"{e.name}.{v.name}" for e in system.elements for v in e.outputs}
    inputs = [f"{e.name}.{v.name}" for e in system.elements for v in e.inputs]
    for wire in system.wires:
        source, target = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
        counted[target] = counted.get(target, 0) + 1
        if (wire.factor, wire.offset, wire.items) != (1.0, 0.0, ()):
            yield Problem(f"{source} -> {target}: a connection with a conversion cannot be fused", hint=_PLAIN_ONLY)
        if source not in outputs:
            yield Problem(f"{source}: a wire starts at what is not an output")
    yield from (
        Problem(f"{name}: {counted.get(name, 0)} wires end at this input") for name in inputs if counted.get(name) != 1
    )
    yield from (Problem(f"{name}: a wire ends at what is not an input") for name in counted.keys() - set(inputs))


def unknown_place(element: Element, variable: Variable) -> Problem:
    """The problem of a variable that is no member of the component, as FMI 3's time is none."""
    return Problem(f"{element.name}.{variable.name}: only ports and parameters can be fused", hint=_PLAIN_ONLY)


def not_ours(element: Element, reason: str) -> Problem:
    """The problem of an FMU that cannot be built once more."""
    hint = _AGAIN if "version" in reason else _PLAIN_ONLY if "process" in reason else _FROM_SOURCE
    return Problem(f"{element.name}: the FMU {element.model.archive.name} {reason}, so it cannot be fused", hint=hint)
