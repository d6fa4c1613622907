"""Zip archives: those from anywhere are unpacked safely, and our own are the same bytes for the same contents."""

from __future__ import annotations

import errno
import hashlib
import io
import os
import re
import stat
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath

from dse.cache import keep_folder
from dse.errors import DseError, Location, Problem, fail

_MAXIMUM_ENTRIES = 20_000
_MAXIMUM_BYTES = 4 * 2**30
# Deflate reaches 1032:1 on zeros, real files hardly 20:1; small entries may be anything.
_MAXIMUM_RATIO = 200
_SMALL_ENTRY = 16 * 2**20
_CHUNK = 2**20
_LONGEST_NAME = 200
_LONGEST_PATH = 1000
_RESERVED = re.compile(r"(?:con|prn|aux|nul|com[1-9]|lpt[1-9])(?:\..*)?|.*[. ]", re.IGNORECASE | re.DOTALL)
# What a file system says of a name it cannot hold; all else is the fault of the folder.
_NAME_ERRORS = {errno.ENAMETOOLONG, errno.EINVAL, errno.EILSEQ, errno.ENOTDIR, errno.EISDIR, errno.EEXIST}


_EARLIEST = (1980, 1, 1, 0, 0, 0)


def pack_zip(contents: Mapping[str, bytes]) -> bytes:
    """A zip archive of *contents* by path: sorted names, no clock, and stored plainly.

    Deflate would give other bytes with another zlib, and these files are small or compressed already.
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(contents):
            entry = zipfile.ZipInfo(name, _EARLIEST)
            entry.create_system = 3  # Unix, on every platform, so that the mode below is understood
            entry.external_attr = 0o100644 << 16
            archive.writestr(entry, contents[name])
    return buffer.getvalue()


def digest_of(archive: Path, where: Location) -> str:
    """SHA-256 of the file in hexadecimal digits. Raises DseError at *where*: no such file, or it cannot be read."""
    try:
        with archive.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except FileNotFoundError as error:
        raise fail("there is no such file", where) from error
    except OSError as error:
        raise fail(f"cannot be read: {(error.strerror or str(error)).lower()}", where) from error


def unpack_zip(archive: Path, folder: Path, where: Location, what: str) -> None:
    """Unpack *archive*, which is a *what* (``FMU``), into *folder*, which is there and empty.

    Raises DseError at *where*: no complete zip file, paths that lead elsewhere or are not portable, links, encrypted or
    doubled entries, or more and larger files than a real archive has. OSError if *folder* cannot be written.
    """
    try:
        with zipfile.ZipFile(archive) as opened:
            left_out = dict(_left_out(opened.infolist()))
            entries = [entry for entry in opened.infolist() if entry not in left_out]
            problems = [Problem(f"refused as unsafe: {reason}", where) for reason in _dangers(entries, what)]
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
        raise fail(f"is not a complete zip file: {error}", where, f"export or copy the {what} again") from error


def unpacked(archive: Path, into: Path, where: Location, what: str) -> Path:
    """The folder below *into* that holds what is in *archive*, named by its content and made only once.

    Several processes may ask at once. Raises DseError as `unpack_zip`, and if *into* cannot be written.
    """
    return keep_folder(into / digest_of(archive, where)[:32], lambda folder: unpack_zip(archive, folder, where, what))


def passed_over(archive: Path, where: Location) -> tuple[Problem, ...]:
    """What `unpack_zip`, which has unpacked *archive*, left out, and what another system could not have unpacked."""
    with zipfile.ZipFile(archive) as opened:
        entries = opened.infolist()
    told = [reason for _, reason in _left_out(entries)]
    told += [_reserved(_name(entry)) for entry in entries if _is_reserved(_name(entry))]
    odd = [entry.orig_filename for entry in entries if "\\" in entry.orig_filename]
    told += [f"paths are written with backslashes, as '{name}'" for name in odd[:1]]
    return tuple(Problem(reason, where) for reason in dict.fromkeys(told))


def _left_out(entries: list[zipfile.ZipInfo]) -> Iterator[tuple[zipfile.ZipInfo, str]]:
    """Entries that nothing needs, each with the reason; ``extra/`` is for other programs."""
    files: set[str] = set()
    for entry in entries:
        name = _name(entry)
        key = str(PurePosixPath(name)).casefold()
        if name == "./":
            yield entry, "the entry './' is not a file"
        elif key in files and key.startswith("extra/") and not name.endswith("/"):
            yield entry, f"the path '{name}' is there twice, the first is taken"
        elif not name.endswith("/"):
            files.add(key)


def _name(entry: zipfile.ZipInfo) -> str:
    """The path as a zip file has to spell it; some programs on Windows write backslashes."""
    return entry.orig_filename.replace("\\", "/")


def _is_reserved(name: str) -> bool:
    return any(_RESERVED.fullmatch(part) for part in PurePosixPath(name).parts if part != "..")


def _reserved(name: str) -> str:
    return f"the path '{name}' holds a name that is reserved on Windows"


def _dangers(entries: list[zipfile.ZipInfo], what: str) -> Iterator[str]:
    """Reasons not to unpack; names are looked at as the archive spells them."""
    if len(entries) > _MAXIMUM_ENTRIES:
        yield f"it holds {len(entries)} files, more than {_MAXIMUM_ENTRIES}"
    if sum(entry.file_size for entry in entries) > _MAXIMUM_BYTES:
        yield f"unpacked it is larger than {_MAXIMUM_BYTES // 2**30} GiB"
    # Paths as a file system sees them that ignores case.
    files: set[str] = set()
    folders: set[str] = set()
    for entry in entries:
        name = _name(entry)
        path, is_folder = PurePosixPath(name), name.endswith("/")  # not `is_dir`, which fails where there is no name
        key, parents = str(path).casefold(), {str(parent).casefold() for parent in path.parents} - {"."}
        if "\0" in name:
            yield f"the path {name!r} holds a character that is not portable"
        elif name.startswith("/") or re.match(r"[A-Za-z]:", name):
            yield f"the path '{name}' is absolute"
        elif ".." in path.parts:
            yield f"the path '{name}' leads out of the {what}"
        elif not path.parts:
            yield "a file has no name"
        elif any(len(part.encode("utf-8", "replace")) > _LONGEST_NAME for part in path.parts):
            yield f"the path '{name[:40]}…' holds a name of more than {_LONGEST_NAME} bytes"
        elif len(name) > _LONGEST_PATH:
            yield f"the path '{name[:40]}…' is longer than {_LONGEST_PATH} characters"
        elif os.name == "nt" and _is_reserved(name):
            yield _reserved(name)
        elif key in files or parents & files or (key in folders and not is_folder):
            yield f"the path '{name}' is there twice"
        if stat.S_ISLNK(entry.external_attr >> 16):
            yield f"'{name}' is a link"
        if entry.flag_bits & 1:
            yield f"'{name}' is encrypted"
        if entry.file_size > max(_SMALL_ENTRY, _MAXIMUM_RATIO * entry.compress_size):
            yield f"'{name}' unpacks to more than {_MAXIMUM_RATIO} times its size"
        (folders if is_folder else files).add(key)
        folders |= parents


def _extract(opened: zipfile.ZipFile, entry: zipfile.ZipInfo, folder: Path, where: Location) -> None:
    target = folder.joinpath(*PurePosixPath(_name(entry)).parts)
    if _name(entry).endswith("/"):
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
