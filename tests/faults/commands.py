"""Whole commands in which each n-th call on files fails: what they come to, and what the same command makes of it then.

``python tests/faults/commands.py`` tries n = 1 … 300 for each command, error and process; ``--every 10`` each tenth.
What came of each goes into a file of lines of JSON, and what is in it already is not tried again.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from subprocess import CompletedProcess

import compile_cache
from command_line import run_dse
from faults import page, shim
from faults.undisturbed import PATIENCE, WORKSPACE, Case, litter, results_of, wrong_in

from dse.errors import DseError

ERRORS = {"full": "ENOSPC", "broken": "EIO", "files": "EMFILE", "denied": "EACCES"}
"""What each kind of call fails with."""

LARGEST = 300

_PLUGIN = Path(__file__).parents[2] / "examples" / "plugin"
_OUT = "{out}"
_OTHERS = re.compile("tmp/([a-z0-9_]{8}|dask-scratch-space)")
"""By what Python finds out whether it can write there, which it cannot remove if just that fails; and Dask's own."""

_FAILED_RUNS = 3


@dataclass(frozen=True, slots=True)
class Command:
    """*words* of a command, the commands *before* it that make what it needs, and the *results* in a folder.

    *cold*: it begins with an empty cache, else with what building left there.
    """

    words: tuple[str, ...]
    results: Callable[[Path], Mapping[str, bytes]]
    before: tuple[tuple[str, ...], ...] = ()
    cold: bool = False


def _study(place: Path) -> Mapping[str, bytes]:
    """All results; which runs were tried twice is true of this study alone."""
    found = results_of(place)
    return found | {"report": re.sub(rb'"retried":\[.*?\],"drawn"', b"", found["report"], count=1)}


def _report(place: Path) -> Mapping[str, bytes]:
    return {"report": (place / "out" / "report.html").read_bytes()}


def _fmus(place: Path) -> Mapping[str, bytes]:
    return {file.name: file.read_bytes() for file in sorted((place / "out").glob("*.fmu"))}


def _explore(study: str, *more: str) -> tuple[str, ...]:
    return ("explore", study, "-o", _OUT, *more)


COMMANDS = {
    "explore": Command(_explore("all", "-j", "1"), _study),
    "explore, two workers": Command(_explore("near_boundary", "-j", "2"), _study),
    "explore, a pool of processes": Command(_explore("pool"), _study),
    "explore, Dask": Command(_explore("dask"), _study),
    "report": Command(("report", _OUT), _report, (_explore("all", "-j", "1"),)),
    "merge": Command(
        ("merge", _OUT), _study, tuple(_explore("all", "-j", "1", "--shard", f"{part}/2") for part in (1, 2))
    ),
    "build": Command(("build", "-o", _OUT), _fmus, cold=True),
}


class Commands:
    """Carries out commands in *folder*, disturbed and not."""

    def __init__(self, folder: Path, library: Path) -> None:
        self._folder, self._disk = folder, folder / "disk"
        self._workspace, self._place = self._disk / "workspace", self._disk / "case"
        shutil.copytree(WORKSPACE, self._workspace)
        self._expected: dict[str, Mapping[str, bytes]] = {}
        self._left: dict[str, set[str]] = {}
        self._counts: dict[str, dict[tuple[str, str], int]] = {}
        described = folder / "plugin" / "pool-1.dist-info"
        described.mkdir(parents=True)
        (described / "METADATA").write_text("Metadata-Version: 2.1\nName: pool\nVersion: 1\n")
        (described / "entry_points.txt").write_text("[dse.executors]\nfutures = dse_example.futures:Futures\n")
        path = (str(described.parent), str(_PLUGIN), os.environ.get("PYTHONPATH", ""))
        self._environment = {"LD_PRELOAD": str(library), "PYTHONPATH": os.pathsep.join(path)}
        # Without its bytecode each Python would compile all it imports.
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

    def counts(self, name: str) -> dict[tuple[str, str], int]:
        """How many calls there are by role and kind; a few more or less the next time."""
        if name not in self._counts:
            # The first time the process that carries out commands imports what they need.
            for _ in range(2):
                self._lay_out(name)
                self._carry_out(name, None)
            self._counts[name] = shim.told(self._place / "control").counts
        return self._counts[name]

    def disturbed(self, name: str, fault: shim.Fault) -> Case:
        """The command *name* with *fault*, and once more without."""
        self._lay_out(name)
        done = self._carry_out(name, fault)
        told = shim.told(self._place / "control")
        case = Case(fault, bool(told.failed), told.what, done.returncode, done.stdout + done.stderr)
        if not case.happened:
            return case
        case.wrong += [] if done.returncode == _FAILED_RUNS and fault.role == "worker" else wrong_in(done)
        if done.returncode == 0:
            case.wrong += self._differences(name, "said it was done")
        again = self._run(COMMANDS[name].words)
        if again.returncode == _FAILED_RUNS and fault.role == "worker":
            # What fails twice, the second time alone in a fresh process, is a failed run, for which there is an option.
            again = self._run((*COMMANDS[name].words, "--retry-failed"))
        case.wrong += [f"again: {what}" for what in wrong_in(again)]
        if again.returncode == 0:
            case.wrong += self._differences(name, "again")
        else:
            case.wrong.append(f"again: {again.stderr.strip()[-300:]}")
        case.litter = [left for left in litter(self._place, self._left[name]) if not _OTHERS.fullmatch(left)]
        return case

    def _lay_out(self, name: str) -> None:
        """Everything as it is before the command, in the one folder whose path the results may hold."""
        kept = self._folder / f"before {name}"
        if not kept.exists():
            self._clear()
            for words in COMMANDS[name].before or (("explore", "all", "-o", _OUT, "-j", "1"),):
                assert self._run(words).returncode == 0
            if not COMMANDS[name].before:
                shutil.rmtree(self._place / "out")
                shutil.rmtree(self._place / "cache" / "runs")
            if COMMANDS[name].cold:
                shutil.rmtree(self._place / "cache")
            shutil.move(self._place, kept)
            shutil.copytree(kept, self._place)
            done = self._run(COMMANDS[name].words)
            assert done.returncode == 0, done.stdout + done.stderr
            self._left[name] = {path.name for path in (self._place / "out").iterdir()} | {"report.html"}
            self._expected[name] = COMMANDS[name].results(self._place)
        self._clear()
        shutil.copytree(kept, self._place, dirs_exist_ok=True)

    def _clear(self) -> None:
        if self._place.exists():
            shutil.rmtree(self._place)
        (self._place / "tmp").mkdir(parents=True)

    def _differences(self, name: str, when: str) -> list[str]:
        expected = self._expected[name]
        try:
            found = COMMANDS[name].results(self._place)
        except (DseError, OSError) as error:
            return [f"{when}: cannot be read: {str(error).strip().splitlines()[0]}"]
        return [
            f"{when}: other bytes: {file}: {_first_difference(found.get(file, b''), expected.get(file, b''))}"
            for file in sorted({*found, *expected})
            if found.get(file) != expected.get(file)
        ]

    def _carry_out(self, name: str, fault: shim.Fault | None) -> CompletedProcess[str]:
        shim.set_fault(self._place / "control", fault, self._disk)
        return self._run(COMMANDS[name].words, DSE_TESTS_FAULTS=str(self._place / "control"))

    def _run(self, words: tuple[str, ...], **more: str) -> CompletedProcess[str]:
        place = self._place
        said = tuple(word.replace(_OUT, str(place / "out")) for word in words)
        more |= {**self._environment, "TMPDIR": str(place / "tmp")}
        return run_dse(self._workspace, *said, cache=place / "cache", longest=PATIENCE, **more)


def _first_difference(found: bytes, expected: bytes) -> str:
    at = next((at for at, (a, b) in enumerate(zip(found, expected, strict=False)) if a != b), 0)
    return f"{found[max(0, at - 80) : at + 40]!r} for {expected[at : at + 40]!r}"


def tried(commands: Commands, name: str, every: int, first: int, known: Container[str]) -> Iterator[Case]:
    """What came of n = *first*, *first* + *every* … 300 for each error and process; those *known* are left out."""
    counts = commands.counts(name)
    for role, kind in product(shim.ROLES[:2], ERRORS):
        for nth in range(first, min(LARGEST, counts[role, kind]) + 1, every):
            fault = shim.Fault(kind, role, ERRORS[kind], nth, shim.EACH)
            if f"{name}: {fault}" not in known:
                yield commands.disturbed(name, fault)


def main() -> None:
    """Try them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--command", nargs="*", default=COMMANDS)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--file", type=Path, default=Path("out/commands.jsonl"))
    parser.add_argument("--write", action="store_true", help="put what is in the file into docs/trust.md, too")
    options = parser.parse_args()
    options.file.parent.mkdir(parents=True, exist_ok=True)
    options.file.touch()
    known = {line["name"] for line in map(json.loads, options.file.open(encoding="utf-8"))}
    with tempfile.TemporaryDirectory() as scratch, options.file.open("a", encoding="utf-8", buffering=1) as lines:
        compiled = Path(scratch, "compiled")
        compiled.mkdir()
        compile_cache.use(compiled, optimized=True)
        commands = Commands(Path(scratch), shim.build(Path(scratch)))
        for name in options.command:
            for case in tried(commands, name, options.every, options.first, known):
                told = asdict(case) | {"command": name, "name": f"{name}: {case.fault}"}
                lines.write(json.dumps(told) + "\n")
                if case.wrong or case.litter:
                    print(f"{name}: {case.fault}: {case.call}\n    {case.wrong} {case.litter}", flush=True)
    if options.write:
        page.write("commands", page.table_of_commands(map(json.loads, options.file.open(encoding="utf-8"))))


if __name__ == "__main__":
    main()
