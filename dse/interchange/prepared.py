"""An SSP package, or a single FMU, made ready to be simulated: its FMUs opened, its experiment complete."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from dse.cache import cache_folder
from dse.cosim import require_kernel
from dse.domain.bench import Simulation, is_multiple
from dse.domain.design import Configuration
from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.method import PLAIN, Method
from dse.domain.run import Waveforms
from dse.errors import DseError, Location, fail
from dse.fmu import in_parallel, open_fmu
from dse.formats import shown
from dse.interchange.names import free_word
from dse.interchange.reading.open import open_ssp
from dse.interchange.resolving.matching import of_fmu
from dse.interchange.resolving.network import Models
from dse.interchange.resolving.resolve import ResolvedSystem, system_of
from dse.interchange.structure import Connector, ExperimentSettings, SspComponent, SspSystem, System
from dse.metrics import compile_metrics
from dse.testbench import KnownFmus, PreparedBench, Recording, with_facts

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

    @property
    def units(self) -> dict[str, str]:
        """The units of its signals."""
        return {signal.name: signal.unit for signal in self.resolved.signals}

    def signals(self, recorded: Waveforms) -> Waveforms:
        """What was recorded as the system's own connectors show it."""
        values = {s.name: s.carry.apply_all(recorded.values[s.label]) for s in self.resolved.signals}
        return Waveforms(recorded.time, values)


def read_package(path: Path, variant: str | None = None, cache: Path | None = None) -> tuple[SspSystem, Models]:
    """The package or FMU at *path* with its FMUs opened. Raises DseError with the problems of all of them."""
    if is_fmu(path):
        return _alone(path, cache)
    ssp = open_ssp(path, cache_folder(cache) / "ssp", variant)
    components: dict[tuple[Path, str], SspComponent] = {}
    for component in ssp.places.values():
        components.setdefault(component.key, component)
    return ssp, in_parallel(components, lambda key: _opened(components[key], cache))


def is_fmu(path: Path) -> bool:
    """Whether *path* is that of a single FMU."""
    return path.suffix.lower() == ".fmu"


def _alone(path: Path, cache: Path | None) -> tuple[SspSystem, Models]:
    """The FMU as the only component of a system, with its outputs as connectors."""
    model, where = open_fmu(path, cache=cache), Location(shown(path))
    outputs = tuple(
        Connector(each.name, "output", None, where, (None,) * len(each.shape))
        for each in model.variables.values()
        if each.causality == "output"
    )
    name = _element(path)
    component = SspComponent(name, path.name, path, outputs, (), where)
    system = System(name, (component,), (), (), ())
    return SspSystem(path.stem, "", "", system, ExperimentSettings()), {component.key: model}


def _element(path: Path) -> str:
    """What a single FMU is called in messages; its variables are called as they are."""
    return free_word(path.stem, ())


def _opened(component: SspComponent, cache: Path | None) -> FmuModel:
    wanted = None if component.implementation == "any" else FmiInterface(component.implementation)
    try:
        return open_fmu(component.fmu, cache=cache, interface=wanted)
    except DseError as error:
        raise DseError(*(of_fmu(component, problem) for problem in error.problems)) from error


def check_ssp(path: Path, cache: Path | None = None) -> ResolvedSystem:
    """The system of the package or FMU at *path*, whose experiment may be incomplete.

    Raises DseError with what is wrong.
    """
    return system_of(*read_package(path, None, cache))


def prepare_ssp(
    path: Path,
    *,
    variant: str | None = None,
    stop: float | None = None,
    step: float | None = None,
    settings: Mapping[str, str] | None = None,
    record: Sequence[str] = (),
    method: Method = PLAIN,
    tolerance: float | None = None,
    timeout: float = 600.0,
    cache: Path | None = None,
) -> PreparedPackage:
    """Make the package or FMU at *path* ready to be simulated. Raises DseError with all that is wrong.

    The run may take *timeout* seconds. What *stop* and *step* (seconds) do not say is taken from the package, then from
    its FMUs' default experiments; so it is with what FMUs are told as their *tolerance*.
    """
    require_kernel()
    ssp, models = read_package(path, variant, cache)
    where, prefix = Location(shown(path)), f"{_element(path)}." if is_fmu(path) else ""

    def full(name: str) -> str:
        is_full = name.startswith(prefix) and not any(name in model.variables for model in models.values())
        return name if is_full else prefix + name

    given = {full(name): text for name, text in (settings or {}).items()}
    resolved = system_of(ssp, models, settings=given, record=[full(name) for name in record])
    if prefix:
        signals = (replace(each, name=each.name.removeprefix(prefix)) for each in resolved.signals)
        resolved = replace(resolved, signals=tuple(signals))
    if not resolved.signals:
        hint = "name what to record (--record)"
        raise fail("it has no outputs that can be recorded", where, hint)
    timing = timing_of(ssp.experiment, models.values(), stop, step, where)
    every = ssp.experiment.record_every if step is None else None
    if not (every and is_multiple(every, timing.step) and is_multiple(timing.stop, every)):
        every = timing.step
    tolerance = ssp.experiment.tolerance if tolerance is None else tolerance
    bench = PreparedBench(
        configuration=Configuration("ssp", {}),
        system=resolved.structure.with_tolerance(tolerance),
        simulation=Simulation(
            timing.stop, timing.step, resolved.record, every, timeout=timeout, method=method, tolerance=tolerance
        ),
        program=compile_metrics((), (), {}, frozenset()),
        recording=Recording(resolved.record, resolved.record, resolved.record),
    )
    return PreparedPackage(ssp, resolved, timing, with_facts(bench, {}, where, KnownFmus(cache)))


def timing_of(
    experiment: ExperimentSettings,
    models: Collection[FmuModel],
    stop: float | None,
    step: float | None,
    where: Location,
) -> Timing:
    """How long and how finely to simulate. Raises DseError if nobody says how long."""
    if experiment.start and stop is None:
        what = f"the experiment starts at {experiment.start:g} s; simulations start at 0 s in this version"
        raise fail(what, where, "set how long to simulate from 0 s on: --stop '10 s'")
    own = [model.experiment for model in models]
    stops = [said.stop - (said.start or 0.0) for said in own if said.stop is not None]
    until, stop_said_by = _first(stop, experiment.stop, max(stops, default=None))
    if until is None:
        what = "it does not define how long to simulate"
        raise fail(what, where, "set it: --stop '10 s'")
    least = min((said.step for said in own if said.step), default=None)
    every, step_said_by = _first(step, experiment.step, least if least and is_multiple(until, least) else None)
    if every is None:
        every, step_said_by = until / _STEPS, f"1/{_STEPS} of the time, as none is given"
    return Timing(until, every, stop_said_by, step_said_by)


def _first(asked: float | None, package: float | None, fmus: float | None) -> tuple[float | None, str]:
    """The first that is said, and who says it."""
    for said, by in ((asked, "asked for"), (package, "the package"), (fmus, "its FMUs")):
        if said is not None:
            return said, by
    return None, ""
