"""The study of the drives on one bench: each is a run, beside the one that nobody drove.

What tells runs apart are two conditions, ``drive`` and ``driver``. New drives extend the study; the runs that are
there keep their numbers and rows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dse.api.studies.provenance import note_sources
from dse.api.studies.replay import (
    DRIVE,
    DRIVER,
    DRIVES,
    NOBODY,
    Kept,
    bench_driven,
    drive_name,
    is_drives,
    kept_drives,
)
from dse.api.studies.single_run import Tell, alone, ready
from dse.domain.definition import DefinedSampler, DefinedVariable, StudyDefinition
from dse.domain.drive import Drive
from dse.domain.run import Run, RunRequest, Waveforms
from dse.domain.study import Selection
from dse.errors import DseError, Problem, fail
from dse.scratch import ScratchFolder
from dse.storage import StudyFolder, block_of, waveform_file, write_waveforms
from dse.testbench import bench_study, one_configuration

if TYPE_CHECKING:
    from dse.domain.bench import TestBench

CONTROLLER = "controller"
"""Who drove the drive that is none."""


def drive_again(drive: Drive, bench: TestBench, *, tell: Tell | None = None) -> Run:
    """The run of *drive* on *bench*, simulated now; waveforms have a row for each step. Raises DseError."""
    with ScratchFolder() as scratch:
        driven = bench_driven(drive, bench, Path(scratch))
        return alone(bench_study(driven, Selection((drive.configuration,))), 2, tell=tell)[0]


def keep_drives(
    bench: TestBench,
    drives: Mapping[str, Drive],
    folder: Path,
    *,
    tell: Tell | None = None,
    on_problem: Callable[[Problem], None],
) -> None:
    """Have the runs of *drives*, by id, in the study *folder*; what is there and made from the same files stays.

    A drive that does not fit the bench is told, and left out. Raises DseError if the bench itself cannot be simulated.
    *drives* in a shared world have no run without a driver beside them: alone, a car has nobody around it.
    """
    is_shared = any(drive.is_shared for drive in drives.values())
    stored = _stored(folder)
    known = kept_drives(stored) if stored else {}
    fitting = {name: drive for name, drive in drives.items() if _fits(drive, bench, on_problem)}
    wanted = _configurations(bench, fitting, stored)
    if not wanted:
        return
    base = ready(bench_study(bench, Selection(tuple(wanted))), tell=tell).definition
    if stored and stored.differences(_defined(base, known, is_shared)):
        if tell:
            tell(f"bench '{bench.name}' has changed since: its drives are simulated again")
        StudyFolder.discard(folder)
        for name in known.keys() - fitting.keys():
            on_problem(
                Problem(f"drive {name} on '{bench.name}' has no recording any more: it cannot be simulated again")
            )
        known = {}
    for name, drive in fitting.items():
        pace = drive.pace
        seconds = float(drive.time[-1])
        known.setdefault(name, Kept(drive.driver, drive.configuration, seconds, pace.steps, pace.overruns))
    definition = _defined(base, known, is_shared)
    with StudyFolder.resume(folder, definition) as store:
        _add_missing(store, bench, fitting, () if is_shared else tuple(wanted), tell or (lambda _: None))
        note_sources(bench_study(bench), store)
        store.end()


def _fits(drive: Drive, bench: TestBench, on_problem: Callable[[Problem], None]) -> bool:
    try:
        with ScratchFolder() as scratch:
            bench_driven(drive, bench, Path(scratch))
    except DseError as error:
        for problem in error.problems:
            on_problem(problem)
        return False
    return True


def _configurations(bench: TestBench, drives: Mapping[str, Drive], stored: StudyDefinition | None) -> dict[str, None]:
    """Those of the stored study that still are some, and those of *drives*."""
    found: dict[str, None] = {}
    for each in (
        *(c.id for c in (stored.configurations if stored else ())),
        *(d.configuration for d in drives.values()),
    ):
        try:
            found[one_configuration(bench.design, each).id] = None
        except DseError:
            continue
    return found


def _stored(folder: Path) -> StudyDefinition | None:
    if not StudyFolder.is_at(folder):
        return None
    with StudyFolder.open(folder) as store:
        definition = store.header.definition
    if not is_drives(definition):
        raise fail(
            f"{folder} is not a study of drives, but of '{definition.study}'", hint="keep drives in another folder"
        )
    return definition


def _defined(base: StudyDefinition, known: Mapping[str, Kept], is_shared: bool) -> StudyDefinition:
    """The study of the drives *known* on the bench of *base*."""
    drivers = _drivers(known)
    told = {name: asdict(kept) for name, kept in known.items()}
    constants = {DRIVER: 0.0, DRIVE: 0.0}
    return replace(
        base,
        title=f"{base.title}: who drove{' in a shared world' if is_shared else ''}",
        variables=(
            _condition(DRIVER, "who drove", [CONTROLLER, *map(_label, drivers)]),
            _condition(DRIVE, "drive", [NOBODY, *known]),
        ),
        sampler=DefinedSampler(DRIVES, {"drives": told}),
        configurations=tuple(
            replace(each, constants=dict(sorted({**each.constants, **constants}.items())))
            for each in base.configurations
        ),
    )


def _drivers(known: Mapping[str, Kept]) -> list[str]:
    return list(dict.fromkeys(kept.driver for kept in known.values()))


def _label(driver: str) -> str:
    """What a driver is called in a table; whoever calls themself as the design does is told apart."""
    return f"{driver} (a person)" if driver == CONTROLLER else driver


def _condition(name: str, title: str, labels: Sequence[str]) -> DefinedVariable:
    values = tuple(float(number) for number in range(len(labels)))
    last = values[-1]
    return DefinedVariable(
        name, title, "", 0.0, last, len(labels), 0.0, values=values, role="condition", labels=tuple(labels)
    )


def _add_missing(
    store: StudyFolder, bench: TestBench, drives: Mapping[str, Drive], configurations: Sequence[str], tell: Tell
) -> None:
    """Simulate what *store* has no row of: each configuration without a driver, then each drive."""
    definition = store.header.definition
    known = kept_drives(definition)
    drivers = _drivers(known)
    before = {
        (request.configuration, drive_name(definition, request.point))
        for request in store.table().requests()
        if request.number < store.header.base
    }
    # The same as when this era began, whatever of it is there already.
    wanted = [*((name, NOBODY) for name in configurations), *((kept.configuration, n) for n, kept in known.items())]
    places = {NOBODY: (0.0, 0.0)}
    places |= {n: (1.0 + drivers.index(kept.driver), float(at)) for at, (n, kept) in enumerate(known.items(), 1)}
    todo = [each for each in wanted if each not in before]
    requests = [
        RunRequest(number, configuration, dict(zip((DRIVER, DRIVE), places[name], strict=True)))
        for number, (configuration, name) in enumerate(todo, store.header.base)
    ]
    if requests:
        store.ask(0, requests, len(requests))
    there = store.finished()
    for request, (configuration, name) in zip(requests, todo, strict=True):
        if request.number in there or (name != NOBODY and name not in drives):
            continue
        if name == NOBODY:
            tell(f"{bench.name}: {configuration} without a driver")
            made = alone(bench_study(bench, Selection((configuration,))), 2)[0]
        else:
            tell(f"{bench.name}: drive {name} of {known[name].driver}")
            made = thinned(drive_again(drives[name], bench), bench)
        run = replace(made, request=request)
        store.add(configuration, [places[name]], block_of([run], store.header.measures))
        if run.waveforms is not None:
            file = waveform_file(request.number, request.number)
            write_waveforms(store.waveform_folder / file, [(request.number, run.waveforms)])
            store.add_kept([request.number], file)
        store.commit()


def thinned(run: Run, bench: TestBench) -> Run:
    """*run* with waveforms as often as *bench* keeps them."""
    if run.waveforms is None:
        return run
    rows = np.arange(0, len(run.waveforms.time), bench.simulation.stride)
    values = {name: column[rows] for name, column in run.waveforms.values.items()}
    return replace(run, waveforms=Waveforms(run.waveforms.time[rows], values))
