"""One configuration on its bench, with other parameter values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.studies.prepared_run import PreparedRun
from dse.domain.run import TESTBENCH
from dse.domain.study import Selection
from dse.exploration import simulate_alone
from dse.storage import StudyHeader, changed_inputs, si_unit
from dse.testbench import (
    bench_study,
    make_runner,
    on_bench,
    one_configuration,
    prepare_study,
    singly,
    with_settings,
)

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.definition import StudyDefinition
    from dse.domain.design import Configuration
    from dse.domain.run import Run as RunNoun
    from dse.domain.study import Study
    from dse.loading import Raw
    from dse.testbench import PreparedStudy, WorldPlace


Tell = Callable[[str], None]
"""Takes messages about the progress of a build."""

OnChanged = Callable[[tuple[str, ...]], object]
"""Takes what has changed since a study was made, before anything is simulated; it may raise."""


def prepare_once(
    bench: TestBench,
    configuration: str | None,
    settings: Mapping[str, Raw],
    *,
    check_step: bool = False,
    fuse: bool = False,
    sandbox: bool = False,
    fmi: int = 2,
    tell: Tell | None = None,
    world: WorldPlace | None = None,
) -> PreparedRun:
    """The configuration whose id starts so, or the first, with values as users write them, ready to be simulated.

    The *world* is where that half of the bench is simulated, if not here.
    Raises DseError if there is no such configuration or parameter, or a value does not fit it.
    """
    study = _single(bench, configuration, settings)
    if check_step:
        simulation = replace(study.bench.simulation, check_step=True)
        study = replace(study, bench=replace(study.bench, simulation=simulation))
    planned = ready(study, fmi, fuse=fuse, sandbox=sandbox, tell=tell, world=world)
    ((name, prepared),) = planned.benches.items()
    return PreparedRun(name, on_bench(prepared, 0), planned.definition, recorded_units(planned))


def study_of_bench(bench: TestBench, configuration: str | None = None) -> Study:
    """The study of *bench* on the configuration whose id starts so, or on every valid one."""
    if configuration is None:
        return bench_study(bench)
    return bench_study(bench, Selection.of((one_configuration(bench.design, configuration),)))


def fused_libraries(
    bench: TestBench, configuration: str | None, fmi: int = 2, *, tell: Tell | None = None
) -> dict[str, Path]:
    """The fused library of each configuration of `study_of_bench`, by its id."""
    planned = ready(study_of_bench(bench, configuration), fmi, fuse=True, tell=tell)
    each = [(name, bench) for name, benches in planned.benches.items() for bench in singly(benches)]
    return {name: bench.fused.path for name, bench in each if bench.fused is not None}


def write_package(
    bench: TestBench,
    configuration: str | None,
    settings: Mapping[str, Raw],
    target: Path,
    *,
    fmi: int = 2,
    platforms: Sequence[str] = (),
) -> tuple[Configuration, int]:
    """Write the configuration as `prepare_once` has it as an SSP package; returns it and how many elements it has.

    Its FMUs get libraries for *platforms*, too, which FMI names: ``win64``, ``aarch64-darwin``.
    """
    from dse.fmu import in_parallel, platforms_named, with_platforms
    from dse.interchange import ExperimentSettings, write_ssp
    from dse.testbench import prepare_bench

    study = _single(bench, configuration, settings)
    (chosen,) = study.selection.configurations
    prepared = prepare_bench(study.bench, [chosen], version=fmi)[chosen.id]
    system, simulation, others = prepared.system, prepared.simulation, platforms_named(platforms)
    if others:
        archives = {element.model.archive: element.name for element in system.elements}
        made = in_parallel(archives, lambda archive: with_platforms(archives[archive], archive, others))
        elements = (replace(e, model=replace(e.model, archive=made[e.model.archive])) for e in system.elements)
        system = replace(system, elements=tuple(elements))
    times = ExperimentSettings(0.0, simulation.stop, simulation.step, simulation.record_every, simulation.tolerance)
    write_ssp(target, bench.name, system, times)
    return chosen, len(system.elements)


def recorded_units(planned: PreparedStudy) -> dict[str, str]:
    """The SI unit of each waveform that is kept of the study's runs."""
    from dse.domain.component import Kind
    from dse.domain.method import BONDS
    from dse.testbench import wire_bench

    kept: dict[str, str] = {}
    for prepared in (bench for benches in planned.benches.values() for bench in singly(benches)):
        wired = wire_bench(planned.study.bench, prepared.configuration)
        units = {name: si_unit(t.unit.symbol) if t.kind is Kind.REAL else "" for name, t in wired.signals.items()}
        units |= {f"{BONDS}.{bond.name}": "J" for bond in prepared.simulation.method.bonds}
        kept |= {name: units[name] for name in prepared.recording.kept}
    return kept


def ready(
    study: Study,
    fmi: int = 2,
    *,
    fuse: bool = False,
    sandbox: bool = False,
    tell: Tell | None = None,
    world: WorldPlace | None = None,
) -> PreparedStudy:
    """*study* with all that has to be built for it. Raises DseError."""
    say = tell or (lambda _: None)
    say("building FMUs, assembling configurations")
    return prepare_study(study, version=fmi, say=say, sandboxed=sandbox, world=world, fuse=fuse)


def alone(
    study: Study,
    fmi: int,
    *,
    on: int = 0,
    fuse: bool = False,
    sandbox: bool = False,
    tell: Tell | None = None,
    world: WorldPlace | None = None,
) -> tuple[RunNoun, PreparedStudy]:
    """The single run of *study*, made in a process of its own, with waveforms; and what it was made from.

    It is made *on* the bench of this number, with the *world* where that is.
    """
    planned = ready(study, fmi, fuse=fuse, sandbox=sandbox, tell=tell, world=world)
    return _simulated(planned, on, sandbox=sandbox, tell=tell), planned


def _simulated(planned: PreparedStudy, on: int, *, sandbox: bool = False, tell: Tell | None = None) -> RunNoun:
    ((name, prepared),) = planned.benches.items()
    if tell:
        tell("simulating")
    measures = StudyHeader(planned.definition).measures
    return simulate_alone(on_bench(prepared, on), make_runner, name, measures, sandboxed=sandbox)


def again(
    study: Study,
    stored: StudyDefinition,
    run: RunNoun,
    fmi: int,
    *,
    tell: Tell | None = None,
    on_changed: OnChanged | None = None,
) -> tuple[RunNoun, PreparedStudy, tuple[str, ...]]:
    """As `alone`, for a *run* of the study that is *stored*; and what has changed since the study was made.

    If something has, *on_changed* is called with it before anything is simulated.
    """
    planned = ready(study, fmi, tell=tell)
    changed = tuple(changed_inputs(stored, planned.definition, run))
    if changed and on_changed:
        on_changed(changed)
    return _simulated(planned, int(run.request.point.get(TESTBENCH, 0)), tell=tell), planned, changed


def _single(bench: TestBench, configuration: str | None, settings: Mapping[str, Raw]) -> Study:
    chosen = one_configuration(bench.design, configuration)
    return bench_study(with_settings(bench, settings, chosen), Selection.of((chosen,)))
