"""A small study, what it comes to when nothing happens, and what came of one to which something did."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Container
from dataclasses import dataclass, field
from pathlib import Path
from subprocess import CompletedProcess

from command_line import run_dse
from faults import shim

from dse.api import Results
from dse.errors import DseError
from dse.scratch import is_left_over

WORKSPACE = Path(__file__).with_name("workspace")
PATIENCE = 200
"""Seconds after which a command hangs."""

_FORMATS = ("csv", "json", "parquet", "junit")
_EXPECTED = {"study.sqlite", "waveforms", "report.html"}
_LIES = ("damaged", "--fresh", "mistake in dse")


@dataclass(frozen=True, slots=True)
class Scenario:
    """A study, from a *cold* cache or a warm one. *fresh*: calls count from the start of Python, not of the command."""

    study: str
    cold: bool = False
    fresh: bool = False

    def __str__(self) -> str:
        cache = "cold" if self.cold else "warm"
        return f"keep_waveforms: {self.study}, {cache} cache{', from the start of Python' if self.fresh else ''}"


@dataclass(slots=True)
class Case:
    """What came of a *fault*, if it *happened*: the *call* that failed, and the command's exit *code* and words.

    *wrong* is what should not have been, *litter* what was left behind at the end. *early*: the command had not begun.
    """

    fault: shim.Fault
    happened: bool
    call: str
    code: int
    said: str
    early: bool = False
    wrong: list[str] = field(default_factory=list)
    litter: list[str] = field(default_factory=list)


class Studies:
    """Runs studies of the workspace, disturbed and not, in *folder*."""

    def __init__(self, folder: Path, library: Path) -> None:
        self.workspace = folder / "workspace"
        shutil.copytree(WORKSPACE, self.workspace)
        self._folder = folder
        self._library = library
        self._cache = folder / "cache"
        self._undisturbed: dict[str, dict[str, bytes]] = {}
        self._counts: dict[Scenario, dict[tuple[str, str], int]] = {}
        # Without its bytecode each Python would compile all it imports.
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

    def undisturbed(self, study: str) -> dict[str, bytes]:
        """The results of *study*, by name of what was exported."""
        if study not in self._undisturbed:
            place = self.laid_out()
            done = self._explore(place, Scenario(study))
            assert done.returncode == 0, done.stdout + done.stderr
            self._undisturbed[study] = results_of(place)
            shutil.rmtree(self._cache, ignore_errors=True)
            # The runs are to be made, not taken from this study.
            shutil.copytree(place / "cache", self._cache, ignore=lambda *_: ["runs"])
        return self._undisturbed[study]

    def counts(self, scenario: Scenario) -> dict[tuple[str, str], int]:
        """How many calls there are by role and kind; a few more or less the next time."""
        if scenario not in self._counts:
            self.undisturbed(scenario.study)
            place = self.laid_out(cold=scenario.cold)
            shim.set_fault(place / "control", None, self._folder)
            self._explore(place, scenario, counted=True)
            self._counts[scenario] = shim.told(place / "control").counts
        return self._counts[scenario]

    def disturbed(self, scenario: Scenario, fault: shim.Fault) -> Case:
        """Explore with *fault*, and once more without."""
        self.undisturbed(scenario.study)
        place = self.laid_out(cold=scenario.cold)
        shim.set_fault(place / "control", fault, self._folder)
        done = self._explore(place, scenario, counted=True)
        told = shim.told(place / "control")
        case = Case(fault, bool(told.failed), told.what, done.returncode, done.stdout + done.stderr)
        if not case.happened:
            return case
        case.early = scenario.fresh and not (place / "out").exists() and _is_early(case.said)
        case.wrong += [] if case.early else wrong_in(done)
        if done.returncode == 0 and not case.wrong:
            case.wrong += [f"said it was done: {what}" for what in self.differences(place, scenario.study)]
        again = self._explore(place, scenario)
        case.wrong += [f"again: {what}" for what in wrong_in(again)]
        if again.returncode == 0:
            case.wrong += [f"again: {what}" for what in self.differences(place, scenario.study)]
        elif again.returncode == 1:
            case.wrong.append(f"again: {_last(again)}")
        case.litter = litter(place)
        return case

    def laid_out(self, *, cold: bool = False) -> Path:
        """A place for a study, a cache and temporary files, with nothing in it but a warm cache."""
        place = self._folder / "case"
        if place.exists():
            shutil.rmtree(place)
        (place / "tmp").mkdir(parents=True)
        if not cold and self._cache.exists():
            shutil.copytree(self._cache, place / "cache")
        return place

    def differences(self, place: Path, study: str) -> list[str]:
        """In what the study in *place* is not as if nothing had been."""
        expected = self.undisturbed(study)
        try:
            results = results_of(place)
        except (DseError, OSError) as error:
            return [f"cannot be read: {str(error).strip().splitlines()[0]}"]
        names = sorted({*results, *expected})
        different = [name for name in names if results.get(name) != expected.get(name)]
        return [f"other bytes: {', '.join(different[:4])}"] if different else []

    def _explore(self, place: Path, scenario: Scenario, *, counted: bool = False) -> CompletedProcess[str]:
        # One worker: calls come in nearly the same order each time, so that every one has its number.
        words = ("explore", scenario.study, "-o", str(place / "out"), "-j", "1")
        # Without the file that tells it more the library lets everything pass.
        more = {"LD_PRELOAD": str(self._library), "TMPDIR": str(place / "tmp")}
        if counted:
            more["DSE_TESTS_FAULTS"] = str(place / "control")
        if scenario.fresh and counted:
            command = [sys.executable, "-m", "dse", *words]
            environment = {**os.environ, **more, "DSE_CACHE": str(place / "cache")}
            return subprocess.run(
                command, cwd=self.workspace, env=environment, capture_output=True, text=True, check=False
            )
        return run_dse(self.workspace, *words, cache=place / "cache", longest=PATIENCE, **more)


def wrong_in(done: CompletedProcess[str], *, signalled: bool = False) -> list[str]:
    """What a command must not come to, whatever happens to it; *signalled*, it may die of that."""
    text = done.stdout + done.stderr
    wrong = []
    if done.returncode < 0 and not signalled:
        hung = done.returncode == -signal.SIGALRM
        wrong.append("hangs" if hung else f"died of signal {-done.returncode}: {_last(done)}")
    if "Traceback" in text:
        wrong.append(f"traceback: {text[text.index('Traceback') :][-1500:]}")
    wrong += [f"says '{lie}': {_last(done)}" for lie in _LIES if lie in text]
    if done.returncode == 3:
        line = next((line for line in text.splitlines() if " failed: " in line), "")
        wrong.append(f"false failures: {line.strip()[:200]}")
    elif done.returncode > 0 and not done.stderr.strip():
        wrong.append("ended without a word")
    return wrong


def litter(place: Path, expected: Container[str] = _EXPECTED) -> list[str]:
    """What is left in *place* that a finished study does not leave; *expected* are the names in ``out``."""
    # Folders of a dead process go when the next one makes its own.
    left = [f"tmp/{path.name}" for path in (place / "tmp").iterdir() if not is_left_over(path.name)]
    left += [f"cache/{path.name}" for path in (place / "cache").rglob(".*.tmp") if not is_left_over(path.name)]
    return left + [f"out/{path.name}" for path in (place / "out").iterdir() if path.name not in expected]


def results_of(place: Path) -> dict[str, bytes]:
    """All that the study in *place* gives: tables, report and waveforms; DseError if it cannot be read."""
    results = Results(place / "out")
    made = {name: results.export(name) for name in _FORMATS}
    made["report"] = results.report().read_bytes()
    return made | {file.name: file.read_bytes() for file in (place / "out" / "waveforms").iterdir()}


def _is_early(said: str) -> bool:
    """Whether *said* is of Python itself: it was not told to run the command yet."""
    return "Traceback" in said and not re.search(r'entry\.py", line \d+, in _carry_out', said)


def _last(done: CompletedProcess[str]) -> str:
    lines = [line.strip() for line in (done.stderr or done.stdout).splitlines() if line.strip()]
    return next((line for line in lines if "damaged" in line), lines[-1] if lines else "")[:200]
