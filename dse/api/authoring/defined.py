"""What is defined in Python: its arguments are written as a file of a workspace, which is read as any other.

So YAML and Python have the same rules. The files written here are in ``WRITTEN``, by which an error names the argument.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Generic, Protocol, Self, TypeVar
from weakref import finalize

from dse.domain.component import Component as ComponentNoun
from dse.errors import Location, fail
from dse.formats import MOST_LEVELS, UNSAFE, WRITTEN, Call, KeyPath, dump_yaml, remember, shown, unsafe
from dse.loading import Workspace as Files, read_document
from dse.scratch import make_folder, new_folder, write_whole
from dse.shipped import lay_out

_FOLDERS = ("components", "designs", "roads", "testbenches")
_HEAD = "# Written from Python, which may write it anew.\n"
_NAME = re.compile(r"[^\W\d][\w-]*")


class HasName(Protocol):
    """A noun with a name, and the place in a file where it is defined."""

    @property
    def name(self) -> str:
        """What others call it."""
        ...

    @property
    def where(self) -> Location | None:
        """Where it is defined."""
        ...


N = TypeVar("N", bound=HasName)


class Definitions:
    """A workspace in which Python defines things. *files* reads them; it is another one after each definition."""

    def __init__(self, files: Files) -> None:
        self.files = files
        self.known: dict[Path, Mapping[str, Any]] = {}
        """What Python defined last, by file."""

    @staticmethod
    def new(folder: str | Path | None = None) -> Definitions:
        """A copy of the example workspace in a new or empty *folder*, by default one that goes with the process."""
        root = new_folder() if folder is None else Path(folder).resolve()
        made = Definitions(Files(root))
        if folder is None:
            finalize(made, shutil.rmtree, root, ignore_errors=True)
        lay_out(root, _FOLDERS)
        remember(root, for_good=folder is not None)
        return made

    @contextmanager
    def redefining(self, target: Path, call: Call) -> Iterator[None]:
        """Inside, *target* (a file or folder) may be written; if that or reading it fails, it is as it was before.

        Raises DseError if it is there, and was not written from Python.
        """
        if target.exists() and not _is_written(target):
            what = f"the workspace has {shown(target)} already"
            raise fail(what, Location(call.text), "choose another name")
        known = {**self.known}
        with TemporaryDirectory(prefix=".dse-", dir=self.files.root) as aside:
            before = Path(aside) / "before"
            if target.exists():
                target.rename(before)
            try:
                make_folder(target.parent)
                yield
            except BaseException:
                shutil.rmtree(target) if target.is_dir() else target.unlink(missing_ok=True)
                if before.exists():
                    before.rename(target)
                self.files, self.known = Files(self.files.root), known
                raise

    def write(self, file: Path, data: Mapping[str, Any], call: Call) -> None:
        """Write *data* to *file* from the *call*, and read the workspace anew."""
        write_whole(file, _HEAD + dump_yaml(data))
        WRITTEN[file] = call
        self.known[file] = data
        self.files = Files(self.files.root)


@lru_cache(maxsize=1)
def default_definitions() -> Definitions:
    """Those of the process, for what is defined without a workspace."""
    return Definitions.new()


class InWorkspace(Protocol):
    """What says where something is to be defined: a `dse.Workspace`."""

    @property
    def definitions(self) -> Definitions:
        """Of this workspace."""
        ...


class Defined(Generic[N]):
    """What has a file of its own, and may be defined in Python; *noun* is the content of the file."""

    noun: N

    def __init__(self, noun: N, definitions: Definitions | None, data: Mapping[str, Any] | None = None) -> None:
        self.noun = noun
        self.definitions = definitions
        self._data = data

    @classmethod
    def of(cls, noun: N, definitions: Definitions | None = None) -> Self:
        """What *noun* is; if it is as its file in a workspace says, the *definitions* of that."""
        made = cls.__new__(cls)
        Defined.__init__(made, noun, definitions)
        return made

    @property
    def name(self) -> str:
        """Its name."""
        return self.noun.name

    @property
    def data(self) -> Mapping[str, Any]:
        """The content of its file as plain data, which the class takes as arguments: ``dse.Study(**study.data)``.

        Raises DseError if it has no file.
        """
        if self._data is None:
            where = self.noun.where
            if self.definitions is None or where is None:
                raise fail(f"'{self.name}' is not as in a file")
            self._data = read_document(Path(where.file).resolve(), self.definitions.files.root).data
        return self._data

    def to_yaml(self, target: str | Path | None = None) -> str:
        """The content of its file as YAML, without includes; written to the file *target* if that is given.

        Files that a component's source names are not copied. Raises DseError if it has no file, or *target* cannot be
        written.
        """
        text = dump_yaml(self.data)
        if target is not None:
            write_whole(Path(target), text)
        return text

    @property
    def is_current(self) -> bool:
        """Whether Python has not defined another thing of this name since."""
        where = self.noun.where
        known = self.definitions.known.get(Path(where.file).resolve()) if where and self.definitions else None
        return known is None or self._data is None or known == self._data


class Arguments:
    """The arguments of a *call* as plain data; *used* are the things among them that have a file."""

    def __init__(self, call: Call) -> None:
        self.call = call
        self.used: list[tuple[Defined[Any], Location]] = []

    def at(self, path: KeyPath) -> Location:
        """Where the argument at *path* is."""
        return Location(self.call.argument(path))

    def plain(self, value: object, path: KeyPath) -> Any:
        """*value*, the argument at *path*, as YAML reads it: things are named, arrays and tuples are lists.

        Raises DseError for what no file can say.
        """
        if len(path) > MOST_LEVELS:
            raise fail("nested too deeply", self.at(path[:1]), f"use at most {MOST_LEVELS} levels")
        if isinstance(value, str | Path):
            text = str(value)
            if UNSAFE.search(text):
                raise unsafe(text, self.at(path))
            return text
        if value is None or (isinstance(value, bool | int | float) and type(value) in (bool, int, float)):
            return value
        if isinstance(value, Mapping):
            return {self._key(key, path): self.plain(each, (*path, str(key))) for key, each in value.items()}
        if isinstance(value, list | tuple):
            return [self.plain(each, (*path, number)) for number, each in enumerate(value)]
        if isinstance(value, Defined):
            self.used.append((value, self.at(path)))
            return value.name
        if isinstance(value, ComponentNoun):
            return value.name
        to_list = getattr(value, "tolist", None)
        if to_list is not None and not isinstance(value, type):  # of numpy and pandas
            return self.plain(to_list(), path)
        what = f"a {type(value).__name__} cannot be written to a file"
        raise fail(what, self.at(path), "give texts, numbers, lists and mappings, as in YAML")

    def definitions(self, workspace: InWorkspace | None) -> Definitions:
        """Where to define: in *workspace*, else in that of what was used, else in that of the process.

        Raises DseError if these are several, or if something that was used has been defined anew since.
        """
        found = workspace.definitions if workspace else None
        for each, where in self.used:
            if each.definitions is not None and found is not None and each.definitions is not found:
                raise fail(f"'{each.name}' is in another workspace", where, "define both in one workspace")
            if not each.is_current:
                raise fail(f"'{each.name}' has been defined anew since", where, "take the new one")
            found = found or each.definitions
        return found or default_definitions()

    def _key(self, key: object, path: KeyPath) -> str:
        if not isinstance(key, str | int):
            raise fail(f"{key!r} is not a key", self.at(path), "keys are texts")
        return self.plain(str(key), path)  # type: ignore[no-any-return]  # of a text


def called(word: str, key: str, name: object, path: KeyPath = ()) -> Call:
    """The call ``dse.WORD('NAME')``. Raises DseError unless *name* can be that of a file."""
    call = Call(f"dse.{word}({name!r})", path)
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        what = f"{name!r} is not a name"
        raise fail(what, Location(call.argument((*path, key))), "names are of letters, digits and _")
    return call


@dataclass(frozen=True, slots=True)
class FileKind(Generic[N]):
    """A kind of file with one thing in it: the *word* is the class in Python, the *key* has its name."""

    word: str
    key: str
    folder: str
    suffix: str
    read: Callable[[Files, str], N]

    def define(
        self, name: object, arguments: Mapping[str, object], workspace: InWorkspace | None
    ) -> tuple[N, Definitions, Mapping[str, Any]]:
        """Write the file and read it; where it is, and its data. Raises DseError, which names arguments."""
        call = called(self.word, self.key, name)
        given = Arguments(call)
        data = {self.key: name, **{key: given.plain(value, (key,)) for key, value in arguments.items()}}
        definitions = given.definitions(workspace)
        file = definitions.files.root / self.folder / f"{name}{self.suffix}"
        others = [path for path in definitions.files.files(self.folder) if path.name == file.name and path != file]
        with definitions.redefining(others[0] if others else file, call):
            definitions.write(file, data, call)
            return self.read(definitions.files, str(name)), definitions, data


def _is_written(target: Path) -> bool:
    """Whether the file, or the YAML of the folder, was written from Python."""
    files = [target / name for name in ("component.yaml", "interfaces.yaml")] if target.is_dir() else [target]
    return any(file.is_file() and file.read_bytes().startswith(_HEAD.encode()) for file in files)
