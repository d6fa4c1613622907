"""A small study, what it comes to when nothing happens, and what came of one to which something did."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from subprocess import CompletedProcess

from command_line import run_dse
from faults import shim

from dse.api import Results
from dse.errors import DseError

WORKSPACE = Path(__file__).with_name("workspace")
FORMATS = ("csv", "json", "parquet", "junit")
PATIENCE = 90
"""Seconds after which a command hangs."""

_LIES = ("damaged", "--fresh")


@dataclass(slots=True)
class Case:
    """What came of one fault; *wrong* is what should not have been, *litter* what was left behind at the end."""

    fault: shim.Fault
    happened: bool = False
    call: str = ""
    code: int = 0
    said: str = ""
    healed: bool = False
    wrong: list[str] = field(default_factory=list)
    litter: list[str] = field(default_factory=list)


class Studies:
    """Runs studies of the workspace, disturbed and not, in *folder*."""

    def __init__(self, folder: Path, library: Path) -> None:
        self.folder = folder
        self.workspace = folder / "workspace"
        self._library = library
        # Without its bytecode each Python would compile all it imports.
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        shutil.copytree(WORKSPACE, self.workspace)
        self._cache = folder / "cache"
        self._undisturbed: dict[str, dict[str, bytes]] = {}

    def undisturbed(self, study: str) -> dict[str, bytes]:
        """The results of *study*, by name of what was exported."""
        if study not in self._undisturbed:
            place, cache, _ = self.laid_out(cold=False)
            done = self._explore(place, cache, study)
            assert done.returncode == 0, done.stdout + done.stderr
            self._undisturbed[study] = self.results(place)
            shutil.rmtree(self._cache, ignore_errors=True)
            shutil.copytree(cache, self._cache)
        return self._undisturbed[study]

    def counts(self, study: str, *, cold: bool) -> dict[tuple[str, str], int]:
        """How many calls of each kind there are by role; a few more or less the next time."""
        self.undisturbed(study)
        place, cache, control = self.laid_out(cold=cold)
        shim.set_fault(control, None)
        self._explore(place, cache, study, DSE_TESTS_FAULTS=str(control))
        return shim.told(control).counts

    def disturbed(self, study: str, fault: shim.Fault, *, cold: bool = False) -> Case:
        """Explore *study* with *fault*, and once more without."""
        expected = self.undisturbed(study)
        place, cache, control = self.laid_out(cold=cold)
        shim.set_fault(control, fault)
        done = self._explore(place, cache, study, DSE_TESTS_FAULTS=str(control))
        told = shim.told(control)
        case = Case(fault, bool(told.failed), told.what, done.returncode, done.stdout + done.stderr)
        if not case.happened:
            return case
        case.wrong += wrong_in(done)
        if done.returncode == 0 and not case.wrong:
            case.wrong += [f"said it was done: {what}" for what in self.differences(place, expected)]
        again = self._explore(place, cache, study)
        case.wrong += [f"again: {what}" for what in wrong_in(again)]
        if again.returncode:
            case.wrong.append(f"again: {again.returncode}: {_last(again)}")
        else:
            case.wrong += [f"again: {what}" for what in self.differences(place, expected)]
        case.healed = again.returncode == 0 and not case.wrong
        case.litter = litter(place)
        return case

    def results(self, place: Path) -> dict[str, bytes]:
        """All that the study in *place* gives: tables, waveforms and report; DseError if it cannot be read."""
        results = Results(place / "out")
        made = {name: results.export(name) for name in FORMATS}
        made["report"] = results.report().read_bytes()
        waveforms = place / "out" / "waveforms"
        return made | {file.name: file.read_bytes() for file in waveforms.iterdir()}

    def laid_out(self, *, cold: bool = False) -> tuple[Path, Path, Path]:
        # Always the same place: a report tells the folder it was made from.
        place = self.folder / "case"
        if place.exists():
            shutil.rmtree(place)
        (place / "tmp").mkdir(parents=True)
        cache = place / "cache"
        if not cold and self._cache.exists():
            shutil.copytree(self._cache, cache)
        return place, cache, place / "control"

    def _explore(self, place: Path, cache: Path, study: str, **more: str) -> CompletedProcess[str]:
        # One worker: calls come in nearly the same order each time, so that every one has its number.
        words = ("explore", study, "-o", str(place / "out"), "-j", "1")
        # Without the variable that arms it the library lets everything pass.
        more = {"LD_PRELOAD": str(self._library), "TMPDIR": str(place / "tmp"), **more}
        return run_dse(self.workspace, *words, cache=cache, longest=PATIENCE, **more)

    def differences(self, place: Path, expected: dict[str, bytes]) -> list[str]:
        try:
            results = self.results(place)
        except (DseError, OSError) as error:
            return [f"cannot be read: {str(error).strip().splitlines()[0]}"]
        names = sorted({*results, *expected})
        different = [name for name in names if results.get(name) != expected.get(name)]
        return [f"other bytes: {', '.join(different[:4])}"] if different else []


def wrong_in(done: CompletedProcess[str], *, signalled: bool = False) -> list[str]:
    """What a command must not come to, whatever happens to it; *signalled*, it may die of that."""
    text = done.stdout + done.stderr
    wrong = []
    if done.returncode < 0 and not signalled:
        wrong.append("hangs" if done.returncode == -14 else f"died of signal {-done.returncode}")
    if "Traceback" in text:
        wrong.append(f"traceback: {_last(done)}")
    wrong += [f"says '{lie}': {_last(done)}" for lie in _LIES if lie in text]
    if done.returncode == 3:
        line = next((line for line in text.splitlines() if " failed: " in line), "")
        wrong.append(f"false failures: {line.strip()[:200]}")
    elif done.returncode > 0 and not done.stderr.strip():
        wrong.append("ended without a word")
    return wrong


def _last(done: CompletedProcess[str]) -> str:
    lines = [line for line in (done.stderr or done.stdout).splitlines() if line.strip()]
    shown = next((line for line in lines if "damaged" in line), lines[-1] if lines else "")
    return shown.strip()[:200]


def litter(place: Path) -> list[str]:
    """What is left in *place* that a finished study does not leave."""
    left = [f"tmp/{path.name}" for path in (place / "tmp").iterdir()]
    left += [f"cache/{path.name}" for path in (place / "cache").rglob(".*.tmp")]
    return left + [f"out/{path.name}" for path in (place / "out").iterdir() if path.name not in _EXPECTED]


_EXPECTED = {"study.sqlite", "waveforms", "report.html"}
