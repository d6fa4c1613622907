"""``dse explore``."""

from __future__ import annotations

from dse.api import workspace_of
from dse.cli.app import app
from dse.cli.arguments import FmiVersion, Fresh, Fuse, Gate, NewFolder, Sandbox, StudyName, Threads, Workers


@app.command()
def explore(
    study: StudyName,
    folder: NewFolder,
    workers: Workers = 0,
    threads: Threads = 1,
    version: FmiVersion = 2,
    fuse: Fuse = False,
    fresh: Fresh = False,
    gate: Gate = False,
    sandbox: Sandbox = False,
) -> None:
    """Explore a study's design variables (PET).

    Interrupted and started again it runs only what is missing; on a finished folder it does nothing.
    """
    from dse.api import ExploreOptions
    from dse.cli.exploring import explore_and_show

    options = ExploreOptions(workers, threads, fuse, fresh, version, sandbox)
    explore_and_show(workspace_of(study).study(study), folder, options, gate=gate)
