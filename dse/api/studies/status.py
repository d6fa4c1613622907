"""How a study is getting on, seen from outside: also while another process explores it."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path

from dse.api.studies.summary import is_shard, state_of
from dse.storage import Maker, RunCounts, StudyFolder, Writer, shards_in, this_process, writer_of

_PATIENCE = 1.0
"""Seconds that the rate of a running study is measured over."""

_ENOUGH = 10
"""Runs in that time from which on the rate is taken from them; below, from how long a run takes."""


@dataclass(frozen=True, slots=True)
class Status:
    """*runs* were asked for so far, what came of them is the *tally*. *writer* explores at the moment, if anybody does.

    *rate* is in runs per second, 0 where nobody is at work. *spooled* runs are made and will be stored when the study
    goes on. *size* and *free* are bytes: of the folder, and on its disk. *working* are those of the tally's makers that
    are at work, as far as can be seen from here.
    """

    folder: Path
    name: str
    runs: int
    tally: RunCounts
    writer: Writer | None
    working: tuple[Maker, ...]
    rate: float
    logged: int
    size: int
    free: int

    @property
    def is_shard(self) -> bool:
        """Whether only a part of the runs is to be made in this folder."""
        return is_shard(self.folder)

    @property
    def state(self) -> str:
        """As `state_of` tells."""
        return state_of(self.folder, self.runs, self.tally.finished, self.writer)

    @property
    def left(self) -> float:
        """Seconds to the last run that was asked for, infinite if nobody is at work."""
        return seconds_left((self,))


def seconds_left(parts: Sequence[Status]) -> float:
    """Seconds until all runs of a study are there of which *parts* are the shards, or that is the only part."""
    todo, rate = parts[0].runs - sum(part.tally.finished for part in parts), sum(part.rate for part in parts)
    return 0.0 if todo <= 0 else todo / rate if rate else inf


def statuses(folder: str | Path) -> list[Status]:
    """The `status` of the study in *folder*, or of each shard in it."""
    shards = [] if StudyFolder.is_at(Path(folder)) else shards_in(Path(folder))
    with ThreadPoolExecutor() as pool:
        return list(pool.map(status, shards or [folder]))


def status(folder: str | Path) -> Status:
    """How the study in *folder* is getting on; looks for a second if it is running.

    Raises DseError if it is no study, or damaged.
    """
    path = Path(folder)
    with StudyFolder.open(path) as store:
        writer, before, start = writer_of(path), store.tally(), time.monotonic()
        if writer:
            time.sleep(_PATIENCE)
        tally, logged = store.tally(), 0 if writer else len(store.logged())
        made = _made(tally) - _made(before)
        working = tuple(maker for maker in tally.makers if writer and _is_at_work(maker, writer))
        # Where runs take long, none may end while we look.
        measured = made / (time.monotonic() - start) if made >= _ENOUGH else sum(1 / m.seconds for m in working)
        with StudyFolder.open(path) as now:  # what is asked for may have become more
            runs, name = now.header.runs, now.header.definition.study
    size = sum(_sizes(path))
    return Status(path, name, runs, tally, writer, working, measured if writer else 0.0, logged, size, _free(path))


def status_as_data(status: Status) -> Mapping[str, object]:
    """*status* as plain data."""
    tally, writer = status.tally, status.writer
    return {
        "study": status.name,
        "state": status.state,
        "runs": status.runs,
        "finished": tally.finished,
        "failed": tally.failed,
        "with_waveforms": tally.kept,
        "rate": status.rate,
        "seconds_left": status.left,
        "writer": {"host": writer.host, "process": writer.process} if writer else None,
        "workers": [
            {
                "host": m.host,
                "process": m.process,
                "at_work": m in status.working,
                "runs": m.runs,
                "without_result": m.tries,
                "seconds": m.seconds,
            }
            for m in tally.makers
        ],
        "failures": dict(tally.failures),
        "without_result": {"runs": tally.repeated, "causes": dict(tally.tries)},
        "made_again": tally.again,
        "spooled": status.logged,
        "bytes": status.size,
        "bytes_free": status.free,
    }


def _made(tally: RunCounts) -> int:
    return tally.finished + tally.again


def _is_at_work(maker: Maker, writer: Writer) -> bool:
    """Whether *maker* made some of the newest runs and, where that can be seen, lives."""
    here = this_process().rpartition("/")[0]
    if not isfinite(maker.seconds) or maker.seconds <= 0:
        return False
    if maker.host != here or writer.host != here:
        return True
    import psutil

    with suppress(psutil.Error):
        return writer.process in (maker.process, *(each.pid for each in psutil.Process(maker.process).parents()))
    return False


def _sizes(folder: Path) -> Iterator[int]:
    for place, _, names in os.walk(folder):
        for name in names:
            with suppress(OSError):  # it may be gone by now
                yield Path(place, name).lstat().st_size


def _free(path: Path) -> int:
    with suppress(OSError):
        return shutil.disk_usage(path).free
    return 0
