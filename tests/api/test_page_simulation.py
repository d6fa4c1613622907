"""Report pages that simulate by themselves, against the runs that were simulated natively."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from chromium import started_chromium

import dse
from dse.api.studies import page_simulation
from dse.domain.bench import VERDICTS
from dse.errors import DseError, Location
from dse.loading import Workspace
from dse.report import read_content

if TYPE_CHECKING:
    from playwright.sync_api import Page

SIMULATE = """async points => {
    const given = id => document.getElementById(id).textContent;
    const inflated = id => fetched(Uint8Array.from(atob(given(id)), letter => letter.charCodeAt(0)));
    const fetched = packed =>
        new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
    const told = JSON.parse(new TextDecoder().decode(await inflated("simulation")));
    if (!points) return told;
    const module = await WebAssembly.compile(await inflated("module"));
    const worker = new Worker(URL.createObjectURL(new Blob([given("worker")])));
    worker.postMessage({ document: told, module });
    const typed = given => ({ ...given, values: Float64Array.from(given.values) });
    const asked = points.map(point => ({ ...typed(point), changes: (point.changes ?? []).map(typed) }));
    worker.postMessage({ points: asked });
    const { data } = await new Promise(done => worker.addEventListener("message", done));
    return JSON.parse(JSON.stringify(data.runs, (_, v) => (ArrayBuffer.isView(v) ? Array.from(v) : v)));
}"""
"""What the worker of a page answers to points; without any, the document that it is given. NaN is None."""

pytestmark = pytest.mark.thorough

NOISY = """\
study: noisy
testbench: acc_following
configurations:
  where: >-
    (sensor is radar_77ghz_mid or sensor is lidar_905nm) and controller is pd_acc and brake is hydraulic_booster
    and (powertrain is combustion_6at or powertrain is bev_ideal) and video is absent
design_variables:
  controller.kp_speed: {range: [0.5 1/s, 3 1/s], levels: 2}
conditions:
  world.lead_speed: {values: [40 km/h, 55 km/h]}
sampler: full_factorial
replicates: 2
keep_waveforms: none
"""


@pytest.fixture(scope="module")
def live(results: dse.Results, folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return results.report(tmp_path_factory.mktemp("live") / "page.html", live=True, workspace=folder)


def simulated(page: Path, ask: Any) -> tuple[Mapping[str, Any], list[Mapping[str, Any]]]:
    """The document of *page*, and what its worker makes of the points that *ask* gives for it."""
    with started_chromium() as browser:
        opened = browser.new_page()
        opened.goto(page.as_uri())
        document = opened.evaluate(SIMULATE)
        return document, opened.evaluate(SIMULATE, ask(document))


def points_of(results: dse.Results, document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The runs of a study as its page asks for them."""
    ids = [each.id for each in results.definition.configurations]
    draws = sorted({float(results.run(number).point.get("draw", 0.0)) for number in range(len(results))})
    found = []
    for number in range(len(results)):
        run = results.run(number)
        configuration = ids.index(run.configuration)
        system = next(n for n, each in enumerate(document["systems"]) if each["configuration"] == configuration)
        settings = document["systems"][system]["settings"]
        values = [run.point.get(document["settings"][at]["name"], value) for at, _, value in settings]
        draw = draws.index(float(run.point.get("draw", 0.0)))
        found.append({"system": system, "draw": draw, "values": values, "traces": number == 0})
    return found


def assert_equal(results: dse.Results, document: Mapping[str, Any], runs: list[Mapping[str, Any]]) -> None:
    """The page's libm may round otherwise: a billionth of a metric is far above that, and far below any verdict."""
    for number, made in enumerate(runs):
        run = results.run(number)
        assert made["problem"] == ""
        found = [np.nan if value is None else value for value in made["metrics"]]
        scaled = [
            value * each["factor"] + each["offset"] for value, each in zip(found, document["metrics"], strict=True)
        ]
        np.testing.assert_allclose(scaled, [run.metrics[each["name"]] for each in document["metrics"]], 1e-9, 1e-12)
        marks = [VERDICTS.index(run.verdicts[name]) for name in document["requirements"]]
        assert made["marks"] == marks


def test_a_page_makes_the_runs_of_its_study(results: dse.Results, live: Path) -> None:
    document, runs = simulated(live, lambda document: points_of(results, document))
    assert len(runs) == len(results) == 6
    assert_equal(results, document, runs)
    speed = next(number for number, each in enumerate(document["figures"]) if each["current"] == "world.speed")
    kept = results.run(0).waveforms["world.speed"]
    np.testing.assert_allclose(np.array(runs[0]["traces"][speed]["values"]) / 3.6, kept, 1e-9, 1e-12)


def test_what_fails_in_a_page_is_told_and_the_next_run_is_right(results: dse.Results, live: Path) -> None:
    def broken_first(document: Mapping[str, Any]) -> list[dict[str, Any]]:
        good = points_of(results, document)
        return [{**good[0], "values": [None] * len(good[0]["values"])}, *good]

    document, (broken, *runs) = simulated(live, broken_first)
    assert broken["problem"] != ""
    assert_equal(results, document, runs)


def test_what_changes_during_a_run_counts_from_then_on(results: dse.Results, live: Path) -> None:
    changed_at = 1500

    def three(document: Mapping[str, Any]) -> list[dict[str, Any]]:
        point = {**points_of(results, document)[0], "columns": True}
        settings = document["systems"][0]["settings"]
        names = [document["settings"][at]["name"] for at, _, _ in settings]
        slower = [0.5 * v if n == "controller.set_speed" else v for n, v in zip(names, point["values"], strict=True)]
        change = {"first": changed_at, "values": point["values"]}
        return [point, {**point, "changes": [change]}, {**point, "changes": [{**change, "values": slower}]}]

    document, (plain, same, other) = simulated(live, three)
    assert same["columns"] == plain["columns"]
    stride = document["systems"][0]["stride"]
    before = slice(0, changed_at // stride + 1)
    speeds = [run["columns"]["world.speed"] for run in (plain, other)]
    assert speeds[0][before] == speeds[1][before]
    # It follows at 50 km/h, and is set to half of 70 km/h.
    assert speeds[1][-1] / speeds[0][-1] == pytest.approx(0.7, rel=1e-3)


def test_noise_conditions_and_solvers_are_the_same_in_a_page(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "ws")
    (tmp_path / "ws/testbenches/noisy.pet.yaml").write_text(NOISY, "utf-8")
    bench = tmp_path / "ws/testbenches/acc_following.yaml"
    bench.write_text(bench.read_text("utf-8").replace("  stop: 60 s", "  stop: 60 s\n  check_step: true"), "utf-8")
    found = dse.open(tmp_path / "ws").studies["noisy"].explore(tmp_path / "out", workers=1)
    page = found.report(live=True, workspace=tmp_path / "ws")
    document, runs = simulated(page, lambda document: points_of(found, document))
    assert document["draws"] == len({run["draw"] for run in points_of(found, document)}) > 1
    assert len(document["systems"]) == len(found.definition.configurations) > 1
    # Error bars stand beside their metrics in a page.
    assert [each["name"] for each in document["metrics"]] == [each.name for each in read_content(found.folder).metrics]
    assert any(each.error_of for each in found.definition.metrics)
    assert_equal(found, document, runs)


def test_the_same_study_gives_the_same_bytes(results: dse.Results, live: Path, folder: Path, tmp_path: Path) -> None:
    assert results.report(tmp_path / "page.html", live=True, workspace=folder).read_bytes() == live.read_bytes()


def test_what_has_changed_since_the_study_was_made_is_refused(
    results: dse.Results, folder: Path, tmp_path: Path
) -> None:
    shutil.copytree(folder, tmp_path / "changed")
    bench = tmp_path / "changed/testbenches/acc_following.yaml"
    bench.write_text(bench.read_text("utf-8").replace("stop: 60 s", "stop: 50 s"), "utf-8")
    with pytest.raises(
        DseError, match=r"^small: the workspace has changed since the study was made \(simulation stop\)"
    ):
        results.report(tmp_path / "page.html", live=True, workspace=tmp_path / "changed")
    assert not (tmp_path / "page.html").exists()


def test_more_configurations_than_fit_are_refused(
    results: dse.Results, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_simulation, "MOST_CONFIGURATIONS", 0)
    with pytest.raises(DseError, match="a page simulates at most 0 configurations, this study has 1"):
        results.report(tmp_path / "page.html", live=True, workspace=folder)


def made(page: Page, runs: int) -> None:
    """Wait until so many runs of the plane are there."""
    page.wait_for_selector(f"#simulated-note[data-made='{runs}']")


def test_a_slider_moves_the_waveform_the_verdicts_and_the_plane(
    results: dse.Results, live: Path, folder: Path, tmp_path: Path
) -> None:
    with started_chromium() as browser:
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        told: list[str] = []
        page.on("console", lambda message: told.append(message.text))
        page.on("pageerror", lambda error: told.append(str(error)))
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto(live.as_uri())
        page.click("#tab-simulate")
        made(page, 625)
        value = page.locator("#simulated tbody tr:first-child td").first
        start, plane = value.inner_text(), plotted(page)
        # A variable of the plane moves the run, and not the plane.
        slide(page, "controller.kp_speed", 0.9)
        page.wait_for_function(
            "start => document.querySelector('#simulated tbody td').textContent !== start", arg=start
        )
        assert plotted(page) == plane
        # Everything else moves both; ten moves that nobody waits for leave the plane of the last.
        page.evaluate("document.querySelectorAll('.simulating details.part').forEach(each => (each.open = true))")
        for part in range(10):
            slide(page, "world.lead_speed", 0.3 + part / 20)
        made(page, 625)
        assert plotted(page) != plane
        page.locator(".simulating .plot").click(position={"x": 300, "y": 200})
        page.click("#copy-next-study")
        text = page.inner_text("#next-study")
        assert told == []
        assert {address.split(":")[0] for address in asked} == {"file", "blob"}
        page.close()
    shutil.copytree(folder, tmp_path / "ws")
    (tmp_path / "ws/testbenches/small_next.pet.yaml").write_text(text, "utf-8")
    found = Workspace.around(tmp_path / "ws").study("small_next", Location("test"))
    assert [each.name for each in found.variables] == ["controller.kp_speed", "controller.kd_speed"]
    assert "#   world.lead_speed: " in text


def slide(page: Page, name: str, share: float) -> None:
    page.eval_on_selector(
        f".setting[data-name='{name}'] input[type=range]",
        "(slider, share) => { slider.value = +slider.min + share * (slider.max - slider.min);"
        " slider.dispatchEvent(new Event('input')); }",
        share,
    )


def plotted(page: Page) -> str:
    """The pixels of the plane."""
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return str(page.evaluate("document.querySelector('.simulating canvas.ground').toDataURL()"))
