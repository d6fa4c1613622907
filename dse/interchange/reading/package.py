"""Packages are opened: unpacked safely, and every file that one of them names is found inside."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

from dse.errors import Location, fail
from dse.formats.xml import XmlElement, read_xml_file
from dse.formats.xml_values import shortened
from dse.formats.yaml import shown
from dse.formats.zipped import unpacked
from dse.loading.paths import is_file

DEFAULT = "SystemStructure"
"""The variant that is meant if none is named."""


@dataclass(frozen=True, slots=True)
class Package:
    """The files of a package below *folder*; *called* is how its places begin, *into* takes unpacked packages in it."""

    folder: Path
    called: str
    into: Path

    def place(self, file: PurePosixPath) -> str:
        """How the package's file *file* is called in messages."""
        return f"{self.called}/{file}" if self.called != "." else str(file)


@dataclass(frozen=True, slots=True)
class Target:
    """What a URI in a package leads to; *fragment* is what stands behind its ``#``."""

    file: PurePosixPath
    path: Path
    fragment: str


def open_package(path: Path, into: Path) -> tuple[Package, str]:
    """The package at *path*, unpacked below *into*, and the variant its name asks for.

    A ``.ssd`` file is a variant of a package that has been unpacked already: the folder it lies in. Raises DseError.
    """
    where = Location(shown(path))
    if not is_file(path):
        raise fail("there is no such file", where)
    if path.suffix.lower() == ".ssd":
        return Package(path.parent.resolve(), shown(path.parent), into), path.stem
    return Package(unpacked(path, into, where, "package").resolve(), shown(path), into), DEFAULT


def variants(package: Package) -> Iterator[PurePosixPath]:
    """The files of all variants of the package, the default one first."""
    names = sorted(path.name for path in package.folder.iterdir() if path.suffix == ".ssd" and is_file(path))
    default = f"{DEFAULT}.ssd"
    yield from (PurePosixPath(name) for name in sorted(names, key=lambda name: (name != default, name)))


def follow(package: Package, base: PurePosixPath, uri: str, where: Location) -> Target:
    """What *uri* leads to, as it stands in the package's file *base*.

    Raises DseError, at *where*: a scheme (``http:``), a path that is absolute or leads out of the package, or no file.
    """
    text, _, fragment = uri.partition("#")
    name = unquote(text)
    if re.match(r"[A-Za-z][A-Za-z0-9+.\-]*:", name):
        what = f"'{shortened(uri)}' is not in the package"
        raise fail(what, where, "only files that lie in the package are read; put it into resources/")
    if name.startswith("/") or "\\" in name or "\0" in name:
        raise fail(f"'{shortened(uri)}' is no relative path", where, "as resources/part.fmu")
    file = base
    if name:
        parts: list[str] = list(base.parent.parts)
        for part in PurePosixPath(name).parts:
            if part != "..":
                parts.append(part)
            elif parts:
                parts.pop()
            else:
                raise fail(f"'{shortened(uri)}' leads out of the package", where, "put the file into resources/")
        file = PurePosixPath(*parts)
    path = (package.folder / file).resolve()
    if not path.is_relative_to(package.folder):
        raise fail(f"'{shortened(uri)}' leads out of the package", where, "put the file into resources/")
    if not is_file(path):
        raise fail(f"there is no file '{shortened(str(file))}' in the package", where, _alike(package, file))
    return Target(file, path, unquote(fragment))


def read_file(package: Package, target: Target) -> XmlElement:
    """The root of an XML file of the package. Raises DseError."""
    return read_xml_file(target.path, package.place(target.file))


def _alike(package: Package, file: PurePosixPath) -> str:
    folder = package.folder / file.parent
    names = sorted(p.name for p in folder.iterdir() if p.suffix == file.suffix) if folder.is_dir() else []
    return f"there are {', '.join(names[:8])}" if names else ""
