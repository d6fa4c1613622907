"""The front-end's answers are kept, and never given for other files or other parameters."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dse.cache import content_key, keep_content
from dse.domain.component import NO_INTERFACE, Component, Kind, ModelicaSource, Parameter, Type
from dse.fmu.component_build import build
from dse.fmu.unpack import open_fmu
from dse.modelica.frontend import process
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.sources import ModelSources, read_sources
from dse.modelica.translate import answer

LAG = """within Lib;
model Lag
  parameter Integer n = 2;
  parameter Real T = 0.5;
  parameter Real gain = Data.gain;
  Real x[n](each start = 0, each fixed = true);
  output Real y = gain * x[n];
equation
  for i in 1:n loop
    T * der(x[i]) = (if i == 1 then 1 else x[max(1, i - 1)]) - x[i];
  end for;
end Lag;
"""
DATA = "within Lib;\npackage Data\n  constant Real gain = 0.5;\nend Data;\n"


@pytest.fixture
def library(tmp_path: Path) -> Path:
    folder = tmp_path / "here" / "Lib"
    folder.mkdir(parents=True)
    for name, text in {"package": "package Lib\nend Lib;\n", "Lag": LAG, "Data": DATA}.items():
        (folder / f"{name}.mo").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What was started: ``front-end``, or the file that the compiler was given last."""
    found: list[str] = []
    start = process.FrontEnd._start
    run = subprocess.run

    def watched(front_end: process.FrontEnd) -> Any:
        found.append("front-end")
        return start(front_end)

    def compiled(command: Any, *rest: Any, **options: Any) -> Any:
        found.append(Path(next((word for word in command if str(word).endswith((".c", ".o"))), command[-1])).name)
        return run(command, *rest, **options)

    monkeypatch.setattr(process.FrontEnd, "_start", watched)
    monkeypatch.setattr(subprocess, "run", compiled)
    return found


def lag(library: Path, **starts: float) -> Component:
    source = ModelicaSource("Lib.Lag", (library,), ())
    parameters = tuple(
        Parameter(name, Type(Kind.INTEGER), int(start), tunable=False)
        if name == "n"
        else Parameter(name, Type(Kind.REAL), start)
        for name, start in starts.items()
    )
    return Component("lag", NO_INTERFACE, source=source, parameters=parameters)


def start_of(component: Component, name: str, cache: Path) -> float:
    return float(open_fmu(build(component, cache=cache), cache=cache).variables[name].start[0])


def test_another_start_value_asks_no_front_end_and_compiles_one_small_file(
    library: Path, tmp_path: Path, started: list[str]
) -> None:
    cache = tmp_path / "cache"
    build(lag(library, T=0.25), cache=cache)
    assert started.count("front-end") == 1
    started.clear()
    assert start_of(lag(library, T=0.75), "T", cache) == 0.75
    assert "front-end" not in started
    assert "fmi2.c" not in started
    assert len(started) == 2  # start.c, and the link
    started.clear()
    build(lag(library, T=0.75), cache=cache)
    assert started == []


@pytest.mark.thorough
def test_another_structural_value_is_another_answer(library: Path, tmp_path: Path, started: list[str]) -> None:
    cache = tmp_path / "cache"
    build(lag(library, n=2), cache=cache)
    started.clear()
    assert "x[3]" in open_fmu(build(lag(library, n=3), cache=cache), cache=cache).variables
    assert "front-end" in started


@pytest.mark.sampled(3)
@pytest.mark.parametrize("file", ["Data", "Lag", "package"])
def test_another_text_of_any_file_is_another_answer(
    library: Path, tmp_path: Path, started: list[str], file: str
) -> None:
    cache = tmp_path / "cache"
    build(lag(library), cache=cache)
    started.clear()
    path = library / f"{file}.mo"
    path.write_text(
        path.read_text(encoding="utf-8").replace("gain = 0.5", "gain = 0.125") + "// other\n", encoding="utf-8"
    )
    assert start_of(lag(library), "gain", cache) == (0.125 if file == "Data" else 0.5)
    assert "front-end" in started


def answered(tmp_path: Path, asked_for: ModelSources) -> FrontEndResult:
    def keep(asked: Sequence[tuple[str, bytes]], make: Callable[[], bytes]) -> bytes:
        return keep_content(tmp_path / "kept" / content_key(asked), make)

    return answer(asked_for, {}, keep)


def sources(library: Path, *, as_library: bool) -> ModelSources:
    return read_sources("lag", "Lib.Lag", [] if as_library else [library], [library.parent] if as_library else [])


@pytest.mark.parametrize("as_library", [False, True])
def test_what_is_recalled_is_what_was_said_wherever_the_files_lie_now(
    library: Path, tmp_path: Path, started: list[str], as_library: bool
) -> None:
    first = answered(tmp_path, sources(library, as_library=as_library))
    again = answered(tmp_path, sources(library, as_library=as_library))
    assert started.count("front-end") == 1
    assert again == first
    moved = library.parent.rename(tmp_path / "there") / "Lib"
    other = answered(tmp_path, sources(moved, as_library=as_library))
    assert started.count("front-end") == 1
    places = {Path(source.path) for source in other.sources.values()}
    assert places <= {moved / name for name in ("Lag.mo", "Data.mo", "package.mo")}
    assert all(str(tmp_path) not in path.read_text(encoding="utf-8") for path in (tmp_path / "kept").iterdir())
    assert replace(other, sources={}, dae={}) == replace(first, sources={}, dae={})


def test_a_file_of_a_library_that_changed_and_a_damaged_answer_are_asked_anew(
    library: Path, tmp_path: Path, started: list[str]
) -> None:
    def asked() -> int:
        started.clear()
        answered(tmp_path, sources(library, as_library=True))
        return started.count("front-end")

    assert [asked(), asked()] == [1, 0]
    (library / "Data.mo").write_text(DATA.replace("0.5", "7.0"), encoding="utf-8")
    assert [asked(), asked()] == [1, 0]
    for kept in (tmp_path / "kept").iterdir():
        kept.write_bytes(kept.read_bytes()[:-20])
    assert [asked(), asked()] == [1, 0]
