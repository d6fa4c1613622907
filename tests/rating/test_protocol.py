"""What is read from the protocol's package, against its workbook."""

from __future__ import annotations

import random
import sys
from collections import Counter

import pytest

from dse.errors import DseError
from dse.rating import Protocol


def test_a_test_has_the_cells_of_its_matrix_in_the_workbook(protocol):
    # Counted in the workbook itself: rows below the test's name until an empty one, times its columns.
    from euroncap_rating_2026.crash_avoidance import data_model, matrix_processing

    book = protocol.template()
    counted = {}
    for sheet in book:
        for row in range(1, sheet.max_row + 1):
            name = sheet.cell(row, 1).value
            if name in data_model.MATRIX_INDICES and sheet.title.endswith(" pred."):
                rows = next(n for n in range(sheet.max_row) if sheet.cell(row + 2 + n, 1).value is None)
                columns = data_model.MATRIX_INDICES[name]["n_cols"]
                removed = [place for place in matrix_processing.CELL_REMOVAL_MAP.get(name, ()) if place[1] < columns]
                counted[name] = rows * columns - len(removed)
    assert Counter(cell.test for cell in protocol.cells()) == counted
    assert set(counted) == set(protocol.tests)
    assert len(counted) == 43


def test_the_points_of_all_tests_are_those_of_the_workbook(protocol):
    sheet = protocol.template()["Scenario Scores"]
    heads = {cell.value: cell.column for cell in sheet[1]}
    most, scenario = Counter(), ""
    for row in range(2, sheet.max_row + 1):
        scenario = sheet.cell(row, heads["Scenario"]).value or scenario
        most[scenario] += sheet.cell(row, heads["Max score"]).value
    ours = Counter()
    for test in protocol.tests:
        ours[protocol.scenario(test)] += protocol.most_points(test)
    assert set(most) - set(ours) == {"Driveability", "Driver state link"}  # these have no matrix
    assert ours == pytest.approx({name: most[name] for name in ours}, abs=1e-9)


def test_a_cell_is_where_the_workbook_has_it(protocol):
    book = protocol.template()
    for cell in protocol.cells():
        sheet = book[cell.sheet]
        first = sheet.cell(cell.row, 1).value.strip()
        assert first in cell.attributes.values(), cell


def test_reading_cells_leaves_the_users_random_numbers_alone(protocol):
    random.seed(7)
    before = random.getstate()
    protocol._read_cells(protocol.template())
    assert random.getstate() == before


def test_a_band_begins_at_its_edge(protocol):
    # Frontal Collisions 5.2: at 30 km/h green is no impact, brown below 10 km/h, red from there on.
    cell = next(c for c in protocol.cells() if c.test == "CCRs" and c.attributes["VUT speed"] == "30 km/h")
    values = [0.0, 0.004, 0.006, 9.994, 9.995, 10.0, float("nan")]
    colours = ["green", "green", "brown", "brown", "red", "red", "red"]
    assert [protocol.colour(cell, value, {}) for value in values] == colours


def test_a_warning_is_coloured_by_its_time(protocol):
    cells = protocol.cells(frozenset({"CPLA day"}))
    chosen = [cell for cell in cells if cell.test == "CPLA day" and cell.kpi == "fcw_ttc"]
    assert {cell.attributes["VUT speed"] for cell in chosen} == {"50 km/h", "60 km/h", "70 km/h", "80 km/h"}
    colours = [protocol.colour(chosen[0], value, {}) for value in (1.69, 1.7, float("nan"))]
    assert colours == ["red", "green", "red"]
    assert not [cell for cell in protocol.cells() if cell.kpi == "fcw_ttc"]


@pytest.mark.parametrize(
    ("response", "seconds", "colour"),
    [("Information", 2.3, "brown"), ("Warning", 1.7, "orange"), ("Retention", 1.7, "yellow"), ("Warning", 1.69, "red")],
)
def test_a_door_is_claimed_for_the_driver_alone(protocol, response, seconds, colour):
    cell = next(cell for cell in protocol.cells() if cell.test == "CBDA")
    assert protocol.colour(cell, seconds, {"Vehicle response": response}) == colour


def test_a_layers_criterion_is_the_packages(protocol):
    # In darkness a car may not be hit at the full speed; for weather the package states nothing, so no colour is lost.
    assert protocol.is_met("Illumination (Night)", "", "CCRs", "green", "brown")
    assert not protocol.is_met("Illumination (Night)", "", "CCRs", "green", "red")
    assert protocol.is_met("Adverse weather conditions", "", "CCRs", "brown", "yellow")
    assert not protocol.is_met("Adverse weather conditions", "", "CCRs", "green", "yellow")
    # A pedestrian who is faster may be hit, one who is slower may not be hit harder.
    assert protocol.is_met("Speed", "+3 km/h", "CPNA day", "green", "brown")
    assert not protocol.is_met("Speed", "-2 km/h", "CPNA day", "green", "brown")


def test_another_package_cannot_be_named():
    with pytest.raises(DseError, match="unknown protocol 'os'"):
        Protocol("os")


def test_a_package_that_is_not_installed_is_named_with_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "euroncap_rating_2026.common", None)
    with pytest.raises(DseError, match=r"(?s)not installed.*dse-workbench\[ncap\]"):
        Protocol("euroncap-rating-2026")
