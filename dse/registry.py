"""What people add to dse, found by name: one file of a room, or an entry point of an installed package.

A room is a package in which the module NAME holds the implementation NAME: adding a file is all there is to do. Another
distribution offers its own in ``[project.entry-points."<group>"]``. Nothing is imported before it is asked for by name,
so that a broken package stops only those who use it.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from dse.errors import Location, closest, fail

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

T = TypeVar("T")


class Registry(Generic[T]):
    """The implementations of one protocol: *word* is what one is called in messages, *group* that of its entry points.

    Built in are the modules of *room*, each by its attribute *attribute*, or what *own* holds.
    """

    def __init__(
        self, group: str, word: str, *, room: str = "", attribute: str = "", own: Mapping[str, T] | None = None
    ) -> None:
        self.group = group
        self.word = word
        self._room = room
        self._attribute = attribute
        self._own = own or {}

    def names(self) -> tuple[str, ...]:
        """Every name there is, sorted."""
        return tuple(sorted({*self._built_in, *self._offered}))

    def get(self, name: str, where: Location | None = None) -> T:
        """What is called *name*. Raises DseError at *where*: unknown, offered twice, or not to be loaded."""
        found: Any
        offers = self._offered.get(name, ())
        if len(offers) + (name in self._built_in) > 1:
            packages = ["dse"] * (name in self._built_in) + [_package(offer) for offer in offers]
            what = f"the {self.word} '{name}' is offered by several packages: {', '.join(packages)}"
            raise fail(what, where, "uninstall all but one of them")
        if name in self._own:
            return self._own[name]
        if name in self._built_in:
            found = getattr(import_module(f"{self._room}.{name}"), self._attribute)
        elif offers:
            found = self._load(offers[0], where)
        else:
            raise fail(f"unknown {self.word} '{name}'", where, closest(name, self.names()))
        implementation: T = found
        return implementation

    def package(self, name: str) -> str:
        """The distribution that offers *name*; "dse" for what is built in."""
        offers = self._offered.get(name, ())
        return _package(offers[0]) if offers else "dse"

    @cached_property
    def _built_in(self) -> frozenset[str]:
        if not self._room:
            return frozenset(self._own)
        from pkgutil import iter_modules

        modules = iter_modules(import_module(self._room).__path__)
        return frozenset({*self._own, *(m.name for m in modules if not m.name.startswith("_"))})

    @cached_property
    def _offered(self) -> Mapping[str, tuple[EntryPoint, ...]]:
        from importlib.metadata import entry_points

        offered: dict[str, tuple[EntryPoint, ...]] = {}
        for point in entry_points(group=self.group):
            offered[point.name] = (*offered.get(point.name, ()), point)
        return offered

    def _load(self, point: EntryPoint, where: Location | None) -> object:
        try:
            return point.load()
        except Exception as error:  # another's code: whatever it raises is told in words
            what = f"the {self.word} '{point.name}' of {_package(point)} cannot be loaded"
            said = f"{type(error).__name__}: {error}"
            raise fail(f"{what}: {said}", where, f"mend or uninstall {_package(point)}") from error


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist else point.value
