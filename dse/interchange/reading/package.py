"""Packages are opened: unpacked safely, and every file that one of them names is found inside."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

from dse.errors import Location, fail
from dse.formats import XmlElement, passed_over, read_xml_file, shortened, shown, unpacked
from dse.interchange.reading.common import Findings, own_elements
from dse.loading import is_file

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


def open_package(path: Path, into: Path, found: Findings) -> tuple[Package, str]:
    """The package at *path*, unpacked below *into*, and the variant its name asks for.

    A ``.ssd`` file is a variant of a package that has been unpacked already: the folder it lies in. What is passed over
    goes to *found*. Raises DseError.
    """
    where = Location(shown(path))
    if not is_file(path):
        raise fail("there is no such file", where)
    if path.suffix.lower() == ".ssd":
        return Package(path.parent.resolve(), shown(path.parent), into), path.stem
    folder = unpacked(path, into, where, "package").resolve()
    found.ignored += passed_over(path, where)
    return Package(folder, shown(path), into), DEFAULT


def variants(package: Package) -> Iterator[PurePosixPath]:
    """The files of all variants of the package, the default one first."""
    names = sorted(path.name for path in package.folder.iterdir() if path.suffix == ".ssd" and is_file(path))
    default = f"{DEFAULT}.ssd"
    yield from (PurePosixPath(name) for name in sorted(names, key=lambda name: (name != default, name)))


@dataclass(frozen=True, slots=True)
class PackageFile:
    """The file *name* of a package, in which URIs of others may stand."""

    package: Package
    name: PurePosixPath

    def follow(self, uri: str, where: Location) -> Target:
        """What *uri* leads to.

        Raises DseError, at *where*: a scheme (``http:``), a path that is absolute or leads out of the package, or no
        file.
        """
        text, _, fragment = uri.partition("#")
        name = unquote(text)
        if re.match(r"[A-Za-z][A-Za-z0-9+.\-]*:", name):
            what = f"'{shortened(uri)}' is not in the package"
            raise fail(what, where, "only files inside the package are read; put it into resources/")
        if name.startswith("/") or "\\" in name or "\0" in name:
            raise fail(f"'{shortened(uri)}' is not a relative path", where, "as resources/part.fmu")
        file = PurePosixPath(posixpath.normpath(self.name.parent / name)) if name else self.name
        folder = self.package.folder
        path = (folder / file).resolve()
        if ".." in file.parts or not path.is_relative_to(folder):
            raise fail(f"'{shortened(uri)}' leads out of the package", where, "put the file into resources/")
        if not is_file(path):
            raise fail(f"there is no file '{shortened(str(file))}' in the package", where, _alike(self.package, file))
        return Target(file, path, unquote(fragment))

    def read(self, uri: str, where: Location, found: Findings) -> XmlElement:
        """The root of the XML file that *uri* leads to, without what is of others. Raises DseError."""
        target = self.follow(uri, where)
        return own_elements(read_xml_file(target.path, self.package.place(target.file), found.ignored), found)


def _alike(package: Package, file: PurePosixPath) -> str:
    folder = package.folder / file.parent
    names = sorted(p.name for p in folder.iterdir() if p.suffix == file.suffix) if folder.is_dir() else []
    return f"there are {', '.join(names[:8])}" if names else ""
