"""``include: [other.yaml]``: sections of other files joined into this one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from dse.domain.expression import Piece
from dse.errors import DseError, Location, Problem, fail
from dse.loading.root import named_file, root_of
from dse.loading.yaml import Document, Path_, read_yaml, shown

T = TypeVar("T")

_DEEPEST = 20
_MOST = 200


def read_document(path: Path, inside: Path | None = None) -> Document:
    """Read *path* and what it includes, relative to the including file.

    Mappings at the top level are joined key by key, lists are appended; a key that stands in both files is
    a problem. Included files must lie in the folder *inside*, by default the workspace around *path*. Raises
    DseError, also when files include each other in a circle, too deeply or too often.
    """
    return _read(path.resolve(), (), inside or root_of(path), [])


def _read(path: Path, chain: tuple[Path, ...], inside: Path, seen: list[Path]) -> Document:
    document = read_yaml(path)
    seen.append(path)
    included = document.data.get("include")
    if included is None:
        return document
    if not isinstance(included, list) or not all(isinstance(entry, str) for entry in included):
        raise fail("'include' must be a list of files", document.place(("include",)), "include: [common.yaml]")
    data = {key: value for key, value in document.data.items() if key != "include"}
    marks = _Marks(dict(document.places), dict(document.keys), dict(document.pieces))
    problems: list[Problem] = []
    for number, entry in enumerate(included):
        where = document.place(("include", number))
        target = named_file(path.parent, entry, inside, (".yaml", ".yml"), where)
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
        problems += _join(data, marks, other)
    if problems:
        raise DseError(*problems)
    return Document(document.path, data, marks.places, marks.keys, marks.pieces)


@dataclass(frozen=True, slots=True)
class _Marks:
    """Where the values, keys and texts joined so far stand."""

    places: dict[Path_, Location]
    keys: dict[Path_, Location]
    pieces: dict[Path_, tuple[Piece, ...]]

    def take(self, other: Document, source: Path_, target: Path_) -> None:
        """Add what *other* says at and below *source* as that of *target*."""
        _copy(other.places, self.places, source, target)
        _copy(other.keys, self.keys, source, target)
        _copy(other.pieces, self.pieces, source, target)


def _at(problem: Problem, where: Location) -> Problem:
    if problem.where is None or (problem.where.line == 0 and problem.what == "no such file"):
        return Problem(f"included file {problem.where} does not exist", where, problem.hint)
    return problem


def _join(data: dict[str, Any], marks: _Marks, other: Document) -> list[Problem]:
    problems: list[Problem] = []
    for section, value in other.data.items():
        mine = data.get(section)
        if mine is None:
            data[section] = value
            marks.take(other, (section,), (section,))
        elif isinstance(mine, dict) and isinstance(value, dict):
            data[section] = dict(mine)
            for key, entry in value.items():
                if key in mine:
                    first = marks.keys[(section, key)]
                    problems.append(
                        Problem(
                            f"'{section}.{key}' stands in an including file too",
                            other.key((section, key)),
                            f"see {first}",
                        )
                    )
                    continue
                data[section][key] = entry
                marks.take(other, (section, key), (section, key))
        elif isinstance(mine, list) and isinstance(value, list):
            data[section] = mine + value
            for i in range(len(value)):
                marks.take(other, (section, i), (section, len(mine) + i))
        else:
            problems.append(
                Problem(
                    f"'{section}' stands in an including file too",
                    other.key((section,)),
                    f"see {marks.keys[(section,)]}",
                )
            )
    return problems


def _copy(theirs: Mapping[Path_, T], mine: dict[Path_, T], source: Path_, target: Path_) -> None:
    for path, mark in theirs.items():
        if path[: len(source)] == source:
            mine[target + path[len(source) :]] = mark
