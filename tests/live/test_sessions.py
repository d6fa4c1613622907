"""Somebody at the wheel of a small bench, over the real kernel."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from background import LIMIT
from live.conftest import open_sockets
from small_drive import drive_workspace

from dse.api import Drives, LiveDrive, open as open_workspace, open_drive
from dse.errors import DseError
from dse.live import Patience, Why


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory):
    return open_workspace(drive_workspace(tmp_path_factory.mktemp("drives")))


@pytest.fixture
def driven(field) -> Iterator[LiveDrive]:
    live = open_drive(field.benches["field"].noun, driver="  Ada\n<b>  ")
    yield live
    live.close()


def until(met: Callable[[], object], seconds: float = LIMIT) -> None:
    end = time.monotonic() + seconds
    while not met():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.005)


def echoed(live: LiveDrive, number: int) -> bool:
    seen = live.session.newest
    return seen is not None and seen.echo >= number


@pytest.mark.thorough
def test_what_is_done_at_the_wheel_is_used_shown_and_recorded(driven: LiveDrive) -> None:
    driven.start()
    until(lambda: driven.session.newest)
    driven.control({"accelerator": 0.5, "cruise": False, "gear": "park"}, 7)
    until(lambda: echoed(driven, 7))
    driven.tune({"car.gain": 36.0}, 8)
    until(lambda: echoed(driven, 8))
    seen = driven.session.newest
    assert seen is not None
    assert seen.time > 0
    driven.finish()
    ended = driven.session.wait(LIMIT)
    assert ended is not None
    assert ended.why is Why.FINISHED, ended.text
    drive = driven.result
    assert drive is not None
    assert drive.driver == "Ada <b>"
    assert {*drive.inputs} == {"accelerator", "steering", "cruise", "gear", "tune.car.gain", "tune.car.doomed"}
    assert np.array_equal(drive.time, np.arange(len(drive.time)) * 0.01)
    assert {*drive.inputs["accelerator"]} == {0.0, 0.5}
    assert [*drive.inputs["cruise"][[0, -1]]] == [1.0, 0.0]
    assert [*drive.inputs["gear"][[0, -1]]] == [1.0, 0.0]
    assert [*drive.inputs["tune.car.gain"][[0, -1]]] == [2.5, 10.0]
    assert drive.pace.steps == len(drive.time) - 1


@pytest.mark.thorough
def test_a_drive_made_again_from_its_record_gives_the_same_bits(driven: LiveDrive, field, tmp_path: Path) -> None:
    driven.start()
    until(lambda: driven.session.newest)
    for number in range(1, 6):
        driven.control({"accelerator": 0.1 * number, "steering": 0.01 * number}, number)
        driven.tune({"car.gain": 10.0 * number}, 100 + number)
        until(lambda: echoed(driven, 100))
    driven.finish()
    assert driven.session.wait(LIMIT) is not None
    drive = driven.result
    assert drive is not None
    kept = Drives(tmp_path / "drives", field.files)
    kept.add(drive)
    (checked,) = kept.check()
    assert checked.was_noted
    assert checked.is_same, (checked.from_driving, checked.from_study)


@pytest.mark.thorough
def test_an_fmu_that_crashes_is_named_and_the_next_drive_goes_on(driven: LiveDrive, field) -> None:
    driven.start()
    until(lambda: driven.session.newest)
    driven.tune({"car.doomed": 0.0})
    ended = driven.session.wait(LIMIT)
    assert ended is not None
    assert ended.why is Why.CRASHED
    assert ended.text.startswith("car: fmi2DoStep at t = ")
    assert "SIGABRT" in ended.text
    assert driven.result is None


@pytest.mark.thorough
def test_a_run_that_does_not_begin_is_ended(driven: LiveDrive, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("dse.live.session.TURN", 0.0)  # a run may well begin in a quarter of a second
    driven.start(Patience(start=0.0))
    ended = driven.session.wait(LIMIT)
    assert ended is not None
    assert ended.why is Why.CRASHED
    assert "did not begin" in ended.text


@pytest.mark.parametrize(
    "values",
    [
        {"horn": 1.0}, {"accelerator": "full"}, {"accelerator": float("nan")}, {"accelerator": None}, {"cruise": 2},
        {"gear": "reverse"}, {"gear": 2}, {"gear": -1}, {"gear": 0.5}, {"accelerator": True}, {"accelerator": []},
        {"accelerator": 0.5, "horn": 1},
    ],
)  # fmt: skip
def test_what_is_no_control_is_refused_and_changes_nothing(field, shared: LiveDrive, values: dict) -> None:
    before = dict(shared.session._values)
    with pytest.raises(DseError):
        shared.control(values)
    assert shared.session._values == before


@pytest.mark.parametrize("values", [{"car.gain": 181.0}, {"car.gain": -1}, {"car.mass": 1.0}, {"car.gain": "1"}])
def test_what_is_no_parameter_or_out_of_its_range_is_refused(shared: LiveDrive, values: dict) -> None:
    before = dict(shared.session._values)
    with pytest.raises(DseError):
        shared.tune(values)
    assert shared.session._values == before


@pytest.fixture(scope="module")
def shared(field) -> Iterator[LiveDrive]:
    live, sockets = open_drive(field.benches["field"].noun), open_sockets()
    live.start()
    until(lambda: open_sockets() - sockets)  # its own, and no test's
    yield live
    live.close()


def test_every_column_is_what_a_replay_would_show(shared: LiveDrive) -> None:
    from dse.report import SceneSignals

    values = np.random.default_rng(1).normal(size=len(shared.view.wanted))
    told = SceneSignals(dict.fromkeys(shared.view.wanted), {}, ())
    host = told.host({name: values[place : place + 1] for place, name in enumerate(shared.view.wanted)})
    shown = dict(zip(shared.view.columns, shared.view.of(values), strict=True))
    for name, column in host.columns.items():
        assert shown[f"host.{name}"] == column[0]
    speed = shared.view.wanted.index("car.motion.speed")
    assert shown["instrument.0"] == pytest.approx(3.6 * values[speed], rel=1e-15)


def test_a_bench_without_a_driver_is_refused_by_name(tmp_path: Path) -> None:
    root = drive_workspace(tmp_path)
    interfaces = root / "components" / "interfaces.yaml"
    interfaces.write_text(interfaces.read_text().replace("driver:", "chauffeur:"), encoding="utf-8")
    idle = root / "components" / "idle" / "component.yaml"
    idle.write_text(idle.read_text().replace("implements: driver", "implements: chauffeur"), encoding="utf-8")
    with pytest.raises(DseError, match="'field' cannot be driven: none of its test components implements 'driver'"):
        open_drive(open_workspace(root).benches["field"].noun)
