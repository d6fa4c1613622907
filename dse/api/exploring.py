"""Making runs: of a study into a folder, of a study with one run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.study import ExecutorChoice
from dse.errors import fail
from dse.exploration.executor import Executor, chosen
from dse.exploration.loop import ExplorationInterruptedError, Explored, explore
from dse.exploration.progress import Progress
from dse.exploration.supervision.single_run import simulate_alone
from dse.storage.database.header import StudyHeader
from dse.storage.folder import StudyFolder
from dse.testbench.execute import make_runner
from dse.testbench.fuse import fused_plan
from dse.testbench.plan import Plan, plan

if TYPE_CHECKING:
    from dse.domain.run import Run
    from dse.domain.study import Study

__all__ = ["ExplorationInterruptedError", "Explored", "Progress", "alone", "explore_into", "ready"]


def ready(study: Study, *, version: int = 2, fuse: bool = False, tell: Callable[[str], None] | None = None) -> Plan:
    """*study* with all that has to be built for it; *tell* is told what is going on. Raises DseError."""
    say = tell or (lambda _: None)
    say("building FMUs, assembling configurations")
    planned = plan(study, version=version)
    if not fuse:
        return planned
    say("fusing configurations")
    return fused_plan(planned, tell=lambda made, all_: say(f"fusing configurations: {made} of {all_}"))


def explore_into(
    planned: Plan,
    folder: Path,
    *,
    workers: int = 0,
    threads: int = 1,
    fresh: bool = False,
    on_progress: Callable[[Progress], None] | None = None,
) -> Explored:
    """Have the study's executor make the runs that *folder* does not have yet.

    The local one has so many *workers* (0: what the study says, or one for each processor), each with *threads* runs
    at once. *fresh* throws away what the folder holds. Raises DseError, and ExplorationInterruptedError on Ctrl-C; what
    was finished is stored then.
    """
    executor = executor_of(planned.study, workers, threads)
    if fresh:
        StudyFolder.discard(folder)
    with StudyFolder.resume(folder, planned.definition) as store:
        return explore(planned.study, planned.prepared, store, executor=executor, on_progress=on_progress)


def executor_of(study: Study, workers: int = 0, threads: int = 1) -> Executor:
    """What makes the runs of *study*; DseError for *workers* or *threads* of another executor than the local one."""
    given = {"workers": workers} if workers else {}
    given |= {"threads": threads} if threads > 1 else {}
    name, options = study.executor.name, study.executor.options
    if given and name != "local":
        what = f"the study's executor is '{name}', and {' and '.join(given)} can be given to 'local' only"
        raise fail(what, study.where, "leave them out, or change 'executor' in the study")
    return chosen(ExecutorChoice(name, {**options, **given}))


def alone(planned: Plan) -> Run:
    """The single run of the study, made in a process of its own, with waveforms."""
    ((name, prepared),) = planned.prepared.items()
    return simulate_alone(prepared, make_runner, name, StudyHeader(planned.definition).measures)
