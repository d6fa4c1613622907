"""What a package may import that adds a component kind, a sampler, an executor, a figure or a metric function to dse.

`examples/plugin` in dse's repository has one of each; `dse.testing` has the tests they must pass. Nothing is imported
before it is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dse.domain.component import Component, CSource, Source
    from dse.domain.sampler import Brief, Candidate, DesignVariable, Outcomes
    from dse.errors import DseError, Location, Problem, fail
    from dse.exploration.once_sampler import OnceSampler, scaled
    from dse.exploration.remote import Carried, carry_out, hand_over, parcel
    from dse.exploration.work import Batch, Sink, Work
    from dse.kinds import ComponentKind, SourcePlace, SourceSection, build_generated
    from dse.loading.extensions import ExecutorSection, SamplerSection, Surroundings
    from dse.metrics.catalogue import Argument, Wants, metric_function, same
    from dse.report.charts.chart import Axis, Band, Bars, Chart, Line, Points, Rule, Steps
    from dse.report.content.nouns import ReportContent

_PLACES = {
    "dse.domain.component": ("CSource", "Component", "Source"),
    "dse.domain.sampler": ("Brief", "Candidate", "DesignVariable", "Outcomes"),
    "dse.errors": ("DseError", "Location", "Problem", "fail"),
    "dse.exploration.work": ("Batch", "Sink", "Work"),
    "dse.exploration.remote": ("Carried", "carry_out", "hand_over", "parcel"),
    "dse.exploration.once_sampler": ("OnceSampler", "scaled"),
    "dse.kinds": ("ComponentKind", "SourcePlace", "SourceSection", "build_generated"),
    "dse.loading.extensions": ("ExecutorSection", "SamplerSection", "Surroundings"),
    "dse.metrics.catalogue": ("Argument", "Wants", "metric_function", "same"),
    "dse.report.charts.chart": ("Axis", "Band", "Bars", "Chart", "Line", "Points", "Rule", "Steps"),
    "dse.report.content.nouns": ("ReportContent",),
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
    "Carried",
    "Chart",
    "Component",
    "ComponentKind",
    "DesignVariable",
    "DseError",
    "ExecutorSection",
    "Line",
    "Location",
    "OnceSampler",
    "Outcomes",
    "Points",
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
    "carry_out",
    "fail",
    "hand_over",
    "metric_function",
    "parcel",
    "same",
    "scaled",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'dse.plugins' has no attribute '{name}'")
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value
