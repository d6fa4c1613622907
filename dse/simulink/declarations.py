"""What the header of a generated model declares, read by libclang: types, functions, variables and their comments.

Comments are the only place of a port's name (``'<Root>/speed'``), so the preprocessor's output would not do. libclang
is made for code that its user has written: here it reads in a process of its own, and what it found is kept.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any, TypeVar

from dse.cache import cache_folder, content_key, read_entry, try_to_put
from dse.errors import DseError, Location, Problem
from dse.formats import shown
from dse.simulink.libclang_process import asked, identity

T = TypeVar("T")


class Number(StrEnum):
    """What a number in C is for."""

    REAL = "real"
    INTEGER = "integer"
    BOOLEAN = "boolean"
    ENUMERATION = "enumeration"


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number; *name* as it is spelled. *low* and *high* are what it holds; *items* of an enumeration by value."""

    name: str
    number: Number
    low: int = 0
    high: int = 0
    items: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True, slots=True)
class Array:
    """*count* times *element*; -1 for an array of unknown length."""

    element: CType
    count: int


@dataclass(frozen=True, slots=True)
class Pointer:
    """To *target*; what a constant one points to is not written."""

    target: CType
    is_constant: bool = False


@dataclass(frozen=True, slots=True)
class Named:
    """A struct or a class, by its *name* in the table of records."""

    name: str


@dataclass(frozen=True, slots=True)
class Other:
    """What is none of these."""

    name: str


CType = Scalar | Array | Pointer | Named | Other


@dataclass(frozen=True, slots=True)
class Declared:
    """Something with a type: a field, a variable or an argument. *comment* is the one that follows it."""

    name: str
    type: CType
    comment: str = ""
    is_constant: bool = False
    file: str = ""


@dataclass(frozen=True, slots=True)
class Function:
    """*result* is None for void."""

    name: str
    arguments: tuple[Declared, ...]
    result: CType | None
    file: str = ""


@dataclass(frozen=True, slots=True)
class Record:
    """A struct or class; *size* in bytes, -1 if it is nowhere defined.

    *methods* are the public ones of a class, *statics* what all objects of it share.
    """

    name: str
    fields: tuple[Declared, ...]
    size: int
    methods: tuple[Function, ...] = ()
    statics: tuple[Declared, ...] = ()
    file: str = ""


@dataclass(frozen=True, slots=True)
class Declarations:
    """All that one header declares, with what it includes from the folders of the model."""

    functions: Mapping[str, Function] = field(default_factory=dict)
    variables: Mapping[str, Declared] = field(default_factory=dict)
    records: Mapping[str, Record] = field(default_factory=dict)

    def record(self, type_: CType) -> Record | None:
        """What a type is, if it is a struct or class."""
        return self.records.get(type_.name) if isinstance(type_, Named) else None


def declarations(
    headers: tuple[Path, ...], options: tuple[str, ...], folders: tuple[Path, ...], *, is_cpp: bool
) -> Declarations:
    """What *headers* declare when they are read one after the other with the *options* of a compiler.

    Of files outside of *folders* only types are taken. Raises DseError with what the parser says at file and line.
    """
    places = [_absolute(folder) for folder in folders]
    words = [f"-I{_absolute(word[2:])}" if word.startswith("-I") else word for word in options]
    words = [*(f"-I{_absolute(header.parent)}" for header in headers), *words]
    request = {"headers": [header.name for header in headers], "options": words, "folders": places, "is_cpp": is_cpp}
    looked_in = dict.fromkeys(word[2:] for word in words if word.startswith("-I"))
    own = {path: content for place in looked_in for path, content in _headers_in(Path(place))}
    about = json.dumps([identity(), request]).encode()
    target = cache_folder() / "declared" / content_key([("request", about), *sorted(own.items())])
    answer = _kept(target)
    if answer is None:
        answer = asked(request, Location(shown(headers[0])))
        if "wrong" in answer:
            raise DseError(*(_problem(headers[0], *each) for each in answer["wrong"]))
        others = [file for file in answer.pop("files") if file not in own]
        answer["others"] = {file: _digest(file) for file in others}
        try_to_put(target, json.dumps(answer).encode())
    return _read(answer)


def _absolute(path: Path | str) -> str:
    """From the root, by the links that are in it: so it is what the user knows."""
    return os.path.abspath(path)  # noqa: PTH100  # which would follow them


def _headers_in(folder: Path) -> Iterable[tuple[str, bytes]]:
    for path in folder.iterdir() if folder.is_dir() else ():
        if path.suffix in _HEADERS and path.is_file():
            yield str(path), path.read_bytes()


_HEADERS = (".h", ".hpp")


def _kept(target: Path) -> Any:
    """What was read before, unless another file of those it includes has changed since."""
    content = read_entry(target)
    if content is None:
        return None
    answer = json.loads(content)
    return answer if all(_digest(file) == digest for file, digest in answer["others"].items()) else None


def _digest(file: str) -> str:
    try:
        return content_key([("", Path(file).read_bytes())])
    except OSError:
        return ""


def _problem(header: Path, what: str, file: str, line: int, column: int) -> Problem:
    return Problem(what, Location(shown(Path(file)), line, column) if file else Location(shown(header)))


def _read(answer: Any) -> Declarations:
    types: list[CType] = []
    for kind, *about in answer["types"]:
        types.append(_type(kind, about, types))

    def declared(name: str, type_: int, *more: Any) -> Declared:
        return Declared(name, types[type_], *more)

    def function(name: str, arguments: Any, result: int | None, file: str) -> Function:
        return Function(name, _all(declared, arguments), None if result is None else types[result], file)

    def record(name: str, fields: Any, size: int, methods: Any, statics: Any, file: str) -> Record:
        return Record(name, _all(declared, fields), size, _all(function, methods), _all(declared, statics), file)

    return Declarations(
        {name: function(*about) for name, about in answer["functions"].items()},
        {name: declared(*about) for name, about in answer["variables"].items()},
        {name: record(*about) for name, about in answer["records"].items()},
    )


def _all(make: Callable[..., T], each: Any) -> tuple[T, ...]:
    return tuple(make(*about) for about in each)


def _type(kind: str, about: Any, types: list[CType]) -> CType:
    """A type as parsing.py describes it; those within are in *types* already."""
    match kind:
        case "scalar":
            name, number, low, high, items = about
            return Scalar(name, Number(number), low, high, tuple((item, value) for item, value in items))
        case "array":
            return Array(types[about[0]], about[1])
        case "pointer":
            return Pointer(types[about[0]], about[1])
        case "named":
            return Named(about[0])
        case _:
            return Other(about[0])
