"""``dse run``."""

from __future__ import annotations

from dse.api import new_folder, workspace_of
from dse.cli.app import app
from dse.cli.arguments import (
    Bench,
    FmiVersion,
    Fresh,
    Fuse,
    Gate,
    NewFolder,
    Parts,
    RetryFailed,
    Sandbox,
    Threads,
    Workers,
    World,
    world_of_study,
)


@app.command()
def run(
    bench: Bench,
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
) -> None:
    """Run a test bench on every valid configuration.

    If it was interrupted, the same command resumes it.
    """
    from dse.api import ExploreOptions, study_of_bench
    from dse.cli.exploration import explore_and_show

    space = workspace_of(bench)
    study = study_of_bench(space.bench(bench))
    there = world_of_study(world, parts, study)
    options = ExploreOptions(workers, threads, fuse, fresh, version, sandbox, retry_failed, world=there)
    explore_and_show(study, folder or new_folder(space, study.name), options, gate=gate)
