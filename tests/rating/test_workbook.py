"""Workbooks of three designs: points where they must be, and what the official commands make of the files."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from rated_cars import WARNED, predicted

from dse.rating import fill

pytestmark = pytest.mark.thorough  # the package takes seconds for a workbook

LOW_SPEED_CORNERS = {"CMCscp SfS": 5 / 7, "CMFtap SfS": 3 / 4}
"""The share of their cells that the package selects for verification and counts: LSC 4.1.2 leaves out over 60 km/h."""


def by_layer(filled):
    return {(s.scenario, s.layer): s for s in filled.scores if s.layer}


def official_scores(path: Path, folder: Path) -> dict[str, list[float]]:
    """What the package's own ``compute-score`` writes for a workbook, sheet by sheet."""
    import openpyxl

    command = [sys.executable, "-m", "euroncap_rating_2026", "crash_avoidance", "compute-score"]
    subprocess.run([*command, "-i", str(path), "-o", str(folder)], cwd=folder, check=True, capture_output=True)
    (report,) = folder.glob("ca_*_report.xlsx")
    book = openpyxl.load_workbook(report)
    found = {}
    for name in ("Scenario Scores", "Category Scores", "Test Scores"):
        column = next(cell.column for cell in book[name][1] if cell.value == "Score")
        found[name] = [float(book[name].cell(row, column).value) for row in range(2, book[name].max_row + 1)]
    return found


def test_a_design_that_never_brakes_has_no_points(filled):
    assert {score.points for score in filled["none"].scores} == {0.0}
    assert filled["none"].rules == ("Frontal Collision FAIL. Reasons: CCRs <=20km/h",)


def test_a_design_that_avoids_everything_has_all_points_of_the_matrices(filled):
    assert not filled["perfect"].rules
    for (scenario, layer), score in by_layer(filled["perfect"]).items():
        share = 0.0 if layer == "Robustness" or scenario in ("Driveability", "Driver state link") else 1.0
        share = LOW_SPEED_CORNERS.get(scenario, 0.75 if scenario == "CBDA" else share)  # one door of four is claimed
        assert score.points == pytest.approx(share * score.most, abs=1e-3), (scenario, layer)


def test_what_is_not_declared_is_named_and_has_no_points(protocol, filled):
    assert filled["perfect"].undeclared == ()
    perfect = predicted(protocol, "perfect")
    given = {name: text for name, text in perfect.inputs.items() if name != "Extended range performance"}
    bare = fill(protocol, replace(perfect, inputs=given), WARNED)
    assert bare.undeclared == ("Extended range performance (ELK RE)",)
    assert {score.points for (scenario, _), score in by_layer(bare).items() if scenario == "ELK RE"} == {0.0}


def test_points_of_a_middling_design_by_hand(filled):
    # CCRs: 35 km/h are taken off. Of 8 speeds 10, 20 and 30 km/h are green. 5 km/h remain at 40 and 15 at 50 (orange, a
    # half each), 25 at 60 (brown, a quarter); 35 and 45 at 70 and 80 are red. Extended: 6 of 8 rows are not red, which
    # is 75 % and counts so.
    scores = by_layer(filled["middling"])
    assert scores["CCRs", "Standard"].points == pytest.approx(1.2 * (3 + 0.5 + 0.5 + 0.25) / 8, abs=1e-3)
    assert scores["CCRs", "Extended"].points == pytest.approx(0.15 * 0.75, abs=1e-3)
    # One of the layers that may be claimed for CCRs, weather, is; each is worth the same.
    layers = 8
    assert scores["CCRs", "Robustness"].points == pytest.approx(0.15 / layers, abs=1e-3)


def test_what_a_laboratory_assesses_has_points_if_it_is_declared(filled):
    for name, points in (("middling", (2.0, 3.0)), ("perfect", (0.0, 0.0))):
        scores = by_layer(filled[name])
        assert tuple(scores[row, "Standard"].points for row in ("Driveability", "Driver state link")) == points


def test_sums_are_those_of_their_parts(filled):
    for one in filled.values():
        for total in one.totals:
            here = (total.element, total.subelement)
            parts = [s for s in one.scores if s.layer and (s.element, s.subelement) == here]
            assert total.points == pytest.approx(sum(part.points for part in parts), abs=2e-3)
            assert total.most == pytest.approx(sum(part.most for part in parts))
        assert one.most == 100


def test_a_test_that_is_not_simulated_has_no_points_and_no_colour(protocol, filled):
    prediction = predicted(protocol, "perfect")
    kept = {key: colour for key, colour in prediction.colours.items() if key[0] != "CCRb"}
    partial = fill(protocol, replace(prediction, colours=kept), WARNED)
    scores, whole = by_layer(partial), by_layer(filled["perfect"])
    assert [scores["CCRb", layer].points for layer in ("Standard", "Extended", "Robustness")] == [0, 0, 0]
    assert {key: s.points for key, s in scores.items() if key[0] != "CCRb"} == {
        key: s.points for key, s in whole.items() if key[0] != "CCRb"
    }


def test_verification_points_are_drawn_from_the_seed(protocol, filled):
    def selected(one):
        frame = one._frames["FC - Car & PTW verif."]
        return frame.to_numpy().tolist()

    prediction = predicted(protocol, "middling")
    assert str(selected(fill(protocol, prediction, WARNED))) == str(selected(filled["middling"]))
    other = fill(protocol, prediction, WARNED, seed=1)
    assert str(selected(other)) != str(selected(filled["middling"]))
    assert other.scores == filled["middling"].scores


def test_what_the_docs_say_of_braking_declared_in_cpla(protocol):
    # The package verifies its rows at 50 and 60 km/h as if no impact were allowed, so points depend on the draw.
    prediction = predicted(protocol, "middling")
    cells = {cell.key: cell for cell in reversed(protocol.cells()) if cell.test.startswith("CPLA")}
    values = {(key, ""): max(0.0, float(cell.attributes["VUT speed"].split()[0]) - 35.0) for key, cell in cells.items()}
    colours = {key: protocol.colour(cell, values[key, ""], {}) for key, cell in cells.items()}
    braking = replace(prediction, colours=colours, values=values, layers=frozenset())
    points = {by_layer(fill(protocol, braking, frozenset(), seed))["CPLA", "Standard"].points for seed in range(4)}
    assert len(points) > 1


@pytest.mark.parametrize("name", ["none", "perfect", "middling"])
def test_the_official_command_gives_the_file_the_same_points(filled, name, tmp_path):
    import openpyxl

    path = tmp_path / "ours" / f"{name}.xlsx"
    filled[name].write(path)
    official = official_scores(path, tmp_path)
    ours = iter([score.points for score in filled[name].scores])
    for scores in official.values():
        assert scores == [next(ours) for _ in scores]
    assert next(ours, None) is None
    # It is filled with them already, and 'preprocess' reads the colours as words.
    book = openpyxl.load_workbook(path)
    assert [cell.value for cell in book["Test Scores"]["D"][1:]] == official["Test Scores"]
    command = [sys.executable, "-m", "euroncap_rating_2026", "crash_avoidance", "preprocess"]
    subprocess.run([*command, "-i", str(path), "-o", str(tmp_path)], cwd=tmp_path, check=True, capture_output=True)
    again = openpyxl.load_workbook(tmp_path / "ca_preprocessed_template.xlsx")
    for sheet in book:
        if sheet.title.endswith(" pred.") and "robust" not in sheet.title:
            fills = [[str(c.fill.fgColor.rgb) for c in row] for row in sheet.iter_rows()]
            assert [[str(c.fill.fgColor.rgb) for c in row] for row in again[sheet.title].iter_rows()] == fills
