"""A package is read: the variant that is asked for, and all it names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path, PurePosixPath

from dse.errors import DseError, Location, closest, fail, raise_if_any
from dse.formats import read_xml_file, shown
from dse.interchange.reading.common import Findings
from dse.interchange.reading.description import read_description
from dse.interchange.reading.package import DEFAULT, Package, open_package, variants
from dse.interchange.structure import SspSystem


def open_ssp(path: Path, into: Path, variant: str | None = None) -> SspSystem:
    """The system in the package *path* (``.ssp``, or ``.ssd`` in a folder that is one), packages unpacked below *into*.

    *variant* names one of its descriptions, by its file (``VariantB``, ``VariantB.ssd``) or by the name inside; the
    default is ``SystemStructure``. Raises DseError with all that is wrong with its files, each at its line.
    """
    found = Findings()
    package, default = open_package(path, into, found)
    names = _names(package)
    if not names:
        raise fail(f"there is no {DEFAULT}.ssd in it, so it is not an SSP package", Location(shown(path)))
    meant = _meant(names, variant or default)
    if meant is None:
        hint = closest(variant or default, names) if variant else f"name a variant: {', '.join(names)}"
        raise fail(f"it has no variant '{variant or default}'", Location(shown(path)), hint)
    ssp = read_description(package, PurePosixPath(f"{meant}.ssd"), found)
    raise_if_any(found.problems)
    notes, ignored = (tuple(dict.fromkeys(told)) for told in (found.notes, found.ignored))
    return replace(ssp, variants=names, notes=notes, ignored=ignored)


def _names(package: Package) -> dict[str, str]:
    """The variants by file name without suffix, with the names inside; "" for a file that cannot be read."""
    names: dict[str, str] = {}
    for file in variants(package):
        try:
            names[file.stem] = read_xml_file(package.folder / file, package.place(file), []).get("name")
        except DseError:
            # It is told of when it is asked for.
            names[file.stem] = ""
    return names


def _meant(names: dict[str, str], wanted: str) -> str | None:
    stem = wanted.removesuffix(".ssd")
    if stem in names:
        return stem
    inside = [file for file, name in names.items() if name == wanted]
    return inside[0] if len(inside) == 1 else None
