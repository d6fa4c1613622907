"""A configuration as bytes that mean the same in another process, and on another machine.

Files of the FMU cache are named by their place in it, and so by the content of their FMUs: where the bytes are read
they are looked for in the cache there.

The configurations of a study share FMUs, of which each has hundreds of variables. An FMU is pickled once and put into
every configuration as these bytes, and a process that reads them unpickles them once. A variable of an FMU is
its name there. Frozen nouns are pickled as the values of their fields, as dataclasses look for these each time::

    Element("a", model, (model.variables["x"],))  →  _noun, Element, ("a", (_model, bytes), ((_variable, model, "x"),))
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache, lru_cache, partial
from pathlib import Path, PurePosixPath
from typing import Any

from dse.cache import cache_folder
from dse.domain.component import Component
from dse.domain.fmu import FmuModel, Variable
from dse.exploration.work import Runnable


@dataclass(frozen=True, slots=True)
class PackedConfiguration:
    """*content* is for ``pickle.loads``, or `unpacked`.

    *entries* are what it needs of the cache (``unpacked/0123``), *elsewhere* the absolute paths that lie outside of it.
    """

    content: bytes
    entries: tuple[str, ...]
    elsewhere: tuple[Path, ...]


class Packer:
    """Packs configurations that share FMUs."""

    def __init__(self) -> None:
        # By identity, as nouns with mappings have no hash; those that are kept here keep theirs.
        self._models: dict[int, tuple[FmuModel, PackedConfiguration]] = {}
        self._owners: dict[int, tuple[FmuModel, str]] = {}

    def pack(self, noun: Runnable | FmuModel) -> PackedConfiguration:
        """A configuration, or a model for one, ready to be sent."""
        stream = io.BytesIO()
        pickler = _Pickler(stream, self, noun)
        pickler.dump(noun)
        return PackedConfiguration(stream.getvalue(), tuple(sorted(pickler.entries)), tuple(pickler.elsewhere))

    def model(self, model: FmuModel) -> PackedConfiguration:
        """*model* as it is put into configurations."""
        if id(model) not in self._models:
            # Only messages name its file once the FMU is unpacked.
            self._models[id(model)] = model, self.pack(replace(model, archive=Path(model.archive.name), ignored=()))
            self._owners |= {id(variable): (model, name) for name, variable in model.variables.items()}
        return self._models[id(model)][1]

    def owner(self, variable: Variable) -> tuple[FmuModel, str] | None:
        """The model that *variable* belongs to, and its name there; None for one that has not been packed."""
        return self._owners.get(id(variable))


def unpacked(content: bytes, places: Mapping[str, Path]) -> Any:
    """The configuration in *content* where each entry of the cache lies at its place in *places*."""
    return _Unpickler(io.BytesIO(content), places).load()


class _Pickler(pickle.Pickler):
    """Writes paths in the cache as places in it."""

    def __init__(self, stream: io.BytesIO, packer: Packer, whole: object) -> None:
        super().__init__(stream, protocol=pickle.HIGHEST_PROTOCOL)
        self._cache = cache_folder().absolute()
        self._packer, self._whole = packer, whole
        self.entries: set[str] = set()
        self.elsewhere: list[Path] = []

    def reducer_override(self, value: Any) -> Any:
        if isinstance(value, FmuModel) and value is not self._whole:
            model = self._packer.model(value)
            self.entries.update(model.entries)
            self.elsewhere += model.elsewhere
            return _model, (model.content,)
        if isinstance(value, Variable) and (owner := self._packer.owner(value)):
            return _variable, owner
        if isinstance(value, Component) and value.source is not None:
            # Its FMU has been built.
            return _itself, (replace(value, source=None),)
        if isinstance(value, Path) and value.is_absolute():
            if value.is_relative_to(self._cache):
                place = value.relative_to(self._cache).as_posix()
                self.entries.add(_entry(place)[0])
                return _in_cache, (place,)
            self.elsewhere.append(value)
        kind: Any = type(value)
        names = _fields(kind)
        return (_noun, (kind, *(getattr(value, name) for name in names))) if names else NotImplemented


class _Unpickler(pickle.Unpickler):
    """Reads places in the cache as paths below those of its entries."""

    def __init__(self, stream: io.BytesIO, places: Mapping[str, Path]) -> None:
        super().__init__(stream)
        self._places = places

    def find_class(self, module: str, name: str) -> Any:
        if module == __name__ and name == _in_cache.__name__:
            return self._placed
        if module == __name__ and name == _model.__name__:
            return partial(unpacked, places=self._places)
        return super().find_class(module, name)

    def _placed(self, place: str) -> Path:
        entry, rest = _entry(place)
        return self._places[entry].joinpath(*rest)


def _model(content: bytes) -> Any:
    return _kept_model(content, cache_folder())


@lru_cache(maxsize=64)
def _kept_model(content: bytes, _cache: Path) -> Any:
    return pickle.loads(content)  # noqa: S301  # part of what is being loaded


def _variable(model: FmuModel, name: str) -> Variable:
    return model.variables[name]


def _noun(kind: type, *values: object) -> Any:
    made: Any = object.__new__(kind)
    for name, value in zip(_fields(kind), values, strict=True):
        object.__setattr__(made, name, value)
    return made


@cache
def _fields(kind: Any) -> tuple[str, ...]:
    """The fields of a frozen noun that has nothing else; () for other kinds."""
    is_plain = kind.__dictoffset__ == 0 and is_dataclass(kind) and kind.__reduce__ is object.__reduce__
    return tuple(each.name for each in fields(kind)) if is_plain else ()


def _itself(value: Any) -> Any:
    return value


def _in_cache(place: str) -> Path:
    return cache_folder().absolute() / PurePosixPath(place)


def _entry(place: str) -> tuple[str, tuple[str, ...]]:
    parts = PurePosixPath(place).parts
    return "/".join(parts[:2]), parts[2:]
