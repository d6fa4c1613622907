"""What a package may import that adds a component kind, a sampler, an executor, a figure or a metric function to dse.

`examples/plugin` in dse's repository has one of each; `dse.testing` has the tests they must pass. Nothing is imported
before it is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dse.domain.component import Component, CSource, Source
    from dse.domain.sampler import Brief, Candidate, DesignVariable, Outcomes, Placing
    from dse.errors import DseError, Location, Problem, fail
    from dse.exploration import Batch, FuturesExecutor, OneShotSampler, Pool, Sink, Work, scaled, unit_of
    from dse.kinds import build_generated
    from dse.loading import ComponentKind, ExecutorSection, SamplerSection, SourcePlace, SourceSection, Surroundings
    from dse.metrics import Argument, Wants, metric_function, same
    from dse.report import Axis, Band, Bars, Chart, Line, Points, ReportContent, Rule, Steps

_PLACES = {
    "dse.domain.component": ("CSource", "Component", "Source"),
    "dse.domain.sampler": ("Brief", "Candidate", "DesignVariable", "Outcomes", "Placing"),
    "dse.errors": ("DseError", "Location", "Problem", "fail"),
    "dse.exploration": ("Batch", "FuturesExecutor", "OneShotSampler", "Pool", "Sink", "Work", "scaled", "unit_of"),
    "dse.kinds": ("build_generated",),
    "dse.loading": (
        "ComponentKind",
        "ExecutorSection",
        "SamplerSection",
        "SourcePlace",
        "SourceSection",
        "Surroundings",
    ),
    "dse.metrics": ("Argument", "Wants", "metric_function", "same"),
    "dse.report": ("Axis", "Band", "Bars", "Chart", "Line", "Points", "ReportContent", "Rule", "Steps"),
}
_HOMES = {name: module for module, names in _PLACES.items() for name in names}

__all__ = [  # as above: type checkers read a list of words only
    "Argument",
    "Axis",
    "Band",
    "Bars",
    "Batch",
    "Brief",
    "CSource",
    "Candidate",
    "Chart",
    "Component",
    "ComponentKind",
    "DesignVariable",
    "DseError",
    "ExecutorSection",
    "FuturesExecutor",
    "Line",
    "Location",
    "OneShotSampler",
    "Outcomes",
    "Placing",
    "Points",
    "Pool",
    "Problem",
    "ReportContent",
    "Rule",
    "SamplerSection",
    "Sink",
    "Source",
    "SourcePlace",
    "SourceSection",
    "Steps",
    "Surroundings",
    "Wants",
    "Work",
    "build_generated",
    "fail",
    "metric_function",
    "same",
    "scaled",
    "unit_of",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'dse.plugins' has no attribute '{name}'")
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value
