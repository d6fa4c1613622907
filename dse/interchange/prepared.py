"""An SSP package made ready to be simulated: its FMUs opened, its experiment complete."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from dse.cosim.feasibility import require_kernel, simulation_problems
from dse.domain.bench import Simulation
from dse.domain.design import Configuration
from dse.domain.facts import FmuFacts
from dse.domain.fmu import Experiment, FmiInterface, FmuModel
from dse.domain.method import PLAIN, Method
from dse.domain.system import SystemStructure
from dse.errors import DseError, Location, Problem, fail, raise_if_any
from dse.fmu.cache import cache_folder
from dse.fmu.unpack import open_fmu
from dse.formats.yaml import shown
from dse.interchange.reading.open import open_ssp
from dse.interchange.resolving.resolve import Models, ResolvedSystem, system_of
from dse.interchange.structure import Component, SspSystem
from dse.metrics.program import compile_metrics
from dse.testbench.prepared import PreparedBench
from dse.testbench.trust import facts_of

_STEPS = 1000
"""Steps of an experiment for which nobody says how long they are."""


@dataclass(frozen=True, slots=True)
class Timing:
    """How long and how finely, in seconds, and who said so."""

    stop: float
    step: float
    stop_said_by: str
    step_said_by: str


@dataclass(frozen=True, slots=True)
class PreparedPackage:
    """A package that a runner can simulate as the configuration called ``ssp``, and what it was made of."""

    ssp: SspSystem
    resolved: ResolvedSystem
    timing: Timing
    bench: PreparedBench


def read_package(path: Path, variant: str | None = None, cache: Path | None = None) -> tuple[SspSystem, Models]:
    """The package at *path* with its FMUs opened. Raises DseError with the problems of all of them."""
    ssp = open_ssp(path, cache_folder(cache) / "ssp", variant)
    models: dict[tuple[Path, str], FmuModel] = {}
    problems: list[Problem] = []
    for component in ssp.places.values():
        if component.key in models:
            continue
        wanted = None if component.implementation == "any" else FmiInterface(component.implementation)
        try:
            models[component.key] = open_fmu(component.fmu, cache=cache, interface=wanted)
        except DseError as error:
            # Where the FMU is named is what a person can change.
            problems += [_of_fmu(component, problem) for problem in error.problems]
    raise_if_any(problems)
    return ssp, models


def _of_fmu(component: Component, problem: Problem) -> Problem:
    place = str(problem.where).replace(shown(component.fmu), component.source) if problem.where else component.source
    return Problem(f"{place}: {problem.what}", component.where, problem.hint)


def prepare_ssp(
    path: Path,
    *,
    variant: str | None = None,
    stop: float | None = None,
    step: float | None = None,
    settings: Mapping[str, str] | None = None,
    record: Sequence[str] = (),
    method: Method = PLAIN,
    timeout: float = 600.0,
    cache: Path | None = None,
) -> PreparedPackage:
    """Make the package at *path* ready to be simulated. Raises DseError with all that is wrong.

    The run may take *timeout* seconds. What *stop* and *step* (seconds) do not say is taken from the package, then from
    its FMUs' default experiments.
    """
    ssp, models = read_package(path, variant, cache)
    resolved = system_of(ssp, models, settings=settings, record=record)
    if not resolved.signals:
        hint = "add output connectors to its components, or name what to record"
        raise fail("nothing in the package can be recorded", Location(shown(path)), hint)
    where = Location(shown(path))
    timing = timing_of(resolved.experiment, list(models.values()), stop, step, where)
    every = ssp.experiment.record_every if step is None else None
    if not (every and _divides(timing.step, every) and _divides(every, timing.stop)):
        every = timing.step
    simulation = Simulation(timing.stop, timing.step, resolved.record, every, timeout=timeout, method=method)
    facts = facts_of(resolved.structure, cache=cache)
    _require_fit(resolved.structure, simulation, facts, where)
    bench = PreparedBench(
        configuration=Configuration("ssp", {}),
        system=resolved.structure,
        simulation=simulation,
        program=compile_metrics((), (), {}, frozenset()),
        requirements=(),
        columns=resolved.record,
        system_columns=resolved.record,
        kept=resolved.record,
        settings={},
        constants={},
        method=method,
        facts=facts,
    )
    return PreparedPackage(ssp, resolved, timing, bench)


def _require_fit(
    system: SystemStructure, simulation: Simulation, facts: Mapping[str, FmuFacts], where: Location
) -> None:
    """Raise DseError, at *where*, with every reason why *system* cannot be simulated so."""
    require_kernel()
    problems = simulation_problems(system, simulation.method, facts, stop=simulation.stop, step=simulation.step)
    raise_if_any(Problem(problem.what, problem.where or where, problem.hint) for problem in problems)


def timing_of(
    experiment: Experiment, models: Sequence[FmuModel], stop: float | None, step: float | None, where: Location
) -> Timing:
    """How long and how finely to simulate. Raises DseError if nobody says how long."""
    if experiment.start and stop is None:
        what = f"the experiment starts at {experiment.start:g} s; simulations start at 0 s in this version"
        raise fail(what, where, "say how long to simulate from 0 s on: --stop '10 s'")
    stops = [m.experiment.stop - (m.experiment.start or 0.0) for m in models if m.experiment.stop is not None]
    steps = [m.experiment.step for m in models if m.experiment.step]
    if stop is not None:
        stop_said_by = "asked for"
    elif experiment.stop is not None:
        stop, stop_said_by = experiment.stop, "the package"
    elif stops:
        stop, stop_said_by = max(stops), "its FMUs"
    else:
        what = "neither the package nor its FMUs say how long to simulate"
        raise fail(what, where, "say it: --stop '10 s'")
    if step is not None:
        return Timing(stop, step, stop_said_by, "asked for")
    if experiment.step is not None:
        return Timing(stop, experiment.step, stop_said_by, "the package")
    if steps and _divides(min(steps), stop):
        return Timing(stop, min(steps), stop_said_by, "its FMUs")
    return Timing(stop, stop / _STEPS, stop_said_by, f"1/{_STEPS} of the time, as nobody says it")


def _divides(step: float, stop: float) -> bool:
    ratio = stop / step
    return math.isfinite(ratio) and round(ratio) >= 1 and abs(ratio - round(ratio)) <= 1e-9 * ratio
