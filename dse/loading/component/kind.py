"""Kinds of components: what each offers, and how ``source: {kind: …}`` of a component.yaml finds its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from pydantic import ConfigDict

from dse.domain.component import Component, Source, UnsupportedSource
from dse.errors import DseError, Location, fail
from dse.formats.yaml import Document, shown
from dse.loading.fields import Section, read_section
from dse.loading.root import is_file, named_file
from dse.registry import Registry

if TYPE_CHECKING:
    from dse.domain.diagram import Diagram


class SourceSection(Section):
    """What is written under ``source``; a kind adds its keys."""

    kind: str


@dataclass(frozen=True, slots=True)
class SourcePlace:
    """Where the ``source`` of *component* is written: in *document*, of the workspace *inside*."""

    component: str
    document: Document
    inside: Path

    @property
    def folder(self) -> Path:
        """What the paths in it are relative to."""
        return self.document.path.parent

    def at(self, *keys: str | int) -> Location:
        """Where the value at *keys* below ``source`` stands."""
        return self.document.place(("source", *keys))

    def missing(self, key: str, hint: str) -> DseError:
        """The error that *key* is not there."""
        return fail(f"'{key}' is missing in 'source'", self.document.key(("source",)), hint)

    def file(self, name: str, suffixes: Collection[str], *keys: str | int) -> Path:
        """The file called *name* at *keys*, with one of *suffixes* (``.c``). Raises DseError, also outside *inside*."""
        where = self.at(*keys)
        return existing(named_file(self.folder, name, self.inside, suffixes, where), where)


def existing(path: Path, where: Location) -> Path:
    """*path*. Raises DseError, at *where*, if it is no file."""
    if not is_file(path):
        raise fail(f"no such file: {shown(path)}", where, "paths are relative to this component.yaml")
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

    def check(self, component: Component, source: Noun) -> None:
        """Raise DseError with what ``dse check`` can tell without building: by default nothing."""

    def diagram(self, component: Component, source: Noun) -> Diagram | None:  # noqa: ARG002  # nothing is known here
        """The parts and links inside, for a picture; None if nothing is known of them. Raises DseError."""
        return None


KINDS: Registry[ComponentKind[Any, Any]] = Registry("dse.kinds", "component kind", room="dse.kinds", attribute="KIND")

_PLANNED = ("python", "udp")


class _AnySource(SourceSection):
    model_config = ConfigDict(extra="ignore")


def read_source(document: Document, component: str, inside: Path) -> Source:
    """The ``source`` of *component*; the files it names lie in *inside*. Raises DseError."""
    word = read_section(document, _AnySource, ("source",)).kind
    if word in _PLANNED and word not in KINDS.names():
        return UnsupportedSource(word)
    place = SourcePlace(component, document, inside)
    kind = KINDS.get(word, place.at("kind"))
    source: Source = kind.read(read_section(document, kind.section, ("source",)), place)
    return source


def kind_of(component: Component) -> ComponentKind[Any, Any] | None:
    """The kind of *component*; None if it has no source, or one that this version cannot build. Raises DseError."""
    if component.source is None or component.source.kind not in KINDS.names():
        return None
    return KINDS.get(component.source.kind, component.where)
