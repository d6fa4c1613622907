"""``dse explore``."""

from __future__ import annotations

from dse.api import new_folder, workspace_of
from dse.cli.app import app
from dse.cli.arguments import (
    DryRun,
    FmiVersion,
    Format,
    Fresh,
    Fuse,
    Gate,
    NewFolder,
    Output,
    Parts,
    RetryFailed,
    Sandbox,
    ShardOf,
    StudyName,
    Threads,
    Workers,
    World,
    world_of_study,
)


@app.command()
def explore(
    study: StudyName,
    folder: NewFolder = None,
    workers: Workers = 0,
    threads: Threads = 1,
    version: FmiVersion = 2,
    fuse: Fuse = False,
    fresh: Fresh = False,
    retry_failed: RetryFailed = False,
    gate: Gate = False,
    sandbox: Sandbox = False,
    world: World = None,
    parts: Parts = None,
    shard: ShardOf = None,
    dry_run: DryRun = False,
    form: Format = Output.TABLE,
) -> None:
    """Explore a study's design variables (PET).

    If it was interrupted, it runs only what is missing; for a finished folder it does nothing. After a change of the
    study's files, it reports what changed and runs only that. Runs that were made before are reused.
    """
    from dse.api import ExploreOptions
    from dse.cli.exploration import explore_and_show, show_plan
    from dse.domain.study import Shard

    part = Shard(*map(int, shard.split("/"))) if shard else None
    space = workspace_of(study)
    wanted = space.study(study)
    there = world_of_study(world, parts, wanted)
    options = ExploreOptions(workers, threads, fuse, fresh, version, sandbox, retry_failed, shard=part, world=there)
    place = folder or new_folder(space, wanted.name)
    if dry_run:
        show_plan(wanted, place, options, form)
        return
    explore_and_show(wanted, place, options, gate=gate)
