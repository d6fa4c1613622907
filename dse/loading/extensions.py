"""What a study file names that others may add: samplers and executors, each a section of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Self, TypeVar

from pydantic import ValidationError

from dse.domain.study import DesignVariable
from dse.errors import Location, closest, fail
from dse.formats.yaml import Document, Path_
from dse.loading.fields import Section, read_section
from dse.registry import Registry


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What stands around a section: the *document* and place *at* which it stands, and what it may speak of.

    *names* are the design variables of the file, *variables* those of them that could be read. Files it names lie in
    *inside*.
    """

    document: Document
    at: Path_
    names: frozenset[str]
    variables: tuple[DesignVariable, ...]
    inside: Path

    def place(self, *path: str | int) -> Location:
        """Where the value at *path* of the section stands; the nearest around it if it is absent."""
        return self.document.place((*self.at, *path))


class Extension(Section):
    """A section that is found by its *name*.

    *examples* are options that it can do with, the simplest first; *example_files* are what these name, as texts.
    """

    name: ClassVar[str]
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({},)
    example_files: ClassVar[Mapping[str, str]] = {}

    def options(self) -> Mapping[str, Any]:
        """What it was given, as plain data."""
        return self.model_dump(mode="json")


class SamplerSection(Extension):
    """A sampler as its YAML; see `dse.domain.sampler.Sampler` for the rest of what it has to be."""

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


def read_extension(
    document: Document, key: str, written: str | Mapping[str, Any], registry: Registry[type[E]]
) -> tuple[E, Path_]:
    """What stands under *key* as NAME or {NAME: {option: …}}, and where its options stand. Raises DseError."""
    where = document.place((key,))
    if isinstance(written, str):
        shape = registry.get(written, where)
        try:
            return shape(), (key,)
        except ValidationError as error:
            lacking = " and ".join(f"'{'.'.join(map(str, entry['loc']))}'" for entry in error.errors())
            raise fail(f"'{written}' needs {lacking}", where, f"{key}: {_shown(shape)}") from None
    if len(written) != 1:
        raise fail(f"give exactly one {registry.word}", where, closest("", registry.names()))
    ((name, options),) = written.items()
    shape = registry.get(name, document.key((key, name)))
    if not isinstance(options, Mapping):
        what = f"'{key}.{name}': expected its options"
        raise fail(what, document.place((key, name)), f"{key}: {_shown(shape)}")
    return read_section(document, shape, (key, name)), (key, name)


def _shown(shape: type[Extension]) -> str:
    """The first example of *shape* as it is written."""
    options = ", ".join(f"{name}: {value}" for name, value in shape.examples[0].items())
    return f"{{{shape.name}: {{{options}}}}}"
