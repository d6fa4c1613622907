"""What a study file names that others may add: samplers and executors, each a section of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Generic, Self, TypeVar

from pydantic import ValidationError

from dse.domain.sampler import DesignVariable, Placing
from dse.errors import Location, closest, fail
from dse.formats import Entry
from dse.loading.sections import Section, read_section
from dse.registry import Registry


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What stands around a section: the *entry* with its options, and what it may speak of.

    *names* are the design variables of the file, *variables* those of them that could be read. Files it names lie in
    *inside*.
    """

    entry: Entry
    names: frozenset[str]
    variables: tuple[DesignVariable, ...]
    inside: Path

    def place(self, *path: str | int) -> Location:
        """Where the value at *path* of the section stands; the nearest around it if it is absent."""
        return Entry(self.entry.document, (*self.entry.path, *path)).where


class Extension(Section):
    """A section that is found by its *name*.

    *examples* are options that it can do with, the simplest first; *example_files* are what these name, as texts.
    *short* is the option that is meant where a text stands instead of options.
    """

    name: ClassVar[str]
    short: ClassVar[str] = ""
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({},)
    example_files: ClassVar[Mapping[str, str]] = {}

    def options(self) -> Mapping[str, Any]:
        """What it was given, as plain data."""
        return self.model_dump(mode="json")


class SamplerSection(Extension):
    """A sampler as its YAML; see `dse.domain.sampler.Sampler` for the rest of what it has to be."""

    proposes: ClassVar[bool] = False
    placing: ClassVar[Placing] = Placing.CHOSEN

    @classmethod
    def placed(cls, options: Mapping[str, Any]) -> Placing:  # noqa: ARG003  # for those on which it depends
        """How the runs of a study are placed whose sampler has the stored *options*."""
        return cls.placing

    def settled(self, around: Surroundings) -> Self:  # noqa: ARG002  # for those that look around
        """The sampler to use, with what had to be read; raises DseError with what is wrong with it *around* here."""
        return self


class ExecutorSection(Extension):
    """An executor as its YAML; see `dse.exploration.executor.Executor` for the rest of what it has to be."""


SAMPLERS: Registry[type[SamplerSection]] = Registry(
    "dse.samplers", "sampler", room="dse.exploration.samplers", attribute="SAMPLER"
)
EXECUTORS: Registry[type[ExecutorSection]] = Registry(
    "dse.executors", "executor", room="dse.exploration.executors", attribute="EXECUTOR"
)

E = TypeVar("E", bound=Extension)


@dataclass(frozen=True, slots=True)
class Found(Generic[E]):
    """A *section*, and where its options stand."""

    section: E
    entry: Entry


def read_extension(entry: Entry, written: str | Mapping[str, Any], registry: Registry[type[E]]) -> Found[E]:
    """What stands at *entry* as NAME or {NAME: {option: …}}. Raises DseError."""
    if isinstance(written, str):
        shape = registry.get(written, entry.where)
        try:
            return Found(shape(), entry)
        except ValidationError as error:
            lacking = " and ".join(f"'{'.'.join(map(str, finding['loc']))}'" for finding in error.errors())
            raise fail(f"'{written}' needs {lacking}", entry.where, f"{entry.name}: {_shown(shape)}") from None
    if len(written) != 1:
        raise fail(f"give exactly one {registry.word}", entry.where, closest("", registry.names()))
    ((name, options),) = written.items()
    shape = registry.get(name, entry[name].key)
    if shape.short and isinstance(options, str):
        return Found(shape.model_validate({shape.short: options}), entry[name])
    if not isinstance(options, Mapping):
        what = f"'{entry.name}.{name}': expected its options"
        raise fail(what, entry[name].where, f"{entry.name}: {_shown(shape)}")
    return Found(read_section(entry[name], shape), entry[name])


def _shown(shape: type[Extension]) -> str:
    """The first example of *shape* as it is written."""
    options = ", ".join(f"{name}: {value}" for name, value in shape.examples[0].items())
    return f"{{{shape.name}: {{{options}}}}}"
