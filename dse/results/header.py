"""What a study folder is about: the part of it that is written once, before the first run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class StudyHeader:
    """The definition of a study as JSON data, its fingerprint, and how many runs it has.

    *definition* has at least ``variables``, ``metrics`` and ``requirements`` (lists of objects with a ``name``)
    and ``configurations`` (objects with an ``id``; ``choices`` and ``totals`` are stored beside it). Two studies
    with the same *fingerprint* give the same results.
    """

    definition: Mapping[str, Any]
    fingerprint: str
    runs: int

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the design variables, in order."""
        return self._names("variables")

    @property
    def metrics(self) -> tuple[str, ...]:
        """Names of the metrics, in order."""
        return self._names("metrics")

    @property
    def requirements(self) -> tuple[str, ...]:
        """Names of the requirements, in order."""
        return self._names("requirements")

    @property
    def configurations(self) -> tuple[str, ...]:
        """Ids of the configurations, in the order of their runs."""
        return tuple(entry["id"] for entry in self.definition["configurations"])

    def differences(self, other: StudyHeader) -> tuple[str, ...]:
        """Top-level entries of the definition that are not equal in both, sorted."""
        mine, theirs = self.definition, other.definition
        return tuple(sorted(key for key in {*mine, *theirs} if mine.get(key) != theirs.get(key)))

    def _names(self, section: str) -> tuple[str, ...]:
        return tuple(entry["name"] for entry in self.definition[section])
