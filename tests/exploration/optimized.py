"""Samplers driven without simulation: objectives and margins are functions of configuration and point."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import Verdict
from dse.domain.design import Configuration
from dse.domain.sampler import Architecture, Brief, Candidate, DesignVariable, Objective, Outcomes, Sampler
from dse.units import DIMENSIONLESS

Array = NDArray[np.float64]
Runs = tuple[Mapping[str, Array], Mapping[str, Array]]
"""Metrics, NaN of what failed to run, and margins, NaN where a requirement is not exercised; each (n,)."""

Function = Callable[[Sequence[str], Array], Runs]
"""Of n configurations and their points, (n, variables)."""


class One:
    """A space of a single configuration without choices."""

    alternatives: Mapping[str, tuple[str | None, ...]] = {}

    def count(self) -> int:
        return 1

    def draw(self, number: int, seed: int) -> Sequence[Architecture]:
        return [Architecture("only", {})] * number

    stratified = draw

    def completed(self, wishes: Sequence[tuple[str, str | None]], seed: int) -> Architecture:
        return Architecture("only", {})

    def configuration(self, name: str) -> Configuration:
        return Configuration(name, {}, {})


@dataclass
class Driven:
    """What a sampler asked for, ask by ask, and what it was told."""

    asks: list[list[Candidate]] = field(default_factory=list)
    told: list[Outcomes] = field(default_factory=list)

    @property
    def candidates(self) -> list[Candidate]:
        return [candidate for ask in self.asks for candidate in ask]

    def column(self, name: str) -> Array:
        return np.concatenate([outcomes.metrics[name] for outcomes in self.told])

    def margins(self, name: str) -> Array:
        return np.concatenate([outcomes.margins[name] for outcomes in self.told])


def variables(number: int, low: float = 0.0, high: float = 1.0) -> tuple[DesignVariable, ...]:
    return tuple(DesignVariable(f"part.x{i}", low, high, 2, (low + high) / 2, DIMENSIONLESS) for i in range(number))


def brief(some: tuple[DesignVariable, ...], *objectives: str, seed: int = 1, **more: object) -> Brief:
    nothing = np.zeros(0)
    none = Outcomes((), {v.name: nothing for v in some}, np.zeros(0, bool), {}, {}, {})
    wanted = tuple(Objective(name.lstrip("-"), name.startswith("-")) for name in objectives)
    return Brief(some, (), seed, none, **{"space": One(), "objectives": wanted, **more})  # type: ignore[arg-type]


def drive(
    sampler: Sampler, given: Brief, function: Function, has: Callable[[str], Sequence[bool]] | None = None
) -> Driven:
    """All asks of the sampler, answered by *function*; what a configuration does not have is told as nominal."""
    nominal = np.array([variable.nominal for variable in given.variables])
    search = sampler.start(given)
    driven = Driven()
    while asked := list(search.ask()):
        points = np.array([candidate.point for candidate in asked]).reshape(len(asked), -1)
        names = tuple(candidate.configuration for candidate in asked)
        if has is not None:
            points = np.where([has(name) for name in names], points, nominal)
        metrics, margins = function(names, points)
        done = np.all([np.isfinite(values) for values in metrics.values()], axis=0)
        verdicts = {
            name: tuple(_verdict(*one) for one in zip(done.tolist(), values.tolist(), strict=True))
            for name, values in margins.items()
        }
        columns = {v.name: points[:, i] for i, v in enumerate(given.variables)}
        outcomes = Outcomes(names, columns, done, metrics, margins, verdicts)
        driven.asks.append(asked)
        driven.told.append(outcomes)
        search.tell(outcomes)
    return driven


def _verdict(done: bool, margin: float) -> Verdict:
    if not done:
        return Verdict.FAILED_TO_RUN
    if np.isnan(margin):
        return Verdict.NOT_EXERCISED
    return Verdict.PASS if margin >= 0 else Verdict.FAIL
