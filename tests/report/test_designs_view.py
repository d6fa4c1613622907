"""The view of designs in a real browser: what is feasible, which is best, why one is out, what would have to change."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page
from report_pages import settle

from dse.report.content.data import (
    ConfigurationEntry,
    FigureSpec,
    MetricColumn,
    ObjectiveEntry,
    Property,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Runs,
    SamplerKind,
)

pytestmark = pytest.mark.browser

Open = Callable[[ReportContent], Page]
HOSTILE = '</script><img src=x onerror="window.pwned=1"><b>\u202e'

SENSORS = {"camera": (100.0, 0.0), "radar": (300.0, 3.0), "lidar": (900.0, 4.0)}
"""What a sensor costs, and what it adds to the gap."""
BRAKES = {"drum": (50.0, 0.0), "disc": (150.0, 1.0)}
GAINS = (0.0, 0.25, 0.5, 0.75, 1.0)
SLOPES = (0.0, 5.0)


def gap(sensor: str, brake: str, gain: float, slope: float) -> float:
    """Largest at a gain of 0.75, less on a slope: 10 m are asked for."""
    return 8.0 + SENSORS[sensor][1] + BRAKES[brake][1] - 8 * (gain - 0.75) ** 2 - 0.1 * slope


def smallest_gap(sensor: str, brake: str, gain: float) -> float:
    return min(gap(sensor, brake, gain, slope) for slope in SLOPES)


def cost(sensor: str, brake: str) -> float:
    return SENSORS[sensor][0] + BRAKES[brake][0]


KINDS = tuple(product(SENSORS, BRAKES))
DESIGNS = tuple((*kind, gain) for kind in KINDS for gain in GAINS)
"""In the order of their first runs."""


@pytest.fixture(scope="session")
def priced() -> ReportContent:
    """Six configurations at five gains, each on two slopes; the gap is to be 10 m at least."""
    rows = [(*design, slope) for design in DESIGNS for slope in SLOPES]
    n = len(rows)
    gaps = np.array([gap(*row) for row in rows])
    time = np.linspace(0, 1, 3)
    return ReportContent(
        "Sensors and brakes",
        SamplerKind.SCATTERED,
        "out/priced",
        Runs(np.arange(n), tuple(f"{row[0]}_{row[1]}" for row in rows), np.ones(n, dtype=bool), ("",) * n),
        tuple(
            ConfigurationEntry(
                f"{sensor}_{brake}",
                {"sensor": sensor, "brake": brake},
                {"cost": Property(cost(sensor, brake), "EUR")},
                {"brake": f"{brake}_brake", "sensor": f"{sensor}_sensor", "world": ""},
                (("brake", "world"), ("world", "sensor")),
            )
            for sensor, brake in KINDS
        ),
        (
            ReportVariable("c.gain", "gain", "1/s", 0, 1, None, 0.5, np.array([row[2] for row in rows])),
            ReportVariable(
                "w.slope", "slope", "%", 0, 5, None, 0, np.array([row[3] for row in rows]), role="condition"
            ),
        ),
        (MetricColumn("gap", "smallest gap", "m", gaps),),
        (RequirementRow("R1", "keeps its distance", "gap", None, 10.0, np.ones(n, dtype=bool)),),
        (FigureSpec("gap", "Gap", "m", "gap", None, time, np.arange(n), gaps[:, None] + time),),
        objectives=(ObjectiveEntry("cost", is_property=True), ObjectiveEntry("gap", maximize=True)),
    )


def called(place: int) -> str:
    sensor, brake, gain = DESIGNS[place]
    return f"{sensor}, {brake}, gain {gain:.3f}\u202f1/s"


def feasible(least: float) -> list[int]:
    return [place for place, design in enumerate(DESIGNS) if smallest_gap(*design) >= least]


def opened(open_report: Open, content: ReportContent) -> Page:
    page = open_report(content)
    page.click("#tab-designs")
    settle(page)
    return page


def demand(page: Page, percent: int) -> None:
    page.fill("#demand", str(percent))
    settle(page)


def board(page: Page) -> dict[int, dict[str, str]]:
    """The rows of the leader board that are drawn, in their order, by design and heading."""
    heads = page.locator("#leaders thead th").all_inner_texts()
    names = [head.split("[")[0].strip(" \n\u2191\u2193\u25b4\u25be") for head in heads]
    rows = page.eval_on_selector_all(
        "#leaders tbody tr:not(.gap)",
        "rows => rows.map(row => [Number(row.dataset.design), ...[...row.cells].map(cell => cell.innerText)])",
    )
    return {row[0]: dict(zip(names, row[1:], strict=True)) for row in rows}


def number(text: str) -> float:
    return math.nan if text == "\u2013" else float(text.replace("\u2212", "-"))


def whole_board(page: Page) -> dict[int, dict[str, str]]:
    page.eval_on_selector(".leaders .view", "view => { view.style.height = view.style.maxHeight = '99999px' }")
    settle(page)
    return board(page)


def selected(page: Page) -> str:
    settle(page)
    return page.inner_text("#reasons h3").split("\n")[0].strip()


@pytest.mark.thorough
def test_cheapest_architecture_that_meets_all_with_margin_is_found_by_one_slider(
    priced: ReportContent, open_report: Open
) -> None:
    page = opened(open_report, priced)
    demand(page, 20)
    best = min(feasible(12.0), key=lambda place: cost(*DESIGNS[place][:2]))
    assert best != min(feasible(10.0), key=lambda place: cost(*DESIGNS[place][:2]))
    answers = page.locator(".answers li").all_inner_texts()
    assert answers[0] == f"{len(feasible(12.0))} of 30 designs meet every requirement with 20\u202f% margin."
    assert answers[1].startswith("Least cost")
    assert f"{cost(*DESIGNS[best][:2]):.0f}\u202fEUR" in answers[1]
    page.locator(".answers li").nth(1).locator("button").first.click()
    assert selected(page) == called(best)
    assert "It meets every requirement with 20\u202f% margin" in page.inner_text("#reasons .said")


@pytest.mark.thorough
def test_which_gain_to_turn_is_told_of_a_design_that_is_out(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    out = DESIGNS.index(("radar", "drum", 0.0))
    near = min(
        (place for place in feasible(10.0) if DESIGNS[place][:2] == ("radar", "drum")),
        key=lambda place: DESIGNS[place][2],
    )
    whole_board(page)
    page.click(f"#leaders tr[data-design='{out}'] td:nth-child(2)")
    assert selected(page) == called(out)
    assert page.inner_text("#nearest") == called(near)
    gain = DESIGNS[near][2]
    assert page.locator(".changes li").all_inner_texts() == [
        f"gain 0.000\u202f1/s \u2192 {gain:.3f}\u202f1/s (up by {100 * gain:.0f}\u202f% of its range)"
    ]
    page.click("#nearest")
    assert selected(page) == called(near)


@pytest.mark.thorough
def test_why_a_design_is_out_names_the_requirement_its_margin_and_the_fewest_choices_to_change(
    priced: ReportContent, open_report: Open
) -> None:
    page = opened(open_report, priced)
    out = DESIGNS.index(("camera", "drum", 0.75))
    assert not any(DESIGNS[place][:2] == ("camera", "drum") for place in feasible(10.0))
    whole_board(page)
    page.click(f"#leaders tr[data-design='{out}'] td:nth-child(2)")
    settle(page)
    assert page.locator("#reasons .said").first.inner_text() == "It is out: \u201ckeeps its distance\u201d is missed."
    cells = page.locator("#reasons tbody tr").first.locator("th, td").all_inner_texts()
    missed = smallest_gap(*DESIGNS[out]) - 10
    assert "slope 5\u202f%" in cells[0]
    assert number(cells[3].split("\u202f")[0]) == pytest.approx(missed, abs=1e-3)
    assert "No simulated values of its design variables are sufficient" in page.inner_text("#reasons")
    # Radar and lidar would both do, and the gain may stay: the first of them is named.
    assert page.locator(".changes li").all_inner_texts() == ["sensor camera \u2192 radar"]


@pytest.mark.thorough
def test_turning_a_direction_around_moves_the_front(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    before = [place for place, row in whole_board(page).items() if row["Front"]]
    page.select_option("[id='way-property.0']", "max")
    settle(page)
    after = [place for place, row in board(page).items() if row["Front"]]
    dearest = DESIGNS.index(("lidar", "disc", 0.75))
    assert after == [dearest] != before
    page.click("[data-leader=score]")
    settle(page)
    assert next(iter(board(page))) == dearest
    page.fill("[id='weight-property.0']", "0")
    page.select_option("[id='way-metric.0']", "min")
    settle(page)
    # The score follows: the least gap of those that are feasible is first.
    assert next(iter(board(page))) == min(feasible(10.0), key=lambda place: smallest_gap(*DESIGNS[place]))


@pytest.mark.thorough
def test_a_rectangle_on_the_scatter_sets_back_the_designs_outside(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    box = page.locator("#cloud").bounding_box()
    assert box is not None
    # The left half of the costs: the axes go from the least to the greatest, with a little room.
    page.mouse.move(box["x"] + 70, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 66 + (box["width"] - 82) / 2, box["y"] + box["height"] - 52, steps=4)
    page.mouse.up()
    settle(page)
    middle = (150 + 1050) / 2
    inside = [place for place, design in enumerate(DESIGNS) if cost(*design[:2]) < middle]
    assert sorted(whole_board(page)) == inside
    assert f"{len(inside)} of 30 designs within the brushes" in page.inner_text("#cloud-note")
    page.click("#cloud-clear")
    settle(page)
    assert len(board(page)) == len(DESIGNS)


@pytest.mark.thorough
def test_a_click_on_a_point_selects_the_run_that_decides_its_design(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    first = next(place for place in range(len(DESIGNS)) if called(place) == selected(page))
    page.locator("#cloud").focus()
    page.keyboard.press("ArrowRight")
    costs = [cost(*design[:2]) for design in DESIGNS]
    following = next(place for place in range(first + 1, len(DESIGNS)) if costs[place] == costs[first])
    assert selected(page) == called(following)
    page.click("#tab-runs" if page.locator("#tab-runs").count() else "#tab-plot")
    settle(page)
    page.click("#tab-plot")
    settle(page)
    # Of the two slopes the second has the smaller gap.
    assert page.inner_text("#selected-run").split()[1] == str(2 * following + 1)


@pytest.mark.thorough
def test_the_best_of_those_compared_is_marked_and_their_waveforms_lie_on_common_axes(
    priced: ReportContent, open_report: Open
) -> None:
    page = opened(open_report, priced)
    whole_board(page)
    pair = (DESIGNS.index(("radar", "drum", 0.75)), DESIGNS.index(("lidar", "drum", 0.75)))
    for place in pair:
        page.check(f"#pick-{place}")
    page.wait_for_selector(f".overlays[data-runs='{2 * pair[0] + 1} {2 * pair[1] + 1}'] canvas")
    rows = {
        row[0].split("[")[0].strip(): row[1:]
        for row in page.eval_on_selector_all(
            "#compare tbody tr:not(.group)", "rows => rows.map(row => [...row.cells].map(cell => cell.textContent))"
        )
    }
    assert rows["sensor"] == ["radar", "lidar"]
    assert "brake" not in rows
    assert [text.endswith("(best)") for text in rows["cost"]] == [True, False]
    assert [text.endswith("(best)") for text in rows["smallest gap"]] == [False, True]
    assert rows["keeps its distance"] == ["\u2713 0.5\u202fm (5\u202f%)", "\u2713 1.5\u202fm (15\u202f%)"]
    pictures = page.locator(".architecture")
    assert pictures.count() == 2
    assert str(pictures.first.get_attribute("aria-label")) == "brake: drum_brake, sensor: radar_sensor, world"
    assert page.locator(".architecture").first.locator(".differs").count() == 1
    page.select_option(".comparing select", label="slope 0\u202f%")
    page.wait_for_selector(f".overlays[data-runs='{2 * pair[0]} {2 * pair[1]}'] canvas")


@pytest.mark.thorough
def test_at_most_five_designs_are_compared(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    whole_board(page)
    for place in range(7):
        page.check(f"#pick-{place}")
        settle(page)
    assert page.locator("#compare thead th").count() == 5
    assert not page.is_checked("#pick-1")
    assert page.is_checked("#pick-6")


@pytest.mark.thorough
def test_the_boxes_tell_what_an_alternative_buys(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    page.select_option("#boxes-over", "metric.0")
    settle(page)
    rows = page.eval_on_selector_all(
        ".boxes[data-place='sensor'] tbody tr", "rows => rows.map(row => [...row.cells].map(cell => cell.innerText))"
    )
    for sensor, row in zip(sorted(SENSORS), rows, strict=True):
        values = [smallest_gap(*design) for design in DESIGNS if design[0] == sensor]
        good = sum(value >= 10 for value in values)
        assert row[:2] == [sensor, "10"]
        assert row[2].split(" ")[0] == str(good)
        five = np.quantile(values, (0, 0.5, 1)).tolist()
        assert [number(text) for text in row[4:]] == pytest.approx(five, abs=6e-3)


@pytest.mark.thorough
def test_the_waterfall_counts_what_each_requirement_leaves_and_costs(priced: ReportContent, open_report: Open) -> None:
    n = len(priced.runs)
    least = np.array([smallest_gap(*design) for design in DESIGNS])
    gain = np.array([design[2] for design in DESIGNS])
    second = MetricColumn("gain", "gain", "1/s", np.repeat(gain, 2))
    runs = dataclasses.replace(priced.runs, done=np.arange(n) != 58, problems=("",) * 58 + ("it broke", ""))
    content = dataclasses.replace(
        priced,
        runs=runs,
        metrics=(*priced.metrics, second),
        requirements=(
            *priced.requirements,
            RequirementRow("R2", "is not too sharp", "gain", 0.6, None, np.ones(n, dtype=bool)),
        ),
    )
    page = opened(open_report, content)
    ended = np.arange(len(DESIGNS)) != 29
    near, sharp = ended & (least < 10), ended & (gain > 0.6)
    rows = page.eval_on_selector_all(
        "#waterfall tbody tr", "rows => rows.map(row => [...row.cells].map(cell => cell.innerText))"
    )
    assert [[row[0], row[1].split(" ")[0], *row[3:]] for row in rows] == [
        ["all designs", "30", "", ""],
        ["finished at all conditions", "29", "1", ""],
        ["keeps its distance", str(29 - near.sum()), str(near.sum()), str((near & ~sharp).sum())],
        ["is not too sharp", str((ended & ~near & ~sharp).sum()), str(sharp.sum()), str((sharp & ~near).sum())],
    ]


@pytest.mark.thorough
def test_a_requirement_that_is_asked_for_later_follows_the_thresholds(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    page.click("#tab-plot")
    page.fill("#field-atLeast-0", "11.5")
    settle(page)
    page.click("#tab-designs")
    settle(page)
    page.wait_for_function(
        "wanted => document.querySelector('#feasible-designs').textContent.startsWith(wanted)",
        arg=f"{len(feasible(11.5))} of 30",
    )


@pytest.mark.thorough
def test_an_address_brings_back_what_was_chosen(priced: ReportContent, open_report: Open) -> None:
    page = opened(open_report, priced)
    whole_board(page)
    demand(page, 15)
    page.fill("[id='weight-property.0']", "9")
    page.select_option("[id='way-metric.0']", "min")
    page.select_option("#cloud-y", "variable.0")
    page.select_option("#cloud-colour", "place.sensor")
    page.select_option("#boxes-among", "feasible")
    page.click("#leaders [data-leader='design']")
    page.check("#pick-9")
    settle(page)
    before = page.inner_text(".designs")
    page.wait_for_function("() => location.hash.includes('picked')")
    # A file is opened once more, not fetched: the address is all that is kept.
    page.evaluate("() => { const kept = location.hash; location.hash = ''; window.kept = kept }")
    settle(page)
    page.click("#tab-designs")
    settle(page)
    assert page.input_value("#demand") == "0"
    page.evaluate("() => { location.hash = window.kept }")
    settle(page)
    assert page.input_value("#demand") == "15"
    assert page.inner_text(".designs") == before


@pytest.mark.thorough
def test_the_table_of_designs_is_saved_with_all_digits(
    priced: ReportContent, open_report: Open, tmp_path: Path
) -> None:
    page = opened(open_report, priced)
    with page.expect_download() as caught:
        page.click("#save-board")
    caught.value.save_as(tmp_path / "designs.csv")
    with (tmp_path / "designs.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["smallest gap [m]"]) for row in rows] == [smallest_gap(*design) for design in DESIGNS]
    assert [row["sensor"] for row in rows] == [design[0] for design in DESIGNS]
    assert [row["design"] for row in rows] == [called(place) for place in range(len(DESIGNS))]
    good = [place for place, row in enumerate(rows) if row["verdict"] == "pass"]
    assert good == feasible(10.0)


@pytest.mark.thorough
def test_markup_in_any_name_stays_text(priced: ReportContent, open_report: Open) -> None:
    content = dataclasses.replace(
        priced,
        title=HOSTILE,
        configurations=tuple(
            dataclasses.replace(
                one,
                choices={HOSTILE: f"{HOSTILE}{one.id}" + "x" * 10_000},
                properties={HOSTILE: Property(float(place), HOSTILE)},
                parts={f"{HOSTILE}{path}": HOSTILE + component for path, component in one.parts.items()},
                links=tuple((HOSTILE + a, HOSTILE + b) for a, b in one.links),
            )
            for place, one in enumerate(priced.configurations)
        ),
        variables=tuple(dataclasses.replace(one, title=HOSTILE, unit_symbol=HOSTILE) for one in priced.variables),
        metrics=tuple(dataclasses.replace(one, title=HOSTILE, unit_symbol=HOSTILE) for one in priced.metrics),
        requirements=tuple(dataclasses.replace(one, title=HOSTILE) for one in priced.requirements),
        objectives=(ObjectiveEntry(HOSTILE, is_property=True),),
    )
    page = opened(open_report, content)
    for place in range(2):
        page.locator("#leaders tbody input").nth(place).check()
        settle(page)
    page.select_option("#cloud-colour", "place." + HOSTILE.removesuffix("\u202e"))
    settle(page)
    assert page.evaluate("window.pwned") is None
    assert page.locator("img").count() == 0
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def _failed(content: ReportContent) -> ReportContent:
    n = len(content.runs)
    runs = dataclasses.replace(content.runs, done=np.zeros(n, dtype=bool), problems=("it broke",) * n)
    holes = tuple(dataclasses.replace(one, values=np.full(n, np.nan)) for one in content.metrics)
    return dataclasses.replace(content, runs=runs, metrics=holes, figures=())


def _bare(content: ReportContent) -> ReportContent:
    alike = tuple(ConfigurationEntry(one.id, {}, {}) for one in content.configurations)
    return dataclasses.replace(content, configurations=alike, requirements=(), objectives=())


def _infinite(content: ReportContent) -> ReportContent:
    values = content.metrics[0].values.copy()
    values[:6] = (np.inf, -np.inf, np.nan, np.inf, -np.inf, np.nan)
    return dataclasses.replace(content, metrics=(dataclasses.replace(content.metrics[0], values=values),))


def _single(content: ReportContent) -> ReportContent:
    return dataclasses.replace(
        content,
        runs=Runs(np.arange(1), content.runs.configurations[:1], np.ones(1, dtype=bool), ("",)),
        configurations=content.configurations[:1],
        variables=tuple(dataclasses.replace(one, values=one.values[:1]) for one in content.variables),
        metrics=tuple(dataclasses.replace(one, values=one.values[:1]) for one in content.metrics),
        requirements=tuple(dataclasses.replace(one, exercised=one.exercised[:1]) for one in content.requirements),
        figures=(),
    )


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("change", "told"),
    [
        (_failed, "0 of 30 designs meet every requirement."),
        (_bare, "30 of 30 designs meet every requirement."),
        (_infinite, "of 30 designs meet every requirement."),
        (_single, "0 of 1 design meets every requirement."),
    ],
)
def test_odd_studies_have_designs_too(
    priced: ReportContent, open_report: Open, change: Callable[[ReportContent], ReportContent], told: str
) -> None:
    page = opened(open_report, change(priced))
    assert told.rsplit(" of ", maxsplit=1)[-1].split(" design", maxsplit=1)[0] in page.inner_text("#feasible-designs")
    assert page.locator("#leaders tbody tr:not(.gap)").count() >= 1
    demand_there = page.locator("#demand").count()
    if demand_there:
        demand(page, 30)
    page.locator("#cloud").hover()
    page.set_viewport_size({"width": 400, "height": 900})
    settle(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
