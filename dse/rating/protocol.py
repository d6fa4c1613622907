"""What the package of a rating protocol contains: its tests, their cells, colours and points.

Everything is read from the package that is installed. No cell, band, colour or point value is in this file.
"""

from __future__ import annotations

import logging
import random
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib import import_module
from importlib.metadata import version
from importlib.resources import files
from io import BytesIO
from typing import Any

from dse.errors import Location, closest, fail
from dse.loading import variation_name

PACKAGES = ("euroncap-rating-2026",)
"""The packages that are supported. A file cannot have any other imported."""

_UNITS = {
    "v_rel_impact": "km/h",
    "v_reduction": "km/h",
    "v_impact": "km/h",
    "fcw_ttc": "s",
    "TTC": "s",
    "dtle_t_end": "m",
    "impact_occurred": "",
}
"""The units of the protocol's KPIs, which the package has in its texts only."""

_DRAWN = ("Target approach",)
"""Attributes that the package draws at random when it reads a matrix: no property of a cell."""

CellKey = tuple[str, tuple[tuple[str, str], ...]]
"""A test and the attributes of a cell: two cells with the same are one run."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell of the prediction matrix of *test*, at *row* and *column* (from 1) of its *sheet*.

    *extended* tells its range. *kpi* is the value that it is coloured by. *point* is the package's own object.
    """

    test: str
    sheet: str
    row: int
    column: int
    attributes: Mapping[str, str]
    extended: bool
    kpi: str
    point: Any = field(repr=False, compare=False)

    @property
    def key(self) -> CellKey:
        """What tells its run from others."""
        return self.test, tuple(sorted(self.attributes.items()))


class Protocol:
    """A package of `PACKAGES`, opened. Raises DseError, at *where*, if it is unknown or not installed."""

    def __init__(self, name: str, where: Location | None = None) -> None:
        if name not in PACKAGES:
            raise fail(f"unknown protocol '{name}'", where, closest(name, PACKAGES))
        self.name = name
        self._cells: dict[frozenset[str], tuple[Cell, ...]] = {}
        try:
            self.version = version(name)
            self._root = name.replace("-", "_")
            self.common = import_module(f"{self._root}.common")
            self.model = self.module("data_model")
        except ImportError:
            raise fail(f"the package {name} is not installed", where, 'pip install "dse-workbench[ncap]"') from None

    def __reduce__(self) -> tuple[Callable[[str], Protocol], tuple[str]]:
        """In another process the package is opened there, once."""
        return _opened, (self.name,)

    def module(self, name: str) -> Any:
        """A module of the package that calculates crash avoidance."""
        return import_module(f"{self._root}.crash_avoidance.{name}")

    @cached_property
    def tests(self) -> tuple[str, ...]:
        """The tests with a matrix, in the package's order."""
        return tuple(test for _, tests in self._subelements() for test in tests if test in self.model.MATRIX_INDICES)

    def scenario(self, test: str) -> str:
        """The scenario that the points of *test* are counted for."""
        return str(self.model.SUBTEST_TO_TEST_DICT.get(test, test))

    def most_points(self, test: str) -> float:
        """The points that *test* can have, over all its layers."""
        return float(sum(points or 0.0 for points in self.model.TOTAL_SCORES[test].values()))

    def kpis(self, test: str) -> tuple[str, ...]:
        """The KPIs that colour cells of *test*: its own, and that of a warning where one may be declared."""
        kinds, warning = self.model.NCAP_TEST_SCENARIOS, self.model.NcapTestCriteria.WARNING
        own = str(self.model.get_score_parameter_for_test(test))
        warned = str(self.model.NCAP_TEST_CRITERIA_TO_SCORE_PARAMETER[warning])
        return (own, warned) if test in kinds[warning] else (own,)

    @cached_property
    def known_kpis(self) -> tuple[str, ...]:
        """The KPIs of all tests."""
        return tuple(map(str, dict.fromkeys(self.model.NCAP_TEST_CRITERIA_TO_SCORE_PARAMETER.values())))

    def unit(self, kpi: str) -> str:
        """The unit of a KPI. Raises DseError for one that is new."""
        if kpi not in _UNITS:
            raise fail(f"the unit of '{kpi}' of {self.name} {self.version} is not known", None, "update dse")
        return _UNITS[kpi]

    @cached_property
    def attributes(self) -> dict[str, str]:
        """The names of all cells' attributes, and what the expression language calls them, which is as long."""
        names = {name for cell in self.cells() for name in cell.attributes}
        return {name: "".join(c if c.isalnum() else "_" for c in name).lower() for name in sorted(names)}

    def template(self, warned: Collection[str] = ()) -> Any:
        """The package's workbook, empty, as its ``generate-template`` writes it, but for the function of those rows
        that let the manufacturer choose it: a warning for tests in *warned*, else emergency braking."""
        integrity = self.module("integrity")
        book = import_module("openpyxl").load_workbook(str(files("data").joinpath(integrity.PRISTINE_TEMPLATE_NAME)))
        self.common.blank_computed_columns(book, integrity.COMPUTED_SHEET_COLUMNS)
        self.common.add_version_sheet_to_wb(book, self.common.CliCommand.GENERATE_TEMPLATE)
        self.common.add_cli_protocol_row_to_version_sheet(book)
        for sheet in book:
            if sheet.title.endswith(" pred."):
                self._declare(sheet, warned)
        return book

    def cells(self, warned: frozenset[str] = frozenset()) -> tuple[Cell, ...]:
        """All cells of the matrices, with the functions that `template` declares."""
        if warned not in self._cells:
            self._cells[warned] = self._read_cells(self.template(warned))
        return self._cells[warned]

    def _read_cells(self, book: Any) -> tuple[Cell, ...]:
        matrices, info = self.module("matrix_processing"), self.module("test_info")
        frames = self.frames(book)
        found: list[Cell] = []
        with drawing(0):
            for stage, tests in self._subelements():
                sheet = f"{info.get_sheet_prefix(stage['Stage element'], stage['Stage subelement'])} pred."
                key, frame = info.get_stage_subelement_key(stage["Stage element"]), frames[sheet]
                for test in tests:
                    place = matrices.get_matrix_indices(frame, test)
                    points = matrices.get_test_matrix(frame, test, key) if place else ()
                    found += (
                        self._cell(test, sheet, point, place["start_row"] + 2, place["start_col"] + 1)
                        for point in points
                    )
        return tuple(found)

    @cached_property
    def layers(self) -> frozenset[tuple[str, str]]:
        """The robustness layers that can be claimed, each with its scenario."""
        return frozenset((layer, scenario) for layer, scenario, _ in layer_cells(self.template()))

    def frames(self, book: Any) -> dict[str, Any]:
        """The sheets of *book* as the package's own commands read them from a file."""
        stored = BytesIO()
        book.save(stored)
        return dict(self.common.read_excel_file_to_dfs(stored, preserve_na_sheets=self.model.PRESERVE_NA_SHEETS))

    def _cell(self, test: str, sheet: str, point: Any, row: int, column: int) -> Cell:
        attributes = {name: str(text).strip() for name, text in point.attributes.items() if name not in _DRAWN}
        own, *others = self.kpis(test)
        kpi = others[0] if others and attributes.get("Function") == "FCW" else own
        extended = point.test_range.value == "Extended"
        return Cell(test, sheet, point.row + row, point.col + column, attributes, extended, kpi, point)

    def _declare(self, sheet: Any, warned: Collection[str]) -> None:
        """Write the function of each row of *sheet* where the package lets the manufacturer choose it."""
        test = ""
        chosen = {place for cells in choices(sheet, "FCW") for place in cells.cells}
        for row in range(1, sheet.max_row + 1):
            first = sheet.cell(row, 1).value
            test = first if first in self.model.MATRIX_INDICES else test
            for _, column in (place for place in chosen if place[0] == row):
                sheet.cell(row, column).value = "FCW" if test in warned else "AEB"

    def _subelements(self) -> Iterator[tuple[Mapping[str, str], list[str]]]:
        """Each stage subelement with the names of its tests."""
        info = self.module("test_info")
        for stage in self.model.STAGE_SUBELEMENTS:
            key = info.get_stage_subelement_key(stage["Stage element"])
            short = info.get_sheet_prefix(stage["Stage element"], stage["Stage subelement"]).split(" - ", 1)[1]
            yield stage, list(self.model.STAGE_SUBELEMENT_TO_LOADCASES[key][short])

    def colour(self, cell: Cell, value: float, inputs: Mapping[str, str]) -> str:
        """The colour of *value*, in the KPI's unit, by the package's own bands. What is undefined (NaN) is red.

        *inputs* are the manufacturer's declarations, of which the response to an opened door matters here.
        """
        matrices = self.module("matrix_processing")
        if value != value:  # noqa: PLR0124  # NaN: every comparison in the package would be false
            return str(self.common.PredictionColor.RED.value)
        point = matrices.ComputedTestPoint(cell.point, cell.test, self.rounded(value))
        if point.measured_color is not None:
            return str(point.measured_color.value)
        # A door's colour is limited by its prediction, so the best one is put in; only the driver's door is claimed.
        response = inputs.get("Vehicle response")
        point.test_point = matrices.TestPoint(cell.point.row, cell.point.col, self.common.PredictionColor.GREEN)
        found = point.get_lsc_computed_color(
            self.model.VehicleResponse(response) if response else None, self.model.DRIVER_DOOR
        )
        return str(found.value)

    def rounded(self, value: float) -> float:
        """*value* as the package rounds measured ones."""
        return float(import_module(f"{self._root}.numeric").round_half_up(value, 2))

    def weight(self, colour: str) -> float:
        """The share of a cell's points that *colour* gives, 0 … 1, in the standard range."""
        return float(self.model.LSC_COLOR_RANK.get(self.common.PredictionColor(colour), 0.0))

    @cached_property
    def paints(self) -> dict[str, str]:
        """What each colour looks like, as ``#rrggbb``."""
        painted = self.common.PREDICTION_COLOR_MAP.items()
        return {str(c.value): "#" + "".join(f"{round(255 * part):02x}" for part in parts) for c, parts in painted}

    def stated(self, layer: str, scenario: str) -> dict[str, Any]:
        """The criterion for each condition that the package states for a robustness *layer* of a *scenario*."""
        table = self.module("robustness_layer").ROBUSTNESS_LAYER_TO_VERIFICATION_CONDITION
        found = table.get(layer, {}).get(scenario, ())
        return dict(found if isinstance(found, list) else [found] if found else [])

    def conditions(self, layer: str) -> frozenset[str]:
        """All conditions that the package states for a robustness *layer*."""
        return frozenset(
            text for other, scenario in self.layers if other == layer for text in self.stated(layer, scenario)
        )

    def variations(self, scenario: str) -> dict[str, tuple[str, str]]:
        """The names of all variations of robustness layers that *scenario* can have, with their layers and conditions:
        one for each condition, or one for the whole layer."""
        return {
            variation_name(layer, condition): (layer, condition)
            for layer, other in sorted(self.layers)
            if other == scenario
            for condition in ("", *self.stated(layer, scenario))
        }

    def is_met(self, layer: str, condition: str, test: str, nominal: str, colour: str) -> bool:
        """Whether a cell that is *nominal* without the robustness *layer*, and *colour* with it, meets the criterion of
        the *condition*, or of all if it is "": not red, or no worse, where the package states none or both."""
        stated = self.stated(layer, self.scenario(test))
        criteria = {stated[condition]} if condition else set(stated.values())
        if criteria == {self.module("robustness_layer").AssessmentCriteria.NOT_RED}:
            return bool(colour != self.common.PredictionColor.RED.value)
        return self.weight(colour) >= self.weight(nominal)


@cache
def _opened(name: str) -> Protocol:
    return Protocol(name)


def choices(sheet: Any, word: str) -> Iterator[Any]:
    """The ranges of cells of *sheet* whose list of allowed entries contains *word*."""
    for rule in sheet.data_validations.dataValidation:
        if rule.type == "list" and word in str(rule.formula1).strip('"').split(","):
            yield from rule.sqref.ranges


def layer_cells(book: Any) -> Iterator[tuple[str, str, Any]]:
    """Each cell of *book* in which a robustness layer can be claimed for a scenario: both names, and the cell."""
    for sheet in book:
        if sheet.title.endswith("robust. pred."):
            for cells in choices(sheet, "YES"):
                for row, column in cells.cells:
                    layer, scenario = sheet.cell(row, 2).value, sheet.cell(1, column).value
                    yield str(layer), str(scenario), sheet.cell(row, column)


@contextmanager
def drawing(seed: int) -> Iterator[list[str]]:
    """The package's random choices follow from *seed* in here, and what it warns of is collected."""
    before, records = random.getstate(), _RuleRecords()
    log = logging.getLogger(PACKAGES[0].replace("-", "_"))
    passed_on = log.propagate
    log.propagate = False
    log.addHandler(records)
    random.seed(seed)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the package's own, of versions of pandas
            yield records.texts
    finally:
        random.setstate(before)
        log.removeHandler(records)
        log.propagate = passed_on


class _RuleRecords(logging.Handler):
    """Keeps the sentences by which the package announces that a rule takes points away."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Only what is marked as a rule; without its lists of cells."""
        text = record.getMessage()
        if text.startswith("[!!!]"):
            self.texts.append(text.removeprefix("[!!!] ").split(" cells=")[0])
