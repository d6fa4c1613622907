"""The protocol's own workbook, filled with predictions, and the points its calculator gives them."""

from __future__ import annotations

import contextlib
import io
import multiprocessing
import signal
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dse.errors import Problems, closest, raise_if_any
from dse.loading import Written, variation_name
from dse.processes import forget_start, unburdened
from dse.rating.cases import Case
from dse.rating.protocol import CellKey, Protocol, drawing, layer_cells
from dse.scratch import make_folder, written_whole

_GREY = "grey"
ASSESSED = ("Driveability", "Driver state link")
"""What a laboratory assesses, in rows of the verification without a test point: the rating may declare it."""
_ASSESSMENTS = ["Pass", "Fail"]
_TABLES = ("Scenario Scores", "Category Scores", "Test Scores")


@dataclass(frozen=True, slots=True)
class Prediction:
    """What one configuration comes to: *colours* of cells, *values* of cases in the units of the KPIs, and *layers*
    that are claimed, each with its scenario. A cell without a colour was not simulated."""

    colours: Mapping[CellKey, str]
    values: Mapping[Case, float]
    layers: frozenset[tuple[str, str]] = frozenset()
    inputs: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Score:
    """Points out of *most*; *scenario* and *layer* are "" in sums over them, *category* in those over categories."""

    element: str
    subelement: str
    category: str
    scenario: str
    layer: str
    points: float
    most: float


@dataclass(frozen=True, slots=True)
class Points:
    """The *scores* of a workbook: by layer of each scenario, by category, and by stage element.

    *rules* are the protocol's rules that took points away, in the words of its package. *undeclared* are inputs that
    the package asks for in simulated scenarios, and that the rating does not declare: such a scenario has no points.
    """

    scores: tuple[Score, ...]
    rules: tuple[str, ...]
    undeclared: tuple[str, ...]

    @property
    def points(self) -> float:
        """The sum over all stage elements."""
        return round(sum(score.points for score in self.totals), 3)

    @property
    def most(self) -> float:
        """What it can be."""
        return sum(score.most for score in self.totals)

    @property
    def totals(self) -> tuple[Score, ...]:
        """The points of each stage element."""
        return tuple(score for score in self.scores if not score.category)


@dataclass(frozen=True, slots=True)
class Filled(Points):
    """A filled workbook, 12 MB of memory."""

    protocol: Protocol = field(repr=False)
    _book: Any = field(repr=False)
    _frames: Mapping[str, Any] = field(repr=False)

    def write(self, target: Path) -> None:
        """Write the workbook with its verification points, as ``preprocess`` does, their values and the scores.

        The package's ``preprocess`` and ``compute-score`` both read it.
        """
        common = self.protocol.common
        with TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()), drawing(0):
            plain = Path(folder, "plain.xlsx")
            self._book.save(plain)
            frames = {name: frame for name, frame in self._frames.items() if not name.endswith("(bg)")}
            command = common.CliCommand.PREPROCESS
            self.protocol.module("report_writer").write_report(command, str(plain), frames, folder)
            (written,) = (path for path in Path(folder).glob("*.xlsx") if path != plain)
            book = import_module("openpyxl").load_workbook(written)
        for sheet in book:
            if sheet.title.endswith(" pred.") and "robust" not in sheet.title:
                self._name_colours(sheet)
        for table in _TABLES:
            column = next(cell.column for cell in book[table][1] if cell.value == "Score")
            for row, points in enumerate(self._frames[table]["Score"].tolist(), 2):
                book[table].cell(row, column).value = points
        make_folder(target.parent)
        with written_whole(target) as path:
            book.save(path)

    def _name_colours(self, sheet: Any) -> None:
        """Write each colour of *sheet* as a word as well: ``preprocess`` reads words, ``compute-score`` colours."""
        named = {paint[1:]: name for name, paint in self.protocol.paints.items()}
        for row in sheet.iter_rows():
            for cell in row:
                colour = named.get(str(cell.fill.fgColor.rgb)[2:].lower()) if cell.fill.fill_type == "solid" else None
                if colour and colour != _GREY:
                    cell.value = colour.capitalize()


def write_all(
    protocol: Protocol, predictions: Mapping[Path, Prediction], warned: frozenset[str], workers: int
) -> Iterator[Points]:
    """Write a workbook for each of *predictions* to its path, in so many processes: one takes seconds."""
    write = partial(_written, protocol, warned)
    number = min(workers, len(predictions))
    if number < 2:
        yield from map(write, predictions.items())
        return
    with ProcessPoolExecutor(number, multiprocessing.get_context("spawn"), _start) as pool:
        with unburdened():
            written = pool.map(write, predictions.items())
        yield from written


def _start() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches every process, and the one that waits ends the others
    forget_start()


def _written(protocol: Protocol, warned: frozenset[str], wanted: tuple[Path, Prediction]) -> Points:
    path, prediction = wanted
    filled = fill(protocol, prediction, warned)
    filled.write(path)
    return Points(filled.scores, filled.rules, filled.undeclared)


def fill(protocol: Protocol, prediction: Prediction, warned: frozenset[str], seed: int = 0) -> Filled:
    """The workbook of *prediction* with the points of the package's calculator.

    Tests in *warned* declare a warning where the function can be chosen. Verification points are drawn by the package
    from *seed*; their values are those of the same runs.
    """
    book = protocol.template(warned)
    for cell in protocol.cells(warned):
        if colour := prediction.colours.get(cell.key):
            book[cell.sheet].cell(cell.row, cell.column).value = colour.capitalize()
    claimed = {protocol.scenario(test) for test, _ in prediction.colours}
    undeclared = _declare(book, protocol, prediction, claimed)
    for layer, scenario, cell in layer_cells(book):
        cell.value = "YES" if (layer, scenario) in prediction.layers else "NO"
    common = protocol.common
    with drawing(seed) as rules:
        add = protocol.module("preprocess").add_verification_sheets_to_dfs
        stages, frames = add(protocol.frames(book))
        _verify(protocol, stages, frames, prediction)
        for name in [name for name in frames if name.endswith("pred.")]:
            painted = common.prediction_df_to_bg_df(frames[name]).astype(object)
            frames[f"{name} (bg)"] = painted.where(painted.notna(), None)
        scored = protocol.module("compute_score").calculate_score(frames)
    frames |= {name: scored[name] for name in _TABLES}
    return Filled(tuple(_scores(scored)), tuple(dict.fromkeys(rules)), undeclared, protocol, book, frames)


def _declare(book: Any, protocol: Protocol, prediction: Prediction, claimed: set[str]) -> tuple[str, ...]:
    """Fill the input parameters: simulated scenarios are claimed by the manufacturer itself, others are not.

    Returns what is not declared, with its scenario.
    """
    undeclared = []
    sheet = book["Input parameters"]
    heads = {cell.value: cell.column for cell in sheet[1]}
    scenario = ""
    for row in range(2, sheet.max_row + 1):
        scenario = str(sheet.cell(row, heads["Scenario"]).value or scenario).strip()
        parameter = sheet.cell(row, heads["Input parameter"]).value
        allowed = _allowed(sheet, row, heads["Value"])
        if scenario not in claimed:
            value = protocol.common.NOT_APPLICABLE
        elif "Self claimed" in allowed:
            value = "Self claimed"
        else:
            value = prediction.inputs.get(str(parameter), protocol.common.NOT_APPLICABLE)
            if parameter not in prediction.inputs:
                undeclared.append(f"{parameter} ({scenario})")
        if value in allowed:
            sheet.cell(row, heads["Value"]).value = value
    return tuple(undeclared)


def _allowed(sheet: Any, row: int, column: int) -> list[str]:
    """The entries that the cell may have."""
    for rule in sheet.data_validations.dataValidation:
        if rule.type == "list" and any((row, column) in set(cells.cells) for cells in rule.sqref.ranges):
            return [word for word in str(rule.formula1).strip('"').split(",") if word]
    return []


def require_inputs(protocol: Protocol, inputs: Mapping[str, Written]) -> None:
    """Raise DseError unless the package asks for each of *inputs* and allows its value."""
    sheet = protocol.template()["Input parameters"]
    heads = {cell.value: cell.column for cell in sheet[1]}
    known = dict.fromkeys(ASSESSED, _ASSESSMENTS)
    for row in range(2, sheet.max_row + 1):
        allowed = _allowed(sheet, row, heads["Value"])
        if "Self claimed" not in allowed:
            known[str(sheet.cell(row, heads["Input parameter"]).value)] = allowed
    problems = Problems()
    for name, given in inputs.items():
        if name not in known:
            problems.add(f"{protocol.name} has no input '{name}'", given.where, closest(name, known))
        elif given.text not in known[name]:
            problems.add(f"'{name}' cannot be '{given.text}'", given.where, f"one of {', '.join(known[name])}")
    raise_if_any(problems)


def _verify(protocol: Protocol, stages: Any, frames: Mapping[str, Any], prediction: Prediction) -> None:
    """Write the value of each verification point into its row; with the robustness layer that was drawn for it."""
    info = protocol.module("test_info")
    for (element, subelement), stage in stages.items():
        frame = frames[f"{info.get_sheet_prefix(element, subelement)} verif."]
        for row in range(len(frame)):
            if (name := frame.iat[row, 0]) in ASSESSED and name in prediction.inputs:
                frame.iat[row, frame.columns.get_loc("Value")] = prediction.inputs[name]
        head = next((row for row in range(len(frame)) if "Test point" in frame.iloc[row].tolist()), None)
        if head is None:
            continue  # nothing is predicted that could be verified
        heads = frame.iloc[head].tolist()
        row = head + 1
        for test, points in stage.selected_points_dict.items():
            for point in points:
                layer, condition = (
                    str(frame.iat[row, heads.index(head)]) if head in heads else ""
                    for head in ("Robustness layer", "Verification condition")
                )
                # The package adds attributes when it selects a point.
                own = {
                    name: str(text).strip() for name, text in point.attributes.items() if name in protocol.attributes
                }
                key = test, tuple(sorted(own.items()))
                there = [""]
                if (layer, protocol.scenario(test)) in prediction.layers:
                    there = [variation_name(layer, condition), layer, ""]
                value = next(prediction.values[key, name] for name in there if (key, name) in prediction.values)
                frame.iat[row, heads.index("Value")] = protocol.rounded(value)
                row += 1


def _scores(frames: Mapping[str, Any]) -> Iterator[Score]:
    levels = ("Stage element", "Stage subelement", "Category", "Scenario", "Layer")
    for table in _TABLES:
        frame = frames[table]
        there = [level for level in levels if level in frame.columns]
        labels = frame[there].ffill()
        for row in range(len(frame)):
            names = [str(labels.iloc[row][level]) if level in there else "" for level in levels]
            points, most = (float(frame[name].iloc[row]) for name in ("Score", "Max score"))
            element, subelement, category, scenario, layer = names
            yield Score(element, subelement, category, scenario, layer, points, most)
