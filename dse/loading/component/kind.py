"""Kinds of components: what each offers, and how ``source: {kind: …}`` of a component.yaml finds its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from pydantic import ConfigDict

from dse.domain.component import Component, Source
from dse.errors import DseError, Location, Problem, fail
from dse.formats import Entry, shown
from dse.loading.paths import followed, is_file, named_file
from dse.loading.sections import Section, read_section
from dse.loading.values import Raw, read_number, read_unit
from dse.registry import Registry

if TYPE_CHECKING:
    from dse.domain.diagram import Diagram


class SourceSection(Section):
    """What is written under ``source``; a kind adds its keys."""

    kind: str


@dataclass(frozen=True, slots=True)
class SourcePlace:
    """Where the ``source`` of *component* is written: *entry*, in the workspace *inside*."""

    component: str
    entry: Entry
    inside: Path

    def at(self, *keys: str | int) -> Location:
        """Where the value at *keys* below ``source`` stands."""
        return Entry(self.entry.document, (*self.entry.path, *keys)).where

    def number(self, raw: Raw, unit: str, *keys: str | int) -> float:
        """The SI number *raw* at *keys*; a bare one is in *unit*. Raises DseError."""
        return read_number(raw, read_unit(unit, self.at(*keys)), self.at(*keys))

    def missing(self, key: str, hint: str) -> DseError:
        """The error that *key* is not there."""
        return fail(f"'{key}' is missing in 'source'", self.entry.key, hint)

    def path(self, name: str, *keys: str | int) -> Path:
        """What is called *name* at *keys*, links followed; it may lie anywhere, and need not exist. Raises DseError."""
        return followed(self.entry.document.path.parent, name, self.at(*keys))

    def file(self, name: str, suffixes: Collection[str], *keys: str | int) -> Path:
        """The file called *name* at *keys*, with one of *suffixes* (``.c``). Raises DseError, also outside *inside*."""
        where = self.at(*keys)
        return self.existing(named_file(self.entry.document.path.parent, name, self.inside, suffixes, where), *keys)

    def existing(self, path: Path, *keys: str | int) -> Path:
        """*path*, which *keys* name. Raises DseError if it is no file."""
        if not is_file(path):
            raise fail(f"no such file: {shown(path)}", self.at(*keys), "paths are relative to this component.yaml")
        return path


Written = TypeVar("Written", bound=SourceSection)
Noun = TypeVar("Noun", bound=Source)


class ComponentKind(ABC, Generic[Written, Noun]):
    """One way to write a component: the keys of its ``source``, what they mean, and how it becomes an FMU.

    One called ``x`` is the ``KIND`` of the module ``dse/kinds/x.py``, or the entry point ``x`` of the group
    ``dse.kinds``; the *kind* of its noun is ``"x"``.
    """

    section: type[Written]
    """The keys; others are refused."""

    @abstractmethod
    def read(self, section: Written, place: SourcePlace) -> Noun:
        """What *section* means. Raises DseError."""

    @abstractmethod
    def build(self, component: Component, source: Noun, *, version: int, cache: Path | None) -> Path:
        """The FMU archive of *component*, for FMI *version* 2 or 3: the same bytes for the same files. Raises DseError.

        What is built is kept in the folder *cache* (see `dse.cache.cache_folder`) and never changed.
        """

    def check(self, component: Component, source: Noun) -> tuple[Problem, ...]:  # noqa: ARG002  # nothing is known here
        """What in its files is ignored. Raises DseError with what ``dse check`` can tell without building."""
        return ()

    def labels(self, component: Component, source: Noun) -> Mapping[str, tuple[str, ...]]:  # noqa: ARG002  # none here
        """Names of the elements of array ports, by port; ``/`` divides a name from what it is in. Raises DseError."""
        return {}

    def diagram(self, component: Component, source: Noun) -> Diagram | None:  # noqa: ARG002  # nothing is known here
        """The parts and links inside, for a picture; None if nothing is known of them. Raises DseError."""
        return None


KINDS: Registry[ComponentKind[Any, Any]] = Registry("dse.kinds", "component kind", room="dse.kinds", attribute="KIND")


class _AnySource(SourceSection):
    model_config = ConfigDict(extra="ignore")


def read_source(entry: Entry, component: str, inside: Path) -> Source:
    """The ``source`` of *component*; the files it names lie in *inside*. Raises DseError."""
    word = read_section(entry, _AnySource).kind
    kind = KINDS.get(word, entry["kind"].where)
    source: Source = kind.read(read_section(entry, kind.section), SourcePlace(component, entry, inside))
    return source


def kind_of(component: Component) -> ComponentKind[Any, Any] | None:
    """The kind of *component*; None if it has no source. Raises DseError."""
    return None if component.source is None else KINDS.get(component.source.kind, component.where)
