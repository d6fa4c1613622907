"""FMU archives are opened: unpacked into the cache, safely, described, and compiled if they hold sources only."""

from __future__ import annotations

import re
import sys
from dataclasses import fields, replace
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_folder
from dse.domain.component import Component
from dse.domain.fmu import FmiInterface, FmuModel, Host, Special
from dse.errors import DseError, Location, Problem, fail
from dse.fmu.reading.build_description import has_recipe
from dse.fmu.reading.description import Description, read_description
from dse.fmu.slot_table import LIVE, PARTNER
from dse.fmu.source_build import build_from_sources
from dse.fmu.toolchain.compilation import CompilationError, compile_library, compile_program, options
from dse.fmu.toolchain.compiler import Compiler, with_compiler
from dse.fmu.toolchain.platforms import this_platform
from dse.fmu.windows import bridge_of, bridge_sources, bridge_to, needed_for_wine, windows_library
from dse.formats import digest_of, passed_over, shown, unpack_zip

# FMUs in processes of their own on Linux: a bridge in the place of their library, and a host for each instance.


_LIBRARIES = ("-Wl,--no-as-needed", "-lm", "-ldl", "-lpthread")
"""What Python's process has, too: many FMUs use the mathematical library without naming it."""


def isolated(model: FmuModel, where: Location, cache: Path | None) -> FmuModel:
    """*model* with a process of its own for each instance, so that there may be several of any FMU.

    Raises DseError located at *where* if that cannot be.
    """
    if why := _not_possible(model):
        raise fail(f"{model.identifier}: it cannot be isolated: {why}", where, "leave out 'isolate'")
    try:
        made = with_compiler(cache, lambda compiler: _compiled(compiler, cache))
    except CompilationError as error:
        raise fail(f"the host for isolated FMUs does not compile: {error.diagnostics[0].message}", where) from error
    bridge = bridge_of(model.library, model.identifier, made, cache)
    host = Host((str((made / "host").absolute()), str(model.library.absolute())))
    able = replace(model.capabilities, once_per_process=False)
    return replace(model, library=bridge, host=host, capabilities=able, special=model.special | {Special.ISOLATED})


def _not_possible(model: FmuModel) -> str:
    if not this_platform().name.endswith("-linux"):
        return f"that is supported on Linux only, and this is {this_platform().name}"
    if model.version == 1:
        return "that is supported for FMI 2.0 and 3.0 only"
    return "it has another process already" if model.host.command else ""


def _compiled(compiler: Compiler, cache: Path | None) -> Path:
    """The folder with the bridge and the host."""
    files = bridge_sources()
    identity = repr(("isolation", compiler.identity, options(compiler), _LIBRARIES))

    def fill(folder: Path) -> None:
        bridge = compile_library(compiler, files, ["bridge.c"], ".", "bridge.so")
        (folder / "bridge.so").write_bytes(bridge)
        (folder / "host").write_bytes(compile_program(compiler, files, "host.c", "host", *_LIBRARIES))
        (folder / "host").chmod(0o755)

    key = content_key([*files.items(), ("build", identity.encode())])
    return keep_folder(cache_folder(cache) / "bridges" / key, fill)


def open_fmu(archive: Path, *, cache: Path | None = None, interface: FmiInterface | None = None) -> FmuModel:
    """The FMU in *archive*, unpacked into the cache under its content's hash, ready to be loaded on this platform.

    *interface* is the one that is asked for; without, co-simulation comes before model exchange, unless only that of
    model exchange has a library here. An FMU that has no library for this platform but its sources is compiled, once.
    Raises DseError located at *archive* or in a file of
    it: not a zip file, unsafe paths or sizes, no library and no sources that compile, or a description that
    ``read_description`` refuses.
    """
    where = Location(shown(archive))
    digest = digest_of(archive, where)
    target = cache_folder(cache) / "unpacked" / digest[:32]
    folder = keep_folder(target, lambda aside: unpack_zip(archive, aside, where, "FMU"))
    description = read_description(folder, where.file, interface=interface)
    if interface is None and not _is_here(folder, description):
        description = _of_exchange(folder, where) or description
    # What is told of an FMU has the names it has in a model.
    told = {f.name: getattr(description, f.name) for f in fields(FmuModel) if hasattr(description, f.name)}
    library, host, unused = _library(folder, description, where, cache)
    told["ignored"] = (*passed_over(archive, where), *description.ignored, *unused)
    told["is_live"] = (folder / LIVE).is_file()
    return FmuModel(archive=archive, folder=folder, library=library, host=host, content_hash=digest, **told)


def open_component(component: Component, archive: Path, *, cache: Path | None = None) -> FmuModel:
    """The FMU in *archive*, which was built of *component*, to be simulated as its source asks for, if it does.

    What is wrong with that is told where it is asked for.
    """
    model = _of_component(component, archive, cache)
    for special, where in (component.source.special if component.source else {}).items():
        model = _WAYS[Special(special)](model, where, cache)
    return model


def _without_events(model: FmuModel, where: Location, _: Path | None) -> FmuModel:
    if not model.ticks:
        what = "the FMU has no event mode that could be off"
        raise fail(
            f"{model.identifier}: {what}", where, "leave out 'event_mode': co-simulation of FMI 3.0 alone has one"
        )
    able = replace(model.capabilities, has_event_mode=False)
    return replace(model, capabilities=able, special=model.special | {Special.NO_EVENT_MODE})


_WAYS = {Special.NO_EVENT_MODE: _without_events, Special.ISOLATED: isolated}


def _of_component(component: Component, archive: Path, cache: Path | None) -> FmuModel:
    asked = component.source and component.source.interface
    if not asked:
        return open_fmu(archive, cache=cache)
    try:
        return open_fmu(archive, cache=cache, interface=FmiInterface(asked[0]))
    except DseError as error:
        problems = (f"component '{component.name}': {p.where}: {p.what}" for p in error.problems)
        hint = "leave out 'interface' for the one that the FMU has"
        raise DseError(*(Problem(what, asked[1] or component.where, hint) for what in problems)) from error


def _of_exchange(folder: Path, where: Location) -> Description | None:
    """The description for model exchange if it has a library here; what is wrong with it otherwise is of no concern."""
    try:
        description = read_description(folder, where.file, interface=FmiInterface.MODEL_EXCHANGE)
    except DseError:
        return None
    return description if _is_here(folder, description) else None


def _is_here(folder: Path, description: Description) -> bool:
    here = _libraries(folder, description) or has_recipe(folder, description)
    return bool(here or windows_library(folder, description))


def _libraries(folder: Path, description: Description) -> list[Path]:
    paths = [folder / path for path in this_platform().candidates(description.version, description.identifier)]
    return [path for path in paths if path.is_file()]


def _library(
    folder: Path, description: Description, where: Location, cache: Path | None
) -> tuple[Path, Host, tuple[Problem, ...]]:
    """The library, the host that it needs, and what is wrong with the sources that it is used instead of."""
    platform = this_platform()
    for path in _libraries(folder, description):
        return path, _partner(folder, where), ()
    unused: tuple[Problem, ...] = ()
    for_windows = windows_library(folder, description)
    if has_recipe(folder, description):
        try:
            return build_from_sources(folder, description, where.file, cache), _partner(folder, where), ()
        except DseError as error:
            if not for_windows:
                raise
            unused = error.problems
    if for_windows:
        return *bridge_to(for_windows, description.identifier, where, cache), unused
    raise fail(
        f"the FMU has no library '{description.identifier}{platform.suffix}' for this platform, {platform.name}; "
        f"{_held(folder, description)}",
        where,
        f"export it for this platform, or with its sources{needed_for_wine(folder, description)}",
    )


def _partner(folder: Path, where: Location) -> Host:
    """The process that does the work of an FMU that names a module of dse for it (dse/fmu/runtime/partner.h)."""
    named = folder / PARTNER
    if not named.is_file():
        return Host()
    module = named.read_text("utf-8", "replace")
    if not re.fullmatch(r"dse(\.[a-z_]+)+", module, re.ASCII):
        raise fail(f"'{module[:80]}' in {PARTNER} is not a module of dse", where, "build the FMU again")
    return Host((sys.executable, "-P", "-m", module, str((folder / PARTNER).parent.absolute())))


def _held(folder: Path, description: Description) -> str:
    """What an FMU has instead of the library it should have."""
    platform = this_platform()
    for relative in platform.candidates(description.version, description.identifier):
        beside = sorted(path.name for path in (folder / relative.parent).glob(f"*{platform.suffix}"))
        if beside:
            return f"its folder {relative.parent} holds {', '.join(beside)}"
    binaries = folder / "binaries"
    others = sorted(path.name for path in binaries.iterdir() if path.is_dir()) if binaries.is_dir() else []
    held = f"it has libraries for {', '.join(others)}" if others else "it has no libraries at all"
    if (folder / "sources").is_dir():
        held += ", and does not declare which of its sources are to be compiled"
    return held
