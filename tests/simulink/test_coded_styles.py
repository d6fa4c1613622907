"""Generated code in each style gives what its equations say, in every copy and in every run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import coded_texts as texts
import pytest
from coded_copies import Copy
from workspaces import written

from dse.simulink import Style, build_library, read_model

pytest.importorskip("clang.cindex")

U = [math.sin(0.3 * k) + 0.2 * k for k in range(50)]
ON = [k % 7 != 3 for k in range(50)]


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@contextmanager
def copies(files: Mapping[str, str], folder: Path, cache: Path, count: int = 1) -> Iterator[list[Copy]]:
    model = read_model(written(folder / "lag_ert_rtw", files), step=texts.STEP)
    library = build_library(model, cache=cache)
    yield [Copy(model, library, folder / f"{k}.so") for k in range(count)]


STYLES = {
    "whole_program": (texts.whole_program(), Style.GLOBAL, ("speed", "enable", "filtered", "Gain")),
    "exported": (texts.exported(), Style.GLOBAL, ("speed", "enable", "filtered", "Gain")),
    "reusable": (texts.reusable(), Style.REUSABLE, ("speed", "enable", "filtered", "Gain")),
    "arguments": (texts.arguments(), Style.ARGUMENTS, ("arg_speed", "arg_enable", "arg_Out1", "")),
    "class": (texts.class_of_cpp(), Style.CLASS, ("speed", "enable", "filtered", "Gain")),
}


@pytest.mark.parametrize("name", STYLES)
def test_every_style_computes_what_its_equation_says(name: str, tmp_path: Path, cache: Path) -> None:
    files, style, (speed, enable, filtered, gain) = STYLES[name]
    model = read_model(written(tmp_path / "lag_ert_rtw", files), step=texts.STEP)
    assert model.interface.style is style
    assert model.timing.step == texts.STEP
    with copies(files, tmp_path, cache, 2) as (one, other):
        assert not gain or one.parameter(gain) == texts.GAIN
        one.start(**({gain: 2.0} if gain else {}))
        other.start()
        found = [
            (one.step(**{speed: u, enable: on})[filtered], other.step(**{speed: -u, enable: on})[filtered])
            for u, on in zip(U, ON, strict=True)
        ]
    expected = texts.lag(U, 2.0 if gain else texts.GAIN, ON)
    assert [one for one, _ in found] == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert [other for _, other in found] == pytest.approx(
        texts.lag([-u for u in U], texts.GAIN, ON), rel=1e-12, abs=1e-12
    )


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_outputs_of_a_model_that_integrates_are_those_at_the_end_of_the_step(
    order: int, tmp_path: Path, cache: Path
) -> None:
    with copies(texts.continuous(order), tmp_path, cache) as (model,):
        model.start()
        found = [model.step(speed=u)["filtered"] for u in U]
    assert found == pytest.approx(texts.lag_by_ode(order, U), rel=1e-12, abs=1e-12)


def test_raw_outputs_are_those_of_the_last_minor_step(tmp_path: Path, cache: Path) -> None:
    from dse.simulink import Chosen

    model = read_model(written(tmp_path / "lag_ert_rtw", texts.continuous(3)))
    made = model.interface
    chosen = Chosen(tuple(made.inputs), tuple(made.outputs), tuple(made.parameters))
    raw = Copy(model, build_library(model.with_ports(chosen, is_raw=True), cache=cache), tmp_path / "raw.so")
    raw.start()
    assert raw.step(speed=1.0)["filtered"] != pytest.approx(texts.lag_by_ode(3, [1.0])[0], rel=1e-3)


def test_every_rate_runs_as_often_as_its_comment_says(tmp_path: Path, cache: Path) -> None:
    model = read_model(written(tmp_path / "read", texts.two_rates()))
    assert (model.timing.step, model.timing.rates) == (0.1, (1, 3))
    with copies(texts.two_rates(), tmp_path, cache) as (copy,):
        copy.start()
        found = [copy.step(speed=1.0) for _ in range(8)]
    assert [each["quick"] for each in found] == [1, 2, 3, 4, 5, 6, 7, 8]
    assert [each["slow"] for each in found] == [1, 1, 1, 4, 4, 4, 7, 7]


def test_the_step_of_a_scheduler_is_a_part_of_the_rate_it_tells(tmp_path: Path) -> None:
    model = read_model(written(tmp_path, texts.scheduled()))
    assert (model.timing.step, model.timing.source) == (0.1, "its scheduler")


def test_whole_numbers_are_rounded_and_kept_within_what_they_hold(tmp_path: Path, cache: Path) -> None:
    with copies(texts.whole_numbers(), tmp_path, cache) as (model,):
        model.start()
        first = model.step(speed=100.4, mode=3, small=300)
        assert (first["doubled"], first["same"], first["told"]) == (200, 3, 255)
        second = model.step(speed=math.nan, mode=99, small=-5)
        assert (second["doubled"], second["same"], second["told"]) == (0, 7, 0)
