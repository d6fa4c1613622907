"""FMU archives are opened: unpacked into the cache, safely, and described."""

from __future__ import annotations

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

_MAXIMUM_ENTRIES = 20_000
_MAXIMUM_BYTES = 4 * 2**30
# Deflate reaches 1032:1 on zeros, real files hardly 20:1; small entries may be anything.
_MAXIMUM_RATIO = 200
_SMALL_ENTRY = 16 * 2**20
_CHUNK = 2**20


def open_fmu(archive: Path, *, cache: Path | None = None) -> FmuModel:
    """The FMU in *archive*, unpacked into the cache under its content's hash, ready to be loaded on this platform.

    Raises DseError located at *archive*: not a zip file, unsafe paths or sizes, no library for this platform, or
    a description that ``read_description`` refuses.
    """
    where = Location(str(archive))
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
                _extract(opened, entry, folder, where)
    except (zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, EOFError, NotImplementedError, ValueError) as error:
        raise fail(f"is not a complete zip file: {error}", where, "export or copy the FMU again") from error


def _dangers(entries: list[zipfile.ZipInfo]) -> Iterator[str]:
    """Reasons not to unpack; names are looked at as the archive spells them."""
    if len(entries) > _MAXIMUM_ENTRIES:
        yield f"it holds {len(entries)} files, more than {_MAXIMUM_ENTRIES}"
    if sum(entry.file_size for entry in entries) > _MAXIMUM_BYTES:
        yield f"unpacked it is larger than {_MAXIMUM_BYTES // 2**30} GiB"
    seen: set[str] = set()
    for entry in entries:
        name = entry.orig_filename
        if "\\" in name or "\0" in name:
            yield f"the path {name!r} holds a character that is not portable"
        elif name.startswith("/") or re.match(r"[A-Za-z]:", name):
            yield f"the path '{name}' is absolute"
        elif ".." in PurePosixPath(name).parts:
            yield f"the path '{name}' leads out of the FMU"
        elif name in seen or any(str(parent) in seen for parent in PurePosixPath(name).parents):
            yield f"the path '{name}' is there twice"
        elif not PurePosixPath(name).parts:
            yield "a file has no name"
        if stat.S_ISLNK(entry.external_attr >> 16):
            yield f"'{name}' is a link"
        if entry.flag_bits & 1:
            yield f"'{name}' is encrypted"
        if entry.file_size > max(_SMALL_ENTRY, _MAXIMUM_RATIO * entry.compress_size):
            yield f"'{name}' unpacks to more than {_MAXIMUM_RATIO} times its size"
        seen.add(name)


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
