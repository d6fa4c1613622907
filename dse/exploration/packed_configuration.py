"""A configuration as bytes that mean the same in another process, and on another machine.

Files of the FMU cache are named by their place in it, and so by the content of their FMUs: where the bytes are read
they are looked for in the cache there.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

from dse.cache import cache_folder
from dse.domain.component import Component
from dse.domain.fmu import FmuModel
from dse.exploration.work import Runnable


@dataclass(frozen=True, slots=True)
class PackedConfiguration:
    """*content* is for ``pickle.loads``, or `unpacked`.

    *entries* are what it needs of the cache (``unpacked/0123``), *elsewhere* the absolute paths that lie outside of it.
    """

    content: bytes
    entries: tuple[str, ...]
    elsewhere: tuple[Path, ...]


def packed(configuration: Runnable) -> PackedConfiguration:
    """*configuration*, ready to be sent."""
    stream = io.BytesIO()
    pickler = _Pickler(stream, protocol=pickle.HIGHEST_PROTOCOL)
    pickler.dump(configuration)
    return PackedConfiguration(stream.getvalue(), tuple(sorted(pickler.entries)), tuple(pickler.elsewhere))


def unpacked(content: bytes, places: Mapping[str, Path]) -> Any:
    """The configuration in *content* where each entry of the cache lies at its place in *places*."""
    return _Unpickler(io.BytesIO(content), places).load()


class _Pickler(pickle.Pickler):
    """Writes paths in the cache as places in it."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._cache = cache_folder().absolute()
        self.entries: set[str] = set()
        self.elsewhere: list[Path] = []

    def reducer_override(self, value: object) -> Any:
        if isinstance(value, FmuModel) and value.archive.is_absolute():
            # Only messages name it once the FMU is unpacked.
            return _itself, (replace(value, archive=Path(value.archive.name), ignored=()),)
        if isinstance(value, Component) and value.source is not None:
            # Its FMU has been built.
            return _itself, (replace(value, source=None),)
        if isinstance(value, Path) and value.is_absolute():
            if value.is_relative_to(self._cache):
                place = value.relative_to(self._cache).as_posix()
                self.entries.add(_entry(place)[0])
                return _in_cache, (place,)
            self.elsewhere.append(value)
        return NotImplemented


class _Unpickler(pickle.Unpickler):
    """Reads places in the cache as paths below those of its entries."""

    def __init__(self, stream: io.BytesIO, places: Mapping[str, Path]) -> None:
        super().__init__(stream)
        self._places = places

    def find_class(self, module: str, name: str) -> Any:
        return self._placed if (module, name) == (__name__, _in_cache.__name__) else super().find_class(module, name)

    def _placed(self, place: str) -> Path:
        entry, rest = _entry(place)
        return self._places[entry].joinpath(*rest)


def _itself(value: Any) -> Any:
    return value


def _in_cache(place: str) -> Path:
    return cache_folder().absolute() / PurePosixPath(place)


def _entry(place: str) -> tuple[str, tuple[str, ...]]:
    parts = PurePosixPath(place).parts
    return "/".join(parts[:2]), parts[2:]
