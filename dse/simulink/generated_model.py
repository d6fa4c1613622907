"""A generated model from its folder: read, and compiled into a library that can be loaded any number of times."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType

from dse.cache import cache_folder, content_key, keep_content
from dse.errors import DseError, Location, Problem, fail
from dse.fmu import (
    CompilationError,
    Compiler,
    Diagnostic,
    compile_foreign,
    find_compiler,
    foreign_options,
    with_compiler,
)
from dse.formats import shown
from dse.scratch import ScratchFolder
from dse.simulink.classes import class_of, read_class
from dse.simulink.declarations import Declarations, declarations
from dse.simulink.folder import CoderFolder, read_folder
from dse.simulink.functions import read_interface
from dse.simulink.glue import CodedModel, glue
from dse.simulink.timing import timing

_HEADERS = Path(__file__).parent / "headers"
_HERE, _OURS, _GLUE = "model", "headers", "glue"

# As the coder's own makefiles compile: overflow wraps, memory may be read as another type.
_OPTIONS = ("-fwrapv", "-fno-strict-aliasing", "-fvisibility=hidden", "-ffunction-sections", "-fdata-sections", "-DRT")
_SIXTEEN = re.compile(r"#if \(\s*UINT_MAX\s*!=\s*\(0xFFFFU\)|typedef\s+(?:signed )?long(?:\s+int)?\s+int32_T")
_THIRTY_TWO = re.compile(r"ULONG_MAX\s*!=\s*\(0xFFFFFFFFU?L?\)")
_MOST_TOLD = 5


def read_model(
    path: Path,
    name: str = "",
    *,
    step: float | None = None,
    rates: Mapping[str, float] = MappingProxyType({}),
    sources: tuple[Path, ...] = (),
) -> CodedModel:
    """The model *name* in the folder at *path*, or the one there is. *step* (s) is believed where it is given.

    *rates* has that (s) for each function, by name, of code with one for each rate.
    *sources* are files and folders of the user's that belong to it. Raises DseError: it is none, it needs what only
    MathWorks has, or nothing tells its step.
    """
    folder = read_folder(path, name, sources)
    where = Location(shown(folder.path / folder.header))
    known = _declared(folder)
    kind = class_of(known, folder.model, where) if folder.is_cpp else None
    try:
        made = (
            read_class(known, kind) if kind else read_interface(known, folder.model, folder.header, folder.code, where)
        )
    except DseError as error:
        raise DseError(*(replace(each, where=each.where or where) for each in error.problems)) from None
    if "rtmIsSampleHit(" in folder.code and re.search(r"define rtmIsSampleHit\(.{0,200}sampleHits", folder.own_text):
        raise fail("a main program that is not here determines when its rates run", where, "generate it for ert.tlc")
    if _SIXTEEN.search(_types(folder)):
        made.warnings.append("it was generated for integers of 16 bits: here they are computed with 32")
    if not made.inputs and not made.outputs:
        made.warnings.append("it has no ports at its top: nothing can be connected to it")
    steps = list(made.steps)
    told = timing(
        path, folder.own_text, folder.main, steps, is_rated=made.is_rated, given=step, rates=rates, where=where
    )
    if told.is_only_commented:
        said = f"that it steps every {told.step:g} s is only in {told.source}"
        if not made.is_rated:  # it may be the comment of a slower block
            hint = f"set the model's step, if that is right: step: {told.step:g} s (import: --step)"
            raise fail(said, where, hint)
        made.warnings.append(f"{said}: if so, set it: step: {told.step:g} s")
    model = CodedModel(folder, made, told, kind.name if kind else "")
    if model.integrates and not made.solver:
        made.warnings.append("its solver was not found: outputs are those of its last minor step")
    return model


def _declared(folder: CoderFolder) -> Declarations:
    language = ("-x", "c++", "-std=c++14") if folder.is_cpp else ("-x", "c", "-std=gnu11")
    # The compiler's own headers use what only it knows.
    foreign = [f"-D_{name}MMINTRIN_H_INCLUDED" for name in ("X", "E", "P", "T", "S", "I", "A", "W")]
    included = [f"-I{place.as_posix()}" for place in (folder.path, *folder.places.values())]
    options = (*language, *_sizes(folder), *included, "-idirafter", str(_HEADERS), "-DRT", *foreign)
    system = tuple(word for place in _system_folders(find_compiler(), folder.is_cpp) for word in ("-isystem", place))
    headers = tuple(folder.path / name for name in folder.headers)
    try:
        return declarations(headers, (*options, *system), (folder.path,), is_cpp=folder.is_cpp)
    except DseError as error:
        raise DseError(*(_proprietary(each) for each in error.problems)) from None


@lru_cache(maxsize=8)
def _system_folders(compiler: Compiler, is_cpp: bool) -> tuple[str, ...]:
    """Where a compiler finds the headers of the system."""
    command = [*compiler.command, "-E", "-v", "-x", "c++" if is_cpp else "c", "-"]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, timeout=60)
    return tuple(re.findall(r"^ (/\S+)$", done.stderr, re.MULTILINE))


_MISSING = re.compile(r"'([^']+)' file not found|(\S+): No such file or directory")
_OF_OTHERS = (
    (re.compile(r"simstruc|fixedpoint|matrix\.h|mex\.h"), "S-functions, which MATLAB runs"),
    (re.compile(r"nesl_|pm_|ssc_|mc_|sm_"), "Simscape's run-time library"),
    (re.compile(r"ros/|slros|rclcpp"), "ROS"),
    (re.compile(r"ext_mode|ext_share|ext_test|xil"), "external mode"),
    (re.compile(r"xpc|rtwtarget|sldrt"), "Simulink Real-Time"),
    (re.compile(r"windows\.h|winsock"), "Windows"),
    (re.compile(r"coder_posix_time|cudnn|tmwutil|HostLib|vip\w+_rt|dsp\w+_rt"), "a run-time library of MATLAB"),
    (re.compile(r"MW_|mw_|c2000|F28|codertarget|Arduino|arduino|stm32|brtenv|main\.h|v4l2"), "drivers of a board"),
)


_GENERATED = re.compile(
    r"_(?:types|private|data)\.h$|^rt_(?:nonfinite|defines|zcfcn)|^rtGet|^multiword_types|^complex_types"
)


def _proprietary(problem: Problem) -> Problem:
    found = _MISSING.search(problem.what)
    header = (found[1] or found[2]) if found else ""
    if not header:
        return problem
    needs = next((what for pattern, what in _OF_OTHERS if pattern.search(header)), "")
    what = f"the code includes '{header}', which is not in the folder" + (f": it needs {needs}" if needs else "")
    if _GENERATED.search(header):
        return Problem(what, problem.where, "take all that was generated: this folder, and slprj beside it")
    return Problem(
        what,
        problem.where,
        "add it to the folder, or name where it is: sources: [...]" if not needs else "generate the model without that",
    )


def _sizes(folder: CoderFolder) -> tuple[str, ...]:
    """Options that make checks of word sizes pass that are not those of this machine."""
    return ("-include", "limits_of_32_bits.h") if _THIRTY_TWO.search(_types(folder)) else ()


def _types(folder: CoderFolder) -> str:
    """Where the coder defines its types and checks the sizes of words."""
    every = {**folder.texts, **folder.further}
    return "\n".join([folder.own_text, *(text for name, text in every.items() if name.endswith("rtwtypes.h"))])


def build_library(model: CodedModel, *, cache: Path | None = None) -> bytes:
    """The model as a shared library with the functions of dse/fmu/runtime/coded.h.

    Same input, same bytes. Files that are no part of the model and do not compile here are left out. Raises DseError
    with what the compiler says in the user's own files.
    """
    folder = model.folder
    files = dict(_files(model))
    units = [*(f"{_HERE}/{name}" for name in folder.units), f"{_OURS}/nothing.c"]
    suffix = ".cpp" if folder.is_cpp else ".c"
    needed = {f"{_GLUE}{suffix}", f"{_HERE}/{folder.source}"}
    needed |= {unit for unit in units if unit.startswith(f"{_HERE}/sources/")}

    def made(compiler: Compiler) -> bytes:
        about = repr((compiler.identity, foreign_options(compiler), _OPTIONS, units, folder.model)).encode()
        key = content_key([*sorted(files.items()), ("build", about)])
        return keep_content(cache_folder(cache) / "coded" / key, lambda: compiled(compiler))

    def compiled(compiler: Compiler) -> bytes:
        with ScratchFolder() as scratch:
            for path, content in files.items():
                (Path(scratch) / path).parent.mkdir(parents=True, exist_ok=True)
                (Path(scratch) / path).write_bytes(content)
            wanted = [*units, f"{_GLUE}{suffix}"]
            left_out: tuple[Diagnostic, ...] = ()
            while True:
                try:
                    told = {unit: _unit_options(folder, unit, compiler) for unit in wanted}
                    libraries = ("stdc++",) if any(unit.endswith(".cpp") for unit in wanted) else ()
                    return compile_foreign(compiler, Path(scratch), told, libraries, "model.so", link=_link())
                except CompilationError as error:
                    hopeless = set(error.units) - needed
                    if not hopeless:
                        # What is not there may have been in what was left out.
                        raise CompilationError((*error.diagnostics, *left_out), error.units) from error
                    left_out += tuple(each for each in error.diagnostics if each not in left_out)
                    wanted = [unit for unit in wanted if unit not in hopeless]

    try:
        return with_compiler(cache, made)
    except CompilationError as error:
        raise DseError(*_problems(error, folder)) from error


def _files(model: CodedModel) -> Iterator[tuple[str, bytes]]:
    suffix = ".cpp" if model.folder.is_cpp else ".c"
    yield f"{_GLUE}{suffix}", glue(model).encode()
    for name, text in {**model.folder.texts, **model.folder.further}.items():
        yield f"{_HERE}/{name}", text.encode()
    for path in sorted(_HEADERS.iterdir()):
        if path.suffix in (".h", ".c"):
            yield f"{_OURS}/{path.name}", path.read_bytes()


def _unit_options(folder: CoderFolder, unit: str, compiler: Compiler) -> tuple[str, ...]:
    # What gcc makes unique in a process would never be unloaded; clang makes nothing so, and does not know the option.
    unique = ("-fno-gnu-unique",) if "gcc version" in compiler.identity else ()
    language = (
        ("-x", "c++", "-std=gnu++14", "-fno-access-control", *unique) if unit.endswith(".cpp") else ("-std=gnu11",)
    )
    included = [f"-I{_HERE}", *(f"-I{_HERE}/{place}" for place in folder.places)]
    return (*language, *_OPTIONS, *_sizes(folder), f"-DMODEL={folder.model}", *included, "-idirafter", _OURS)


def _link() -> tuple[str, ...]:
    # What nobody calls may want what is not there: the tasks of a target, drivers.
    return ("-Wl,-dead_strip",) if sys.platform == "darwin" else ("-Wl,--gc-sections", "-Wl,-z,now")


def _problems(error: CompilationError, folder: CoderFolder) -> list[Problem]:
    found: list[Problem] = []
    for each in error.diagnostics[:_MOST_TOLD]:
        file = each.file.removeprefix(f"{_HERE}/")
        inside = file in folder.texts or file in folder.further
        where = Location(shown(folder.file(file)), each.line, each.column) if inside else Location(shown(folder.path))
        found.append(_proprietary(Problem(each.message, where)))
    return found
