"""Studies: the paper's PET, design variables explored on a test bench."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, TypeVar

from dse.domain.bench import Metric, Requirement, TestBench
from dse.domain.component import Kind, Type
from dse.domain.design import Configuration
from dse.domain.distribution import Correlations
from dse.domain.expression import Expression
from dse.domain.sampler import DesignVariable, Objective, Sampler
from dse.errors import Location


class Keep(StrEnum):
    """Which runs' waveforms are stored."""

    ALL = "all"
    NEAR_BOUNDARY = "near_boundary"
    NONE = "none"


class CheckStep(StrEnum):
    """Which runs are repeated with finer numerics, to tell how certain their verdicts are."""

    NONE = "none"
    NEAR_BOUNDARY = "near_boundary"


@dataclass(frozen=True, slots=True)
class Selection:
    """Which configurations a study explores: all valid ones, those named, or those where a condition holds.

    *configurations* are those of *ids* if they are known: in a large design space, finding an id takes a second.
    """

    ids: tuple[str, ...] = ()
    where: Expression | None = None
    configurations: tuple[Configuration, ...] = field(default=(), repr=False, compare=False)

    @classmethod
    def of(cls, configurations: Iterable[Configuration]) -> Selection:
        """These *configurations*, each once."""
        known = {each.id: each for each in configurations}
        return cls(tuple(known), configurations=tuple(known.values()))


@dataclass(frozen=True, slots=True)
class ExecutorChoice:
    """What makes the runs, by the name it is found by, with its options as plain data. Results do not depend on it."""

    name: str = "local"
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Shard:
    """Part *number* (from 1) *of* so many parts of a study, each of which is explored by itself."""

    number: int
    of: int

    @property
    def folder(self) -> str:
        """The name of its study folder."""
        return f"shard-{self.number}-of-{self.of}"


SHARD_FOLDER = re.compile(r"shard-([1-9][0-9]*)-of-([1-9][0-9]*)")
"""What the names of shards' folders look like."""


@dataclass(frozen=True, slots=True)
class Replicates:
    """How many draws each run is made with: *at_least* so many, and up to *at_most* while a verdict is open.

    *confidence* is that of intervals of rates, and with which a verdict is certain.
    """

    at_least: int
    at_most: int
    confidence: float = 0.95

    @property
    def is_sequential(self) -> bool:
        """Whether how many depends on results."""
        return self.at_least < self.at_most


@dataclass(frozen=True, slots=True)
class Study:
    """Design variables × sampler on one bench, or on *others* as well, each of which is one more condition.

    All have one design space; metrics and requirements of one name agree. *constraints* are over the names of the
    variables; *correlations* of uncertain ones by their names. With *replicates* the last variable is the draw.
    """

    name: str
    bench: TestBench
    variables: tuple[DesignVariable, ...]
    sampler: Sampler
    selection: Selection = Selection()
    keep: Keep = Keep.NEAR_BOUNDARY
    seed: int = 0
    title: str = ""
    where: Location | None = None
    executor: ExecutorChoice = ExecutorChoice()
    objectives: tuple[Objective, ...] = ()
    constraints: tuple[Expression, ...] = ()
    correlations: Correlations = field(default_factory=dict)
    check_step: CheckStep = CheckStep.NONE
    others: tuple[TestBench, ...] = ()
    replicates: Replicates | None = None

    @property
    def sampled(self) -> tuple[DesignVariable, ...]:
        """The variables that the sampler is asked for values of."""
        return self.variables if self.replicates is None else self.variables[:-1]

    @property
    def once(self) -> bool:
        """Whether its runs do not depend on results: all of them are asked for at once."""
        return self.sampler.once and not (self.replicates and self.replicates.is_sequential)

    @property
    def benches(self) -> tuple[TestBench, ...]:
        """All benches; the condition `TESTBENCH` counts them from 0."""
        return (self.bench, *self.others)

    @property
    def metrics(self) -> tuple[Metric, ...]:
        """Those of all benches, each by the first bench that has it."""
        return _first_of_each(bench.metrics for bench in self.benches)

    @property
    def requirements(self) -> tuple[Requirement, ...]:
        """Those of all benches, each by the first bench that has it."""
        return _first_of_each(bench.requirements for bench in self.benches)


_Named = TypeVar("_Named", Metric, Requirement)


def _first_of_each(lists: Iterable[tuple[_Named, ...]]) -> tuple[_Named, ...]:
    found: dict[str, _Named] = {}
    for one in (one for each in lists for one in each):
        found.setdefault(one.name, one)
    return tuple(found.values())


def types_of(variables: Iterable[DesignVariable]) -> dict[str, Type]:
    """What constraints may speak of: the *variables*, as numbers in SI."""
    return {variable.name: Type(Kind.REAL, variable.unit) for variable in variables if not variable.labels}
