"""FMU archives that are broken before anything in them is called."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

from reference_fmus.build import write_archive

from zoo.animals import ANIMALS, build_animal

XML = "modelDescription.xml"


def _files(good: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(good) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _with_xml(change: Callable[[str], str]) -> Callable[[Path, Path], None]:
    def build(good: Path, path: Path) -> None:
        files = _files(good)
        write_archive(path, {**files, XML: change(files[XML].decode()).encode()})

    return build


def _climbs_out(good: Path, path: Path) -> None:
    write_archive(path, {**_files(good), "../../../evil": b"evil"})


def _is_absolute(good: Path, path: Path) -> None:
    write_archive(path, {**_files(good), "/tmp/evil": b"evil"})  # noqa: S108  # it is what must not be written


def _is_a_link(good: Path, path: Path) -> None:
    write_archive(path, _files(good))
    link = zipfile.ZipInfo("resources")
    link.external_attr = 0o120777 << 16
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(link, "/etc")


def _has_another_platforms_binary(good: Path, path: Path) -> None:
    files = _files(good)
    write_archive(path, {XML: files[XML], "binaries/win32/animal.dll": b"MZ"})


def _is_a_bomb(good: Path, path: Path) -> None:
    write_archive(path, {**_files(good), "resources/zeros": bytes(1 << 28)})


def _entities(xml: str) -> str:
    lines = ['<!ENTITY a0 "ha">', *(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 10))]
    return xml.replace("<fmiModel", f"<!DOCTYPE fmi [{''.join(lines)}]>\n<fmiModel", 1).replace(
        'modelName="animal"', 'modelName="&a9;"'
    )


BAD_ARCHIVES: Mapping[str, tuple[Callable[[Path, Path], object], str]] = {
    "truncated": (lambda good, path: path.write_bytes(good.read_bytes()[:2000]), "zip"),
    "empty": (lambda _, path: path.write_bytes(b""), "zip"),
    "a_text": (lambda _, path: path.write_text("this is no archive"), "zip"),
    "climbs_out": (_climbs_out, "evil"),
    "absolute": (_is_absolute, "evil"),
    "is_a_link": (_is_a_link, "link"),
    "without_description": (
        lambda good, path: write_archive(path, {k: x for k, x in _files(good).items() if k != XML}),
        XML,
    ),
    "without_binary": (_has_another_platforms_binary, "win32"),
    "cut_xml": (_with_xml(lambda xml: xml[: len(xml) // 2]), f"{XML}:"),
    "entity_bomb": (_with_xml(_entities), f"{XML}:"),
    "external_entity": (
        _with_xml(
            lambda xml: xml.replace("<fmiModel", '<!DOCTYPE f [<!ENTITY x SYSTEM "/etc/passwd">]>\n<fmiModel', 1)
        ),
        f"{XML}:",
    ),
    "another_version": (_with_xml(lambda xml: xml.replace('fmiVersion="2.0"', 'fmiVersion="7.0"')), "7.0"),
    "names_twice": (_with_xml(lambda xml: xml.replace('name="gain"', 'name="bites"')), "bites"),
    "climbing_identifier": (
        _with_xml(lambda xml: xml.replace('modelIdentifier="animal"', 'modelIdentifier="../../animal"')),
        "modelIdentifier",
    ),
    "decompression_bomb": (_is_a_bomb, "zeros"),
}
"""By name: what builds it of a good archive, and a piece of what must be said of it."""


def build_bad(name: str, folder: Path) -> Path:
    """``NAME.fmu`` in *folder*."""
    good = folder / "tame.fmu"
    if not good.exists():
        build_animal(ANIMALS["tame"], folder, "tame")
    BAD_ARCHIVES[name][0](good, folder / f"{name}.fmu")
    return folder / f"{name}.fmu"
