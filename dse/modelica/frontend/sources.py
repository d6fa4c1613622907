"""The Modelica files of a component, read once, so that what is compiled is what its key is made of."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from dse.errors import DseError, Location, Problem, fail, raise_if_any

FILES = "files"
"""The folder that compilers find the files of a model in."""
_MAX_BYTES = 20_000_000
_MOST_FILES = 5_000
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"  # The language allows it, the front-end does not.


@dataclass(frozen=True, slots=True)
class ModelSources:
    """A model by its full name, and the files it is made of.

    *contents* and *origins* (the user's own spelling of the path) are by relative path with forward slashes: a package
    folder keeps its name. *roots* are folders of libraries that are read where they are. *component* and *where* are
    for messages.
    """

    component: str
    model: str
    contents: Mapping[str, bytes]
    origins: Mapping[str, str]
    roots: tuple[Path, ...] = ()
    where: Location | None = None

    def lay_out(self, folder: Path, overlay: Mapping[str, bytes] | None = None) -> None:
        """Write all files to where a compiler in *folder* finds them, with the contents *overlay* in place of some."""
        (folder / FILES).mkdir(parents=True, exist_ok=True)
        for name, content in {**self.contents, **(overlay or {})}.items():
            target = folder / FILES / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)

    def spelled(self, path: str) -> str:
        """*path* of a compiler's message as the user spells it."""
        return self.origins.get(path.replace("\\", "/").removeprefix(f"{FILES}/"), path)


@dataclass(frozen=True, slots=True)
class SourceText:
    """One file as the front-end read it. *path* is spelled as the user does."""

    path: str
    text: str

    def location(self, offset: int) -> Location:
        """Line and column of the byte *offset* of the text in UTF-8; columns count characters."""
        content = self.text.encode()
        before = content[: max(offset, 0)].decode("utf-8", "replace")
        line_start = before.rfind("\n") + 1
        return Location(self.path, before.count("\n") + 1, len(before) - line_start + 1)


def read_sources(
    component: str, model: str, files: Iterable[Path], roots: Iterable[Path] = (), where: Location | None = None
) -> ModelSources:
    """Read *files*: Modelica files, or folders that hold a ``package.mo``.

    Raises DseError for what is missing, cannot be read, is no UTF-8, or has the name of another file.
    """
    contents: dict[str, bytes] = {}
    origins: dict[str, str] = {}
    problems: list[Problem] = []
    for listed in files:
        folder = listed.parent if listed.name == "package.mo" else listed
        try:
            found = list(_package(folder)) if folder.is_dir() else [(folder.name, folder)]
        except OSError as error:
            problems.append(_unreadable(component, folder, error, where))
            continue
        if not any(relative.endswith(".mo") for relative, _ in found):
            hint = "name a .mo file, or a folder with a package.mo"
            problems.append(Problem(f"component '{component}': {_shown(folder)} holds no Modelica", where, hint))
        for relative, path in found:
            if relative in contents:
                if origins[relative] != _shown(path):
                    what = f"component '{component}': {origins[relative]} and {_shown(path)} have the same name"
                    problems.append(Problem(what, where, "put them into packages of different names"))
                continue
            try:
                content = path.read_bytes() if path.stat().st_size <= _MAX_BYTES else None
                content = content.removeprefix(_BYTE_ORDER_MARK) if content is not None else None
            except OSError as error:
                problems.append(_unreadable(component, path, error, where))
                continue
            problem = _unfit(component, path, content)
            if problem is None and content is not None:
                contents[relative], origins[relative] = content, _shown(path)
            elif problem is not None:
                problems.append(problem)
    for root in roots:
        if not root.is_dir():
            what = f"component '{component}': there is no folder {_shown(root)} for Modelica libraries"
            problems.append(Problem(what, where, "correct 'modelica_path'"))
    raise_if_any(problems)
    if len(contents) > _MOST_FILES:
        what = f"component '{component}': more than {_MOST_FILES} Modelica files"
        raise fail(what, where, "name large libraries under 'modelica_path'")
    return ModelSources(component, model, contents, origins, tuple(roots), where)


def library_contents(sources: ModelSources) -> Iterator[tuple[str, bytes]]:
    """The Modelica files of the libraries by path below their folder, in a fixed order. Raises DseError."""
    for root in sources.roots:
        for path in sorted(root.rglob("*.mo")):
            try:
                yield path.relative_to(root).as_posix(), path.read_bytes()
            except OSError as error:
                raise DseError(_unreadable(sources.component, path, error, sources.where)) from error


def libraries(sources: ModelSources) -> list[str]:
    """Names of the top-level classes that may be among the files and libraries, sorted."""
    own = {name.split("/", maxsplit=1)[0].removesuffix(".mo") for name in sources.contents}
    found = {entry.name for root in sources.roots for entry in (root, *root.iterdir()) if _is_library(entry)}
    # A folder may be called "Modelica 4.0.0".
    return sorted({name.removesuffix(".mo").split(" ", maxsplit=1)[0] for name in own | found})


def _is_library(path: Path) -> bool:
    return (path / "package.mo").is_file() or path.suffix == ".mo"


def _package(folder: Path) -> Iterator[tuple[str, Path]]:
    """The package's files by path relative to the folder around it, in a fixed order."""
    if not (folder / "package.mo").is_file():
        return
    # A link could lead in a circle, so none to a folder is followed.
    for parent, folders, names in os.walk(folder):
        folders.sort()
        for name in sorted(names):
            if name.endswith(".mo") or name == "package.order":
                path = Path(parent) / name
                yield (Path(folder.resolve().name) / path.relative_to(folder)).as_posix(), path


def _unfit(component: str, path: Path, content: bytes | None) -> Problem | None:
    if content is None:
        return Problem(
            f"component '{component}': {_shown(path)} is larger than {_MAX_BYTES // 1_000_000} million bytes"
        )
    try:
        content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        return Problem("this is not UTF-8 text", Location(_shown(path), line, 1), "save the file as UTF-8")
    return None


def _unreadable(component: str, path: Path, error: OSError, where: Location | None) -> Problem:
    reason = "there is no such file" if isinstance(error, FileNotFoundError) else (error.strerror or str(error)).lower()
    what = f"component '{component}': {_shown(path)} cannot be read: {reason}"
    return Problem(what, where, "paths are relative to the component")


def _shown(path: Path) -> str:
    from dse.formats import shown

    return shown(path)
