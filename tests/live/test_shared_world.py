"""Several cars in one world, over the real kernel: who sees whom when, and what one of them does to the others."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from background import LIMIT
from shared_field import shared_workspace

from dse.api import Drives, SharedDrive, open as open_workspace, open_shared_drive, study_name
from dse.domain.drive import Drive
from dse.errors import DseError
from dse.live import Car, Patience, Script, SharedWorld, Why, sharing_of
from dse.testbench import one_configuration

PATIENT = LIMIT  # s: however slow the machine is, no car is late


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory):
    return open_workspace(shared_workspace(tmp_path_factory.mktemp("shared")))


@pytest.fixture
def world() -> Iterator[SharedWorld]:
    found = SharedWorld(0.01, most=3, grace=PATIENT)
    yield found
    found.close()


@pytest.fixture
def seat(field, world: SharedWorld) -> Iterator[Callable[..., SharedDrive]]:
    taken: list[SharedDrive] = []

    def take(driver: str, script: Script | Path | None = None, of: SharedWorld = world) -> SharedDrive:
        taken.append(open_shared_drive(field.benches["field"].noun, of, driver=driver, script=script))
        return taken[-1]

    yield take
    for live in taken:
        live.close()


def until(met: Callable[[], object]) -> None:
    end = time.monotonic() + LIMIT
    while not met():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.005)


def at(live: SharedDrive, seconds: float) -> None:
    until(lambda: live.session.newest and live.session.newest.time >= seconds)


def over(live: SharedDrive) -> Drive:
    live.finish()
    ended = live.session.wait(LIMIT)
    assert ended is not None
    assert ended.why is Why.FINISHED, ended.text
    assert live.result is not None
    return live.result


@pytest.mark.thorough
def test_a_brake_is_seen_by_another_car_within_three_steps_and_recordings_give_the_same_bits(
    seat, field, tmp_path: Path
) -> None:
    brakes = Script((0.0, 0.5), ({"accelerator": 0.0}, {"accelerator": -1.0}))
    first, second = seat("Ada", brakes), seat("Bea")
    first.start()
    second.start()
    at(first, 0.7)
    at(second, 0.7)
    ada, bea = over(first), over(second)
    began = int(np.flatnonzero(ada.inputs["accelerator"] == -1.0)[0])
    # The same moment in both: where Bea is told the station that Ada's run had a step before, at 10 m/s.
    assert {*bea.inputs["other1.id"]} <= {0.0, 1.0}
    seen = int(np.flatnonzero(bea.inputs["other1.acceleration"] < 0)[0])
    station = ended_at(first, began)
    same = int(np.flatnonzero(bea.inputs["other1.station"] > station - 1e-6)[0])
    assert 0 <= seen - same <= 3
    kept = Drives(tmp_path / "drives", field.files)
    for drive in (ada, bea):
        assert study_name(drive) == "field.shared"
        assert drive.settings == {"road.start_station": 100.0 if drive is ada else 160.0}
        kept.add(drive)
    checked = list(kept.check())
    assert [each.is_same and each.was_noted for each in checked] == [True, True], checked
    (board,) = kept.boards()
    assert {score.driver for score in board.scores} == {"Ada", "Bea"}


@pytest.mark.thorough
@pytest.mark.usefixtures("kept_cache")
@pytest.mark.parametrize("name", ["drive_motorway", "drive_town"])
def test_cars_see_the_traffic_of_the_bench_and_recordings_give_the_same_bits(name: str, tmp_path: Path) -> None:
    opened = open_workspace(Path(__file__).parents[2])
    bench = opened.benches[name].noun
    world = SharedWorld(bench.simulation.step, most=64, grace=PATIENT)
    lives = [open_shared_drive(bench, world, driver=driver, script=Script((), ())) for driver in ("Ada", "Bea")]
    try:
        assert world.most == 16  # so many cars the traffic reacts to
        for live in lives:
            live.start()
        for live in lives:
            at(live, 3.0)
        drives = [over(live) for live in lives]
    finally:
        for live in lives:
            live.close()
        world.close()
    assert not world.problem
    kept = Drives(tmp_path / "drives", opened.files)
    seen = []
    for drive in drives:
        columns = drive.inputs
        rows = set[tuple[float, float]]()
        for slot in range(1, 9):
            other = {port: columns[f"other{slot}.{port}"] for port in ("id", "station")}
            users = other["id"] >= 1_000_000
            assert np.all(columns[f"other{slot}.path"][users] >= 0)
            rows |= set(zip(other["id"][users], other["station"][users], strict=True))
            # No road user jumps while it is in a slot.
            same = users[1:] & (np.diff(other["id"]) == 0)
            assert np.all(np.abs(np.diff(other["station"])[same]) < 1.0)
        seen.append(rows)
        kept.add(drive)
    assert min(map(len, seen)) > 100
    if name == "drive_town":
        # The lights of both follow the world: whoever began later is that much ahead.
        assert all(np.ptp(drive.inputs["clock"][1:]) == 0 for drive in drives)
    checked = list(kept.check())
    assert [each.is_same and each.was_noted for each in checked] == [True, True], checked


def ended_at(live: SharedDrive, row: int) -> float:
    """The station of the middle of its car at this row of its run."""
    run = live.session.ended.run
    return float(run.waveforms.values["car.motion.x"][row]) + live.seating.place.car.place


@pytest.mark.thorough
def test_one_leaves_and_its_car_with_it_while_the_other_drives_on(seat, world: SharedWorld) -> None:
    first, second = seat("Ada"), seat("Bea")
    first.start()
    second.start()
    at(first, 0.1)
    at(second, 0.2)
    first.close()
    assert [place.number for place in world.places] == [2]
    before = second.session.newest.time
    at(second, before + 0.1)
    bea = over(second)
    assert bea.inputs["other1.class"].max() == 1.0
    assert bea.inputs["other1.class"][-1] == 0.0


@pytest.mark.thorough
def test_a_car_that_hangs_stops_for_the_others_who_drive_on(field) -> None:
    world = SharedWorld(0.01, grace=0.02)
    hung = open_shared_drive(field.benches["field"].noun, world)
    other = open_shared_drive(field.benches["field"].noun, world)
    try:
        hung.start(Patience(LIMIT, 1.0, LIMIT))
        other.start()
        at(hung, 0.1)
        at(other, 0.1)
        hung.tune({"car.hangs": 0.0})
        until(lambda: hung.ended)
        assert hung.ended.why is Why.CRASHED
        assert "no progress" in hung.ended.text
        at(other, other.session.newest.time + 0.1)
        bea = over(other)
        assert 0.0 in bea.inputs["other1.speed"][bea.inputs["other1.class"] == 1.0]
    finally:
        hung.close()
        other.close()
        world.close()


@pytest.mark.thorough
def test_a_script_from_a_file_drives_and_one_that_is_none_is_refused_with_its_line(seat, tmp_path: Path) -> None:
    file = tmp_path / "brakes.csv"
    file.write_text("time,accelerator,cruise\n0,0.5,true\n0.2,-1,\n", "utf-8")
    live = seat("script", file)
    live.start()
    at(live, 0.3)
    drive = over(live)
    assert [*dict.fromkeys(drive.inputs["accelerator"])][-2:] == [0.5, -1.0]
    assert drive.inputs["cruise"][-1] == 1.0
    for text, problem in (
        ("time,throttle\n0,1\n", "is not a script of a driver"),
        ("time,accelerator\n1,0\n1,0\n", "the times are not ascending"),
        ("time,accelerator\n0,<b>\n", "not a number"),
        ("time,accelerator\n0,nan\n", "not a number"),
    ):
        file.write_text(text, "utf-8")
        with pytest.raises(DseError, match=problem):
            seat("script", file)


def test_a_world_gives_each_car_a_free_start_and_refuses_one_too_many() -> None:
    world = SharedWorld(0.01, most=2)
    try:
        first, second = (world.admit(Car(), 100.0, ("speed",), 2) for _ in range(2))
        assert (first.start, second.start) == (100.0, 160.0)
        with pytest.raises(DseError, match="all 2 seats of this world are taken"):
            world.admit(Car(), 100.0, ("speed",), 2)
        world.leave(first)
        assert world.admit(Car(), 100.0, ("speed",), 2).start == 100.0
    finally:
        world.close()


def test_a_bench_without_other_vehicles_cannot_be_shared(field) -> None:
    from dataclasses import replace

    bench = field.benches["field"].noun
    chosen = one_configuration(bench.design, None)
    assert (sharing_of(bench, chosen).traffic, sharing_of(bench, chosen).places) == ("traffic", 2)
    without = replace(
        bench,
        test_components=tuple(each for each in bench.test_components if each.name == "driver"),
        connections=tuple(each for each in bench.connections if "road" not in str(each)),
    )
    with pytest.raises(DseError, match="no part has the inputs 'movers'"):
        sharing_of(without, chosen)
