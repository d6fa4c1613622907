"""Overview, understanding and conditions in a real browser."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable

import numpy as np
import pytest
from known_functions import even, study, variable
from playwright.sync_api import Page
from report_pages import content_of, settle

from dse.analysis import evaluated, features, planes
from dse.domain.definition import DefinedObjective
from dse.report import insight_of
from dse.report.content.data import (
    ReportContent,
    SamplerKind,
)
from dse.storage import RunTable

pytestmark = pytest.mark.browser

HOSTILE = '</script><img src=x onerror="window.pwned=1"><b>'
Open = Callable[[ReportContent], Page]


def plane(count: int = 200, **facts) -> RunTable:
    """y = x1 + x2 / 4 is required to be at most 0.5."""
    points = even(count, 2, 0)
    return study(points, {"y": points[:, 0] + points[:, 1] / 4}, {"y": 0.5}, **facts)


def conditions() -> RunTable:
    """x1 at two speeds and three grips: y = x1 + speed - grip is at most 0.5; not exercised where the grip is 0."""
    designs, speeds, grips = np.linspace(0.05, 0.95, 10), [0.0, 1.0], [0.0, 0.5, 1.0]
    points = np.array([[x, s, g] for x in designs for s in speeds for g in grips])
    variables = (
        variable("x1"),
        variable("speed", role="condition", values=(0.0, 1.0)),
        variable("grip", role="condition", values=(0.0, 0.5, 1.0)),
    )
    y = points[:, 0] + points[:, 1] - points[:, 2]
    return study(points, {"y": y}, {"y": 0.5}, variables=variables, exercised=points[:, 2] > 0)


def opened(page: Page, view: str) -> Page:
    page.click(f"#tab-{view}")
    settle(page)
    return page


def selected(page: Page) -> int:
    settle(page)
    return int(page.inner_text("#selected-run").split()[1])


def plain(text: str) -> str:
    return text.replace("\u202f", " ").replace("\u2212", "-")


@pytest.mark.thorough
def test_the_overview_says_what_was_found_and_opens_the_run_that_is_picked(open_report: Open) -> None:
    table = plane()
    page = opened(open_report(content_of(table)), "overview")
    insight = insight_of(table)
    assert [each.text for each in insight.told if each.topic != "withheld"] == page.locator(
        "#findings > ul li"
    ).all_inner_texts()
    robust = page.locator(".pick", has_text="Most robust")
    robust.click()
    assert selected(page) == insight.centres[0].run
    assert page.get_attribute("#tab-plot", "aria-selected") == "true"


@pytest.mark.thorough
def test_the_verdict_matrix_counts_what_the_runs_did_and_opens_the_worst(open_report: Open) -> None:
    table = conditions()
    page = opened(open_report(content_of(table)), "conditions")
    rows = page.locator("#matrix tbody tr")
    assert rows.count() == 3
    page.select_option(".conditions select >> nth=3", "all")
    settle(page)
    shown = [[plain(cell.inner_text()) for cell in row.locator("td").all()] for row in rows.all()]
    at = {name: table.points[name] for name in ("speed", "grip")}
    for row, grip in enumerate([0.0, 0.5, 1.0]):
        for column, speed in enumerate([0.0, 1.0]):
            there = (at["speed"] == speed) & (at["grip"] == grip)
            passing = int((table.verdicts("R1")[there] == 0).sum())
            assert f"{passing} of 10" in shown[row][column]
    cell = page.locator("#matrix tbody tr >> nth=1").locator("button >> nth=1")
    there = np.flatnonzero((at["speed"] == 1.0) & (at["grip"] == 0.5))
    cell.click()
    assert selected(page) == int(there[np.argmin(table.margins("R1")[there])])


@pytest.mark.thorough
def test_the_profiler_says_what_the_formula_says(open_report: Open) -> None:
    table = plane()
    page = opened(open_report(content_of(table)), "understanding")
    for index, place in enumerate((0.25, 0.8)):
        slider = page.locator(".profile-control input").nth(index)
        slider.evaluate("(e, v) => { e.value = v; e.dispatchEvent(new Event('input')) }", str(place))
    settle(page)
    (part,) = insight_of(table).parts
    profile = part.responses[0].profile
    assert profile is not None
    point = features(np.array([[0.25, 0.8]]), planes(table)[0].factors)
    expected = evaluated(
        point, part.centres[profile.centres].astype(float), profile.weights[:, None].astype(float), profile.power
    )
    assert float(plain(page.inner_text("#prediction b")).split()[0]) == pytest.approx(float(expected[0, 0]), abs=2e-4)
    page.click("#profile-nearest")
    away = np.hypot(table.points["x1"] - 0.25, table.points["x2"] - 0.8)
    assert f"run, {int(np.argmin(away))}, was simulated" in page.inner_text("#nearest-run")


@pytest.mark.thorough
def test_the_lights_follow_the_thresholds(open_report: Open) -> None:
    table = plane()
    page = open_report(content_of(table))
    page.fill("#field-atMost-0", "-1")
    opened(page, "overview")
    row = plain(page.inner_text("#lights tbody tr >> nth=1"))
    assert "0 of 200" in row
    assert page.locator("#lights .light.fail").count() == 2
    assert "No run meets all requirements" in page.inner_text("#warnings")
    assert "thresholds" in page.inner_text("#warnings").lower()
    assert "you have changed thresholds" in page.inner_text("#findings").lower()
    assert page.locator(".pick").count() == 1  # the robust centre of the study's own
    opened(page, "plot")
    page.fill("#field-atMost-0", "9")
    opened(page, "overview")
    assert page.locator("#lights .light.pass").count() == 2


@pytest.mark.thorough
def test_failed_runs_are_warned_of_by_their_causes(open_report: Open) -> None:
    done = np.arange(200) % 4 > 0
    page = opened(open_report(content_of(plane(done=done))), "overview")
    first = page.locator("#warnings li").first
    assert "50 of 200 runs failed to run: it broke at t = \u2026 s (50)" in plain(first.inner_text())
    first.locator("button").click()
    assert selected(page) == 0


@pytest.mark.thorough
def test_what_was_not_exercised_is_warned_of(open_report: Open) -> None:
    page = opened(open_report(content_of(conditions())), "overview")
    assert "not exercised in 20 of 60 runs" in plain(page.inner_text("#warnings"))
    assert "20 not exercised" in plain(page.inner_text("#lights"))


@pytest.mark.thorough
def test_show_sets_back_what_is_outside_of_a_box(open_report: Open) -> None:
    table = plane(600)
    page = opened(open_report(content_of(table)), "understanding")
    box = insight_of(table).boxes[0]
    page.click(".box-row >> nth=0 >> text=Show")
    settle(page)
    inside = np.ones(600, dtype=bool)
    for limits in box.ranges:
        values = table.points[f"x{limits.variable + 1}"]
        inside &= (values >= limits.low - 1e-6) & (values <= limits.high + 1e-6)
    passing = int((inside & (table.verdicts("R1") == 0)).sum())
    assert f"{passing} of the {int(inside.sum())} runs inside pass" in plain(page.inner_text("#brushed"))
    page.click("#clear-brushes")
    settle(page)
    assert not page.is_visible("#clear-brushes")


@pytest.mark.thorough
def test_a_small_plane_opens_in_the_plot(open_report: Open) -> None:
    points = even(60, 3, 0)
    page = opened(open_report(content_of(study(points, {"y": points.sum(axis=1)}, {"y": 1.5}))), "understanding")
    assert page.locator(".pair").count() == 3
    page.locator(".pair").nth(2).click()
    settle(page)
    assert page.get_attribute("#tab-plot", "aria-selected") == "true"
    assert "x2" in page.inner_text("#view")
    assert "x3" in page.inner_text("#view")


@pytest.mark.thorough
def test_a_search_is_told_with_its_best_designs(open_report: Open) -> None:
    points = even(100, 2, 0)
    table = study(points, {"y": points[:, 0], "z": points[:, 1]}, {"y": 0.5})
    definition = dataclasses.replace(table.header.definition, objectives=(DefinedObjective("z"),))
    table = dataclasses.replace(table, header=dataclasses.replace(table.header, definition=definition))
    page = opened(open_report(content_of(table)), "understanding")
    feasible = int((points[:, 0] <= 0.5).sum())
    assert f"{feasible} of 100 designs" in plain(page.inner_text("#search"))
    opened(page, "overview").locator(".pick", has_text="Best design").first.click()
    assert selected(page) == int(np.argmin(np.where(points[:, 0] <= 0.5, points[:, 1], np.inf)))


@pytest.mark.thorough
def test_no_view_is_wider_than_the_page(open_report: Open) -> None:
    page = open_report(content_of(conditions()))
    for width in (400, 1440, 2560):
        page.set_viewport_size({"width": width, "height": 900})
        for view in ("overview", "understanding", "conditions"):
            opened(page, view)
            assert page.evaluate("document.documentElement.scrollWidth") <= width, (view, width)


@pytest.mark.thorough
def test_names_of_users_stay_text(open_report: Open) -> None:
    long = "\u202e" + "x" * 10_000
    points = even(80, 2, 0)
    variables = (variable("x1", title=HOSTILE), variable("x2", title=long, role="condition", values=(0.0, 1.0)))
    points[:, 1] = np.arange(80) % 2
    choices = [{HOSTILE: (HOSTILE, long)[i % 2]} for i in range(80)]
    table = study(
        points, {"y": points[:, 0]}, {"y": 0.5}, variables=variables, choices=choices, done=np.arange(80) % 9 > 0
    )
    page = open_report(content_of(table, HOSTILE, HOSTILE))
    page.set_viewport_size({"width": 400, "height": 900})
    for view in ("overview", "understanding", "conditions"):
        opened(page, view)
        assert page.evaluate("document.documentElement.scrollWidth") <= 400
    assert page.evaluate("window.pwned") is None
    assert page.locator("#view img").count() == 0


@pytest.mark.thorough
@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_runs_are_shown_without_a_complaint(open_report: Open, count: int) -> None:
    page = opened(open_report(content_of(plane(count))), "overview")
    assert page.locator("#warnings li").count() > 0
    if page.locator("#tab-understanding").count():
        opened(page, "understanding")


@pytest.mark.thorough
def test_metrics_that_are_nowhere_defined_are_withheld_by_name(open_report: Open) -> None:
    points = even(60, 2, 0)
    values = {"y": np.full(60, np.nan), "z": np.where(points[:, 0] > 0.5, np.inf, points[:, 1])}
    page = opened(open_report(content_of(study(points, values, {"y": 0.5, "z": 0.5}))), "understanding")
    assert "it is defined in 0 of 60 runs" in page.inner_text("#view")
    opened(page, "overview")


@pytest.mark.thorough
def test_all_failed_is_a_page_all_the_same(open_report: Open) -> None:
    page = opened(open_report(content_of(plane(60, done=np.zeros(60, dtype=bool)))), "overview")
    assert "60 of 60 runs failed to run" in plain(page.inner_text("#warnings"))
    assert page.locator(".pick").count() == 0


@pytest.mark.thorough
def test_thirty_variables_and_five_requirements_on_one_metric(open_report: Open) -> None:
    points = even(200, 30, 0)
    table = study(points, {"y": points[:, 0], "z": points[:, 1]}, {"y": 0.5})
    page = opened(open_report(content_of(table)), "understanding")
    assert page.locator(".pair").count() == 15
    page.locator(".checks input:checked").first.uncheck()
    settle(page)
    assert page.locator(".pair").count() == 10
    assert page.locator(".profile-cell").count() == 12
    base = content_of(table)
    several = tuple(dataclasses.replace(base.requirements[0], name=f"R{k}", at_most=0.1 * k) for k in range(1, 6))
    asked = dataclasses.replace(base.insight.asked, exercised=("",) * 5)  # type: ignore[union-attr]
    content = dataclasses.replace(base, requirements=several, insight=dataclasses.replace(base.insight, asked=asked))  # type: ignore[type-var]
    opened(page := open_report(content), "overview")
    assert page.locator("#lights tbody tr").count() == 6


def test_the_payload_is_plain_json_of_bounded_size() -> None:
    from dse.report.page.encoding import Block
    from dse.report.page.payload import insight_json

    block = Block()
    text = json.dumps(insight_json(insight_of(plane(600)), block), allow_nan=False)
    assert len(text) + len(block.text()) < 40_000


@pytest.mark.thorough
def test_an_enumeration_is_a_choice_with_labels_in_every_view(open_report: Open) -> None:
    points = np.array([[x, k] for x in np.linspace(0, 1, 30) for k in (0.0, 1.0, 2.0)])
    labels = ("dry", "wet", "icy")
    surface = variable("surface", role="condition", high=2.0, values=(0.0, 1.0, 2.0), labels=labels)
    table = study(points, {"y": points[:, 0] + points[:, 1]}, {"y": 1.0}, variables=(variable("x1"), surface))
    content = content_of(table)
    shown = (content.variables[0], dataclasses.replace(content.variables[1], labels=labels))
    page = opened(open_report(dataclasses.replace(content, variables=shown)), "conditions")
    assert page.locator("#matrix thead th").all_inner_texts()[1:] == list(labels)
    assert "nothing between the values of surface" in opened(page, "plot").inner_text("#plane-note")
    opened(page, "understanding").select_option(".profile-control select", "2")
    settle(page)
    assert float(plain(page.inner_text("#prediction b")).split()[0]) > 1.5
    page.click("#profile-nearest")
    settle(page)
    assert page.input_value(".profile-control select") == "2"


@pytest.mark.thorough
def test_what_is_chosen_in_understanding_and_conditions_comes_back_with_the_address(open_report: Open) -> None:
    base = conditions()
    y, points = base.metric("y"), np.stack([base.points[name] for name in ("x1", "speed", "grip")], axis=1)
    variables = (
        variable("x1"),
        variable("speed", role="condition", values=(0.0, 1.0)),
        variable("grip", role="condition", values=(0.0, 0.5, 1.0)),
    )
    table = study(points, {"y": y, "z": points[:, 0] * points[:, 2]}, {"y": 0.5, "z": 0.4}, variables=variables)
    page = opened(open_report(content_of(table)), "conditions")
    page.select_option("#conditions-across", label="grip")
    settle(page)
    assert page.input_value("#conditions-down") == "1"
    page.select_option("#conditions-requirement", "1")
    page.select_option("#conditions-of", "all")
    opened(page, "understanding")
    page.select_option("#understood-metric", "1")
    settle(page)
    page.locator(".profile-control input").first.evaluate(
        "e => { e.value = 0.25; e.dispatchEvent(new Event('input')) }"
    )
    settle(page)

    def told() -> list[str]:
        opened(page, "conditions")
        matrix = page.inner_text("#view")
        chosen = [page.input_value(f"#conditions-{name}") for name in ("across", "down", "requirement", "of")]
        opened(page, "understanding")
        return [matrix, *chosen, page.input_value("#understood-metric"), page.inner_text("#prediction")]

    before = told()
    assert before[1:6] == ["2", "1", "1", "all", "1"]
    page.wait_for_function(
        "() => location.hash.includes('conditions.of=all') && location.hash.includes('understanding.at')"
    )
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert told() == before
    # What fits no study is left out.
    page.evaluate("""() => { location.hash = 'conditions.across=7&conditions.down=x&conditions.requirement=-3'
        + '&conditions.of=1&understanding.metric=9&understanding.part=-1'
        + '&understanding.at=0:9:NaN&understanding.planes=1,1,77' }""")
    settle(page)
    assert told()[1:6] == ["1", "2", "-1", "design", "0"]


@pytest.mark.thorough
def test_choosing_another_metric_leaves_nothing_behind(open_report: Open) -> None:
    points = even(60, 2, 0)
    table = study(points, {"y": points[:, 0], "z": points[:, 1] ** 2}, {"y": 0.5, "z": 0.4})
    page = opened(open_report(content_of(table)), "understanding")
    session = page.context.new_cdp_session(page)

    def nodes(turns: int) -> int:
        for turn in range(turns):
            page.select_option("#understood-metric", str((turn + 1) % 2))
            settle(page)
        session.send("HeapProfiler.collectGarbage")
        return int(session.send("Memory.getDOMCounters")["nodes"])

    few = nodes(2)
    # What still listens to the page is kept, with all the elements it would draw.
    assert nodes(8) < few + 20


@pytest.mark.thorough
def test_one_run_is_not_picked_as_two(open_report: Open) -> None:
    """y = x1 + x2 / 4 is to be at most 0.2: of two runs one passes, of three two do."""
    points = np.array([[0.1, 0.2], [0.9, 0.2], [0.15, 0.1]])
    y = points[:, 0] + points[:, 1] / 4

    def names(count: int) -> list[str]:
        content = content_of(study(points[:count], {"y": y[:count]}, {"y": 0.2}))
        page = opened(open_report(content), "overview")
        return page.locator(".pick b").all_inner_texts()

    assert names(2) == ["The only one that passes"]
    assert names(3) == ["Most to spare", "Nearest to the boundary"]


@pytest.mark.thorough
def test_names_and_values_that_are_apart_are_chosen(open_report: Open) -> None:
    """x1 and x2 on a grid, at two kinds of road and at three visibilities, which are chosen by the designer here."""
    axes = np.linspace(0, 1, 4), np.linspace(0, 1, 4), [0.0, 1.0], [0.03, 0.05, 1.0]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)
    content = content_of(study(points, {"y": points[:, 0]}, {"y": 0.5}))
    *others, road, visibility = content.variables
    road = dataclasses.replace(road, labels=("gravel", "asphalt"), apart=(0.0, 1.0))
    visibility = dataclasses.replace(visibility, apart=(0.03, 0.05, 1.0))
    gridded = dataclasses.replace(content, variables=(*others, road, visibility), sampler=SamplerKind.FULL_FACTORIAL)
    page = opened(open_report(gridded), "plot")
    kinds = [page.locator(f"#fixed-{index}") for index in (2, 3)]
    assert [kind.evaluate("each => each.tagName") for kind in kinds] == ["SELECT", "SELECT"]
    assert kinds[0].locator("option").all_inner_texts() == ["gravel", "asphalt"]
    assert kinds[1].locator("option").all_inner_texts() == ["0.030", "0.050", "1.000"]
    kinds[0].select_option(label="asphalt")
    settle(page)
    assert kinds[0].input_value() == "1"
    only = opened(page, "runs").locator(".heading-choice").first
    assert only.locator("option").all_inner_texts() == ["all", "gravel", "asphalt"]
    only.select_option(label="gravel")
    settle(page)
    assert page.inner_text(".chip b") == "gravel \u2026 gravel"
    assert "48 of 96" in page.inner_text("#within")
