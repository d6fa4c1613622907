"""What a supervisor and its workers tell each other, beside batches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from dse.exploration.work import MakeRunner
from dse.sandbox import Sandbox
from dse.storage import Measures, RowBlock


@dataclass(frozen=True, slots=True)
class Setup:
    """What every worker needs; the folder *configurations* holds each as a pickle.

    A worker makes *threads* runs at a time, and is in *sandbox* if there is one. It is *copied* from the supervisor's
    process where that is possible, and has what that has imported; not where studies have their files open.
    """

    make_runner: MakeRunner
    configurations: Path
    waveforms: Path
    log_folder: Path
    measures: Measures
    study: str = ""
    threads: int = 1
    sandbox: Sandbox | None = None
    copied: bool = False

    def file(self, configuration: str) -> Path:
        """Where *configuration* lies; an id may hold what a file name may not."""
        return self.configurations / f"{configuration.encode().hex()[:200]}.pickle"


def in_sandbox(setup: Setup) -> Setup:
    """*setup* for workers in a sandbox, who are in a folder of their own."""
    home = setup.configurations / "scratch"
    return replace(setup, sandbox=Sandbox((home, setup.waveforms, setup.log_folder), (setup.configurations,)))


@dataclass(frozen=True, slots=True)
class Fault:
    """What came to nothing after *seconds*: the run *number*, or loading its configuration if that is None."""

    number: int | None
    cause: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Report:
    """From a worker: runs of the batch *identity* that are finished.

    *ended* with the last of them; then *kept* are the numbers whose waveforms are in the batch's file. *retired*
    comes last: the process is worn out and leaves, runs that are still to be made go to another; *fault* is what came
    to nothing here and may be good there. *broken* says why no worker can go on, as when the disk is full. *spooled* is
    of a run that the worker could not write to the write-ahead log.
    """

    identity: int
    block: RowBlock | None = None
    ended: bool = False
    kept: tuple[int, ...] = ()
    retired: bool = False
    broken: str = ""
    fault: Fault | None = None
    logged: bytes = b""


FROM_WORKERS = (Report, RowBlock, Fault)
"""What a worker's messages are made of."""
