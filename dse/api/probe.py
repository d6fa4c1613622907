"""Finding out what FMUs really do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from dse.cosim import ProbeLimits, probe
from dse.domain.system import Element
from dse.fmu import build, open_component, open_fmu, this_platform
from dse.loading import Workspace
from dse.testbench import (
    consequences,
    facts_as_data,
    keep_facts,
    known_facts,
    numerics_as_data,
    numerics_of_element,
)

if TYPE_CHECKING:
    from dse.domain.facts import FmuFacts, FmuNumerics, Question
    from dse.domain.fmu import FmuModel

__all__ = [
    "consequences", "facts_as_data", "known_facts", "model_of", "numerics_as_data", "probe_fmu", "probe_numerics",
]  # fmt: skip


def model_of(name: str, *, version: int = 2) -> FmuModel:
    """The FMU in the file *name*, or that of the component called so in the workspace here. Raises DseError."""
    if _is_file(name):
        return open_fmu(Path(name))
    component = Workspace.around(Path()).component(name)
    return open_component(component, build(component, version=version))


def probe_fmu(model: FmuModel, *, timeout: float, tell: Callable[[Question], None], sandbox: bool = False) -> FmuFacts:
    """Make the experiments, each of at most *timeout* seconds, and keep what they show in the cache."""
    facts = probe(model, this_platform().name, limits=ProbeLimits(time=timeout), tell=tell, sandboxed=sandbox)
    keep_facts(facts)
    return facts


def probe_numerics(
    name: str, model: FmuModel, *, timeout: float, again: bool = False, sandbox: bool = False
) -> FmuNumerics:
    """How exact *model* is, which `model_of` found by *name*: tried in its default experiment, or known from before."""
    outputs = tuple(v for v in model.variables.values() if v.causality == "output" and v.kind is not None)
    is_ours = False
    if not _is_file(name):
        source = Workspace.around(Path()).component(name).source
        is_ours = source is not None and not source.is_finished
    element = Element(model.identifier, model, (), outputs, {})
    limits = ProbeLimits(time=timeout)
    return numerics_of_element(element, is_ours=is_ours, limits=limits, again=again, sandboxed=sandbox)


def _is_file(name: str) -> bool:
    return Path(name).suffix.lower() == ".fmu" or Path(name).is_file()
