"""Making runs: of a study into a folder, and of a study with one run."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor as FuturesPool
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.study import ExecutorChoice
from dse.errors import fail
from dse.exploration import (
    Executor,
    ExplorationInterruptedError,
    Explored,
    FuturesExecutor,
    Progress,
    explore,
    load_executor,
    simulate_alone,
)
from dse.storage import StudyFolder, StudyHeader
from dse.testbench import PreparedStudy, fuse_study, make_runner, prepare_study

if TYPE_CHECKING:
    from dse.domain.run import Run
    from dse.domain.study import Study

__all__ = ["ExplorationInterruptedError", "ExploreOptions", "Explored", "Progress", "alone", "explore_into", "ready"]

Tell = Callable[[str], None]
"""Is told what is going on while things are built."""


@dataclass(frozen=True, slots=True)
class ExploreOptions:
    """How a study is explored; its results do not depend on it.

    The local executor has so many *workers* (0: what the study says, or one for each processor), each with *threads*
    runs at once. *fuse* links each configuration into one library first, *fresh* throws away what the folder holds.
    *fmi* is the version of the FMUs that are built. *executor* makes the runs instead of what the study names: an
    executor of ``concurrent.futures`` with so many *workers* (0: as it says itself), or a function that makes one.
    """

    workers: int = 0
    threads: int = 1
    fuse: bool = False
    fresh: bool = False
    fmi: int = 2
    executor: FuturesPool | Callable[[], FuturesPool] | None = None


def ready(study: Study, fmi: int = 2, *, fuse: bool = False, tell: Tell | None = None) -> PreparedStudy:
    """*study* with all that has to be built for it. Raises DseError."""
    say = tell or (lambda _: None)
    say("building FMUs, assembling configurations")
    planned = prepare_study(study, version=fmi)
    if not fuse:
        return planned
    say("fusing configurations")
    return fuse_study(planned, tell=lambda made, all_: say(f"fusing configurations: {made} of {all_}"))


def explore_into(
    study: Study,
    folder: Path,
    options: ExploreOptions,
    *,
    on_progress: Callable[[Progress], None] | None = None,
    tell: Tell | None = None,
) -> Explored:
    """Have the study's executor make the runs that *folder* does not have yet.

    Raises DseError, and ExplorationInterruptedError on Ctrl-C; what was finished is stored then.
    """
    planned = ready(study, options.fmi, fuse=options.fuse, tell=tell)
    executor = executor_of(study, options)
    if options.fresh:
        StudyFolder.discard(folder)
    with StudyFolder.resume(folder, planned.definition) as store:
        return explore(study, planned.benches, store, executor=executor, on_progress=on_progress)


def executor_of(study: Study, options: ExploreOptions) -> Executor:
    """What makes the runs of *study*; DseError for workers or threads of another executor than the local one."""
    if options.executor is not None:
        return FuturesExecutor(options.executor, options.workers)
    given = {"workers": options.workers} if options.workers else {}
    given |= {"threads": options.threads} if options.threads > 1 else {}
    choice = study.executor
    if given and choice.name != "local":
        what = f"the study's executor is '{choice.name}', and {' and '.join(given)} can be given to 'local' only"
        raise fail(what, study.where, "leave them out, or change 'executor' in the study")
    return load_executor(ExecutorChoice(choice.name, {**choice.options, **given}))


def alone(study: Study, fmi: int, *, fuse: bool = False, tell: Tell | None = None) -> tuple[Run, PreparedStudy]:
    """The single run of *study*, made in a process of its own, with waveforms; and what it was made from."""
    planned = ready(study, fmi, fuse=fuse, tell=tell)
    ((name, prepared),) = planned.benches.items()
    if tell:
        tell("simulating")
    return simulate_alone(prepared, make_runner, name, StudyHeader(planned.definition).measures), planned
