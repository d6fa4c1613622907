"""Making runs: of a study into a folder, of a study with one run, of a package. The one module that knows how."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.study import ExecutorChoice
from dse.errors import fail
from dse.exploration.alone import simulate_alone
from dse.exploration.executor import Executor, chosen
from dse.exploration.explore import ExplorationInterruptedError, explore
from dse.exploration.progress import Progress
from dse.storage.folder import StudyFolder
from dse.testbench.fuse import fuse_study
from dse.testbench.runner import make_runner
from dse.testbench.study import PreparedStudy, prepare_study

if TYPE_CHECKING:
    from dse.domain.run import Run, Waveforms
    from dse.domain.study import Study
    from dse.interchange.prepared import PreparedPackage

__all__ = ["ExplorationInterruptedError", "Explored", "Progress", "alone", "explore_into", "package_alone", "ready"]


@dataclass(frozen=True, slots=True)
class Explored:
    """What an exploration did. *before* is how many runs the folder had, *new* how many were added; with *extended*
    the study asks for other runs than before.

    *again* were simulated again for their waveforms; *retried* were tried twice because their worker was killed from
    outside or grew too large, *irreproducible* gave another result the second time.
    """

    before: int
    new: int
    again: int
    retried: int
    irreproducible: int
    extended: bool


def ready(
    study: Study, *, version: int = 2, fuse: bool = False, tell: Callable[[str], None] | None = None
) -> PreparedStudy:
    """*study* with all that has to be built for it; *tell* is told what is going on. Raises DseError."""
    say = tell or _silent
    say("building FMUs, assembling configurations")
    planned = prepare_study(study, version=version)
    if not fuse:
        return planned
    say("fusing configurations")
    return fuse_study(planned, tell=lambda made, all_: say(f"fusing configurations: {made} of {all_}"))


def explore_into(
    planned: PreparedStudy,
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
        before = len(store.finished())
        tell = on_progress or _silent
        summary = explore(planned.study, planned.benches, store, executor=executor, on_progress=tell)
        new = len(store.finished()) - before
        again = max(0, summary.simulated - new)
        return Explored(before, new, again, summary.retried, summary.irreproducible, store.is_extended)


def executor_of(study: Study, workers: int = 0, threads: int = 1) -> Executor:
    """What makes the runs of *study*; DseError for *workers* or *threads* of another executor than the local one."""
    given = {"workers": workers} if workers else {}
    given |= {"threads": threads} if threads > 1 else {}
    name, options = study.executor.name, study.executor.options
    if given and name != "local":
        what = f"the study's executor is '{name}', and {' and '.join(given)} can be given to 'local' only"
        raise fail(what, study.where, "leave them out, or change 'executor' in the study")
    return chosen(ExecutorChoice(name, {**options, **given}))


def alone(planned: PreparedStudy) -> Run:
    """The single run of the study, made in a process of its own, with waveforms."""
    with (
        tempfile.TemporaryDirectory(prefix="dse-") as scratch,
        StudyFolder.create(Path(scratch) / "run", planned.definition) as store,
    ):
        executor = chosen(ExecutorChoice("local", {"workers": 1}))
        explore(planned.study, planned.benches, store, executor=executor)
        return store.run(0)


def package_alone(package: PreparedPackage) -> tuple[Waveforms | None, str]:
    """The waveforms of a package at its own point, or None and what was wrong."""
    return simulate_alone(package.bench, make_runner)


def _silent(_: object) -> None:
    pass
