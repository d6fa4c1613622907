"""One run of the compiler: staged C files in, a shared library or located problems out."""

from __future__ import annotations

import posixpath
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from dse.errors import fail
from dse.fmu.parallel import in_parallel
from dse.fmu.toolchain.compiler import WEB, Compiler, environment, no_compiler
from dse.scratch import ScratchFolder

# No contraction: a*b+c rounds twice everywhere, so results do not depend on the processor's instructions.
LANGUAGE_OPTIONS = ("-std=c11", "-O2", "-ffp-contract=off")
"""Options that decide what the numbers are; whoever compiles the embedded sources should use them too."""

# No errno: it is never looked at, and without it square roots are one instruction. Values stay the same.
MODEL_OPTIONS = ("-fno-math-errno",)
"""Further options for the C that is made from Modelica."""

# A clock in the binary would make two builds differ; the rest are mistakes that C would let through.
_CHECKS = ("date-time", "implicit-function-declaration", "incompatible-pointer-types", "int-conversion", "return-type")

_LONGEST = 900
"""Seconds after which a compiler is stopped."""

_MOST_MEMORY = 4 * 1024**2
"""KiB that it may have for a unit of other people's code."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """An error the compiler reports. *file* is relative to the staged folder; "" if it is the linker's."""

    file: str
    line: int
    column: int
    message: str


class CompilationError(Exception):
    """The compiler refused; *diagnostics* is never empty. *units* are those that did not compile, if any was told."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...], units: tuple[str, ...] = ()) -> None:
        super().__init__(diagnostics)
        self.diagnostics = diagnostics
        self.units = units


def options(compiler: Compiler) -> tuple[str, ...]:
    """All options but the names of files. They belong in the cache key."""
    return (*_compile_options(compiler), *_link_options(compiler))


def _compile_options(compiler: Compiler) -> tuple[str, ...]:
    checks = (f"-Werror={check}" for check in _CHECKS)
    common = (*LANGUAGE_OPTIONS, "-fvisibility=hidden", *checks)
    return common if compiler.system in ("win32", WEB) else (*common, "-fPIC")


def _link_options(compiler: Compiler) -> tuple[str, ...]:
    common = ("-shared", *compiler.link_options)
    if compiler.system == "win32":
        return (*common, "-s")
    # Without "defs", a function that is nowhere defined would only be missed when the FMU is loaded.
    return common if compiler.system == "darwin" else (*common, "-s", "-Wl,-z,defs")


def compile_library(
    compiler: Compiler,
    files: Mapping[str, bytes],
    units: Iterable[str],
    include_folder: str,
    library: str,
    extra: Iterable[str] = (),
) -> bytes:
    """The shared library *library* made of *units*, which see no other files than *files* and the system's headers.

    *extra* are further options. Same input, same bytes: paths are relative. Raises CompilationError.
    """
    arguments = [*options(compiler), *extra, f"-I{include_folder}", *units]
    return _made(compiler, files, arguments, library, _libraries(compiler))


def compile_object(compiler: Compiler, files: Mapping[str, bytes], unit: str, extra: Iterable[str] = ()) -> bytes:
    """The object file of *unit*, which sees no other files than *files* and the system's headers.

    *extra* are further options. Same input, same bytes: paths are relative. Raises CompilationError.
    """
    return _made(compiler, files, [*_compile_options(compiler), *extra, "-c", unit], "unit.o", ())


def compile_assembly(compiler: Compiler, files: Mapping[str, bytes], unit: str, extra: Iterable[str] = ()) -> str:
    """The assembler text of *unit*, not optimized: to see which names it defines. Raises CompilationError."""
    made = _made(compiler, files, [*_compile_options(compiler), *extra, "-O0", "-S", unit], "unit.s", ())
    return made.decode("utf-8", "replace")


def link_library(compiler: Compiler, objects: Mapping[str, bytes], library: str) -> bytes:
    """The shared library *library* made of *objects* by file name. Raises CompilationError."""
    return _made(compiler, objects, [*_link_options(compiler), *objects], library, _libraries(compiler))


def link_module(compiler: Compiler, objects: Mapping[str, bytes]) -> bytes:
    """A WebAssembly module of *objects* by file name, which exports what web.h offers a page. CompilationError."""
    exports = (f"-Wl,--export=dse_web_{name}" for name in ("begin", "go", "starts", "rows", "said", "step"))
    return _made(
        compiler, objects, ["-mexec-model=reactor", "-s", "-Wl,--gc-sections", *exports, *objects], "m.wasm", ()
    )


def compile_program(compiler: Compiler, files: Mapping[str, bytes], unit: str, program: str, *extra: str) -> bytes:
    """The program *program* made of *unit*, which sees no other files than *files*, with the options *extra* behind it.

    Raises CompilationError.
    """
    arguments = [*LANGUAGE_OPTIONS, "-s", *compiler.link_options, unit, *extra]
    return _made(compiler, files, arguments, program, ())


def compile_foreign(
    compiler: Compiler,
    folder: Path,
    units: Mapping[str, tuple[str, ...]],
    libraries: Iterable[str],
    library: str,
    *,
    link: Iterable[str] = (),
) -> bytes:
    """The shared library *library* made of other people's *units* (paths in *folder*), each with its own options.

    *libraries* are linked besides the mathematical one, with the options *link*. Same input, same bytes: paths are
    relative. Raises CompilationError with the diagnostics of all units.
    """
    common = (*_FOREIGN_OPTIONS, *(() if compiler.system == "win32" else ("-fPIC",)))
    linked = (*_libraries(compiler), *(f"-l{name}" for name in libraries))
    with _scratch() as scratch:
        objects = {f"{number}.o": unit for number, unit in enumerate(units)}

        def compile_unit(made: str) -> tuple[Diagnostic, ...]:
            target, unit = scratch / made, objects[made]
            arguments = (*common, *units[unit], "-c", unit, "-o", str(target))
            answer = _run(compiler, arguments, folder, is_foreign=True)
            if answer.returncode == 0 and target.is_file():
                return ()
            return tuple(replace(each, file=each.file or unit) for each in _reported(answer))

        told = in_parallel(objects, compile_unit)
        problems = dict.fromkeys(one for each in told.values() for one in each)
        if problems:
            raise CompilationError(tuple(problems), tuple(objects[made] for made, each in told.items() if each))
        answer = _run(compiler, (*_link_foreign(compiler), *link, *objects, "-o", library, *linked), scratch)
        return _product(scratch / library, answer)


# No contraction, as for our own. What they leave to the system's headers, GNU's C knows.
_FOREIGN_OPTIONS = ("-w", "-std=gnu17", "-O2", "-ffp-contract=off")


def foreign_options(compiler: Compiler) -> tuple[str, ...]:
    """What ``compile_foreign`` adds to a unit's own options, and what it links with. They belong in the cache key."""
    return (*_FOREIGN_OPTIONS, *_link_foreign(compiler))


def _link_foreign(compiler: Compiler) -> tuple[str, ...]:
    """A function of an FMU must not be replaced by one of the same name elsewhere in the process."""
    own = _link_options(compiler)
    return own if compiler.system in ("win32", "darwin") else (*own, "-Wl,-Bsymbolic")


def _libraries(compiler: Compiler) -> tuple[str, ...]:
    return () if compiler.system == "win32" else ("-lm",)


def _made(
    compiler: Compiler, files: Mapping[str, bytes], arguments: Iterable[str], product: str, libraries: Iterable[str]
) -> bytes:
    with _scratch() as scratch:
        folder = scratch / "sources"
        for name, content in files.items():
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
        answer = _run(compiler, (*arguments, "-o", f"../{product}", *libraries), folder)
        return _product(scratch / product, answer)


def _product(made: Path, answer: subprocess.CompletedProcess[str]) -> bytes:
    if answer.returncode == 0 and made.is_file():
        return made.read_bytes()
    raise CompilationError(_reported(answer))


@contextmanager
def _scratch() -> Iterator[Path]:
    """A temporary folder. What fails as somebody else empties it is no fault of what is compiled."""
    with ScratchFolder() as name:
        mark = Path(name, "mark")
        mark.touch()
        try:
            yield Path(name)
        except (OSError, CompilationError) as error:
            if mark.exists():
                if isinstance(error, OSError) and error.filename is None:  # of writing what is open
                    error.filename = name
                raise
            what = f"{tempfile.gettempdir()}: the compiler's temporary folder was emptied while it was in use"
            raise fail(what, hint="set TMPDIR to a folder that is left alone") from error


def _run(
    compiler: Compiler, arguments: Iterable[str], folder: Path, *, is_foreign: bool = False
) -> subprocess.CompletedProcess[str]:
    if not compiler.command:
        raise no_compiler()
    command = [*compiler.command, *arguments]
    if is_foreign and sys.platform != "win32":
        # A few macros can stand for more than the machine holds, which macOS does not limit. What the compiler has
        # started would go on when it is stopped itself.
        limits = f"ulimit -v {_MOST_MEMORY} 2> /dev/null; ulimit -t {_LONGEST} 2> /dev/null"
        command = ["/bin/sh", "-c", f'{limits}; exec "$0" "$@"', *command]
    try:
        return subprocess.run(
            command,
            cwd=folder,
            env={**environment(), "TMPDIR": str(folder)},  # what it leaves there if it is killed goes with the folder
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            encoding="utf-8",
            errors="replace",
            timeout=_LONGEST,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, 1, "", f"it took longer than {_LONGEST} s")


def _reported(answer: subprocess.CompletedProcess[str]) -> tuple[Diagnostic, ...]:
    return tuple(_diagnostics(answer.stderr or answer.stdout))


_LOCATED = re.compile(r"^(?P<file>[^\s:][^:]*):(?P<line>\d+):(?:(?P<column>\d+):)? (?:fatal )?error: (?P<message>.*)$")
_UNDEFINED = re.compile(r"undefined (?:reference to|symbol:?) [`'\"]?(?P<name>[A-Za-z_]\w*)")
_TWICE = re.compile(r"(?:multiple definition of|duplicate symbol:?) [`'\"]?(?P<name>[A-Za-z_]\w*)")
_ADVICE = re.compile(r"Please submit a full bug report|See <(?:file|http)")
_FLAG = re.compile(r" \[-W[^\]]*\]$")


def _diagnostics(text: str) -> list[Diagnostic]:
    found = []
    for line in text.splitlines():
        if match := _LOCATED.match(line):
            file = posixpath.normpath(match["file"].replace("\\", "/"))
            message = _FLAG.sub("", match["message"])
            found.append(Diagnostic(file, int(match["line"]), int(match["column"] or 0), message))
    if found:
        return list(dict.fromkeys(found))
    for pattern, message in ((_UNDEFINED, "'{}' is called but not defined"), (_TWICE, "'{}' is defined twice")):
        names = dict.fromkeys(match["name"] for match in pattern.finditer(text))
        found += [Diagnostic("", 0, 0, message.format(name)) for name in names]
    return found or [Diagnostic("", 0, 0, "the compiler failed: " + _last_lines(text))]


def _last_lines(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip() and not _ADVICE.match(line)]
    return "; ".join(lines[-3:]) or "it printed nothing"
