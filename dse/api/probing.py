"""Finding out what FMUs really do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from dse.cosim import ProbeLimits, probe
from dse.fmu import build, open_component, open_fmu, this_platform
from dse.loading import Workspace
from dse.testbench import consequences, facts_as_data, keep_facts, known_facts

if TYPE_CHECKING:
    from dse.domain.facts import FmuFacts, Question
    from dse.domain.fmu import FmuModel

__all__ = ["consequences", "facts_as_data", "known_facts", "model_of", "probe_fmu"]


def model_of(name: str, *, version: int = 2) -> FmuModel:
    """The FMU in the file *name*, or that of the component called so in the workspace here. Raises DseError."""
    path = Path(name)
    if path.suffix.lower() == ".fmu" or path.is_file():
        return open_fmu(path)
    component = Workspace.around(Path()).component(name)
    return open_component(component, build(component, version=version))


def probe_fmu(model: FmuModel, *, timeout: float, tell: Callable[[Question], None], sandbox: bool = False) -> FmuFacts:
    """Make the experiments, each of at most *timeout* seconds, and keep what they show in the cache."""
    facts = probe(model, this_platform().name, limits=ProbeLimits(time=timeout), tell=tell, sandboxed=sandbox)
    keep_facts(facts)
    return facts
