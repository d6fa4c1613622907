"""FMUs in processes of their own on Linux: a bridge in the place of their library, and a host for each instance."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from dse.cache import cache_folder, content_key, keep_folder
from dse.domain.fmu import FmuModel, Host, Special
from dse.errors import Location, fail
from dse.fmu.toolchain.compilation import CompilationError, compile_library, compile_program, options
from dse.fmu.toolchain.compiler import Compiler, with_compiler
from dse.fmu.toolchain.platforms import this_platform
from dse.fmu.windows import bridge_of, bridge_sources

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
