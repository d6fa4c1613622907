"""FMU archives are opened: unpacked into the cache, safely, and described."""

from __future__ import annotations

import errno
import hashlib
import re
import stat
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from dse.domain.fmu import FmuModel
from dse.errors import DseError, Location, Problem, fail
from dse.fmu.cache import cache_folder, keep_folder
from dse.fmu.description import Description, read_description
from dse.fmu.platforms import this_platform
from dse.loading.yaml import shown

_MAXIMUM_ENTRIES = 20_000
_MAXIMUM_BYTES = 4 * 2**30
# Deflate reaches 1032:1 on zeros, real files hardly 20:1; small entries may be anything.
_MAXIMUM_RATIO = 200
_SMALL_ENTRY = 16 * 2**20
_CHUNK = 2**20
_LONGEST_NAME = 200
_LONGEST_PATH = 1000
_RESERVED = re.compile(r"(?:con|prn|aux|nul|com[1-9]|lpt[1-9])(?:\..*)?|.*[. ]", re.IGNORECASE | re.DOTALL)
# What a file system says of a name it cannot hold; all else is the fault of the cache's folder.
_NAME_ERRORS = {errno.ENAMETOOLONG, errno.EINVAL, errno.EILSEQ, errno.ENOTDIR, errno.EISDIR, errno.EEXIST}


def open_fmu(archive: Path, *, cache: Path | None = None) -> FmuModel:
    """The FMU in *archive*, unpacked into the cache under its content's hash, ready to be loaded on this platform.

    Raises DseError located at *archive*: not a zip file, unsafe paths or sizes, no library for this platform, or
    a description that ``read_description`` refuses.
    """
    where = Location(shown(archive))
    digest = _digest(archive, where)
    target = cache_folder(cache) / "unpacked" / digest[:32]
    folder = keep_folder(target, lambda aside: _unpack(archive, aside, where))
    description = read_description(folder, where)
    return FmuModel(
        archive=archive,
        folder=folder,
        library=_library(folder, description, where),
        version=description.version,
        identifier=description.identifier,
        token=description.token,
        variables=description.variables,
        can_handle_variable_step=description.can_handle_variable_step,
        can_save_state=description.can_save_state,
        once_per_process=description.once_per_process,
        fixed_step=description.fixed_step,
        content_hash=digest,
    )


def _digest(archive: Path, where: Location) -> str:
    try:
        with archive.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except FileNotFoundError as error:
        raise fail("there is no such file", where) from error
    except OSError as error:
        raise fail(f"cannot be read: {(error.strerror or str(error)).lower()}", where) from error


def _unpack(archive: Path, folder: Path, where: Location) -> None:
    try:
        with zipfile.ZipFile(archive) as opened:
            entries = opened.infolist()
            problems = [Problem(f"refused as unsafe: {reason}", where) for reason in _dangers(entries)]
            if problems:
                raise DseError(*problems[:10])
            for entry in entries:
                try:
                    _extract(opened, entry, folder, where)
                except OSError as error:
                    if error.errno not in _NAME_ERRORS:
                        raise
                    reason = (error.strerror or str(error)).lower()
                    raise fail(f"'{entry.filename}' cannot be unpacked: {reason}", where) from error
    except (zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, EOFError, NotImplementedError, ValueError) as error:
        raise fail(f"is not a complete zip file: {error}", where, "export or copy the FMU again") from error


def _dangers(entries: list[zipfile.ZipInfo]) -> Iterator[str]:
    """Reasons not to unpack; names are looked at as the archive spells them."""
    if len(entries) > _MAXIMUM_ENTRIES:
        yield f"it holds {len(entries)} files, more than {_MAXIMUM_ENTRIES}"
    if sum(entry.file_size for entry in entries) > _MAXIMUM_BYTES:
        yield f"unpacked it is larger than {_MAXIMUM_BYTES // 2**30} GiB"
    # Paths as a file system sees them that ignores case.
    files: set[str] = set()
    folders: set[str] = set()
    for entry in entries:
        name = entry.orig_filename
        path = PurePosixPath(name)
        key, parents = str(path).casefold(), {str(parent).casefold() for parent in path.parents} - {"."}
        if "\\" in name or "\0" in name:
            yield f"the path {name!r} holds a character that is not portable"
        elif name.startswith("/") or re.match(r"[A-Za-z]:", name):
            yield f"the path '{name}' is absolute"
        elif ".." in path.parts:
            yield f"the path '{name}' leads out of the FMU"
        elif not path.parts:
            yield "a file has no name"
        elif any(len(part.encode("utf-8", "replace")) > _LONGEST_NAME for part in path.parts):
            yield f"the path '{name[:40]}…' holds a name of more than {_LONGEST_NAME} bytes"
        elif len(name) > _LONGEST_PATH:
            yield f"the path '{name[:40]}…' is longer than {_LONGEST_PATH} characters"
        elif any(_RESERVED.fullmatch(part) for part in path.parts):
            yield f"the path '{name}' holds a name that is reserved on Windows"
        elif key in files or parents & files or (key in folders and not entry.is_dir()):
            yield f"the path '{name}' is there twice"
        if stat.S_ISLNK(entry.external_attr >> 16):
            yield f"'{name}' is a link"
        if entry.flag_bits & 1:
            yield f"'{name}' is encrypted"
        if entry.file_size > max(_SMALL_ENTRY, _MAXIMUM_RATIO * entry.compress_size):
            yield f"'{name}' unpacks to more than {_MAXIMUM_RATIO} times its size"
        (folders if entry.is_dir() else files).add(key)
        folders |= parents


def _extract(opened: zipfile.ZipFile, entry: zipfile.ZipInfo, folder: Path, where: Location) -> None:
    target = folder.joinpath(*PurePosixPath(entry.filename).parts)
    if entry.is_dir():
        target.mkdir(parents=True, exist_ok=True)
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    written = 0
    with opened.open(entry) as source, target.open("xb") as file:
        while chunk := source.read(_CHUNK):
            written += len(chunk)
            if written > entry.file_size:
                raise fail(f"refused as unsafe: '{entry.filename}' is larger than it claims", where)
            file.write(chunk)


def _library(folder: Path, description: Description, where: Location) -> Path:
    platform = this_platform()
    for relative in platform.candidates(description.version, description.identifier):
        path = folder / relative
        if path.is_file():
            return path
    binaries = folder / "binaries"
    others = sorted(path.name for path in binaries.iterdir() if path.is_dir()) if binaries.is_dir() else []
    held = f"; it has libraries for {', '.join(others)}" if others else "; it has no libraries at all"
    raise fail(
        f"the FMU has no library '{description.identifier}{platform.suffix}' for this platform, {platform.name}{held}",
        where,
        "export it for this platform",
    )
