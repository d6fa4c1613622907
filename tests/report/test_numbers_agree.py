"""One study, and every door its numbers leave by: each is the number of the table, in its unit, to the digits shown."""

from __future__ import annotations

import csv
import io
import json
import re
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from definitions import stored_definition
from report_pages import Open, open_tab

import dse
from dse.api import metric_rows, ranking_as_data
from dse.cli.ranking import show_ranking
from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import (
    DefinedConfiguration,
    DefinedDesign,
    DefinedMetric,
    DefinedObjective,
    DefinedRequirement,
    DefinedTotal,
    DefinedVariable,
)
from dse.domain.run import Outcome, Run, RunRequest
from dse.domain.sampler import DesignVariable
from dse.exploration.samplers.csv import Csv
from dse.formats import read_yaml
from dse.loading import Surroundings
from dse.metrics import margin_to_bounds
from dse.report.content.reading import read_content
from dse.storage.folder import StudyFolder
from dse.storage.rows import Measures, block_of
from dse.units import parse_unit, shown

SPEED, MASS = "world.speed", "world.mass"
UNITS = {SPEED: "km/h", MASS: "g", "use": "kWh/km", "overshoot": "%", "warmth": "degC"}
METRICS = ("use", "overshoot", "warmth")
DEFINITION = stored_definition(
    (
        DefinedConfiguration("aa", {"sensor": "radar"}, totals={"weight": DefinedTotal(1234.5, "g")}),
        DefinedConfiguration("bb", {"sensor": "lidar"}, totals={"weight": DefinedTotal(0.7, "kg")}),
    ),
    title="Units",
    design=DefinedDesign("vehicle", "", ("sensor",)),
    variables=(
        DefinedVariable(SPEED, "speed", "km/h", 0.0, 40.0, 0, 10.0),
        DefinedVariable(MASS, "mass", "g", 0.5, 2.0, 0, 1.0, role="condition"),
    ),
    metrics=tuple(DefinedMetric(name, f"the {name}", UNITS[name], "final(x)") for name in METRICS),
    requirements=(
        DefinedRequirement("R1", "little overshoot", "overshoot", "%", at_most=0.07),
        DefinedRequirement("R2", "warm", "warmth", "degC", at_least=273.15 + 19.9),
    ),
    objectives=(DefinedObjective("use"),),
)
SPEEDS, MASSES = (1.9 + 1e-15, 70 / 3.6, 100 / 7), (0.9, 4 / 3)
"""The first is no double in km/h; runs are made at each for each configuration and mass."""


def made(number: int, configuration: str, speed: float, mass: float) -> Run:
    overshoot, warmth = (speed - 10) / 300 * mass, 273.15 + speed * 1.1
    judgements = tuple(
        Judgement(name, Verdict.PASS if margin >= 0 else Verdict.FAIL, margin)
        for name, margin in (
            ("R1", margin_to_bounds(overshoot, 0.07, None)),
            ("R2", margin_to_bounds(warmth, None, 273.15 + 19.9)),
        )
    )
    metrics = {"use": (400 + speed) * mass, "overshoot": overshoot, "warmth": warmth}
    return Run(RunRequest(number, configuration, {SPEED: speed, MASS: mass}), Outcome.DONE, metrics, judgements)


@pytest.fixture
def study(tmp_path: Path) -> Path:
    points = [(name, speed, mass) for name in ("aa", "bb") for speed in SPEEDS for mass in MASSES]
    runs = [made(number, *point) for number, point in enumerate(points)]
    with StudyFolder.create(tmp_path / "out", DEFINITION) as folder:
        folder.ask(0, [run.request for run in runs], len(runs))
        for run in runs:
            block = block_of((run,), Measures(METRICS, ("R1", "R2")))
            folder.add(run.request.configuration, [tuple(run.request.point.values())], block)
    return tmp_path / "out"


def table(results: dse.Results) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(results.export("csv").decode())))


def unit_of(heading: str) -> tuple[str, str]:
    name, _, unit = heading.partition(" [")
    return name, unit.removesuffix("]")


def is_number_of(text: str, exact: str) -> bool:
    """Whether a text as pages show it is *exact*, to the digits that it has."""
    plain = text.replace("\u2212", "-").replace("\u202f", "")
    digits = Decimal(plain).as_tuple()
    assert isinstance(digits.exponent, int)
    return abs(Fraction(plain) - Fraction(exact)) <= Fraction(10) ** digits.exponent / 2 + abs(Fraction(exact)) / 10**15


def test_every_file_and_frame_has_the_numbers_of_the_table(study: Path) -> None:
    results = dse.results(study)
    rows, frame, document = table(results), results.to_pandas(), json.loads(results.export("json"))
    arrow = pq.read_table(pa.BufferReader(results.export("parquet")))
    content = read_content(study)
    columns = {variable.name: variable.values for variable in content.variables}
    columns |= {metric.name: metric.values for metric in content.metrics}
    for heading in rows[0]:
        name, unit = unit_of(heading)
        texts = [row[heading] for row in rows]
        if name not in frame.attrs["units"]:
            continue
        numbers = [float(text) for text in texts]
        assert frame.attrs["units"][name] == unit == document["units"].get(name, "")
        assert frame[name].tolist() == numbers == arrow.column(name).to_pylist(), name
        assert (arrow.schema.field(name).metadata or {}).get(b"unit", b"").decode() == unit
        if name in columns:
            assert UNITS[name] == unit
            assert columns[name].tolist() == numbers, name
    for row, run in zip(rows, document["runs"], strict=True):
        assert [*run["point"].values()] == [float(row[f"{SPEED} [km/h]"]), float(row[f"{MASS} [g]"])]
        assert run["metrics"]["warmth"] == float(row["warmth [degC]"])
        assert run["requirements"]["R1"]["margin"] == float(row["R1.margin [%]"])
        assert run["verdict"] == row["verdict"]
        assert results.run(run["run"]).as_data() | {"units": {}} == run | {"units": {}}


def test_the_terminal_shows_the_numbers_of_the_table(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    results = dse.results(study)
    rows = table(results)
    for row in rows:
        run = results.run(int(row["run"]))
        lines = {line.title: line for line in metric_rows(run.noun, run.definition, run.check)}
        for name in METRICS:
            unit = UNITS[name]
            assert lines[f"the {name}"].value == f"{shown(float(row[f'{name} [{unit}]']))} {unit}"
        assert lines["the warmth"].bound == "≥ 19.9 degC"
        assert lines["the warmth"].margin == f"{shown(float(row['R2.margin [degC]']))} degC"
    found = results.best()
    show_ranking(results, found)
    told = capsys.readouterr().out
    assert "worst condition: use" in told
    assert f"worst condition of use: {MASS} = " in told
    ranking = ranking_as_data(found, DEFINITION)
    for best in ranking["best"]:
        runs = [rows[number] for number in best["runs"]]
        assert best["values"] == [max(float(row["use [kWh/km]"]) for row in runs)]
        assert best["margins"]["R1"] == min(float(row["R1.margin [%]"]) for row in runs)
        assert best["point"] == {SPEED: float(runs[0][f"{SPEED} [km/h]"])}
        line = next(line for line in told.splitlines() if f" {best['configuration']} " in line)
        for text in (f"{shown(best['values'][0])} kWh/km", f"{shown(best['margins']['R1'])} %"):
            assert re.search(rf"\b{re.escape(text)}", line), line


def test_a_table_of_results_gives_the_sampler_the_same_points(study: Path, tmp_path: Path) -> None:
    results = dse.results(study)
    heads = [f"{SPEED} [km/h]", f"{MASS} [g]"]
    points = "\n".join(",".join(cells) for cells in (heads, *([row[head] for head in heads] for row in table(results))))
    (tmp_path / "points.csv").write_text(points, encoding="utf-8")
    (tmp_path / "s.pet.yaml").write_text("study: s\n", encoding="utf-8")
    variables = tuple(DesignVariable(name, 0.0, 40.0, 0, 1.0, parse_unit(UNITS[name])) for name in (SPEED, MASS))
    where = read_yaml(tmp_path / "s.pet.yaml").top["sampler"]["csv"]
    around = Surroundings(where, frozenset({SPEED, MASS}), variables, tmp_path)
    read = Csv(file="points.csv").settled(around).rows
    assert read == tuple((speed, mass) for speed in SPEEDS for mass in MASSES)


@pytest.mark.browser
@pytest.mark.thorough
def test_the_page_shows_and_saves_the_numbers_of_the_table(study: Path, open_report: Open, tmp_path: Path) -> None:
    rows = table(dse.results(study))
    page = open_report(read_content(study))
    open_tab(page, "plot")
    page.click("#save-constraint-plot")
    with page.expect_download() as saved:
        page.get_by_role("button", name="Runs (CSV)").click()
    saved.value.save_as(tmp_path / "runs.csv")
    with (tmp_path / "runs.csv").open(encoding="utf-8", newline="") as file:
        of_page = list(csv.DictReader(file))
    titles = {"speed": SPEED, "mass": MASS, "the use": "use", "the overshoot": "overshoot", "the warmth": "warmth"}
    for row, other in zip(rows, of_page, strict=True):
        assert (row["run"], row["verdict"]) == (other["run"], other["verdict"])
        for title, name in titles.items():
            assert float(other[f"{title} [{UNITS[name]}]"]) == float(row[f"{name} [{UNITS[name]}]"])
    page.keyboard.press("Escape")
    open_tab(page, "runs")
    heads = page.locator(".table table.runs thead th").all_inner_texts()
    lines = page.eval_on_selector_all(
        ".table table.runs tbody tr:not(.gap)", "rows => rows.map(row => [...row.cells].map(cell => cell.innerText))"
    )
    assert len(lines) == len(rows)
    titles |= {"weight": "sum(weight)"}
    for line in lines:
        for title, name in titles.items():
            heading = next(key for key in rows[0] if key.startswith(f"{name} ["))
            text = next(cell for head, cell in zip(heads, line, strict=True) if head.startswith(f"{title} ["))
            assert is_number_of(text, rows[int(line[0])][heading]), (title, text)
