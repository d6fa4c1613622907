"""``dse run``."""

from __future__ import annotations

from dse.api.naming import workspace_of
from dse.cli.app import app
from dse.cli.arguments import Bench, FmiVersion, Fresh, Fuse, Gate, NewFolder, Threads, Workers


@app.command()
def run(
    bench: Bench,
    folder: NewFolder,
    workers: Workers = 0,
    threads: Threads = 1,
    version: FmiVersion = 2,
    fuse: Fuse = False,
    fresh: Fresh = False,
    gate: Gate = False,
) -> None:
    """Run a test bench on every valid configuration.

    Interrupted and started again it goes on where it was.
    """
    from dse.api.studies.exploring import ExploreOptions
    from dse.api.studies.single import study_of_bench
    from dse.cli.exploring import explore_into

    options = ExploreOptions(workers, threads, fuse, fresh, version)
    explore_into(study_of_bench(workspace_of(bench).bench(bench)), folder, options, gate=gate)
