"""Generated code that is broken or means harm: one clear error each, in bounded time and without harm to others."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import coded_texts as texts
import pytest
from coded_workspaces import Code, workspace
from command_line import run_dse
from hostile_codes import FAILING, GOOD, IN_THE_WAY, LONG, NOT_COMPILED, REFUSED, in_header, in_step, ports

from dse.errors import DseError
from dse.simulink import CodedModel, build_library, declarations, libclang_process, read_model

pytest.importorskip("clang.cindex")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="components of the kind simulink are for POSIX")

_SLOW = ("macros in the header", "a device")
"""Until they have all the memory they may have."""


def _cases(table: dict[str, tuple[Code, str]]) -> list[object]:
    marks = {name: [pytest.mark.thorough] if name in _SLOW else [] for name in table}
    return [pytest.param(name, marks=marks[name]) for name in table]


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


def _told(done: subprocess.CompletedProcess[str]) -> str:
    said = done.stdout + done.stderr
    assert "Traceback" not in said
    assert "mistake in dse" not in said
    return said


def _read(folder: Path, name: str = "") -> CodedModel:
    return read_model(folder, name, step=0.1)


def _written(folder: Path, code: Code) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in code.items():
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return folder


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", _cases(REFUSED))
def test_check_says_what_is_wrong_and_where(name: str, tmp_path: Path, cache: Path) -> None:
    code, expected = REFUSED[name]
    root = workspace(tmp_path / "workspace", {"bad": code}, more="" if name == "no step" else "step: 0.1 s")
    (root / "secret.h").write_text("the password is 1234\n", encoding="utf-8")
    done = run_dse(root, "check", ".", cache=cache)
    assert done.returncode == 1
    assert re.search(expected, _told(done)), done.stderr
    assert "1234" not in done.stderr


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", NOT_COMPILED)
def test_what_does_not_compile_is_told_in_the_words_of_the_compiler(name: str, tmp_path: Path, cache: Path) -> None:
    code, expected = NOT_COMPILED[name]
    done = run_dse(workspace(tmp_path / "workspace", {"bad": code}), "simulate", "see", cache=cache)
    assert done.returncode == 1
    assert re.search(expected, _told(done)), done.stderr
    assert str(cache) not in done.stderr


@pytest.mark.thorough
@pytest.mark.parametrize("name", FAILING)
def test_a_run_that_fails_says_what_the_model_did(name: str, tmp_path: Path, cache: Path) -> None:
    code, expected = FAILING[name]
    root = workspace(tmp_path / "workspace", {"bad": code}, timeout="2 s")
    done = run_dse(root, "simulate", "see", cache=cache)
    assert done.returncode == 3
    assert re.search(f"failed to run: .*{expected}", _told(done)), done.stdout


@pytest.mark.thorough
def test_a_study_goes_on_with_the_designs_whose_code_is_innocent(tmp_path: Path, cache: Path) -> None:
    names = ("a null pointer", "exit", "an error status", "an initialization without end")
    bad = {f"bad{number}": FAILING[name] for number, name in enumerate(names)}
    # Each is the model bad, in a folder of its own.
    models = {"good": texts.whole_program("bad"), **{name: code for name, (code, _) in bad.items()}}
    root = workspace(tmp_path / "workspace", models, timeout="1 s")
    done = run_dse(root, "explore", "all", "-o", "out", "-j", "2", cache=cache)
    said = _told(done)
    assert done.returncode == 3
    for _, expected in bad.values():
        assert re.search(expected, said), said
    table = run_dse(root, "results", "out", "--format", "json", cache=cache)
    rows = json.loads(table.stdout)["runs"]
    assert [row["outcome"] for row in rows].count("done") == 2
    assert [row["outcome"] for row in rows].count("failed") == 2 * len(bad)


@pytest.mark.thorough
def test_what_a_model_prints_is_not_taken_for_what_dse_says(tmp_path: Path, cache: Path) -> None:
    code = in_step('extern int puts(const char *); extern int fflush(void *); puts("{\\"end\\": 1}"); fflush(0);')
    root = workspace(tmp_path / "workspace", {"bad": code})
    done = run_dse(root, "simulate", "see", "--format", "json", cache=cache)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["metrics"]["end"] != 1


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", LONG)
def test_long_texts_of_one_kind_are_read_in_a_time_that_grows_as_they_do(name: str, tmp_path: Path) -> None:
    # A pattern that took the square of it would take minutes.
    text = LONG[name]
    text = text * (400_000 // len(text))
    for style in (texts.exported, texts.reusable):
        files = dict(style("bad"))
        files["bad.c"] += f"\n{text}"
        files["bad.h"] = f"{files['bad.h']}#if 0\n{text}\n*/\n#endif\n"
        made = _read(_written(tmp_path / style.__name__, files)).interface
        assert [port.name for port in made.outputs] == ["filtered"]


@pytest.mark.parametrize("name", IN_THE_WAY)
def test_what_else_is_in_the_folder_is_not_in_the_way(name: str, tmp_path: Path) -> None:
    IN_THE_WAY[name](_written(tmp_path / "code", GOOD))
    assert len(_read(tmp_path / "code").interface.inputs) == 2


def test_files_that_cannot_be_read_and_names_without_letters_are_told(tmp_path: Path) -> None:
    folder = _written(tmp_path / "code", GOOD)
    odd = folder / os.fsdecode(b"gr\xfc.h")
    odd.touch()
    with pytest.raises(DseError, match="not UTF-8"):
        _read(folder)
    odd.unlink()
    with pytest.raises(DseError, match="is not a name that Simulink gives a model"):
        _read(folder, "../code/bad")
    with pytest.raises(DseError, match="this is a file, not a folder"):
        _read(folder / "bad.c")
    if sys.platform == "linux":
        (folder / "more.h").symlink_to("/proc/self/mem")
        with pytest.raises(DseError, match=r"more\.h: cannot be read"):
            _read(folder)


@pytest.mark.parametrize("name", ["a \"b' $c", "a\nb", "größe"])
def test_a_folder_may_have_any_name(name: str, tmp_path: Path, cache: Path) -> None:
    model = _read(_written(tmp_path / name, GOOD))
    assert build_library(model, cache=cache)


def test_ports_may_have_any_name_of_c_and_comments_any_text(tmp_path: Path, cache: Path) -> None:
    lines = "real_T größe; /* '<Root>/a\n * b \"c\" \\ d' ü */\nreal_T class, None, self, values, m; // */ '<Root>/\n"
    model = _read(_written(tmp_path / "code", ports(lines)))
    assert build_library(model, cache=cache)
    names = [port.name for port in model.interface.inputs]
    assert names == ["speed", "enable", "größe", "class", "None", "self", "values", "m"]


@pytest.mark.thorough
def test_thousands_of_ports_are_compiled(tmp_path: Path, cache: Path) -> None:
    # In one function of C this takes minutes.
    model = _read(_written(tmp_path / "code", ports("".join(f"real_T p{n};\n" for n in range(10_000)))))
    assert len(model.interface.inputs) == 10_002
    assert build_library(model, cache=cache)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes with names")
def test_a_header_that_never_ends_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(libclang_process, "_SECONDS", 0.5)
    folder = _written(tmp_path / "code", in_header('#include "endless.h"'))
    os.mkfifo(folder / "endless.h")
    with pytest.raises(DseError, match=r"bad\.h: what it declares cannot be read: it took longer than"):
        _read(folder)


def test_a_crash_of_the_parser_is_an_error_like_any_other(tmp_path: Path) -> None:
    # What its lexer skips it skips by recursion.
    with pytest.raises(DseError, match=r"bad\.h: what it declares cannot be read: libclang crashed"):
        _read(_written(tmp_path / "code", in_header("\\\n" * 500_000)))


def test_a_header_is_read_once_until_it_or_what_it_includes_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    asked: list[object] = []

    def counted(*arguments: object) -> object:
        asked.append(arguments)
        return libclang_process.asked(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(declarations, "asked", counted)
    (tmp_path / "more.h").write_text("typedef double more;\n", encoding="utf-8")
    folder = _written(tmp_path / "code", in_header('#include "../more.h"'))
    first, again = _read(folder), _read(folder)
    assert len(asked) == 1
    assert first.interface == again.interface
    (tmp_path / "more.h").write_text("typedef float more;\n", encoding="utf-8")
    _read(folder)
    assert len(asked) == 2
    (folder / "rtwtypes.h").write_text(f"{texts.TYPES}\n", encoding="utf-8")
    _read(folder)
    assert len(asked) == 3
