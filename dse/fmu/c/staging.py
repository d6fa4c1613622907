"""The files of a C component, gathered so that nothing else can enter its build.

A compiler sees only what is listed here, and so the build's key, made of these bytes, misses nothing.
"""

from __future__ import annotations

import errno
import os
import posixpath
import re
import stat
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from dse.domain.component import CSource
from dse.errors import Location, Problem, fail, is_gone, raise_if_any, remedy
from dse.formats import shown


@dataclass(frozen=True, slots=True)
class StagedSources:
    """Contents by relative path, with forward slashes; *origins* are the user's own spellings of the paths."""

    contents: Mapping[str, bytes]
    origins: Mapping[str, Path]
    units: tuple[str, ...]
    header: str


def stage(name: str, source: CSource, where: Location | None) -> StagedSources:
    """The header, the listed files, and every header that lies in a folder of these.

    Paths are kept relative to the folder that holds them all, so ``#include "../common/x.h"`` finds what it found
    before. Raises DseError for what is missing or cannot be read, at *where* the component is defined.
    """
    listed = {_absolute(path): path for path in (*source.files, source.header)}
    raise_if_any(_problems(name, source, where))
    gathered = {**_headers_beside(listed), **listed}
    root = _common_folder(name, listed, where)
    contents, origins, problems = {}, {}, []
    for absolute, written in sorted(gathered.items()):
        relative = absolute.relative_to(root).as_posix()
        try:
            contents[relative] = _read(absolute)
        except OSError as error:
            problems.append(_unreadable(name, written, error, where))
        origins[relative] = written
    raise_if_any(problems)
    units = tuple(_absolute(path).relative_to(root).as_posix() for path in source.files if path.suffix == ".c")
    header = _absolute(source.header).relative_to(root).as_posix()
    raise_if_any(_outside_includes(contents, origins, posixpath.dirname(header)))
    return StagedSources(contents, origins, units, header)


def _absolute(path: Path) -> Path:
    # Not resolve(): a link stands for the file where the user put it.
    return Path(os.path.normpath(path.absolute()))


def _read(path: Path) -> bytes:
    # A device or a pipe may never end.
    if not stat.S_ISREG(path.stat().st_mode):
        raise OSError(errno.EINVAL, "it is not a regular file")
    with path.open("rb") as file:
        content = file.read(_MAX_BYTES + 1)
    if len(content) > _MAX_BYTES:
        raise OSError(errno.EFBIG, f"it is larger than {_MAX_BYTES // 1_000_000} million bytes")
    return content


def _headers_beside(listed: Mapping[Path, Path]) -> dict[Path, Path]:
    folders = {absolute.parent: written.parent for absolute, written in listed.items()}
    found = {}
    for absolute, written in folders.items():
        try:
            # A link beside could lead anywhere; what the build needs of it can be listed.
            headers = sorted(
                path for path in absolute.iterdir() if path.suffix == ".h" and path.is_file() and not path.is_symlink()
            )
        except OSError as error:
            if is_gone(error):
                continue  # the listed file in it is reported as unreadable
            raise
        found.update({path: written / path.name for path in headers if _NAME.fullmatch(path.name)})
    return found


def _common_folder(name: str, listed: Iterable[Path], where: Location | None) -> Path:
    try:
        return Path(os.path.commonpath([path.parent for path in listed]))
    except ValueError as error:
        raise fail(f"component '{name}': its C files are on different drives", where) from error


_MAX_BYTES = 10_000_000
_INCLUDE = re.compile(
    rb"^[ \t]*(?:#|%:|\?\?=)[ \t]*(?:include|embed|import)\w*[ \t]*(?P<named>[\"<][^\">\n]*)", re.MULTILINE
)


def _outside_includes(
    contents: Mapping[str, bytes], origins: Mapping[str, Path], header_folder: str
) -> Iterable[Problem]:
    """Includes that would find a file that is not staged, wherever this machine has one."""
    for relative, content in contents.items():
        for match in _INCLUDE.finditer(content):
            line_start = content.rfind(b"\n", 0, match.start("named")) + 1
            place = content.count(b"\n", 0, line_start) + 1, match.start("named") - line_start + 1
            name = match["named"][1:].decode("utf-8", "replace").replace("\\", "/")
            if name.startswith("/") or re.match(r"[A-Za-z]:", name):
                what = f"the include of '{name}' is an absolute path"
            elif _leads_out(name, (posixpath.dirname(relative), header_folder), contents):
                what = f"the include of '{name}' leads out of the component's files"
            else:
                continue
            yield Problem(what, Location(shown(origins[relative]), *place), LIST_IT)


def _leads_out(name: str, folders: tuple[str, str], contents: Mapping[str, bytes]) -> bool:
    """Whether the compiler, which looks for *name* in these *folders* in turn, would look above them all."""
    paths = [posixpath.normpath(posixpath.join(folder, name)) for folder in folders]
    return paths[0] not in contents and any(path.startswith("../") for path in paths)


LIST_IT = "list the header under the component's 'files'"
"""What to do about a header the build does not see."""

_NAME = re.compile(r"[^\"\\\x00-\x1f]+")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def _problems(name: str, source: CSource, where: Location | None) -> Iterable[Problem]:
    if not any(path.suffix == ".c" for path in source.files):
        yield Problem(f"component '{name}' lists no C file", where, "list the .c files under 'files'")
    for path in (*source.files, source.header):
        if path.suffix not in (".c", ".h"):
            yield Problem(f"component '{name}': {shown(path)} is no .c or .h file", where, "list only C files")
        if not _NAME.fullmatch(path.name):
            yield Problem(f"component '{name}': the file name {path.name!r} cannot be used in an #include", where)
    for word, text in (("struct", source.struct), ("init", source.init), ("step function", source.step_function)):
        if not _IDENTIFIER.fullmatch(text):
            yield Problem(f"component '{name}': the {word} '{text}' is not a name in C", where)
    if source.step is not None and not 0.0 < source.step < float("inf"):
        yield Problem(f"component '{name}': the step of {source.step} s is not positive", where)


def _unreadable(name: str, path: Path, error: OSError, where: Location | None) -> Problem:
    reason = "there is no such file" if isinstance(error, FileNotFoundError) else (error.strerror or str(error)).lower()
    hint = remedy(error.errno, "paths are relative to the component")
    return Problem(f"component '{name}': {shown(path)} cannot be read: {reason}", where, hint)
