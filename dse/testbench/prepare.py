"""Bench + configurations → FMUs built, systems assembled, metrics compiled."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from dse.cosim import require_kernel, simulation_problems
from dse.domain.bench import Simulation, TestBench, is_multiple
from dse.domain.component import Component, Kind, Type
from dse.domain.design import Configuration, split_path, walk
from dse.domain.fmu import FmuModel
from dse.domain.labels import is_part, tightened
from dse.domain.method import BONDS, Algorithm
from dse.domain.noise import DRAW
from dse.domain.system import SystemStructure
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.fmu import build_all, in_parallel, open_component
from dse.metrics import MetricProgram, RowProgram, compile_metrics, compile_value
from dse.system import Elements, assemble, wiring_problems
from dse.testbench.facts import KnownFmus
from dse.testbench.method import method_of, signal_name
from dse.testbench.prepared_bench import PreparedBench, Recording, Setting
from dse.testbench.split_bench import Halves, WorldPlace, far_half, in_world, near_half, signal_in_near, split_in_two
from dse.testbench.wired_bench import WiredBench, wire_bench
from dse.units import parse_unit

Key = TypeVar("Key")
Made = TypeVar("Made")


@dataclass(frozen=True, slots=True)
class CheckedBench:
    """A configuration on its bench in which nothing is wrong that shows without an FMU; *simulation* as prepared."""

    wired: WiredBench
    simulation: Simulation
    program: MetricProgram
    kept: tuple[str, ...]
    derived: Mapping[str, RowProgram]
    halves: Halves | None = None

    @property
    def columns(self) -> tuple[str, ...]:
        """All that is recorded, as ``part.port``."""
        return tuple(dict.fromkeys((*self.program.signals, *self.kept)))

    @property
    def sources(self) -> list[str]:
        """The outputs of components behind the *columns*."""
        whole = self.wired if self.halves is None else self.halves.wired
        found = [whole.faces.get(name, name) for name in self.columns]
        return found if self.halves is None else [signal_in_near(self.halves, name) for name in found]

    @property
    def settings(self) -> tuple[dict[str, Setting], dict[str, float]]:
        """What a run may be given, and the values of what it may not: that is in the world's half."""
        if self.halves is None:
            return self.wired.settings, {}
        settings, far = self.halves.wired.settings, {n for n in self.halves.wired.settings if in_world(self.halves, n)}
        if far & {stream.name for stream in self.halves.wired.streams}:
            far.add(DRAW)  # a run here does not set the seeds there
        return {n: s for n, s in settings.items() if n not in far}, {n: settings[n].value for n in far}


def prepare_bench(
    bench: TestBench,
    configurations: Iterable[Configuration],
    *,
    version: int = 2,
    cache: Path | None = None,
    world: WorldPlace | None = None,
) -> dict[str, PreparedBench]:
    """Make every configuration ready to run on *bench*, by configuration id. Raises DseError with all problems.

    No FMU is built before all is right that can be told without. With a *world*, that half of the bench is there.
    """
    require_kernel()

    def check(configuration: Configuration) -> CheckedBench:
        whole = check_bench(bench, configuration)
        return whole if world is None else _near(whole, world)

    checked = _each({c.id: c for c in configurations}, check)
    return build_checked(checked, version=version, cache=cache)


def build_checked(
    checked: Mapping[str, CheckedBench], *, version: int = 2, cache: Path | None = None
) -> dict[str, PreparedBench]:
    """Build the FMUs of what is *checked*, and assemble systems of them, by the same names. Raises DseError."""
    components = {c.name: c for one in checked.values() for c in one.wired.parts.values()}
    archives = build_all(components.values(), version=version, cache=cache)
    models = in_parallel(archives, lambda name: open_component(components[name], archives[name], cache=cache))
    known, elements = KnownFmus(cache), Elements()
    return _each(checked, lambda one: _prepared(one, models, known, elements))


def check_bench(bench: TestBench, configuration: Configuration) -> CheckedBench:
    """Check wiring, metrics and recorded names of one configuration without building an FMU. Raises DseError."""
    wired = wire_bench(bench, configuration)
    problems = list(wiring_problems(wired))
    method = method_of(wired, problems)
    simulation = replace(bench.simulation, method=method)
    energies = {f"{BONDS}.{bond.name}": Type(Kind.REAL, parse_unit("J")) for bond in method.bonds}
    names = dict.fromkeys((*wired.signals, *energies))
    signals = frozenset(names)
    problems += [*_record_problems(wired, signals), *sampling_problems(simulation, wired.parts)]
    try:
        program = compile_metrics(bench.metrics, bench.requirements, wired.types | energies, signals)
    except DseError as error:
        raise DseError(*problems, *error.problems) from error
    derived = _derived(wired, problems)
    raise_if_any(problems)
    shown = [name for figure in bench.figures for name in (figure.current, figure.target) if name]
    recorded = (label for name in simulation.record for label in _labels(name, names))
    kept = tuple(dict.fromkeys((*recorded, *(name for name in shown if name in signals))))
    return CheckedBench(wired, simulation, program, kept, derived)


def _near(whole: CheckedBench, world: WorldPlace) -> CheckedBench:
    """The car's half of a bench: its metrics are those of the whole."""
    halves = halves_of(whole, world)
    return replace(whole, wired=near_half(halves, world.source), halves=halves)


def halves_of(whole: CheckedBench, world: WorldPlace) -> Halves:
    """The halves of a bench. Raises DseError if it has none, or parameters of the world change from run to run."""
    halves = split_in_two(whole.wired, whole.simulation, world.parts, whole.sources)
    raise_if_any(
        Problem(f"{name} follows from others in every run, and is in the world's half", each.where, "leave it out")
        for each in whole.wired.bench.derived
        if (name := each.name) in whole.derived and in_world(halves, name)
    )
    return halves


def prepare_world(
    bench: TestBench,
    configuration: Configuration,
    world: WorldPlace,
    *,
    version: int = 2,
    cache: Path | None = None,
) -> PreparedBench:
    """The world's half of *configuration* on *bench*, which measures nothing. Raises DseError with all problems."""
    require_kernel()
    whole = check_bench(bench, configuration)
    wired = far_half(halves_of(whole, world), world.source)
    method = whole.simulation.method
    if method.algorithm is Algorithm.JACOBI:
        method = replace(method, leading=wired.order[:1])
    return prepare_unmeasured(wired, replace(whole.simulation, method=method), version=version, cache=cache)


def prepare_unmeasured(
    wired: WiredBench, simulation: Simulation, *, version: int = 2, cache: Path | None = None
) -> PreparedBench:
    """A run of *wired* that measures and records nothing. Raises DseError with all problems."""
    checked = CheckedBench(wired, simulation, compile_metrics((), (), {}, frozenset()), (), {})
    return build_checked({wired.configuration.id: checked}, version=version, cache=cache)[wired.configuration.id]


def _derived(wired: WiredBench, problems: list[Problem]) -> dict[str, RowProgram]:
    """What follows from other settings, as far as it is there; such that stand further down are not among these."""
    settings = wired.settings
    later = [each.name for each in wired.bench.derived]
    found: dict[str, RowProgram] = {}
    for each in wired.bench.derived:
        types = {name: setting.type for name, setting in settings.items() if name not in later}
        later.remove(each.name)
        if each.name in settings:
            try:
                found[each.name] = compile_value(each.expression, types, each.type)
            except DseError as error:
                problems += error.problems
    return found


def _labels(name: str, signals: Collection[str]) -> list[str]:
    """The *signals* that ``record: [name]`` means: the one called so, or all of the group or array."""
    name = tightened(name)
    if name in signals:
        return [name]
    return [signal for signal in signals if is_part(signal, name)]


def with_facts(
    prepared: PreparedBench, parts: Mapping[str, Component], where: Location | None, known: KnownFmus
) -> PreparedBench:
    """*prepared* with what is *known* of its FMUs; *parts* are the components by element, as far as there are some.

    Raises DseError, at *where*, with every reason why it cannot be simulated.
    """
    system, simulation = prepared.system, prepared.simulation
    facts = known.facts_of(system)
    unfit = simulation_problems(system, simulation.method, facts, stop=simulation.stop, step=simulation.step)
    raise_if_any(Problem(problem.what, problem.where or where, problem.hint) for problem in [*_crowded(system), *unfit])
    return replace(prepared, facts=facts, thread_safe=known.is_thread_safe(system, facts, parts))


def _each(keys: Mapping[str, Key], make: Callable[[Key], Made]) -> dict[str, Made]:
    """What *make* makes of each; one DseError with the problems of all."""
    made: dict[str, Made] = {}
    problems: list[Problem] = []
    for name, key in keys.items():
        try:
            made[name] = make(key)
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    return made


def _prepared(
    checked: CheckedBench, models: Mapping[str, FmuModel], known: KnownFmus, elements: Elements
) -> PreparedBench:
    wired, simulation, parts = checked.wired, checked.simulation, checked.wired.parts
    raise_if_any(stepping_problems(simulation, parts, models))
    columns, sources = checked.columns, checked.sources
    settings, fixed = checked.settings
    variables = (name if name.startswith(f"{BONDS}.") else signal_name(name, parts) for name in sources)
    prepared = PreparedBench(
        configuration=wired.configuration,
        system=assemble(wired.configuration.id, wired, models, sources, elements).with_tolerance(simulation.tolerance),
        simulation=simulation,
        program=checked.program,
        recording=Recording(columns, tuple(variables), checked.kept),
        requirements=wired.bench.requirements,
        settings=settings,
        fixed=fixed,
        derived=checked.derived,
        streams=wired.streams,
    )
    return with_facts(prepared, parts, simulation.where, known)


def _crowded(system: SystemStructure) -> list[Problem]:
    """FMUs that say they can be there once only, and are to stand at several places."""
    places: dict[Path, list[str]] = {}
    for element in system.elements:
        if element.model.capabilities.once_per_process:
            places.setdefault(element.model.library, []).append(element.name)
    hint = "`isolate: true` in the source of its component gives each a process of its own"
    return [
        Problem(f"{' and '.join(names)}: {library.stem} can be instantiated only once in a process", hint=hint)
        for library, names in places.items()
        if len(names) > 1
    ]


def _record_problems(wired: WiredBench, signals: frozenset[str]) -> list[Problem]:
    """Recorded names that are no output of a part that is there."""
    problems = []
    parts, simulation = wired.parts, wired.bench.simulation
    places = {path for path, _ in walk(wired.bench.design.root)} | set(parts)
    for name in simulation.record:
        if _labels(name, signals) or name.startswith(f"{BONDS}."):
            continue
        standing = split_path(name, places)
        if standing is None:
            problems.append(Problem(f"cannot record '{name}': no such part", simulation.where))
        elif standing[0] in parts or any(part.startswith(f"{standing[0]}.") for part in parts):
            known = sorted(signal for signal in signals if signal.startswith(f"{standing[0]}."))
            hint = f"outputs: {', '.join(known)}"
            problems.append(Problem(f"cannot record '{name}': no such output", simulation.where, hint))
    return problems


# Whether a bench's communication step suits the parts on it.


def sampling_problems(simulation: Simulation, parts: Mapping[str, Component]) -> Iterator[Problem]:
    """Sampled parts whose sample time is not a whole number of their steps: their own, or the bench's.

    With a coarser step they would see each input several times (and a derivative of zero), with an uneven one they
    would run up to a step late.
    """
    for path, component in parts.items():
        step = simulation.method.steps.get(path, simulation.step)
        sample_time = component.source.sample_time if component.source is not None else None
        if sample_time is not None and not is_multiple(sample_time, step):
            what = f"{path} ({component.name}) samples every {sample_time:g} s, no multiple of the step {step:g} s"
            yield Problem(what, simulation.where, "choose a step of which all sample times are multiples")


def stepping_problems(
    simulation: Simulation, parts: Mapping[str, Component], models: Mapping[str, FmuModel]
) -> Iterator[Problem]:
    """FMUs whose step, their own or the bench's, is no whole multiple of what they can do.

    With ``check_step`` the same is asked of half the step, or of twice the step until the end.
    """
    for path, component in parts.items():
        fixed = models[component.name].fixed_step
        step = simulation.method.steps.get(path, simulation.step)
        if fixed is None:
            continue
        if not is_multiple(step, fixed):
            what = f"{path} ({component.name}) steps by {fixed:g} s, and {step:g} s is not a multiple of that"
            hint = f"step: {fixed:g} s, or for this part alone steps: {{{path}: {fixed:g} s}}"
            yield Problem(what, simulation.where, hint)
        elif simulation.check_step and not is_multiple(step / 2, fixed) and simulation.steps % 2:
            what = (
                f"{path} ({component.name}) steps by {fixed:g} s: half the step is none, and twice the step ends late"
            )
            yield Problem(what, simulation.where, "leave out check_step, or let 'stop' be an even number of steps")
