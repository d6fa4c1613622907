"""The Modelica files of a component, read once, so that what is compiled is what its key is made of."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from dse.errors import DseError, Location, Problem, fail, raise_if_any
from dse.modelica.frontend.jumps import without_jumps
from dse.modelica.frontend.library_functions import with_random, with_tables
from dse.modelica.frontend.library_names import distinct
from dse.modelica.frontend.other_words import counted
from dse.modelica.frontend.source_text import SourceText, changed
from dse.modelica.frontend.used_classes import reached

FILES, LIBRARIES = "files", "libraries"
"""The folders that compilers find the files of a model in, and the parts of libraries."""
_MAX_BYTES = 20_000_000
_MOST_FILES = 5_000
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"  # The language allows it, the front-end does not.


@dataclass(frozen=True, slots=True)
class ModelSources:
    """A model by its full name, and the files it is made of.

    *contents* and *origins* (the user's own spelling of the path) are by relative path with forward slashes: a package
    folder keeps its name. *roots* are folders of libraries, and *parts* the files in them that contain classes the
    model may use, with blanks in place of all others. *component* and *where* are for messages.
    """

    component: str
    model: str
    contents: Mapping[str, bytes]
    origins: Mapping[str, str]
    roots: tuple[Path, ...] = ()
    where: Location | None = None
    parts: Mapping[str, bytes] = field(default_factory=dict)

    def lay_out(self, folder: Path, overlay: Mapping[str, bytes] | None = None) -> None:
        """Write all files to where a compiler in *folder* finds them, with the contents *overlay* in place of some."""
        _lay_out(folder / FILES, {**self.contents, **(overlay or {})})

    def lay_out_parts(self, folder: Path) -> None:
        """Write the parts of the libraries below *folder*."""
        _lay_out(folder / LIBRARIES, self.parts)

    def spelled(self, path: str) -> str:
        """*path* of a compiler's message as the user spells it."""
        relative = path.replace("\\", "/").removeprefix(f"{FILES}/").removeprefix(f"../{LIBRARIES}/")
        return self.origins.get(relative, path)


def _lay_out(folder: Path, contents: Mapping[str, bytes]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)


Keep = Callable[[Sequence[tuple[str, bytes]], Callable[[], bytes]], bytes]
"""Gives what was made of the same named contents before, or makes it."""


def read_sources(
    component: str,
    model: str,
    files: Iterable[Path],
    roots: Iterable[Path] = (),
    where: Location | None = None,
    keep: Keep = lambda _, make: make(),
) -> ModelSources:
    """Read *files*: Modelica files, or folders that hold a ``package.mo``. *keep* keeps the parts of libraries.

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
                contents[relative], origins[relative] = _content(component, path, where), _shown(path)
            except DseError as error:
                problems += error.problems
    for root in roots:
        if not root.is_dir():
            what = f"component '{component}': there is no folder {_shown(root)} for Modelica libraries"
            problems.append(Problem(what, where, "correct 'modelica_path'"))
    raise_if_any(problems)
    if len(contents) > _MOST_FILES:
        what = f"component '{component}': more than {_MOST_FILES} Modelica files"
        raise fail(what, where, "name large libraries under 'modelica_path'")
    sources = ModelSources(component, model, contents, origins, tuple(roots), where)
    return _accepted(_with_parts(sources, keep) if sources.roots else sources)


def _accepted(sources: ModelSources) -> ModelSources:
    """*sources* without what the front-end refuses though the same can be written in other words."""
    contents, parts = (
        counted(files, {**sources.parts, **sources.contents}) for files in (sources.contents, sources.parts)
    )
    contents = changed(without_jumps(contents), with_random)
    return replace(sources, contents=contents, parts=without_jumps(parts))


def _with_parts(sources: ModelSources, keep: Keep) -> ModelSources:
    """*sources* with the parts of the libraries that the model may use. Raises DseError."""
    found = [(name, path, content) for name, path, content in _library_files(sources) if name not in sources.contents]
    files = {name: (path, content) for name, path, content in reversed(found)}  # the first of a name counts
    own = sorted(sources.contents.items())
    library = [(name, content) for name, (_, content) in sorted(files.items())]

    def made() -> bytes:
        texts = [SourceText(name, with_random(_text(content))) for name, content in (*own, *library)]
        used = reached(texts, sources.model)
        parts = [replace(text, text=with_tables(text.text)) for text in used if text.path in files]
        named = distinct(parts, [text for text in used if text.path not in files])
        return json.dumps({text.path: [text.text, origin] for text, origin in named}).encode()

    asked = [("model", sources.model.encode()), ("own", str(len(own)).encode()), *own, *library]
    found_parts = json.loads(keep(asked, made))
    parts = {name: text.encode() for name, (text, _) in found_parts.items()}
    origins = {name: _shown(files[origin][0]) for name, (_, origin) in found_parts.items()}
    return replace(sources, parts=parts, origins={**sources.origins, **origins})


def _text(content: bytes) -> str:
    return content.removeprefix(_BYTE_ORDER_MARK).decode("utf-8", "replace")


def library_contents(sources: ModelSources) -> Iterator[tuple[str, bytes]]:
    """The Modelica files of the libraries by path below their folder, in a fixed order. Raises DseError."""
    return ((name, content) for name, _, content in _library_files(sources))


def _library_files(sources: ModelSources) -> Iterator[tuple[str, Path, bytes]]:
    for root in sources.roots:
        # A root may be the folder of a package itself.
        base = root.resolve().parent if (root / "package.mo").is_file() else root
        top = root.resolve() if base is not root else root
        for path in sorted(path for path in top.rglob("*.mo") if _is_in_packages(path.parent, top)):
            try:
                yield path.relative_to(base).as_posix(), path, path.read_bytes()
            except OSError as error:
                raise DseError(_unreadable(sources.component, path, error, sources.where)) from error


def _is_in_packages(folder: Path, top: Path) -> bool:
    """Whether *folder* is *top* or a package in packages: no other folder belongs to a library."""
    return folder == top or ((folder / "package.mo").is_file() and _is_in_packages(folder.parent, top))


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


def _content(component: str, path: Path, where: Location | None) -> bytes:
    """What is in the file. Raises DseError: it is too large, is no UTF-8, or cannot be read."""
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise fail(
                f"component '{component}': {_shown(path)} is larger than {_MAX_BYTES // 1_000_000} million bytes"
            )
        content = path.read_bytes().removeprefix(_BYTE_ORDER_MARK)
        content.decode("utf-8")
    except OSError as error:
        raise DseError(_unreadable(component, path, error, where)) from error
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise fail("this is not UTF-8 text", Location(_shown(path), line, 1), "save the file as UTF-8") from error
    return content


def _unreadable(component: str, path: Path, error: OSError, where: Location | None) -> Problem:
    reason = "there is no such file" if isinstance(error, FileNotFoundError) else (error.strerror or str(error)).lower()
    what = f"component '{component}': {_shown(path)} cannot be read: {reason}"
    return Problem(what, where, "paths are relative to the component")


def _shown(path: Path) -> str:
    from dse.formats import shown

    return shown(path)
