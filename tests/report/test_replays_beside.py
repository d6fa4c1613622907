"""The way from a run of the report to its replay."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dse.domain.definition import DefinedConfiguration
from dse.report.content.data import Scenes
from dse.report.content.scenes import scenes_of, with_replays


class Definition:
    """As much of a definition as the question needs."""

    def __init__(self, wires: tuple[str, ...] = (), columns: tuple[str, ...] = ()) -> None:
        self.study = "gains"
        self.configurations = (DefinedConfiguration("c1", wires=wires, columns=columns),)


@pytest.mark.parametrize(
    ("wires", "columns", "is_scene"),
    [
        (("chassis.motion.heading -> sensor.motion.heading",), (), True),
        ((), ("world.position", "world.gap"), True),
        ((), ("world.position", "sensor.gap"), False),
        (("pump.flow -> tank.flow",), ("tank.level",), False),
    ],
)
def test_a_study_whose_runs_tell_of_no_car_offers_no_replay(wires, columns, is_scene) -> None:
    assert scenes_of(Definition(wires, columns)) == (Scenes("gains") if is_scene else None)


def test_runs_whose_replays_are_there_are_scenes_whatever_else_is_known(bench_only) -> None:
    assert with_replays(bench_only, ()).scenes is None
    assert with_replays(bench_only, (3, 1)).scenes == Scenes("acc_gains", (1, 3))


@pytest.mark.thorough
def test_a_replay_that_is_there_is_linked_of_others_the_command_is_told(bench_only, open_report, tmp_path) -> None:
    page = open_report(replace(bench_only, scenes=Scenes("acc_gains", (0,))))

    def of(run: int) -> str:
        page.evaluate(f"location.hash = 'run={run}'")
        page.reload()
        page.wait_for_selector("html[data-ready]")
        assert page.inner_text("#selected-run") == f"Run {run}"
        return page.inner_text(".selected .replay") if page.locator(".selected .replay").count() else ""

    assert of(0) == "3-D replay of run 0"
    assert page.get_attribute("#replay", "href") == "replays/run_0.html"
    assert "dse report acc_gains --replay 1" in of(1)
    assert page.locator("#copy-replay").count() == 1
    assert of(4) == ""  # it failed


@pytest.mark.thorough
def test_a_study_without_scenes_says_nothing_of_replays(bench_only, open_report) -> None:
    page = open_report(bench_only)
    assert page.locator(".selected").count() == 1
    assert page.locator(".selected .replay").count() == 0
