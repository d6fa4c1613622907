"""Making the runs of a study into a folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set as AbstractSet
from concurrent.futures import Executor as FuturesPool
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.studies.plan import (
    Plan,
    changes_since,
    known_checks,
    known_runs,
    on_demand,
    plan,
    recall,
    start_over,
)
from dse.api.studies.provenance import note_sources, note_space
from dse.api.studies.single_run import Tell, ready
from dse.domain.study import CheckStep, ExecutorChoice, Shard
from dse.errors import DseError, Location, fail
from dse.exploration import (
    Checkable,
    Executor,
    ExplorationInterruptedError,
    Explored,
    FuturesExecutor,
    Progress,
    check_measures,
    check_near_boundary,
    explore,
    forget_unsettled,
    give,
    load_executor,
)
from dse.storage import Merged, StudyFolder, merge_studies, shards_in
from dse.testbench import (
    PreparedStudy,
    WorldPlace,
    checked_benches,
    require_checkable,
)

if TYPE_CHECKING:
    from dse.domain.study import Study

__all__ = [
    "ExplorationInterruptedError",
    "ExploreOptions",
    "Explored",
    "Merged",
    "Plan",
    "Progress",
    "explore_into",
    "merge_into",
    "plan_into",
]


@dataclass(frozen=True, slots=True)
class ExploreOptions:
    """How a study is explored; its results do not depend on it.

    The local executor has so many *workers* (0: what the study says, or one for each processor), each with *threads*
    runs at once. *fuse* links each configuration into one library first, *fresh* throws away what the folder holds
    and simulates every run, made before or not. *fmi* is the version of the FMUs that are built. In a *sandbox*, FMUs
    have no network and write in their scratch folder only. With *retry_failed*, runs that failed or were not
    reproducible are simulated again.
    *executor* makes the runs instead of what the study names: an executor of ``concurrent.futures`` with so many
    *workers* (0: as it says itself), or a function that makes one. Of a *shard* only its runs are made. The *world* is
    where that half of the bench is simulated, if not here.
    """

    workers: int = 0
    threads: int = 1
    fuse: bool = False
    fresh: bool = False
    fmi: int = 2
    sandbox: bool = False
    retry_failed: bool = False
    executor: FuturesPool | Callable[[], FuturesPool] | None = None
    shard: Shard | None = None
    world: WorldPlace | None = None

    def folder(self, folder: Path) -> Path:
        """The study folder: *folder*, or that of the shard in it."""
        return folder / self.shard.folder if self.shard else folder

    def ready(self, study: Study, tell: Tell | None) -> PreparedStudy:
        """*study* with all that has to be built for it. Raises DseError."""
        return ready(study, self.fmi, fuse=self.fuse, sandbox=self.sandbox, tell=tell, world=self.world)


def explore_into(
    study: Study,
    folder: Path,
    options: ExploreOptions,
    *,
    on_progress: Callable[[Progress], None] | None = None,
    tell: Tell | None = None,
    on_changes: Callable[[Plan], None] | None = None,
) -> Explored:
    """Have the study's executor make the runs that *folder* does not have yet, and that were not made elsewhere.

    If the study's files have changed since *folder* was made, the folder becomes what a new one would be: *on_changes*
    is told what will be done before it is. Earlier results stay in the cache.
    Raises DseError, and ExplorationInterruptedError on Ctrl-C; what was finished is stored then.
    """
    if options.shard and not study.once:
        what = f"the sampler '{study.sampler.name}' looks at results before it asks for more runs: it has no shards"
        raise fail(what, study.where, "leave out --shard; 'executor: dask' has other machines make its runs")
    executor = executor_of(study, options)
    folder = options.folder(folder)
    planned = options.ready(study, tell)
    if not options.fresh:
        recall(planned, folder)
    known = known_runs(planned, reads=not (options.fresh or options.retry_failed))
    if options.fresh:
        StudyFolder.discard(folder)
    elif changes_since(folder, planned, known.addresses):
        if on_changes:
            on_changes(plan(planned, folder, workers=options.workers, shard=options.shard))
        start_over(folder)
    checks = study.check_step is CheckStep.NEAR_BOUNDARY and not options.shard
    if checks:
        require_checkable(planned, planned.benches)
    with StudyFolder.resume(folder, planned.definition) as store:
        if options.retry_failed:
            forget_unsettled(store, study)
        store.note_addresses(known.addresses)
        note_sources(study, store)
        explored = explore(
            study,
            planned.benches,
            store,
            executor=executor,
            on_progress=on_progress,
            known=known,
            shard=options.shard,
            space=planned.space,
            prepare=on_demand(planned, store, known),
        )
        if explored.before and explored.simulated:
            with suppress(DseError):  # what was finished when it was stopped may not have come to the cache
                give(store, known.store)
        note_space(study, store)
        if checks:
            checkable = _checkable(planned, store, options, tell)
            names = planned.benches.keys()
            check_near_boundary(study, names, store, checkable, executor=executor, on_progress=on_progress)
        return explored


def _checkable(
    planned: PreparedStudy, store: StudyFolder, options: ExploreOptions, tell: Tell | None
) -> Callable[[AbstractSet[str]], Checkable]:
    """Gets configurations ready to be checked: their FMUs are tried first, once, for how exact they are."""

    def checkable(names: AbstractSet[str]) -> Checkable:
        benches = checked_benches(planned, sorted(names), say=tell or (lambda _: None), sandboxed=options.sandbox)
        measures = check_measures(store.header.measures)
        return Checkable(benches, known_checks(benches, measures, reads=not (options.fresh or options.retry_failed)))

    return checkable


def plan_into(study: Study, folder: Path, options: ExploreOptions, *, tell: Tell | None = None) -> Plan:
    """What `explore_into` would do. FMUs are built, nothing is simulated, and *folder* is left as it is.

    Raises DseError as exploring would.
    """
    planned = options.ready(study, tell)
    executor_of(study, options)
    return plan(
        planned,
        options.folder(folder),
        workers=options.workers,
        fresh=options.fresh,
        retry_failed=options.retry_failed,
        shard=options.shard,
    )


def executor_of(study: Study, options: ExploreOptions) -> Executor:
    """What makes the runs of *study*; DseError for options that another executor than the local one does not have."""
    if options.executor is not None:
        return FuturesExecutor(options.executor, options.workers)
    given = {"workers": options.workers} if options.workers else {}
    given |= {"threads": options.threads} if options.threads > 1 else {}
    given |= {"sandbox": True} if options.sandbox else {}
    choice = study.executor
    if given and choice.name != "local":
        what = f"the study's executor is '{choice.name}', and {' and '.join(given)} can be given to 'local' only"
        raise fail(what, study.where, "leave them out, or change 'executor' in the study")
    return load_executor(ExecutorChoice(choice.name, {**choice.options, **given}))


def merge_into(folders: Sequence[Path], target: Path | None = None) -> tuple[Path, Merged]:
    """Merge *folders*, or the shards in them, into *target*; without, into the one folder given. Returns it, too.

    DseError if there are no shards, or they are not of one study.
    """
    if target is None and len(folders) > 1:
        raise fail("several folders are to be merged", hint="name the target: dse merge -o OUT …")
    sources = [source for folder in folders for source in (shards_in(folder) or [folder])]
    if sources == [target or folders[0]]:
        what, hint = "contains no shards", "dse explore STUDY --shard 1/8 creates one, in out/STUDY"
        raise fail(what, Location(str(folders[0])), hint)
    return target or folders[0], merge_studies(target or folders[0], sources)
