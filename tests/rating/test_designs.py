"""A rating of real runs: what was simulated, what the workbook has of it, and the page."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from command_line import run_dse
from rated_cars import FILES, RATING
from workspaces import written

from dse.errors import DseError
from dse.loading import Workspace
from dse.rating.cases import case_studies, warned_tests
from dse.rating.designs import RatedRun, predict
from dse.testbench import one_configuration


def studies_of(text, workspace, protocol, rating_file):
    from dse.loading.bench.rating import read_rating

    rating = read_rating(rating_file(text), workspace.bench, workspace.root.parent.parent)
    design = workspace.design("car")
    cells = protocol.cells(warned_tests(rating, protocol))
    return case_studies(rating, protocol, cells, design, [one_configuration(design, None)])


def test_one_study_has_all_cells_of_a_bench_and_the_layers_of_its_standard_cells(workspace, protocol, rating_file):
    (study,) = studies_of(RATING, workspace, protocol, rating_file)
    cells = [cell for cell in protocol.cells() if cell.test in ("CCRs", "CPNA day")]
    assert len([case for case in study.points if not case[1]]) == len(cells) == 56 + 30
    standard = [cell for cell in cells if not cell.extended]
    assert {case[0] for case in study.points if case[1]} == {cell.key for cell in standard}
    assert [variable.name for variable in study.study.variables] == [
        "target.fog", "target.host_speed", "target.light", "target.location", "target.speed",
    ]  # fmt: skip
    by_name = dict(
        zip(
            [variable.name for variable in study.study.variables], zip(*study.points.values(), strict=True), strict=True
        )
    )
    assert set(by_name["target.fog"]) == {10_000.0, 50.0}  # the bench's own value where no layer sets it
    assert set(by_name["target.light"]) == {0.0}
    assert max(by_name["target.host_speed"]) == pytest.approx(80 / 3.6)
    assert set(by_name["target.location"]) == {1.25, 1.0, 0.9, 0.75, 0.5, 0.25, 0.1, 0.0, -0.25}


BY_CONDITION = """\
  Speed:
    +3 km/h: {target.speed: {change: 3 km/h}}
    -2 km/h: {target.host_speed: {change: -10 %}}
"""


def test_a_layer_changes_cells_in_the_conditions_of_the_protocol(workspace, protocol, rating_file):
    (study,) = studies_of(RATING + BY_CONDITION, workspace, protocol, rating_file)
    names = [variable.name for variable in study.study.variables]
    host, target = names.index("target.host_speed"), names.index("target.speed")
    varied = [case for case in study.points if case[1].startswith("Speed")]
    assert {(key[0], name) for key, name in varied} == {("CPNA day", "Speed: +3 km/h"), ("CPNA day", "Speed: -2 km/h")}
    for key, name in varied:
        point, nominal = study.points[key, name], study.points[key, ""]
        slower = 0.9 if name.endswith("-2 km/h") else 1.0
        assert point[host] == pytest.approx(slower * nominal[host])
        assert point[target] == pytest.approx(nominal[target] + (3 / 3.6 if slower == 1.0 else 0.0))


def test_what_a_layer_makes_of_a_cell_must_be_allowed(workspace, protocol, rating_file):
    text = RATING.replace("target.fog: 50 m", "target.host_speed: {change: 200 km/h}")
    with pytest.raises(DseError, match=r"13:51: the range of 'target.host_speed' leaves what component target allows"):
        studies_of(text, workspace, protocol, rating_file)


@pytest.mark.parametrize(
    ("faster", "slower", "claimed"), [(0.0, 0.0, True), (5.0, 0.0, True), (5.0, 20.0, False), (0.0, None, False)]
)
def test_a_layer_is_claimed_if_all_conditions_of_the_protocol_are_met(protocol, faster, slower, claimed):
    speeds = {"": 0.0, "Speed: +3 km/h": faster, "Speed: -2 km/h": slower}
    cells = [cell for cell in protocol.cells() if cell.test in ("CPNA day", "CPNA night")]
    # An impact is red in some cells, whatever its speed.
    red = {cell.key for cell in cells if protocol.colour(cell, 5.0, {}) == "red"}
    runs = {
        (cell.key, name): RatedRun(Path(), 0, 0.0 if cell.key in red else value)
        for cell in cells
        for name, value in speeds.items()
        if value is not None and not (name and cell.extended)
    }
    assert predict(protocol, cells, runs, {}).layers == ({("Speed", "CPNA")} if claimed else set())


def test_a_warning_is_declared_where_its_kpi_has_a_metric(workspace, protocol, rating_file):
    text = RATING.replace("  CPNA day:", "  CPLA day:").replace(
        "layers:", "  CPLA night:\n    bench: wall\n    cells: {target.host_speed: VUT speed}\n"
        "    values: {v_rel_impact: impact_speed, fcw_ttc: warned}\nlayers:"
    )  # fmt: skip
    bench = FILES["testbenches/wall.yaml"] + "  warned: {expression: final(time), unit: s}\n"
    other = Workspace(written(rating_file("").parent / "warned", {**FILES, "testbenches/wall.yaml": bench}))
    (study,) = studies_of(text, other, protocol, rating_file)
    metrics = {}
    for (test, attributes), _ in study.points:
        metrics.setdefault(test, {}).setdefault(dict(attributes).get("Function"), set()).add(
            study.readings[(test, attributes), ""].metric
        )
    assert metrics["CPLA night"] == {"AEB": {"impact_speed"}, "FCW": {"warned"}}
    assert metrics["CPLA day"] == {"AEB": {"impact_speed"}}


@pytest.fixture(scope="module")
def car(tmp_path_factory):
    """The small workspace with two brakes, rated, and a name that is no HTML."""
    alternatives = {
        "designs/car.yaml": "design: car\nroot: {compound: {brake: {alternatives: [brake, weak]}}}\n",
        **{
            name.replace("brake", "weak"): re.sub(r"(?<!implements: )brake", "weak", text)
            for name, text in FILES.items()
            if name.startswith("components/brake/")
        },
        "components/brake/component.yaml": FILES["components/brake/component.yaml"] + "properties: {cost: 30 EUR}\n",
        "testbenches/small.rating.yaml": RATING.replace("protocol", "title: <script>alert(1)</script>\nprotocol", 1),
    }  # fmt: skip
    weak = "components/weak/component.yaml"
    alternatives[weak] = alternatives[weak].replace("35 km/h", "12 km/h") + "properties: {cost: 10 EUR}\n"
    return written(tmp_path_factory.mktemp("car"), {**FILES, **alternatives})


@pytest.mark.thorough
def test_two_designs_are_rated_and_compared(car, kept_cache, tmp_path):
    arguments = ("rate", "car", "--layers", "--best", "2", "--at-least", "0.5", "-o", "out/car", "--workers", "2")
    done = run_dse(car, *arguments, "--format", "json", cache=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    # The cells of CPNA at 25, 50 and 75 % are runs of CCRs as well, here. In fog: 8 speeds by 5 locations of CCRs.
    assert found["simulated"] == 2 * (56 + 30 - 6 * 3 + 8 * 5)
    weak, strong = found["configurations"]
    assert (weak["cost"], strong["cost"]) == (10.0, 30.0)
    assert weak["points"] == 0.0
    assert weak["rules"] == ["Frontal Collision FAIL. Reasons: CCRs <=20km/h"]
    scores = {(s["scenario"], s["layer"]): s["points"] for s in strong["scores"] if s["layer"]}
    # By hand as in test_workbook: the brake takes off 35 km/h.
    assert scores["CCRs", "Standard"] == pytest.approx(1.2 * (3 + 0.5 + 0.5 + 0.25) / 8, abs=1e-3)
    assert found["cheapest"] == strong["id"]
    alone = (*arguments[:-1], "1", "--format", "json")  # and workbooks by one process
    again = json.loads(run_dse(car, *alone, cache=tmp_path).stdout)
    assert again["simulated"] == 0
    assert again["configurations"] == found["configurations"]
    page = (car / "out/car/rating.html").read_text(encoding="utf-8")
    assert "Predicted by simulation, not a rating" in page
    assert "<script" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert not re.search(r"""(src|href)=["']?(https?:|//)""", page)
    assert page.count('class="cell ') == 2 * (56 + 30)
    table = run_dse(car, *arguments, "--reports", cache=tmp_path)
    linked = (car / "out/car/rating.html").read_text(encoding="utf-8")
    assert linked.count('href="wall/report.html#run=') == 2 * (56 + 30)
    # Its study is found again, though no file has its name.
    replayed = run_dse(car, "replay", "out/car/wall", "3", cache=tmp_path)
    assert replayed.returncode == 0, replayed.stderr
    assert "cheapest with at least 0.5 points" in table.stdout
    assert "not simulated, 0 points: CCRm, CCRb" in table.stdout


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("lorry",), "unknown design space 'lorry'"),
        (("car", "--rating", "big"), "unknown rating 'big'"),
        (("car", "-c", "zzzz"), "no valid configuration 'zzzz'"),
        (("car", "--best", "1", "-c", "a"), "one of -c, --where and --best"),
    ],
)
def test_what_cannot_be_rated_is_one_error(car, tmp_path, arguments, message):
    done = run_dse(car, "rate", *arguments, cache=tmp_path)
    assert done.returncode in (1, 2)
    assert message in done.stderr
    assert "Traceback" not in done.stderr
