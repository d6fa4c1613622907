"""Definitions of studies as they are stored, for tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from dse.domain.definition import (
    DefinedBench,
    DefinedConfiguration,
    DefinedDesign,
    DefinedMetric,
    DefinedRequirement,
    DefinedSampler,
    DefinedSimulation,
    StudyDefinition,
)

_PLAIN = StudyDefinition(
    "study",
    "",
    DefinedBench("bench"),
    DefinedDesign("design"),
    (),
    DefinedSampler("full_factorial", {"slices": []}, ()),
    1,
    (),
    (),
    DefinedSimulation(1.0, 0.1, 0.1),
    (),
    (),
)


def stored_definition(configurations: Sequence[DefinedConfiguration] = (), **facts: Any) -> StudyDefinition:
    """A definition over *configurations*; *facts* are other values of its fields."""
    names = tuple(configuration.id for configuration in configurations)
    return replace(_PLAIN, **{"configurations": tuple(configurations), "explored": names, **facts})


def metrics(*names: str) -> tuple[DefinedMetric, ...]:
    """Plain numbers, each the final value of what is called like it."""
    return tuple(DefinedMetric(name, name, "", f"final({name})") for name in names)


def at_most_one(metric: str, *names: str) -> tuple[DefinedRequirement, ...]:
    """Requirements that *metric* is at most 1."""
    return tuple(DefinedRequirement(name, name, metric, "", at_most=1.0) for name in names)
