"""YAML 1.2 text → plain data in which every key and value knows its place.

The text is composed into nodes and turned into plain Python here, so that no constructor of any tag ever
runs: what is not a string, number, truth value, null, list or mapping is refused.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dse.domain.expression import Piece
from dse.errors import DseError, Location, Problem, fail, remedy
from dse.formats.compose import MOST_LEVELS, UNSAFE, compose, unsafe, visible
from dse.formats.scalars import content_start, pieces, place_in

KeyPath = tuple[str | int, ...]
"""Way from the top of a document to a value: mapping keys and list indices."""

_MAX_BYTES = 10_000_000
_MAX_NODES = 500_000
_MAX_DIGITS = 100
_YAML_TAG = "tag:yaml.org,2002"
_PLAIN_TAGS = (f"{_YAML_TAG}:map", f"{_YAML_TAG}:seq")


Mark = list[Any]
"""Where a value stands: line and column; then, if it holds others, what they are marked with; then its file, if that is
not the document's. In a mapping, keys have their line and column and the mark of their value."""


@dataclass(frozen=True, slots=True)
class Call:
    """The call in Python whose arguments a file was written from, as ``dse.Study('gains')``.

    The arguments are the keys of the mapping at *path* of the file, and those of the file itself.
    """

    text: str
    path: KeyPath = ()

    def argument(self, path: KeyPath) -> str:
        """The argument at *path* of the file, as ``dse.Study('gains'): conditions['wind.speed']['range']``."""
        size = len(self.path)
        own = path[size:] if path[:size] == self.path else path
        return f"{self.text}: {own[0]}{''.join(f'[{step!r}]' for step in own[1:])}" if own else self.text


@dataclass(frozen=True, slots=True)
class Document:
    """The data of one file, and where each value and each mapping key stands (*mark*) in *file*, as it is shown.

    Texts over several lines, or with escapes, have *pieces*. A file written from Python has a *call*.
    """

    path: Path
    data: Mapping[str, Any]
    file: str
    mark: Mark
    pieces: Mapping[KeyPath, tuple[Piece, ...]] = field(default_factory=dict)
    call: Call | None = None

    @property
    def top(self) -> Entry:
        """All of it."""
        return Entry(self, ())

    def along(self, path: KeyPath) -> tuple[str, Mark, Mark, bool]:
        """As far as *path* leads: the file, the marks of the last key and of its value; and whether it ends there."""
        file, key, mark = self.file, self.mark, self.mark
        for step in path:
            try:
                key = mark[2][step]
            except (IndexError, KeyError, TypeError):
                return file, mark, mark, False
            mark = key[2] if isinstance(step, str) else key
            file = file if len(mark) < 4 else mark[3]
        return file, key, mark, True


@dataclass(slots=True, eq=False)  # frozen ones take twice as long to make, and every value of every file has one
class Entry:
    """What stands at *path* in a document, if anything does."""

    document: Document
    path: KeyPath

    def __getitem__(self, step: str | int) -> Entry:
        return Entry(self.document, (*self.path, step))

    @property
    def name(self) -> str:
        """The key, or number, under which it stands."""
        return str(self.path[-1])

    @property
    def data(self) -> Any:
        """The value, which must be there."""
        data: Any = self.document.data
        for step in self.path:
            data = data[step]
        return data

    @property
    def where(self) -> Location:
        """Where the value stands; the nearest value around it if it is absent."""
        file, _, mark, _ = self.document.along(self.path)
        return self._at(file, mark)

    @property
    def key(self) -> Location:
        """Where the key stands; the nearest value around it if it is absent."""
        file, mark, _, _ = self.document.along(self.path)
        return self._at(file, mark)

    @property
    def is_there(self) -> bool:
        """Whether a value stands there."""
        return self.document.along(self.path)[3]

    @property
    def origin(self) -> Location | tuple[Piece, ...]:
        """Where the text stands, character by character."""
        pieces = self.document.pieces.get(self.path)
        return pieces if pieces and not self.document.call else self.where

    def _at(self, file: str, mark: Mark) -> Location:
        call = self.document.call
        return Location(file, mark[0], mark[1], call.argument(self.path) if call else "")


def shown(path: Path) -> str:
    """*path* as a person at the current folder would type it."""
    text, here = str(path), os.getcwd()  # noqa: PTH109  # asked for each of thousands of files
    if text.startswith(here + os.sep) and os.pardir not in text:
        return text[len(here) + 1 :].replace(os.sep, "/")
    try:
        relative = os.path.relpath(path)
    except ValueError:  # another drive on Windows
        return text
    return text if relative.startswith(os.pardir) else Path(relative).as_posix()


def read_yaml(path: Path) -> Document:
    """Read one file whose top level is a mapping. Raises DseError with every duplicate key and odd value."""
    return parse_yaml(path, read_content(path))


def parse_yaml(path: Path, content: bytes) -> Document:
    """The document that *content* is, what stands in the file *path*. Raises DseError as `read_yaml` does."""
    file = shown(path)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise fail(f"not UTF-8 text (byte {error.start})", Location(file), "save the file as UTF-8") from None
    root = compose(text, file)
    if root is None:
        raise fail("the file is empty", Location(file), "'dse docs formats' describes each file")
    reader = _Reader(file, text)
    reader.expect_few(root)
    data, mark = reader.value(root, (), 0)
    if reader.problems:
        raise DseError(*reader.problems)
    if not isinstance(data, dict):
        raise fail(
            f"expected a mapping at the top of the file, found {_describe(data)}",
            Location(file, mark[0], mark[1]),
            "start with a line that names what the file defines, as 'design: my_design' or 'component: my_part'",
        )
    return Document(path, data, file, mark, reader.pieces)


def read_content(path: Path) -> bytes:
    """What stands in a file that may hold YAML. Raises DseError: none, too large, or not to be read."""
    where = Location(shown(path))
    try:
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise fail("this is a folder, not a file", where, "name one of the YAML files in it")
        # A device or a pipe may never end.
        if not stat.S_ISREG(mode):
            raise fail("not a regular file", where, "name a file that holds YAML")
        with path.open("rb") as file:
            content = file.read(_MAX_BYTES + 1)
    except FileNotFoundError:
        raise fail("no such file", where, _similar_file(path)) from None
    except OSError as error:
        raise fail(
            f"cannot be read: {error.strerror or error}", where, remedy(error.errno, "check the file's permissions")
        ) from None
    if len(content) > _MAX_BYTES:
        raise fail(f"the file is larger than {_MAX_BYTES // 1_000_000} MB", where, "split it with 'include'")
    return content


def _similar_file(path: Path) -> str:
    import difflib

    names = [entry.name for entry in path.parent.iterdir()] if path.parent.is_dir() else []
    close = difflib.get_close_matches(path.name, names, n=1)
    return f"did you mean {close[0]}?" if close else "check the spelling and the folder you are in"


class _Reader:
    """Turns nodes into data and remembers where everything stands."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        self.text = text
        self.pieces: dict[KeyPath, tuple[Piece, ...]] = {}
        self.problems: list[Problem] = []

    def expect_few(self, root: Any) -> None:
        """Raise DseError if there are too many values below *root*.

        Aliases repeat a node: a short file can stand for billions of values, so each is counted once.
        """
        counts: dict[int, int] = {}
        opened: set[int] = set()
        stack = [root]
        while stack:
            node = stack[-1]
            if id(node) in counts:
                stack.pop()
                continue
            below = _below(node)
            if id(node) not in opened:
                opened.add(id(node))
                stack += [child for child in below if id(child) not in opened]
                continue
            stack.pop()
            # What is not counted yet is around itself; the levels are too many then.
            counts[id(node)] = count = 1 + sum(counts.get(id(child), 0) for child in below)
            if count > _MAX_NODES:
                what = f"more than {_MAX_NODES:,} values once aliases (*name) are expanded"
                advice = "an alias repeats all that its anchor (&name) holds; use fewer of them, or split the file"
                raise fail(what, self._where(node), advice)

    def value(self, node: Any, path: KeyPath, depth: int) -> tuple[Any, Mark]:
        """What *node*, at *path*, stands for, and where."""
        where = self._where(node)
        mark: Mark = [where.line, where.column]
        if depth > MOST_LEVELS:
            what = f"more than {MOST_LEVELS} levels once aliases (*name) are expanded"
            raise fail(what, where, "flatten it; an alias within its own anchor never ends")
        if node.id != "scalar" and str(node.tag) not in _PLAIN_TAGS:
            self._tagged(node)
            return None, mark
        if node.id == "mapping":
            data, marks = self._mapping(node, path, depth)
            return data, [*mark, marks]
        if node.id == "sequence":
            pairs = [self.value(child, (*path, i), depth + 1) for i, child in enumerate(node.value)]
            return [value for value, _ in pairs], [*mark, [mark for _, mark in pairs]]
        value = self._scalar(node, where)
        if isinstance(value, str):
            found = pieces(self._raw(node), value, self._start(node))
            if found:
                self.pieces[path] = found
        return value, mark

    def _mapping(self, node: Any, path: KeyPath, depth: int) -> tuple[dict[str, Any], dict[str, Mark]]:
        result: dict[str, Any] = {}
        marks: dict[str, Mark] = {}
        for key_node, value_node in node.value:
            where = self._where(key_node)
            if key_node.id != "scalar" or str(key_node.tag) == "tag:yaml.org,2002:merge":
                self.problems.append(Problem("a key must be plain text", where, "write the keys out one by one"))
                continue
            key = str(key_node.value)
            if str(key_node.tag).rpartition(":")[0] != _YAML_TAG:
                self._tagged(key_node)
                continue
            if UNSAFE.search(key):
                self.problems += unsafe(key, where).problems
                continue
            if key in result:
                hint = f"first defined in line {marks[key][0]}; keep one of them"
                self.problems.append(Problem(f"duplicate key '{key}'", where, hint))
                continue
            result[key], mark = self.value(value_node, (*path, key), depth + 1)
            marks[key] = [where.line, where.column, mark]
        return result, marks

    def _scalar(self, node: Any, where: Location) -> str | int | float | bool | None:
        tag, text = str(node.tag).rsplit(":", 1)[-1], str(node.value)
        if str(node.tag).rpartition(":")[0] != _YAML_TAG:
            self._tagged(node)
            return None
        if UNSAFE.search(text):
            self.problems += unsafe(text, where).problems
            return None
        if tag in ("int", "float") and len(text) > _MAX_DIGITS:
            self.problems.append(Problem(f"a number of more than {_MAX_DIGITS} characters", where))
            return None
        try:
            if tag == "str":
                return text
            if tag == "bool":
                return text.lower() == "true"
            if tag == "null":
                return None
            if tag == "int":
                return int(text.replace("_", ""), 0) if not text.lstrip("+-").isdigit() else int(text)
            if tag == "float":
                return float(text.replace("_", "").lower().replace(".inf", "inf").replace(".nan", "nan"))
        except ValueError:
            self.problems.append(Problem(f"'{text}' is not a number", where))
            return None
        if tag in ("timestamp", "date"):
            return text
        self._tagged(node)
        return None

    def _tagged(self, node: Any) -> None:
        tag = visible(str(node.tag))
        what = f"the tag '{tag}' is not supported"
        self.problems.append(Problem(what, self._start(node), "write plain values only"))

    def _start(self, node: Any) -> Location:
        return Location(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def _where(self, node: Any) -> Location:
        if node.id != "scalar":
            return self._start(node)
        raw = self._raw(node)
        return place_in(raw, content_start(raw), self._start(node))

    def _raw(self, node: Any) -> str:
        return self.text[node.start_mark.index : node.end_mark.index]


def _below(node: Any) -> list[Any]:
    if node.id == "mapping":
        return [value for _, value in node.value]
    return list(node.value) if node.id == "sequence" else []


def _describe(data: object) -> str:
    names = {list: "a list", str: "text", int: "a number", float: "a number", bool: "a truth value"}
    return names.get(type(data), "nothing")
