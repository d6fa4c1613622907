"""One run in a process of its own, outside of any study: whatever an FMU does, it does not happen here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from dse.domain.run import Run, RunRequest
from dse.exploration.supervision.supervisor import Supervisor
from dse.exploration.work import Batch, MakeRunner, Runnable, Work
from dse.scratch import ScratchFolder
from dse.storage import Attempt, Measures, RowBlock, read_log, waveform_file


@dataclass(slots=True)
class _Kept:
    """Keeps what comes of the run."""

    block: RowBlock | None = None

    def rows(self, _batch: Batch, block: RowBlock) -> None:
        self.block = block

    def tried(self, attempts: Sequence[Attempt]) -> None:
        pass

    def ended(self, _batch: Batch, _kept: tuple[int, ...]) -> None:
        pass

    def tick(self) -> None:
        pass


def simulate_alone(
    prepared: Runnable, make_runner: MakeRunner, configuration: str, measures: Measures, *, sandboxed: bool = False
) -> Run:
    """The run of *prepared* at its own point, with its waveforms unless it failed; its number is 0.

    Raises DseError if the worker cannot even start, or no sandbox can be had that is asked for.
    """
    request, kept = RunRequest(0, configuration, {}), _Kept()
    with ScratchFolder() as scratch:
        folder = Path(scratch)
        work = Work({configuration: prepared}, make_runner, folder, measures, folder / "spool")
        batch = Batch(0, configuration, (request,), waveform_file(0, 0), logged=True)
        with Supervisor(work, kept, workers=1, sandboxed=sandboxed, copied=True) as supervisor:
            supervisor.work_off([batch])
        assert kept.block is not None  # noqa: S101  # a supervisor gives a row for every run
        # As a study folder has it, where a zero has no sign.
        block = replace(kept.block, metrics=kept.block.metrics + 0.0, margins=kept.block.margins + 0.0)
        (run,) = block.runs([request], measures)
        logged = read_log(work.log_folder, measures, name=batch.name)
        return replace(run, waveforms=next((each.waveforms(0) for each in logged if 0 in each.kept), None))
