"""A component written in C as an FMU: its files, the FMI functions and the C that ties them, compiled."""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_file
from dse.domain.component import Component, CSource
from dse.errors import DseError, Location, Problem
from dse.fmu.c.describe import Subject, describe, describe_sources, model_identifier
from dse.fmu.c.glue import Demand, glue, slot_rows
from dse.fmu.c.slots import slots
from dse.fmu.c.staging import LIST_IT, StagedSources, stage
from dse.fmu.slot_table import PARTNER, SLOT_TABLE, SlotTable
from dse.fmu.toolchain.compilation import LANGUAGE_OPTIONS, CompilationError, Diagnostic, compile_library, options
from dse.fmu.toolchain.compiler import Compiler, with_compiler
from dse.fmu.toolchain.platforms import this_platform
from dse.formats import pack_zip, shown


def build_c(component: Component, source: CSource, *, version: int, cache: Path | None = None) -> Path:
    """The FMU archive of *component*, for FMI *version* 2 or 3, from the C of *source*, or from the cache.

    The same files give the same bytes, wherever they lie. Raises DseError: the C does not compile or lacks a port, or
    there is no compiler.
    """
    staged = stage(component.name, source, component.where)
    contents, subject, demands = _contents(component, source, staged, version)
    platform = this_platform()
    library = platform.library(version, subject.identifier)

    def made(compiler: Compiler) -> Path:
        about = repr((compiler.identity, options(compiler), platform.name)).encode()
        key = content_key([*sorted(contents.items()), ("build", about)])
        target = cache_folder(cache) / "built" / f"{subject.identifier}-{key}.fmu"
        return keep_file(target, lambda: packed(compiler))

    def packed(compiler: Compiler) -> bytes:
        return pack_zip({**contents, str(library): _compile(compiler, contents, subject, library.name)})

    try:
        return with_compiler(cache, made)
    except CompilationError as error:
        raise DseError(*_problems(error, component, staged, demands)) from error


_RUNTIME = Path(__file__).parents[1] / "runtime"
_COMMON_FILES = ("slot.h", "instance.h", "c_component.h", "c_component_texts.h", "value.h")
_RUNTIME_FILES = {
    2: (*_COMMON_FILES, "c_component_osmp.h", "fmi2_abi.h", "fmi2.c"),
    3: (*_COMMON_FILES, "fmi3_abi.h", "fmi3_refused.h", "fmi3.c"),
}


def _contents(
    component: Component, source: CSource, staged: StagedSources, version: int
) -> tuple[dict[str, bytes], Subject, Mapping[int, Demand]]:
    """Every file of the FMU but its library, by path; the same for the same component on every machine."""
    variables = slots(component)
    user = {f"sources/component/{name}": content for name, content in staged.contents.items()}
    user[f"sources/{SLOT_TABLE}"] = SlotTable(f"component/{staged.header}", slot_rows(variables)).to_bytes()
    names: tuple[str, ...] = _RUNTIME_FILES[version]
    if source.partner:
        names = (*names, "partner.h")
        user |= {f"resources/{name}": content for name, content in source.resources}
        user[PARTNER] = source.partner.encode()
    if source.is_live:
        names = (*names, "datagram.h", "udp_told.h", "udp.h")
    if source.is_coded:
        names = (*names, "coded.h")
    runtime = {f"sources/runtime/{name}": (_RUNTIME / name).read_bytes() for name in names}
    # The token names the contents, so it is made from the contents without it; a mark is where it belongs.
    mark = content_key(sorted(user.items()))
    subject = Subject(
        name=component.name,
        identifier=model_identifier(component.name),
        title=component.title,
        token=mark,
        period=source.step,
        slots=variables,
        files=(f"runtime/fmi{version}.c", *(f"component/{unit}" for unit in staged.units)),
        include_folder=posixpath.dirname(f"component/{staged.header}"),
        has_state=not (source.partner or source.is_live or source.is_coded),
        needs_tool=source.is_live,
    )
    tied = glue(source, variables, f"../component/{staged.header}", mark)
    marked = {"sources/runtime/model.h": tied.text.encode(), "modelDescription.xml": describe(subject, version)}
    files = {**runtime, **user}
    if version == 3:
        told = describe_sources(subject.identifier, subject.files, subject.include_folder, LANGUAGE_OPTIONS)
        files["sources/buildDescription.xml"] = told

    def contents(token: str) -> dict[str, bytes]:
        return files | {name: text.replace(mark.encode(), token.encode()) for name, text in marked.items()}

    return contents("{" + content_key(sorted(contents("").items())) + "}"), subject, tied.demands


_SOURCES = "sources/"
_MODEL = "runtime/model.h"


def _compile(compiler: Compiler, contents: Mapping[str, bytes], subject: Subject, library: str) -> bytes:
    files = {name.removeprefix(_SOURCES): text for name, text in contents.items() if name.startswith(_SOURCES)}
    return compile_library(compiler, files, subject.files, subject.include_folder, library)


def _problems(
    error: CompilationError, component: Component, staged: StagedSources, demands: Mapping[int, Demand]
) -> list[Problem]:
    """What the compiler says, in the user's own files; only then what the component lacks; else all it said.

    Where a file uses a port that the struct lacks, that the struct lacks it is said instead.
    """
    own = [problem for diagnostic in error.diagnostics if (problem := _in_own_file(diagnostic, staged))]
    lines = sorted({diagnostic.line for diagnostic in error.diagnostics if diagnostic.file == _MODEL})
    unmet: dict[str, Problem] = {}
    for demand in (demands[line] for line in lines if line in demands):
        unmet.setdefault(demand.subject, demand.problem)
    if own:
        lacking = [each for member, each in unmet.items() if any(_names(problem.what, member) for problem in own)]
        names = [member for member, each in unmet.items() if each in lacking]
        others = [problem for problem in own if not any(_names(problem.what, member) for member in names)]
        return [*dict.fromkeys(lacking), *others]
    if "" in unmet:  # without the struct, nothing else can be told
        return [unmet[""]]
    if unmet:
        return list(dict.fromkeys(unmet.values()))
    return [Problem(f"component '{component.name}': {_diagnostic_text(d)}", component.where) for d in error.diagnostics]


def _names(message: str, member: str) -> bool:
    """Whether the compiler's *message* says that there is no *member*, of which it knows the last name."""
    return f"'{member.rpartition('.')[2]}'" in message and "no member" in message


def _in_own_file(diagnostic: Diagnostic, staged: StagedSources) -> Problem | None:
    origin = staged.origins.get(diagnostic.file.removeprefix("component/"))
    if origin is None or not diagnostic.file.startswith("component/"):
        return None
    is_missing_header = "No such file" in diagnostic.message or "file not found" in diagnostic.message
    hint = LIST_IT if is_missing_header else ""
    return Problem(diagnostic.message, Location(shown(origin), diagnostic.line, diagnostic.column), hint)


def _diagnostic_text(diagnostic: Diagnostic) -> str:
    return f"{diagnostic.file}:{diagnostic.line}: {diagnostic.message}" if diagnostic.file else diagnostic.message
