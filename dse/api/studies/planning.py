"""What exploring a study would do, and going on with a study whose files have changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.cache import cache_folder
from dse.exploration import KnownRuns
from dse.storage import RunStore, StudyFolder, StudyHeader, changed_study
from dse.testbench import PreparedStudy, address_of

if TYPE_CHECKING:
    from dse.domain.address import Address

_NO_FOLDER = "new"


@dataclass(frozen=True, slots=True)
class Plan:
    """What exploring a study into a folder would do.

    The study asks for *runs* of *configurations*: *there* are in the folder and stay, *known* are taken from those that
    were made before, *missing* are simulated, of *simulated* configurations. *again* are simulated once more for their
    waveforms, as far as that can be told. With *open_ended* the sampler asks for more when it has seen the results.
    *changes* is what is not as it was when the folder was made, in words. *seconds* is how long it will take if runs
    take as long as those that were made before; None if nobody knows.
    """

    runs: int
    configurations: int
    there: int
    known: int
    missing: int
    simulated: int
    again: int
    open_ended: bool
    changes: tuple[str, ...]
    seconds: float | None


class Known:
    """What is kept of the runs of a study on *planned* benches: in the cache, and in its *folder* as it was."""

    def __init__(self, planned: PreparedStudy, folder: Path, *, reads: bool = True) -> None:
        self.planned = planned
        self.folder = folder
        self.store = RunStore(cache_folder() / "runs")
        self.reads = reads
        self.addresses = {name: made for name, bench in planned.benches.items() if (made := address_of(bench))}
        self.before: Mapping[str, Address] = {}
        self.changes: tuple[str, ...] = ()

    def runs(self, *, writes: bool = True) -> KnownRuns:
        """The same for an exploration."""
        kept = {name: bench.recording.kept for name, bench in self.planned.benches.items()}
        measures = StudyHeader(self.planned.definition).measures
        return KnownRuns(self.store, self.addresses, measures, kept, reads=self.reads, writes=writes)


def outdated(folder: Path, planned: PreparedStudy, addresses: Mapping[str, Address]) -> tuple[str, ...]:
    """What of the files of a study changed since *folder* was made, in words; () if nothing that matters did.

    () also if *folder* is none, or holds something that cannot be gone on with: that is told when it is opened.
    """
    if not StudyFolder.exists(folder):
        return ()
    with StudyFolder.open(folder) as stored:
        definition, there = stored.header.definition, stored.addresses()
    now = planned.definition
    if not definition.is_same_study(now) or any(c.id not in there for c in definition.configurations):
        return ()
    same = all(there[name].names_alike(address) for name, address in addresses.items() if name in there)
    if same and not definition.differences(now):
        return ()
    return tuple(changed_study(definition, now)) or ("the code that measures",)
