"""A run in three dimensions: what is in it by value, and that it is drawn, played and wound in a browser."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from chromium import started_chromium
from PIL import Image
from scenes import STEPS, made_up as scene

import dse
from dse.domain.component import Kind, Type
from dse.domain.study import Selection
from dse.errors import DseError
from dse.loading import Workspace
from dse.report import SceneSignals, scene_mark, scene_page
from dse.report.roads import standing_lights
from dse.report.scene.data import COLOURS, Host
from dse.testbench import bench_study
from dse.world import open_roads

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> dse.Results:
    """One run of a bench on a road."""
    bench = dse.open(ROOT).benches["road_braking"]
    first = bench.design.list(1)[0]
    return dse.Study.of(bench_study(bench.noun, Selection((first.id,)))).explore(
        tmp_path_factory.mktemp("scene") / "study"
    )


def test_the_same_scene_gives_the_same_page_and_nothing_in_it_is_markup() -> None:
    name = '</script><img src="x" onerror=alert(1)>'
    page = scene_page(scene(name))
    assert page == scene_page(scene(name))
    assert "<img" not in page
    assert "connect-src" not in page
    assert "default-src 'none'" in page


def test_a_minute_with_eight_others_is_below_two_megabytes() -> None:
    time = np.linspace(0.0, 60.0, 1501)
    noise = np.random.default_rng(1).normal(size=(100, 1501))  # does not compress
    columns = iter(noise)
    host = {name: next(columns) for name in ("x", "y", "z", "heading", "roll", "pitch", "steering", "speed")}
    names = ("x", "y", "z", "heading", "speed")
    still = dict.fromkeys(("id", "class", "length", "width", "height"), 1 + 0 * time)
    others = tuple({**still, **{name: next(columns) for name in names}} for _ in range(8))
    made = scene(time=time, host=Host(host, 4.5, 1.8, 2.3), others=others, sensors=(), weather={}, instruments=())
    assert len(scene_page(made)) < 2e6


def lit_in(page) -> str:
    """The lamps that are lit."""
    r, g, b = np.moveaxis(picture(page), -1, 0)
    red = (r > 225) & (g < 80) & (b < 70)
    yellow = (r > 225) & (g > 165) & (b < 80)
    green = (r < 80) & (g > 200) & (b < 130)
    return " ".join(name for name, seen in (("red", red), ("yellow", yellow), ("green", green)) if seen.sum() > 3)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("colour", "lit"), [(1, ""), (2, "red"), (3, "red yellow"), (4, "yellow"), (5, "green"), (None, "")]
)
def test_a_light_shows_what_it_showed(shown, colour, lit):
    told = {} if colour is None else {"L1": np.full(STEPS, float(colour))}
    page = shown("t=4.0&view=driver", lights=told, sensors=(), others=(), weather={})
    page.wait_for_function("() => document.documentElement.dataset.frames > 0")
    assert lit_in(page) == lit


@pytest.mark.thorough
def test_a_light_changes_when_it_did(shown):
    colour = np.where(np.linspace(0, 10, STEPS) < 4.05, 2.0, 5.0)
    page = shown("t=4&view=driver", lights={"L1": colour}, sensors=(), others=(), weather={})
    page.wait_for_function("() => document.documentElement.dataset.at === '4'")
    assert lit_in(page) == "red"
    page.evaluate("location.hash = 't=4.1'")
    page.wait_for_function("() => document.documentElement.dataset.at === '4.1'")
    assert lit_in(page) == "green"
    assert page.get_attribute("button[data-view=driver]", "aria-pressed") == "true"


def test_lights_stand_beside_the_lanes_that_obey_them_and_their_line_is_across_those() -> None:
    network = open_roads("intersection", Workspace(ROOT))
    found = {light.id: light for light in standing_lights(network)}
    # Two lanes each way of 3.5 m, then the crossing one with one each way.
    main = next(light for light in found.values() if abs(light.heading) < 1e-9)
    assert main.place.tolist() == pytest.approx([200.0, -8.0, 0.0])
    assert main.line == pytest.approx(np.array([[200.0, 0.0, 0.0], [200.0, -7.0, 0.0]]))
    headings = sorted(round(np.degrees(light.heading)) % 360 for light in found.values())
    assert headings == [0, 90, 180, 270]


def test_colours_are_told_by_the_ids_of_lights_whatever_paths_see_them() -> None:
    colour = Type(Kind.ENUMERATION, items=COLOURS)
    signals = {"road.actors[1].heading": Type(Kind.REAL)}
    signals |= {f"road.light_heads[{n}].colour": colour for n in (1, 2, 3)}
    told = SceneSignals(signals, {}, ())
    columns = {f"road.light_heads[{n}].colour": np.array([float(n), 5.0]) for n in (1, 2, 3)}
    assert set(columns) <= set(told.wanted)
    lights = told.lights(columns, ["a", "b", "a"])
    assert {name: values.tolist() for name, values in lights.items()} == {"a": [1.0, 5.0], "b": [2.0, 5.0]}


def test_the_mark_of_a_page_is_read_again_and_of_no_other_file(tmp_path) -> None:
    page = tmp_path / "run_7.html"
    assert scene_mark(page) == ""
    page.write_text("<html></html>", encoding="utf-8")
    assert scene_mark(page) == ""
    page.write_text(scene_page(scene(mark="0a1b")), "utf-8")
    assert scene_mark(page) == "0a1b"
    page.write_text(scene_page(scene(mark="--><script>")), "utf-8")
    assert scene_mark(page) == "c"
    assert scene_mark(tmp_path) == ""


@pytest.mark.thorough
def test_a_bench_in_which_nobody_says_where_a_car_is_is_refused_by_name(studied, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(SceneSignals, "is_scene", False)
    with pytest.raises(
        DseError, match="run 0 of bench 'road_braking' is not a scene: no part gives the position of a car"
    ):
        studied.write_scene(0, tmp_path / "scene.html", source=ROOT / "testbenches" / "road_braking.yaml")
    assert not SceneSignals({"motor.speed": Type(Kind.REAL)}, {}, ()).wanted


@pytest.fixture(scope="module")
def browser() -> Iterator[object]:
    with started_chromium() as started:
        yield started


@pytest.fixture
def shown(browser, tmp_path):
    def show(fragment: str = "", **changed):
        (tmp_path / "scene.html").write_text(scene_page(scene(**changed)), encoding="utf-8")
        page = browser.new_page(viewport={"width": 800, "height": 500})
        page.problems = []
        page.on("pageerror", lambda error: page.problems.append(str(error)))
        page.goto(f"{(tmp_path / 'scene.html').as_uri()}#{fragment}")
        page.wait_for_selector("html[data-ready]")
        return page

    return show


def clock(page) -> float:
    return float(re.match(r"[\d.]+", page.text_content(".clock"))[0])


def picture(page) -> np.ndarray:
    """What the stage shows, (rows, columns, 3)."""
    return np.asarray(Image.open(BytesIO(page.locator(".stage").screenshot())).convert("RGB"), dtype=float)


@pytest.mark.thorough
def test_it_plays_by_itself_and_stops_where_it_is_told(shown):
    page = shown()
    page.wait_for_function("() => parseFloat(document.querySelector('.clock').textContent) > 0.3")
    page.keyboard.press("Space")
    page.wait_for_selector("button.play[aria-label='Play']")
    stood = clock(page)
    page.wait_for_timeout(200)
    assert clock(page) == stood
    page.keyboard.press("ArrowRight")
    page.wait_for_function(f"() => parseFloat(document.querySelector('.clock').textContent) > {stood + 0.9}")
    assert page.problems == []


@pytest.mark.thorough
def test_what_instruments_say_follows_the_time(shown):
    page = shown("t=4")
    assert page.locator(".instruments output").all_text_contents() == ["72.0 km/h", "calm"]
    page.locator("input[aria-label='Time in s']").fill("6")
    page.wait_for_function("() => document.querySelectorAll('.instruments output')[1].textContent === 'alarm'")


@pytest.mark.thorough
@pytest.mark.parametrize("view", ["chase", "driver", "top", "side"])
def test_every_camera_sees_something_and_not_the_same(shown, view):
    page = shown(f"t=2&view={view}")
    page.wait_for_function("() => document.documentElement.dataset.frames > 0")
    colours = len(np.unique(picture(page).reshape(-1, 3), axis=0))
    assert colours > 20
    assert page.get_attribute(f"button[data-view={view}]", "aria-pressed") == "true"
    assert page.problems == []


@pytest.mark.thorough
def test_fog_takes_the_far_away_the_colour_of_the_air(shown):
    def contrast(fog: float) -> float:
        page = shown("t=2&view=chase", weather={"fog": np.full(STEPS, fog)}, sensors=(), others=())
        page.wait_for_function("() => document.documentElement.dataset.frames > 0")
        shot = picture(page)
        sky, far = (shot[int(len(shot) * share), shot.shape[1] // 2] for share in (0.05, 0.45))
        return float(np.abs(sky - far).sum())

    assert contrast(0.1) < 0.1 * contrast(0.0)


@pytest.mark.thorough
def test_a_run_on_a_road_is_shown_where_it_was_driven(studied, tmp_path):
    from dse.api.studies.scenes import scene_of

    made = scene_of(studied.run(0), source=str(ROOT / "testbenches" / "road_braking.yaml"))
    assert made.host.columns["x"][0] == pytest.approx(80.0, abs=1e-3)  # start_station
    (lead,) = made.others
    gap = lead["x"][0] - made.host.columns["x"][0] - 2.3 - lead["length"][0] / 2
    assert gap == pytest.approx(45.0, abs=0.2)  # initial_gap; it has driven for no step or one
    assert [sensor.title for sensor in made.sensors] == ["Long-range radar, 77 GHz"]
    assert json.loads(re.search(r'id="document">(.*?)</script>', scene_page(made))[1])["others"] == 1


@pytest.mark.thorough
def test_a_live_replay_shows_the_run_and_from_any_moment_another(studied, browser, tmp_path):
    bench = ROOT / "testbenches" / "road_braking.yaml"
    live = studied.write_scene(0, tmp_path / "live.html", source=bench, live=True)
    plain = studied.write_scene(0, tmp_path / "plain.html", source=bench)
    pages = [browser.new_page() for _ in range(2)]
    told: list[str] = []
    pages[0].on("pageerror", lambda error: told.append(str(error)))
    for page, file in zip(pages, (live, plain), strict=True):
        page.goto(f"{file.as_uri()}#t=1")
    pages[0].wait_for_selector(".driving[data-runs='1']")

    def read(page, moment: float) -> list[str]:
        page.evaluate("moment => (location.hash = `t=${moment}`)", moment)
        page.wait_for_function("moment => document.documentElement.dataset.at === `${moment}`", arg=moment)
        return page.locator(".instruments > section output").all_inner_texts()

    moments = (1, 4.04, 9)
    was = [read(pages[0], moment) for moment in moments]
    assert was == [read(pages[1], moment) for moment in moments]
    read(pages[0], 2)
    # A car that is told to stand still does what it did, and then slows down.
    pages[0].evaluate("document.querySelectorAll('.driving details').forEach(each => (each.open = true))")
    entry = pages[0].locator(".setting[data-name='controller.set_speed'] input[type=number]")
    entry.fill("0")
    entry.press("Enter")
    pages[0].wait_for_selector(".driving[data-runs='2']")
    assert pages[0].inner_text(".driving .changes li").startswith("from 2.0 s: ")
    now = [read(pages[0], moment) for moment in moments]
    assert now[0] == was[0]
    assert now[2] != was[2]
    pages[0].click(".driving .all-back")
    pages[0].wait_for_selector(".driving[data-runs='3']")
    assert [read(pages[0], moment) for moment in moments] == was
    assert told == []
    for page in pages:
        page.close()
