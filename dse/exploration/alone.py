"""One run in a process of its own, outside of any study: whatever an FMU does, it does not happen here."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from dse.domain.run import Waveforms
from dse.errors import DseError
from dse.exploration.job import Batch, Bench, MakeRunner, Setup
from dse.exploration.supervisor import Supervisor
from dse.storage.rows import RowBlock
from dse.storage.waveforms import file_name, read_waveforms


@dataclass(slots=True)
class _Keeper:
    """Remembers what the worker says of the run."""

    problem: str = ""
    done: bool = False

    def rows(self, _batch: Batch, block: RowBlock) -> None:
        self.done = bool(block.done.all())
        self.problem = next(iter(block.problems.values()), "")

    def ended(self, _batch: Batch, _kept: tuple[int, ...]) -> None:
        pass

    def tick(self) -> None:
        pass


def simulate_alone(bench: Bench, make_runner: MakeRunner) -> tuple[Waveforms | None, str]:
    """The waveforms of *bench* at its own point, or None and what was wrong.

    Raises DseError if the worker cannot even start.
    """
    keeper = _Keeper()
    file = file_name(0, 0)
    batch = Batch(0, "alone", (), (0,), ((),), file)
    with tempfile.TemporaryDirectory(prefix="dse-") as scratch:
        setup = Setup(make_runner, Path(scratch), Path(scratch), (), ())
        try:
            with Supervisor(setup, {"alone": bench}, keeper, 1) as supervisor:
                supervisor.work_off([batch])
        except DseError as error:
            if not keeper.problem:
                raise
            return None, f"{keeper.problem}\n{error}"
        if not keeper.done:
            return None, keeper.problem
        return read_waveforms(Path(scratch) / file, 0), keeper.problem
