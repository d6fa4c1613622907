"""What a command printed is printed again while nothing it depends on has changed, and only then."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse
from workspaces import OSCILLATOR, written

from dse.api.contents import ListedResults, Listing
from dse.cache import CacheWarning
from dse.cli import answers, streams
from dse.cli.commands import list_
from dse.loading import paths

COUNT = ["enumerate", "d", "--count"]
FILES = {
    "components/interfaces.yaml": "interfaces: {i: {outputs: {y: m}}}\n",
    "components/two.yaml": "components: {a: {implements: i}, b: {implements: i}}\n",
    "designs/d.yaml": "design: d\nroot: {compound: {p: {alternatives: [a, b]}}}\n",
}


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A workspace that is the current folder, and whose files count as settled."""
    written(tmp_path / "w", FILES)
    monkeypatch.chdir(tmp_path / "w")
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(answers, "_SETTLED", 0)
    monkeypatch.setattr(answers, "_has_plugins", lambda: False)
    monkeypatch.setattr(paths, "FOLLOWED", set())
    monkeypatch.setattr(streams, "record", streams.Record())
    return tmp_path / "w"


def asked(
    capsys: pytest.CaptureFixture[bytes], arguments: list[str] = COUNT, gives: bytes = b"2 configurations\n"
) -> bytes:
    """What is printed again; if that is nothing, the command is carried out, and prints *gives*."""
    capsys.readouterr()
    if answers.answer(arguments):
        return capsys.readouterr().out
    streams.record.add(gives)
    answers.keep()
    return b""


def test_an_answer_is_printed_again(root, capsysbinary):
    assert asked(capsysbinary) == b""
    assert asked(capsysbinary) == b"2 configurations\n"
    assert asked(capsysbinary, [*COUNT, "--exact"]) == b""


def rewritten(root: Path) -> None:
    """Other bytes, the same size and times."""
    file = root / "designs/d.yaml"
    before = file.stat()
    file.write_text(file.read_text().replace("design: d", "design: e"))
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))


CHANGES: dict[str, Callable[[Path], object]] = {
    "a file with other bytes": rewritten,
    "a new file": lambda root: (root / "components/new.yaml").touch(),
    "a file that is gone": lambda root: (root / "components/two.yaml").unlink(),
    "a file beside": lambda root: (root / "data.csv").touch(),
    "a folder": lambda root: (root / "roads").mkdir(),
    "what is known of FMUs": lambda root: (root.parent / "cache/facts/new").mkdir(parents=True),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_changed_is_looked_at_again(root, capsysbinary, change):
    asked(capsysbinary)
    change(root)
    assert asked(capsysbinary) == b""


def test_an_answer_is_that_of_one_version_and_environment(root, capsysbinary, monkeypatch):
    asked(capsysbinary)
    with monkeypatch.context() as changed:
        changed.setattr(answers, "__version__", "0.0.1")
        assert asked(capsysbinary) == b""
    monkeypatch.setenv("MODELICAPATH", "elsewhere")
    assert asked(capsysbinary) == b""
    monkeypatch.delenv("MODELICAPATH")
    assert asked(capsysbinary) != b""


def test_a_file_that_the_workspace_names_in_a_folder_of_results_counts(root, capsysbinary):
    table = root / "out/study/run.csv"
    table.parent.mkdir(parents=True)
    table.write_text("t,v\n0,1\n")
    paths.FOLLOWED.add(table)
    asked(capsysbinary)
    (root / "out/other").mkdir()
    assert asked(capsysbinary) != b""
    table.write_text("t,v\n0,2\n")
    assert asked(capsysbinary) == b""


def test_a_list_depends_on_results(root, capsysbinary):
    results = root / "out/study"
    results.mkdir(parents=True)
    assert asked(capsysbinary, ["list"]) == b""
    assert asked(capsysbinary, ["list"]) != b""
    (results / "study.sqlite").touch()
    assert asked(capsysbinary, ["list"]) == b""


def test_a_list_of_a_running_study_is_not_kept(root, monkeypatch):
    verdicts = dict.fromkeys(("pass", "fail", "not exercised", "failed to run"), 0)
    running = ListedResults(root / "out/study", "study", "running", 1, 0, verdicts)
    monkeypatch.setattr("dse.api.listing", lambda _: Listing((), (), (), (running,)))
    streams.record.content = bytearray()
    list_.list_(root)
    assert streams.record.content is None


def test_what_changes_while_a_command_runs_is_not_taken_for_what_it_read(root, capsysbinary):
    assert not answers.answer(COUNT)
    streams.record.add(b"2 configurations\n")
    rewritten(root)
    answers.keep()
    assert asked(capsysbinary) == b""


UNFIT: dict[str, tuple[list[str], Callable[[Path, pytest.MonkeyPatch], object]]] = {
    "it writes a file": ([*COUNT, "-ofile.csv"], lambda *_: None),
    "it is no question": (["explore", "s"], lambda *_: None),
    "there was a note": (COUNT, lambda _, patch: patch.setattr(streams.record, "has_notes", True)),
    "another package adds to dse": (COUNT, lambda _, patch: patch.setattr(answers, "_has_plugins", lambda: True)),
    "a clock could miss a change": (COUNT, lambda _, patch: patch.setattr(answers, "_SETTLED", 10**12)),
    "a link leads to a folder": (COUNT, lambda root, _: (root / "designs/more").symlink_to(root.parent)),
    "there are too many files": (COUNT, lambda _, patch: patch.setattr(answers, "_MOST_FILES", 2)),
    "the user wants none": (COUNT, lambda _, patch: patch.setenv("DSE_ANSWERS", "0")),
    "there is no workspace": (COUNT, lambda root, patch: patch.chdir(root.parent)),
}


@pytest.mark.parametrize(("arguments", "unfit"), UNFIT.values(), ids=UNFIT)
def test_some_answers_are_not_kept(root, capsysbinary, monkeypatch, arguments, unfit):
    unfit(root, monkeypatch)
    for _ in range(2):
        assert asked(capsysbinary, arguments) == b""


def test_a_damaged_answer_is_reported_and_replaced(root, capsysbinary):
    asked(capsysbinary)
    (kept,) = (root.parent / "cache/answers").iterdir()
    kept.write_bytes(kept.read_bytes().replace(b"2 conf", b"3 conf"))
    with pytest.warns(CacheWarning):
        assert asked(capsysbinary) == b""
    assert asked(capsysbinary) == b"2 configurations\n"


def test_help_depends_on_no_workspace(root, capsysbinary, monkeypatch):
    assert asked(capsysbinary, ["--help"], b"Usage\n") == b""
    (root / "designs/new.yaml").touch()
    assert asked(capsysbinary, ["--help"]) == b"Usage\n"


@pytest.mark.thorough
def test_commands_answer_from_what_they_printed(tmp_path):
    written(tmp_path / "w", FILES)
    time.sleep(2.1)
    first, second, third = (run_dse(tmp_path / "w", *COUNT, cache=tmp_path / "cache") for _ in range(3))
    assert first.stdout == second.stdout == third.stdout == "d: 2 of 2 configurations are valid\n"
    assert len([*(tmp_path / "cache/answers").iterdir()]) in (1, 2)
    assert run_dse(tmp_path / "w", "enumerate", "e", "--count", cache=tmp_path / "cache").returncode == 1
    script = "import sys; sys.argv[1:] = %r; from dse.cli import main; main(); print(*sys.modules)"
    for _ in range(2):  # the first one is the first in this environment
        fresh = subprocess.run(
            [sys.executable, "-c", script % COUNT],
            cwd=tmp_path / "w",
            env={**os.environ, "DSE_CACHE": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=True,
        )
    answer, modules = fresh.stdout.splitlines()
    assert answer == first.stdout.strip()
    assert not {"typer", "numpy", "pydantic", "pandas", "dse.loading"} & {*modules.split()}


def test_what_a_simulation_prepared_is_found_while_the_files_it_names_are_the_same(root):
    fmu = root.parent / "cache/built/a.fmu"
    fmu.parent.mkdir(parents=True)

    def found(*arguments: str, prepares: bytes = b"a bench") -> bytes | None:
        assert not answers.answer(["simulate", "bench", *arguments])
        there = answers.found_prepared()
        if there is None and answers.is_asked():
            answers.hand_over(prepares, frozenset({str(fmu)}))
            answers.keep()
        return there

    fmu.write_bytes(b"first")
    assert found() is None
    assert found() == b"a bench"
    assert found("--gate", prepares=b"another") is None
    fmu.write_bytes(b"second")
    assert found(prepares=b"a new bench") is None
    assert found() == b"a new bench"
    rewritten(root)
    assert found() is None
    assert found() == b"a bench"
    fmu.unlink()
    assert found() is None
    assert not answers.answer(COUNT)
    assert not answers.is_asked()


SWING = """\
testbench: swing
design: one
simulation: {stop: 10 s, step: 10 ms, record: [mass.x]}
metrics: {highest: {expression: maximum(mass.x), unit: m}}
requirements: {R1: {metric: highest, at_most: 1.2 m}}
"""


@pytest.mark.thorough
@pytest.mark.parametrize(
    "words", [[], ["--format", "json", "--set", "mass.start=2 m", "--gate"]], ids=["shown", "json"]
)
def test_a_simulation_is_made_again_from_what_was_prepared(tmp_path, words):
    work = written(tmp_path / "w", OSCILLATOR | {"testbenches/swing.yaml": SWING})
    script = (
        "import sys; sys.argv[1:] = %r; import dse.cli, dse.cli.answers as a; a._SETTLED = %d\n"
        "from multiprocessing import util; util.spawnv_passfds = None\n"  # no interpreter can be started
        "try: dse.cli.main()\n"
        "finally: print(*sys.modules, file=sys.stderr)"
    )

    def simulated() -> tuple[int, str, set[str]]:
        done = subprocess.run(
            [sys.executable, "-c", script % (["simulate", "swing", *words], 0)],
            cwd=work,
            env={**os.environ, "DSE_CACHE": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout, {*done.stderr.split()} & {"typer", "pydantic", "dse.loading", "dse.space"}

    simulated()  # what it builds becomes known
    code, output, modules = simulated()
    assert code == (3 if "--gate" in words else 0)
    assert modules == {"typer", "pydantic", "dse.loading", "dse.space"}
    assert simulated()[:2] == (code, output)
    light = set() if code == 0 else modules  # what ends with another code is not kept
    assert simulated() == (code, output, light)
    for fmu in (tmp_path / "cache/built").iterdir():
        fmu.unlink()
    assert simulated()[:2] == (code, output)
    mass = work / "components/mass/mass.c"
    mass.write_text(mass.read_text().replace("self->v = 0.0", "self->v = 0.5"))
    assert simulated()[1] != output
