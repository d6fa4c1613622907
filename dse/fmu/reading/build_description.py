"""Which sources of an FMU are compiled, and how: its buildDescription.xml, or the list in FMI 2.0's description."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from dse.errors import DseError, Location, Problem, fail
from dse.fmu.reading.description import Description
from dse.fmu.toolchain.platforms import this_platform
from dse.formats import XmlElement, read_xml_file, shortened

_FILE = "buildDescription.xml"
_STANDARDS = {
    "C": "gnu17",
    "C89": "gnu89",
    "C90": "gnu89",
    "C99": "gnu99",
    "C11": "gnu11",
    "C17": "gnu17",
    "C23": "gnu2x",
}
# Options name files and programs, too; only those that decide how C is read and translated are passed on.
_OPTION = re.compile(
    r"-(?:std=[a-z0-9:]+|O[0-3sgfast]*|D\w+(?:=[\w.+-]*)?|U\w+|W[\w=-]*|m[\w.=-]+|g\d?|pthread|pedantic|ansi|w|fPIC"
    r"|f(?!plugin|profile|dump|save)[\w-]+(?:=[\w.-]+)?)"
)
_LINKED = ("m", "pthread", "dl", "rt")
"""Libraries of the system, which need no path."""


@dataclass(frozen=True, slots=True)
class SourceFile:
    """One C file, by its path in ``sources/``, and the options it is compiled with."""

    path: str
    options: tuple[str, ...]
    where: Location


@dataclass(frozen=True, slots=True)
class Recipe:
    """How a library is made: its units, and the system's libraries it is linked with."""

    units: tuple[SourceFile, ...]
    libraries: tuple[str, ...] = ()


def has_recipe(folder: Path, description: Description) -> bool:
    """Whether the FMU in *folder* says which of its sources are to be compiled."""
    return description.version > 1 and (bool(description.source_files) or (folder / "sources" / _FILE).is_file())


def read_recipe(folder: Path, description: Description, name: str) -> Recipe:
    """How the FMU in *folder*, called *name*, says its library is made.

    Raises DseError: no C, options or libraries that are not known, or files that are not there.
    """
    problems: list[Problem] = []
    path = folder / "sources" / _FILE
    if path.is_file():
        root = read_xml_file(path, f"{name}/sources/{_FILE}")
        recipe = _from_build_description(root, description, problems)
    else:
        recipe = Recipe(tuple(SourceFile(file, (), description.where) for file in description.source_files))
    problems += _missing(folder / "sources", recipe.units)
    if problems:
        raise DseError(*problems)
    return recipe


def _from_build_description(root: XmlElement, description: Description, problems: list[Problem]) -> Recipe:
    if root.tag != "fmiBuildDescription":
        raise fail(f"its root is <{shortened(root.tag)}>, not <fmiBuildDescription>", root.where)
    platform = this_platform().name
    fitting = [
        one
        for one in root.all("BuildConfiguration")
        if one.get("modelIdentifier") == description.identifier and one.get("platform", platform) == platform
    ]
    if not fitting:
        raise fail(f"no <BuildConfiguration> makes '{description.identifier}' for {platform}", root.where)
    # One that is written for this platform knows more than one for all.
    chosen = next((one for one in fitting if "platform" in one.attributes), fitting[0])
    units = tuple(unit for group in chosen.all("SourceFileSet") for unit in _units(group, problems))
    if not units:
        problems.append(Problem(f"nothing is compiled for '{description.identifier}'", chosen.where))
    libraries = []
    for library in chosen.all("Library"):
        name = library.required("name", problems)
        if name in _LINKED:
            libraries.append(name)
        elif name:
            hint = "export the FMU with a library for this platform"
            problems.append(Problem(f"it is linked with '{name}', which is not supported", library.where, hint))
    return Recipe(units, tuple(libraries))


def _units(group: XmlElement, problems: list[Problem]) -> Iterator[SourceFile]:
    options = tuple(_options(group, problems))
    for file in group.all("SourceFile"):
        name = file.required("name", problems)
        if name:
            yield SourceFile(str(PurePosixPath(name)), options, file.where)


def _options(group: XmlElement, problems: list[Problem]) -> Iterator[str]:
    language = group.get("language").strip()
    if language and language not in _STANDARDS:
        what = f"sources in {shortened(language)} are not compiled, only those in C"
        problems.append(Problem(what, group.where, "export the FMU with a library for this platform"))
    elif language:
        yield f"-std={_STANDARDS[language]}"
    # Options of another compiler mean nothing to ours.
    if group.get("compiler").strip().lower() in ("", "gcc", "clang", "cc"):
        for option in group.get("compilerOptions").split():
            if not _OPTION.fullmatch(option):
                problems.append(Problem(f"the compiler option '{shortened(option)}' is not supported", group.where))
            yield option
    for definition in group.all("PreprocessorDefinition"):
        name = definition.required("name", problems)
        if definition.flag("optional", problems):
            continue
        if name and not re.fullmatch(r"[A-Za-z_]\w*(?:\([\w, ]*\))?", name):
            problems.append(Problem(f"'{shortened(name)}' cannot be defined", definition.where))
        value = definition.attributes.get("value")
        yield f"-D{name}" if value is None else f"-D{name}={value}"
    for include in group.all("IncludeDirectory"):
        name = include.required("name", problems)
        if name and not _is_inside(name):
            problems.append(Problem(f"the folder '{shortened(name)}' is not in sources/", include.where))
        yield f"-I{name}"


def _missing(sources: Path, units: Iterable[SourceFile]) -> Iterator[Problem]:
    for unit in units:
        name = shortened(unit.path)
        if not _is_inside(unit.path):
            yield Problem(f"the source file '{name}' is not in sources/", unit.where)
        elif not unit.path.endswith(".c"):
            hint = "export the FMU with a library for this platform"
            yield Problem(f"'{name}' is not compiled: only files in C are", unit.where, hint)
        elif not (sources / unit.path).is_file():
            yield Problem(f"there is no source file '{name}'", unit.where)


def _is_inside(name: str) -> bool:
    path = PurePosixPath(name)
    is_below = bool(path.parts) and not path.is_absolute() and ".." not in path.parts
    return is_below and not name.startswith("-") and "\\" not in name and ":" not in name
