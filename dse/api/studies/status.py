"""How a study is getting on, seen from outside: also while another process explores it."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from math import inf, isfinite
from pathlib import Path

from dse.domain.bench import VERDICTS, Verdict, overall_verdict
from dse.domain.study import SHARD_FOLDER
from dse.errors import DseError, Location, fail
from dse.storage import LOCK, Maker, RunCounts, StudyFolder, Writer, shards_in, this_process, writer_of

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


# What a study has come to, at a glance: counted by the database, quick also where there are many runs.


@dataclass(frozen=True, slots=True)
class StudySummary:
    """*finished* of *runs* that were asked for; *verdicts* counts them by the verdict on all requirements.

    *state* is as `state_of` tells, *changed* when the folder was last written to.
    """

    study: str
    title: str
    bench: str
    design: str
    runs: int
    finished: int
    configurations: int
    requirements: int
    verdicts: Mapping[Verdict, int]
    state: str
    changed: datetime


def study_summary(folder: str | Path) -> StudySummary:
    """The study in *folder*. Raises DseError if it is none, or damaged."""
    path = Path(folder)
    with StudyFolder.snapshot(path) as store:
        definition, runs = store.header.definition, store.header.runs
        counts = store.verdicts()
        finished = store.count()
    return StudySummary(
        definition.study,
        definition.title or definition.study,
        definition.bench.title or definition.bench.name,
        definition.design.name,
        runs,
        finished,
        len(definition.configurations),
        len(definition.requirements),
        _overall(counts, finished),
        state_of(path, runs, finished, writer_of(path)),
        _changed(path),
    )


def state_of(folder: Path, runs: int, finished: int, writer: Writer | None) -> str:
    """``running``, ``finished`` or ``interrupted``; ``at rest`` for a shard, of which that cannot be told."""
    if writer:
        return "running"
    if finished >= runs:
        return "finished"
    return "at rest" if is_shard(folder) else "interrupted"


def is_shard(folder: Path) -> bool:
    """Whether only a part of a study's runs is to be made in *folder*."""
    return bool(SHARD_FOLDER.fullmatch(folder.name))


def _overall(counts: Mapping[tuple[str, ...], int], finished: int) -> Mapping[Verdict, int]:
    found: Counter[Verdict] = Counter()
    for verdicts, count in counts.items():
        found[overall_verdict(verdicts)] += count
    found[Verdict.FAILED_TO_RUN] += finished - found.total()  # of a study without requirements
    return {verdict: found[verdict] for verdict in VERDICTS if verdict is not Verdict.NOT_APPLICABLE}


def _changed(path: Path) -> datetime:
    """When the newest of the files that a run writes was written."""
    times = [each.stat().st_mtime for each in path.glob("study.sqlite*")]
    return datetime.fromtimestamp(max(times, default=0.0), UTC)


# Stopping whoever explores a study, from another process of the same user on the same machine.


def stop(folder: str | Path) -> Writer:
    """Ask the process that explores the study in *folder* to stop, as Ctrl-C does: what was finished is stored.

    It may take a moment. Raises DseError if nobody explores it, or somebody who cannot be asked from here.
    """
    path = Path(folder)
    writer = writer_of(path)
    if writer is None:
        raise fail("no process explores this study at the moment", Location(str(path)))
    host = this_process().rpartition("/")[0]
    if writer.host != host:
        raise _refused(path, writer, f"it is on another machine than this one ({host})", "press Ctrl-C there")
    if writer.process == os.getpid():
        raise _refused(path, writer, "it is this program itself", "interrupt it where it was started")
    if sys.platform == "win32":
        raise _refused(path, writer, "Windows has no way to interrupt another console", "press Ctrl-C in its window")
    _require_ours(path, writer)
    number = _heard(path, writer)
    try:
        os.kill(writer.process, number)
    except ProcessLookupError:
        raise fail("no process explores this study any more", Location(str(path))) from None
    except PermissionError:
        raise _refused(path, writer, "it belongs to another user", "ask that user") from None
    return writer


def _require_ours(path: Path, writer: Writer) -> None:
    """DseError unless the process is this user's and has the folder's lock open.

    The note beside the lock came with the folder, from anywhere: what it says alone must not have a process stopped.
    """
    import psutil

    try:
        process = psutil.Process(writer.process)
        owner = process.uids().real
        if owner != os.getuid() and os.getuid() != 0:
            raise _refused(path, writer, f"it belongs to another user ({process.username()})", "ask that user")
        lock = (path / LOCK).resolve()
        has_lock = any(os.path.realpath(each.path) == str(lock) for each in process.open_files())
    except psutil.NoSuchProcess:
        raise fail("no process explores this study any more", Location(str(path))) from None
    except psutil.Error as error:
        raise _refused(path, writer, f"the system does not show whether it writes here ({error})", _THERE) from error
    if not has_lock:
        raise _refused(path, writer, f"it does not hold the folder's {LOCK}", _THERE)


def _heard(path: Path, writer: Writer) -> signal.Signals:
    """The signal to stop it with: what a shell has put into the background hears no Ctrl-C, but SIGTERM.

    Only a process that handles SIGTERM itself gets that: it would end any other in the middle of things.
    """
    try:
        told = Path(f"/proc/{writer.process}/status").read_text("ascii", "replace")
    except OSError:  # only Linux tells
        return signal.SIGINT
    masks = {line.partition(":")[0]: line.partition(":")[2].strip() for line in told.splitlines()}

    def has(mask: str, number: signal.Signals) -> bool:
        return bool(int(masks.get(mask, "0"), 16) >> (number - 1) & 1)

    if not has("SigIgn", signal.SIGINT):
        return signal.SIGINT
    if has("SigCgt", signal.SIGTERM):
        return signal.SIGTERM
    raise _refused(path, writer, "it ignores interrupts", "end it where it was started")


_THERE = "press Ctrl-C where it was started"


def _refused(path: Path, writer: Writer, why: str, hint: str) -> DseError:
    return fail(f"{writer} cannot be stopped from here: {why}", Location(str(path)), hint)
