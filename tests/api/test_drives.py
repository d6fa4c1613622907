"""Drives as runs: recorded, simulated again, and compared on a score board."""

from __future__ import annotations

import json
import shutil
import time
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from nasty import nasty_texts
from small_drive import drive_workspace

from dse.api import Drives, Results, open as open_workspace, open_drive
from dse.api.drives.drive_study import drive_again
from dse.api.drives.score_board import board_of
from dse.api.studies.scenes import scene_of
from dse.domain.drive import Drive, Pace, bits_of
from dse.errors import DseError
from dse.storage import drive_id, read_drive, write_drive
from dse.testbench import one_configuration

STEPS = 30


class Shop:
    """The workspace of the small bench, with another bound."""

    def __init__(self, files):
        self.files = files
        self.bound = 1000.0

    def bench(self, name):
        bench = self.files.bench(name)
        return replace(bench, requirements=tuple(replace(each, at_most=self.bound) for each in bench.requirements))


@pytest.fixture(scope="module")
def shop(tmp_path_factory):
    return Shop(open_workspace(drive_workspace(tmp_path_factory.mktemp("cars"), f"{STEPS / 100} s")).files)


@pytest.fixture(scope="module")
def configuration(shop):
    return one_configuration(shop.bench("field").design, None).id


def drive(configuration, driver="Anna", rows=STEPS + 1, push=0.0, **changes):
    times = np.arange(rows) * 0.01
    inputs = {
        "accelerator": 0.3 + push + 0.1 * np.sin(times),
        "steering": 0.01 * np.sin(9 * times),
        "cruise": np.zeros(rows),
        "gear": np.ones(rows),
        "tune.car.gain": 5.0 + times,
    }
    which = changes.pop("which", configuration)
    made = Drive("field", which, driver, 0.01, times, inputs, Pace(rows - 1, 2, 1e-4, 1e-3))
    return replace(made, **changes)


def same(one, other):
    """To the last bit."""
    columns = [
        {"time": each.time.tobytes(), **{n: v.tobytes() for n, v in each.inputs.items()}} for each in (one, other)
    ]
    told = [(each.bench, each.configuration, each.driver, each.step, each.pace, each.settings, each.bits)
            for each in (one, other)]  # fmt: skip
    return columns[0] == columns[1] and told[0] == told[1]


@pytest.fixture(scope="module")
def driven(shop, configuration, tmp_path_factory):
    """A folder with three drives: one that was noted, one by somebody of a strange name, one that ended early."""
    kept = Drives(tmp_path_factory.mktemp("drives"), shop)
    first = drive(configuration)
    noted = replace(first, bits=bits_of(drive_again(first, shop.bench("field"))))
    names = [
        kept.add(noted),
        kept.add(drive(configuration, "[red]<b>Bob</b>", push=0.8)),
        kept.add(drive(configuration, "controller", rows=12)),
    ]
    return kept, names


def test_a_file_gives_the_drive_back(configuration, tmp_path):
    made = drive(configuration, settings={"car.gain": 1.5, "x.on": True}, bits={"metric m": "nan"})
    assert same(read_drive(write_drive(tmp_path, made)), made)


def test_equal_drives_are_one_and_others_are_not(configuration, tmp_path):
    made = drive(configuration)
    assert write_drive(tmp_path, made) == write_drive(tmp_path, drive(configuration))
    assert drive_id(made) != drive_id(drive(configuration, "Bob"))
    assert drive_id(made) != drive_id(
        replace(made, inputs={**made.inputs, "steering": made.inputs["steering"] + 1e-18})
    )


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"bench": "../../etc/passwd"}, "not a name of a bench"),
        ({"bench": "<script>"}, "not a name of a bench"),
        ({"which": "a/b"}, "not a name of a configuration"),
        ({"driver": "two\nlines"}, "not a driver's name"),
        ({"driver": ""}, "not a driver's name"),
        ({"driver": "x" * 61}, "not a driver's name"),
        ({"step": 0.0}, "its step is not a time"),
        ({"step": 0.02}, "the times are not 0"),
        ({"inputs": {}}, "no column or no step"),
        ({"inputs": {"<b>": np.zeros(STEPS + 1)}}, "not a port's name"),
        ({"inputs": {"brake": np.full(STEPS + 1, np.nan)}}, "'brake' is not a number in row 1"),
        ({"inputs": {"brake": np.zeros(3)}}, "no column or no step"),
    ],
)
def test_what_is_no_drive_is_refused_by_name(configuration, tmp_path, changes, told):
    with pytest.raises(DseError, match=told):
        write_drive(tmp_path, drive(configuration, **changes))
    assert not list(tmp_path.iterdir())


def written(path, columns, head):
    schema = {b"dse.drive": json.dumps(head).encode() if not isinstance(head, bytes) else head} if head else None
    pq.write_table(pa.table(columns).replace_schema_metadata(schema), path)


HEAD = {
    "version": 1,
    "bench": "field",
    "configuration": "abcdefghij",
    "driver": "Eve",
    "step": 0.01,
    "settings": {},
    "pace": {"steps": 1, "overruns": 0, "median": 0.0, "p99": 0.0},
    "bits": {},
}
COLUMNS = {"time": [0.0, 0.01], "brake": [0.0, 0.0]}


def test_no_value_in_a_head_is_more_than_damage(tmp_path):
    found = set()
    for text in nasty_texts({**HEAD, "settings": {"car.gain": 1.0}}):
        written(tmp_path / "a.parquet", COLUMNS, text.encode())
        try:
            found.add(type(read_drive(tmp_path / "a.parquet")).__name__)
        except DseError as error:
            found.add(type(error).__name__)
    assert found == {"Drive", "DseError"}


@pytest.mark.parametrize(
    ("columns", "head", "told"),
    [
        (COLUMNS, None, "it has no mark of one"),
        (COLUMNS, b"{", "damaged"),
        (COLUMNS, b"[" * 100_000, "damaged"),
        (COLUMNS, {**HEAD, "version": 2}, "version 2"),
        (COLUMNS, {**HEAD, "pace": []}, "damaged"),
        (COLUMNS, {**HEAD, "step": "fast"}, "damaged"),
        (COLUMNS, {**HEAD, "settings": {"a": [1]}}, "damaged"),
        (COLUMNS, {**HEAD, "bench": "../x"}, "not a name of a bench"),
        ({"time": [0.0, 0.01], "brake": ["a", "b"]}, HEAD, "other columns"),
        ({"brake": [0.0, 0.01], "time": [0.0, 0.0]}, HEAD, "other columns"),
        ({"time": [0.0, 0.01], "brake": [0.0, None]}, HEAD, "without a value"),
        ({"time": [0.0, 0.01], "brake": [0.0, float("inf")]}, HEAD, "not a number in row 2"),
        ({"time": np.zeros(500_000), "brake": np.zeros(500_000)}, HEAD, "too large"),
    ],
)
def test_a_strangers_file_is_refused_by_name_and_stays(tmp_path, shop, columns, head, told):
    folder = tmp_path / "recordings"
    folder.mkdir()
    written(folder / "<img src=x>.parquet", columns, head)
    kept = Drives(tmp_path, shop)
    assert kept.recorded() == {}
    (problem,) = kept.problems
    assert told in problem.what
    assert "<img src=x>.parquet" in str(problem)
    assert [path.name for path in folder.iterdir()] == ["<img src=x>.parquet"]


def test_files_that_are_none_are_told_and_the_others_read(tmp_path, shop, configuration):
    folder = tmp_path / "recordings"
    good = write_drive(folder, drive(configuration))
    torn = good.read_bytes()
    (folder / "torn.parquet").write_bytes(torn[: len(torn) // 2])
    (folder / "notes.txt").write_text("hello")
    (folder / "link.parquet").symlink_to(good)
    (folder / "copy.parquet").write_bytes(torn)
    kept = Drives(tmp_path, shop)
    assert len(kept.recorded()) == 1
    assert sorted(problem.where.file.rpartition("/")[2] for problem in kept.problems) == [
        "link.parquet",
        "notes.txt",
        "torn.parquet",
    ]


def test_a_drive_on_a_bench_that_nobody_knows_is_refused_by_name(tmp_path, shop, configuration):
    kept = Drives(tmp_path, shop)
    write_drive(tmp_path / "recordings", drive(configuration, bench="elsewhere"))
    write_drive(tmp_path / "recordings", drive("zzzzzzzzzz"))
    kept.update()
    told = "\n".join(problem.what for problem in kept.problems)
    assert "elsewhere" in told
    assert "zzzzzzzzzz" in told
    assert sorted(path.name for path in tmp_path.iterdir()) == ["recordings"]


@pytest.mark.thorough
def test_drives_are_runs_of_a_study_beside_the_one_that_nobody_drove(driven, configuration):
    kept, names = driven
    frame = Results(kept.study("field")).to_pandas()
    assert frame["drive"].tolist() == ["nobody", *names]
    assert frame["driver"].tolist() == ["controller", "Anna", "[red]<b>Bob</b>", "controller (a person)"]
    assert set(frame["configuration"]) == {configuration}
    assert frame["way"].nunique() == 4
    waveforms = Results(kept.study("field")).run(2).waveforms
    assert waveforms.time.tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3])


@pytest.mark.thorough
def test_every_drive_made_again_is_the_same_bit_for_bit(driven):
    kept, names = driven
    checked = {each.id: each for each in kept.check()}
    assert set(checked) == set(names)
    assert all(each.is_same for each in checked.values())
    assert [checked[name].was_noted for name in names] == [True, False, False]


@pytest.mark.thorough
def test_a_drive_that_gave_something_else_is_found(driven, tmp_path, shop):
    kept, (first, *_) = driven
    other = Drives(tmp_path, shop)
    noted = kept.recorded()[first]
    forged = replace(noted, bits={**noted.bits, "metric way": (1.0).hex()})
    name = other.add(forged)
    (checked,) = other.check()
    assert (checked.id, checked.from_study, checked.from_driving) == (name, (), ("metric way",))


@pytest.mark.thorough
def test_a_board_is_ordered_as_it_says(driven):
    kept, (anna, bob, early) = driven
    (board,) = kept.boards()
    order = [score.drive for score in board.scores]
    assert order[-1] == early
    assert board.scores[-1].place == 0
    assert board.scores[-1].note == "ended at 0.11 s of 0.3 s"
    placed = board.scores[:-1]
    assert [(-s.met, -s.worst) for s in placed] == sorted((-s.met, -s.worst) for s in placed)
    assert {score.drive for score in placed} == {"nobody", anna, bob}
    data = json.loads(json.dumps(board.data(), allow_nan=False))
    assert data["scores"][0]["place"] == 1
    assert [score["is_controller"] for score in data["scores"]].count(True) == 1


@pytest.mark.thorough
def test_nothing_is_simulated_twice_and_a_changed_bench_makes_all_again(driven, shop, tmp_path):
    kept, _ = driven
    shutil.copytree(kept.path, tmp_path, dirs_exist_ok=True)
    changing, told = Shop(shop.files), []
    copy = Drives(tmp_path, changing)
    copy.update(tell=told.append)
    assert not [text for text in told if "nobody" in text or "drive " in text]
    changing.bound = 1e-9
    copy.update(tell=told.append)
    assert any("has changed since" in text for text in told)
    assert not copy.problems
    after = board_of(copy.study("field"))
    assert len(after.scores) == 4
    assert [score.met for score in after.scores if not score.is_controller] == [0, 0, 0]


@pytest.mark.thorough
def test_a_folder_that_is_no_study_of_drives_is_left_alone(shop, configuration, tmp_path):
    (tmp_path / "field").mkdir()
    (tmp_path / "field" / "mine.txt").write_text("precious")
    with pytest.raises(DseError, match="not empty"):
        Drives(tmp_path, shop).add(drive(configuration))
    assert (tmp_path / "field" / "mine.txt").read_text() == "precious"
    assert len(list((tmp_path / "recordings").iterdir())) == 1


@pytest.mark.thorough
def test_a_board_tells_what_to_lay_over_what(driven):
    kept, (anna, *_) = driven
    (board,) = kept.boards()
    runs = {score.drive: score.run for score in board.scores}
    told = {each["drive"]: each.get("against") for each in board.data()["scores"]}
    assert told[anna] == f"#run={runs[anna]}&pins={runs['nobody']}"
    assert told[None] is None


@pytest.mark.thorough
def test_what_somebody_drove_is_seen_again_in_three_dimensions(driven, shop, monkeypatch, tmp_path):
    kept, names = driven
    monkeypatch.chdir(shop.files.root)
    study = Results(kept.study("field"))
    for number in range(1 + len(names)):
        run = study.run(number)
        x, y = (scene_of(run, near=study.folder).host.columns[name][-1] for name in "xy")
        assert (run.metrics["way"] > 0) == (number > 0)
        assert float(np.hypot(x, y)) == pytest.approx(run.metrics["way"], rel=0.01)
    shutil.copytree(study.folder, tmp_path / "field")
    with pytest.raises(DseError, match=f"no recording of the drive {names[0]}"):
        scene_of(study.run(1), near=tmp_path / "field")


@pytest.mark.thorough
def test_a_report_shows_a_strangers_name_as_text(driven):
    kept, _ = driven
    page = Results(kept.study("field")).report().read_text(encoding="utf-8")
    assert "<b>Bob" not in page


@pytest.mark.thorough
def test_what_somebody_drove_in_real_time_is_the_same_offline(shop, tmp_path):
    live = open_drive(shop.files.bench("field"), driver="Me")
    live.start()
    try:
        number = 0
        while live.ended is None:
            number += 1
            live.control({"accelerator": number % 7 / 7, "steering": 0.01 * number}, number)
            live.tune({"car.gain": 20.0 + number % 50}, number)
            time.sleep(0.01)
        made = live.result
    finally:
        live.close()
    assert len(np.unique(made.inputs["tune.car.gain"])) > 2
    kept = Drives(tmp_path, shop.files)
    name = kept.add(made)
    (checked,) = kept.check()
    assert (checked.id, checked.is_same, checked.was_noted) == (name, True, True)
