"""The compiler of the tests takes what it made before only if nothing it depends on has changed."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import compile_cache
import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="nothing is kept on this machine")


@pytest.fixture(autouse=True)
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, real_compiler: None) -> Path:
    """A folder of this test's own for what is kept."""
    monkeypatch.setenv("CC", os.environ.get("CC", ""))  # what is set below is undone
    monkeypatch.setenv("DSE_TESTS_CC", "")
    monkeypatch.delenv("DSE_TESTS_CC")
    folder = tmp_path / "kept"
    folder.mkdir()
    monkeypatch.setenv("DSE_TESTS_CC_SPENT", "")  # same
    monkeypatch.delenv(compile_cache.OPTIMIZED, raising=False)
    compile_cache.use(folder, optimized=False)
    return folder


def compiled(folder: Path, *options: str, value: int = 1, source: str = "int value(void) { return VALUE; }") -> str:
    """What the compiler says of *source* in *folder*, which becomes value.so."""
    folder.mkdir(exist_ok=True)
    (folder / "value.h").write_text(f"#define VALUE {value}\n", encoding="utf-8")
    (folder / "value.c").write_text(f'#include "value.h"\n{source}\n', encoding="utf-8")
    command = [os.environ["CC"], "-shared", "-fPIC", *options, "value.c", "-o", "value.so"]
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, encoding="utf-8").stderr


def value(folder: Path) -> int:
    return int(ctypes.CDLL(str(folder / "value.so")).value())


@pytest.mark.parametrize("is_staged", [True, False], ids=["staged", "with folders of others"])
def test_a_changed_header_or_option_makes_another_library(tmp_path, is_staged):
    found = []
    for number, (option, header) in enumerate([("-DMORE=10", 1), ("-DMORE=10", 2), ("-DMORE=20", 2), ("-DMORE=10", 1)]):
        folder = tmp_path / str(number)
        include = "-I." if is_staged else f"-I{folder}"
        compiled(folder, option, include, value=header, source="int value(void) { return VALUE + MORE; }")
        found.append(value(folder))
    assert found == [11, 12, 22, 11]


def test_the_same_in_another_folder_is_not_compiled_again(tmp_path, kept):
    compiled(tmp_path / "one")
    (made,) = (path for path in kept.iterdir() if len(path.name) == 64)
    made.write_bytes(b"what was kept")
    compiled(tmp_path / "two")
    assert (tmp_path / "two" / "value.so").read_bytes() == b"what was kept"
    compiled(tmp_path / "three", value=2)
    assert value(tmp_path / "three") == 2


def test_a_warning_is_told_each_time(tmp_path):
    source = "int value(void) { int unused; return VALUE; }"
    assert all("unused" in compiled(tmp_path / "same", "-Wall", source=source) for _ in range(2))


def test_the_optimizer_is_left_out_unless_it_is_asked_for_or_warnings_are(tmp_path: Path, monkeypatch) -> None:
    source = "#ifdef __OPTIMIZE__\nint value(void) { return VALUE; }\n#else\nint value(void) { return 0; }\n#endif"
    for name, options, optimized in (("plain", ("-O2",), 0), ("warned", ("-O2", "-Wall"), 1)):
        compiled(tmp_path / name, *options, source=source)
        assert value(tmp_path / name) == optimized
    monkeypatch.setenv(compile_cache.OPTIMIZED, "1")
    compiled(tmp_path / "as users do", "-O2", source=source)
    assert value(tmp_path / "as users do") == 1


def test_what_is_compiled_for_all_is_charged_to_none(tmp_path: Path) -> None:
    account = compile_cache.account()
    compiled(tmp_path / "one")
    first = compile_cache.spent(account)
    compiled(tmp_path / "two")
    assert 0 < first == compile_cache.spent(account)
