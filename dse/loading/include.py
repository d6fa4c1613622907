"""``include: [other.yaml]``: sections of other files joined into this one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from dse.errors import DseError, Location, Problem, Problems, fail, raise_if_any
from dse.formats import Document, Entry, KeyPath, Mark, read_kept, shown
from dse.loading.paths import named_file

_DEEPEST = 20
_MOST = 200
_Marked = tuple[Mapping[str, Any], Mapping[str, Any]]  # a mapping and the marks of its entries


def read_document(path: Path, inside: Path) -> Entry:
    """All of *path* and of what it includes, relative to the including file.

    Sections at the top level are joined key by key, or appended if they are lists; so are the ``compound`` and the
    ``connections`` of a design's ``root``. Any other key that both files have is a problem. Included files must lie
    in the workspace *inside*. Raises DseError, also when files include each other in a circle, too deeply or too often.
    """
    return _read(path, (), inside, []).top


def _read(path: Path, chain: tuple[Path, ...], inside: Path, seen: list[Path]) -> Document:
    document = read_kept(path, inside)
    path = document.path
    seen.append(path)
    included = document.data.get("include")
    if included is None:
        return document
    entry = document.top["include"]
    if not isinstance(included, list) or not all(isinstance(name, str) for name in included):
        raise fail("'include' must be a list of files", entry.where, "include: [common.yaml]")
    joined = _without_include(document)
    problems = Problems()
    for number, name in enumerate(included):
        where = entry[number].where
        target = named_file(path.parent, name, inside, (".yaml", ".yml"), where)
        if target == path or target in chain:
            circle = " -> ".join(shown(p) for p in (*chain, path, target))
            raise fail(f"files include each other in a circle: {circle}", where, "remove one of the includes")
        if len(chain) >= _DEEPEST:
            raise fail(f"files include each other more than {_DEEPEST} deep", where, "include fewer files from here")
        if len(seen) > _MOST:
            raise fail(f"more than {_MOST} files are included", where, "join some of them")
        try:
            other = _read(target, (*chain, path), inside, seen)
        except DseError as error:
            raise DseError(*(_at(problem, where) for problem in error.problems)) from None
        joined = _join(joined, other, problems)
    raise_if_any(problems)
    return joined


def _without_include(document: Document) -> Document:
    line, column, marks = document.mark
    data = {key: value for key, value in document.data.items() if key != "include"}
    return replace(document, data=data, mark=[line, column, {key: marks[key] for key in data}])


def _at(problem: Problem, where: Location) -> Problem:
    if problem.where is None or (problem.where.line == 0 and problem.what == "no such file"):
        return Problem(f"included file {problem.where} does not exist", where, problem.hint)
    return problem


def _join(mine: Document, other: Document, problems: Problems) -> Document:
    """*mine* with what *other* says besides; what both say is added to *problems*."""
    pieces = {**mine.pieces}

    def twice(path: KeyPath) -> None:
        what = f"'{'.'.join(map(str, path))}' is defined in an including file too"
        problems.add(what, Entry(other, path).key, f"see {Entry(mine, path).key}")

    def take(source: KeyPath, target: KeyPath) -> None:
        found = {path: origin for path, origin in other.pieces.items() if path[: len(source)] == source}
        pieces.update({target + path[len(source) :]: origin for path, origin in found.items()})

    def join(path: KeyPath, ours: _Marked, theirs: _Marked, around: tuple[Mark, ...]) -> _Marked:
        """Two mappings at one *path*; *around* are the marks of what holds *theirs*."""
        data, marks = {**ours[0]}, {**ours[1]}
        for key, value in theirs[0].items():
            line, column, mark = theirs[1][key]
            own = data.get(key)
            below = (*path, key)
            if key not in data or (own is None and not path):
                data[key], marks[key] = value, [line, column, _of(other, mark, *around)]
                take(below, below)
            elif isinstance(own, list) and isinstance(value, list) and _is_joined(below):
                data[key] = own + value
                further = [_of(other, entry, mark, *around) for entry in mark[2]]
                marks[key] = _with(marks[key], marks[key][2][2] + further)
                for i in range(len(value)):
                    take((*below, i), (*below, len(own) + i))
            elif isinstance(own, dict) and isinstance(value, dict) and _is_joined(below):
                data[key], joined = join(below, (own, marks[key][2][2]), (value, mark[2]), (mark, *around))
                marks[key] = _with(marks[key], joined)
            else:
                twice(below)
        return data, marks

    data, marks = join((), (mine.data, mine.mark[2]), (other.data, other.mark[2]), ())
    return replace(mine, data=data, mark=[*mine.mark[:2], marks], pieces=pieces)


def _is_joined(path: KeyPath) -> bool:
    """Whether what two files say there goes together: sections, and in a design the parts and wires of the root."""
    return len(path) == 1 or path in (("root", "compound"), ("root", "connections"))


def _of(document: Document, mark: Mark, *around: Mark) -> Mark:
    """*mark*, which stands in *document*, for use in another one; *around* are the marks of what holds it."""
    file = next((found[3] for found in (mark, *around) if len(found) > 3), document.file)
    return [*mark[:2], mark[2] if len(mark) > 2 else None, file]


def _with(entry: list[Any], below: Any) -> list[Any]:
    """The *entry* of a section whose value holds what *below* marks instead."""
    line, column, mark = entry
    return [line, column, [*mark[:2], below, *mark[3:]]]
