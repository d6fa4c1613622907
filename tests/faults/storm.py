"""Random signals to a study's workers, its coordinator and all of them, until the same command has ended it."""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import compile_cache
import psutil
from faults import page, shim
from faults.undisturbed import PATIENCE, Studies, litter, wrong_in

SIGNALS = ("KILL", "TERM", "HUP", "INT", "STOP", "SEGV", "ABRT")
TARGETS = ("worker", "worker", "coordinator", "group")
STUDIES = ("long_all", "long_near_boundary", "long_none")
WORKERS = 2

_MEAN_WAIT = 0.8
_LOOK_EVERY = 0.05
_GONE_WITHIN = 30.0
_WHEN_AT_WORK = 0.75
_ENDED = (0, 3)
"""Exit codes of a study that is whole; with 3 runs of it failed."""

_LONGEST_STOP = 3.0
"""Longer than a run of the studies may take."""


@dataclass(slots=True)
class Storm:
    """What came of it: signals by (name, target), commands, studies, runs begun in vain, and what was wrong."""

    signals: dict[tuple[str, str], int] = field(default_factory=dict)
    commands: int = 0
    studies: int = 0
    repeats: int = 0
    wrong: list[str] = field(default_factory=list)

    @property
    def sent(self) -> int:
        """How many signals."""
        return sum(self.signals.values())


def storm(studies: Studies, signals: int, seed: int, until: float) -> Storm:
    """Send so many *signals*, study after study; ends the last one in peace."""
    chance, told = random.Random(seed), Storm()
    while told.sent < signals and time.monotonic() < until:
        study = STUDIES[told.studies % len(STUDIES)]
        studies.undisturbed(study)
        place = studies.laid_out()
        before, kills = told.sent, 0
        rows: set[int] = set()
        code = -1
        while code not in _ENDED:
            told.commands += 1
            quiet = told.sent >= signals
            done, sent = _disturbed(studies, place, study, chance, told, 0 if quiet else signals - told.sent)
            kills += sent
            code = done.returncode
            where = f"{study} (seed {seed}, command {told.commands})"
            told.wrong += [f"{where}: {what}" for what in wrong_in(done, signalled=bool(sent))]
            now = _rows(place / "out")
            if rows - now:
                told.wrong.append(f"{where}: {len(rows - now)} rows lost")
            rows = now
            if not sent and code not in _ENDED:
                told.wrong.append(f"{where}: does not end: {done.stderr[-300:]}")
                return told
        told.studies += 1
        print(f"{study}: {told.sent - before} signals", file=sys.stderr, flush=True)
        told.wrong += [f"{study}: its {what}" for what in studies.differences(place, study)]
        repeats = _repeats(place / "out", study)
        told.repeats += repeats
        if repeats > WORKERS * (told.sent - before):
            told.wrong.append(f"{study}: {repeats} runs repeated for {told.sent - before} signals")
        told.wrong += [f"{study}: left behind: {what}" for what in litter(place)]
    return told


def _disturbed(
    studies: Studies, place: Path, study: str, chance: random.Random, told: Storm, most: int
) -> tuple[subprocess.CompletedProcess[str], int]:
    """One command, which is sent up to *most* signals; how it ended, and how many it was sent."""
    environment = {**os.environ, "DSE_CACHE": str(place / "cache"), "TMPDIR": str(place / "tmp")}
    words = [sys.executable, "-m", "dse", "explore", study, "-o", str(place / "out"), "-j", str(WORKERS)]
    sent, until = 0, time.monotonic() + PATIENCE
    with (place / "said").open("w+b") as said:
        process = subprocess.Popen(
            words, cwd=studies.workspace, env=environment, stdout=said, stderr=said, start_new_session=True
        )
        # Now and then while it starts, mostly when there is something to lose.
        at_work = chance.random() < _WHEN_AT_WORK
        while process.poll() is None and time.monotonic() < until:
            if at_work and sent < most and not _workers(process):
                time.sleep(_LOOK_EVERY)
                continue
            wait = chance.expovariate(1 / _MEAN_WAIT) if sent < most else PATIENCE
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(wait)
            if process.returncode is None and sent < most:
                sent += _send(process, chance, told)
        if process.poll() is None:
            told.wrong.append(f"{study}: hangs")
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        said.seek(0)
        text = said.read().decode(errors="replace")
    # Whoever is left of it must go by himself, and soon.
    until = time.monotonic() + _GONE_WITHIN
    while _alive(process.pid) and time.monotonic() < until:
        time.sleep(10 * _LOOK_EVERY)
    if _alive(process.pid):
        told.wrong.append(f"{study}: processes are left over")
        os.killpg(process.pid, signal.SIGKILL)
    return subprocess.CompletedProcess(words, process.returncode, text, text), sent


def _workers(process: subprocess.Popen[bytes]) -> list[int]:
    """Read from /proc: psutil would look through every process there is, many times a second."""
    with contextlib.suppress(OSError):
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        return [
            int(child) for child in children if b"multiprocessing-fork" in Path(f"/proc/{child}/cmdline").read_bytes()
        ]
    return []


def _send(process: subprocess.Popen[bytes], chance: random.Random, told: Storm) -> int:
    name, target = chance.choice(SIGNALS), chance.choice(TARGETS)
    pause = chance.uniform(0.1, _LONGEST_STOP)
    number = process.pid
    if target == "worker":
        workers = _workers(process)
        if not workers:
            return 0
        number = chance.choice(workers)
    send = os.killpg if target == "group" else os.kill
    try:
        send(number, getattr(signal, f"SIG{name}"))
        if name == "STOP":
            time.sleep(pause)
            send(number, signal.SIGCONT)
    except ProcessLookupError:
        return 0
    told.signals[name, target] = told.signals.get((name, target), 0) + 1
    return 1


def _alive(group: int) -> list[int]:
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error, ProcessLookupError):
            if process.status() != psutil.STATUS_ZOMBIE and os.getpgid(process.pid) == group:
                found.append(process.pid)
    return found


def _rows(folder: Path) -> set[int]:
    if not (folder / "study.sqlite").exists():
        return set()
    with contextlib.closing(sqlite3.connect(folder / "study.sqlite", timeout=30)) as connection:
        return {number for (number,) in connection.execute("SELECT number FROM runs")}


def _repeats(folder: Path, study: str) -> int:
    """Attempts beyond those that an undisturbed study makes."""
    with contextlib.closing(sqlite3.connect(folder / "study.sqlite", timeout=30)) as connection:
        if not connection.execute("SELECT 1 FROM sqlite_schema WHERE name = 'attempts'").fetchone():
            return 0
        (attempts,) = connection.execute("SELECT count(*) FROM attempts").fetchone()
        (runs,) = connection.execute("SELECT count(*) FROM runs").fetchone()
        (kept,) = connection.execute("SELECT count(*) FROM kept").fetchone()
    return int(attempts - runs - (kept if study.endswith("near_boundary") else 0))


def main() -> None:
    """Let it rage, and say what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--signals", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60, help="begin no study after so many")
    parser.add_argument("--write", action="store_true", help="put the table into docs/trust.md, too")
    options = parser.parse_args()
    # What a shell starts in the background ignores interrupts, and so would all that is started here.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with tempfile.TemporaryDirectory() as scratch:
        compiled = Path(scratch, "compiled")
        compiled.mkdir()
        compile_cache.use(compiled, optimized=True)
        studies = Studies(Path(scratch), shim.build(Path(scratch)))
        told = storm(studies, options.signals, options.seed, time.monotonic() + 60 * options.minutes)
    said = (
        f"{told.sent} signals, {told.commands} commands until {told.studies} studies were complete; "
        f"{told.repeats} additional attempts of runs; {len(told.wrong)} violations."
    )
    print("\n".join([said, *page.table_of_signals(told.signals), *told.wrong]))
    if options.write:
        page.write("storm", [*page.table_of_signals(told.signals), "", said])
    sys.exit(bool(told.wrong))


if __name__ == "__main__":
    main()
