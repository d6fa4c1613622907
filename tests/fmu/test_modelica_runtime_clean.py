"""The runtime compiles without a warning, and does nothing undefined while it runs."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from fmu.modelica_models import models
from fmu.modelica_models.bench import Handmade

from dse.fmu.toolchain.compilation import LANGUAGE_OPTIONS
from dse.fmu.toolchain.compiler import find_compiler

_ALL = [model for model in vars(models).values() if isinstance(model, Handmade)]
_SANITIZED = ("stiff_oscillator", "van_der_pol", "ball", "relay", "sampled", "root", "checked", "kinds")
_DRIVER = Path(models.__file__).parent / "drive.c"


def _named(name):
    return next(model for model in _ALL if model.name == name)


def _write(folder, model, version):
    for name, content in model.files(version).items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)


def _compile(folder, *arguments):
    command = [*find_compiler().command, *LANGUAGE_OPTIONS, "-Iruntime", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, encoding="utf-8", check=False)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["oscillator", "stiff_oscillator", "ball", "sampled", "checked", "kinds"])
def test_the_sources_compile_without_a_warning(tmp_path, name, version):
    _write(tmp_path, _named(name), version)
    checks = ("-Wall", "-Wextra", "-Werror", "-Wstrict-prototypes", "-fsyntax-only")
    answer = _compile(tmp_path, *checks, f"runtime/fmi{version}.c", "start.c")
    assert answer.stderr == ""
    assert answer.returncode == 0


@pytest.fixture(scope="module")
def sanitize(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sanitizer")
    (folder / "empty.c").write_text("int main(void) { return 0; }\n", encoding="utf-8")
    options = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O0", "-g")
    if _compile(folder, *options, "empty.c", "-o", "empty").returncode != 0:
        pytest.skip("this compiler has no sanitizers")
    return options


@pytest.mark.thorough
@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", _SANITIZED)
def test_nothing_undefined_happens_on_any_call(tmp_path, sanitize, name):
    model = _named(name)
    _write(tmp_path, model, 2)
    (tmp_path / "drive.c").write_bytes(_DRIVER.read_bytes())
    answer = _compile(tmp_path, *sanitize, "drive.c", "runtime/fmi2.c", "start.c", "-o", "drive", "-lm")
    assert answer.returncode == 0, answer.stderr
    sizes = [str(len(each)) for each in (model.values, model.states, model.relations)]
    ran = subprocess.run(
        [str(tmp_path / "drive"), *sizes],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        env={**os.environ, "ASAN_OPTIONS": "detect_leaks=1"},
    )
    assert ran.stderr == ""
    assert ran.returncode == 0
    assert ran.stdout.startswith("told ")
