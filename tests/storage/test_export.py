from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from xml.etree import ElementTree as ET

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import DefinedTotal, DefinedVariable, StudyDefinition
from dse.domain.run import Outcome, Run, RunRequest
from dse.storage.export.headings import Units
from dse.storage.export.tables import EXPORTS, to_csv, to_frame, to_json, to_junit, to_parquet
from dse.storage.folder import StudyFolder
from dse.units import parse_unit


@pytest.fixture
def folder(stored: Path) -> Iterator[StudyFolder]:
    with StudyFolder.open(stored) as folder:
        yield folder


@pytest.mark.parametrize("name", EXPORTS)
def test_an_export_does_not_tell_in_which_order_runs_were_made(
    name: str,
    folder: StudyFolder,
    tmp_path: Path,
    definition: StudyDefinition,
    runs: list[Run],
    add: Callable[[StudyFolder, Run], None],
    asked: Callable[[StudyFolder], StudyFolder],
) -> None:
    with StudyFolder.create(tmp_path / "other", definition) as other:
        asked(other)
        for run in runs:
            add(other, run)
        assert EXPORTS[name](other, Units.SHOWN) == EXPORTS[name](folder, Units.SHOWN)


@pytest.mark.parametrize("name", EXPORTS)
def test_a_study_without_runs_can_be_exported(name: str, tmp_path: Path, definition: StudyDefinition) -> None:
    with StudyFolder.create(tmp_path / "new", definition) as new:
        assert EXPORTS[name](new, Units.SHOWN)


def test_csv_floats_read_back_exactly_and_the_undefined_is_empty(folder: StudyFolder) -> None:
    rows = list(csv.DictReader(io.StringIO(to_csv(folder).decode())))
    assert list(rows[0]) == [
        *("run", "configuration", "sensor", "sum(cost) [EUR]", "outcome", "problem"),
        *("controller.kp [1/s]", "overshoot", "rise_time"),
        *("verdict", "R1.verdict", "R1.margin", "R2.verdict", "R2.margin"),
    ]
    assert float(rows[0]["overshoot"]) == 0.1 + 0.2
    assert rows[0]["rise_time"] == ""
    assert float(rows[1]["overshoot"]) == -5e-324
    assert float(rows[1]["rise_time"]) == math.inf
    assert [row["R1.verdict"] for row in rows] == ["pass", "fail", "failed to run", "pass"]
    assert [row["verdict"] for row in rows] == ["not exercised", "fail", "failed to run", "not exercised"]
    assert rows[2]["outcome"] == "failed"


def test_choices_and_sums_of_the_configuration_stand_in_every_row(folder: StudyFolder) -> None:
    rows = list(csv.DictReader(io.StringIO(to_csv(folder).decode())))
    assert [row["sensor"] for row in rows] == ["radar", "radar", "radar", "lidar <ä>"]
    assert [row["sum(cost) [EUR]"] for row in rows] == ["45.0", "45.0", "45.0", ""]


def test_a_choice_is_told_from_a_metric_of_its_name(tmp_path: Path, definition: StudyDefinition) -> None:
    named = replace(definition, metrics=(replace(definition.metrics[0], name="sensor", unit="km/h"),), requirements=())
    with StudyFolder.create(tmp_path / "named", named) as study:
        head = to_csv(study).decode().splitlines()[0].split(",")
        assert to_csv(study, Units.SI).decode().splitlines()[0].split(",") == [*head[:-1], "sensor [m/s]"]
    assert head[2] == "choice(sensor)"
    assert head[-1] == "sensor [km/h]"


def test_the_verdict_on_all_requirements_is_told_from_a_metric_of_its_name(
    tmp_path: Path, definition: StudyDefinition
) -> None:
    named = replace(
        definition,
        metrics=(replace(definition.metrics[0], name="verdict"),),
        requirements=(replace(definition.requirements[0], metric="verdict"),),
    )
    with StudyFolder.create(tmp_path / "named", named) as study:
        head = to_csv(study).decode().splitlines()[0].split(",")
    assert head[-4:] == ["verdict", "verdict(run)", "R1.verdict", "R1.margin"]


def test_numbers_leave_in_the_units_that_are_shown_or_in_si(
    tmp_path: Path, definition: StudyDefinition, add: Callable[[StudyFolder, Run], None]
) -> None:
    shown = replace(
        definition,
        configurations=(replace(definition.configurations[0], totals={"mass": DefinedTotal(1200.0, "g")}),),
        explored=("c1",),
        variables=(DefinedVariable("controller.kp", "", "km/h", 0.0, 1.0, 3, 0.5),),
        metrics=(replace(definition.metrics[0], unit="%"), replace(definition.metrics[1], unit="degC")),
        requirements=(definition.requirements[0], replace(definition.requirements[1], metric="rise_time")),
    )
    verdicts = (Judgement("R1", Verdict.PASS, 0.25), Judgement("R2", Verdict.FAIL, -1.5))
    values = {"overshoot": 0.5, "rise_time": 293.15}
    run = Run(RunRequest(0, "c1", {"controller.kp": 0.1}), Outcome.DONE, values, verdicts)
    with StudyFolder.create(tmp_path / "shown", shown) as study:
        study.ask(0, [run.request], 1)
        add(study, run)
        row = next(csv.DictReader(io.StringIO(to_csv(study).decode())))
        frames = {units: to_frame(study, units) for units in Units}
        documents = {units: json.loads(to_json(study, units)) for units in Units}
        (case,) = ET.fromstring(to_junit(study)).iterfind(".//testcase[failure]")  # noqa: S314  # our own bytes
    assert row["sum(mass) [g]"] == "1200.0"
    assert row["overshoot [%]"] == "50.0"
    assert row["rise_time [degC]"] == "20.0"
    assert (row["R1.margin [%]"], row["R2.margin [degC]"]) == ("25.0", "-1.5")
    assert parse_unit("km/h").to_si(Fraction(row["controller.kp [km/h]"])) == 0.1
    assert frames[Units.SHOWN].loc[0, "overshoot"] == 50.0
    assert frames[Units.SHOWN].attrs["units"]["rise_time"] == "degC"
    assert frames[Units.SI].loc[0, ["overshoot", "rise_time", "controller.kp"]].tolist() == [0.5, 293.15, 0.1]
    assert frames[Units.SI].attrs["units"]["sum(mass)"] == "kg"
    assert documents[Units.SHOWN]["runs"][0]["metrics"] == {"overshoot": 50.0, "rise_time": 20.0}
    assert documents[Units.SHOWN]["runs"][0]["verdict"] == "fail"
    assert documents[Units.SHOWN]["units"]["R1.margin"] == "%"
    assert documents[Units.SI]["runs"][0]["metrics"] == values
    assert [documents[Units.SI]["units"].get(name) for name in ("controller.kp", "overshoot", "rise_time")] == [
        *("m/s", None, "K")
    ]
    assert case.attrib["name"] == "R2 run 0 (controller.kp = 0.36 km/h)"
    assert case[0].attrib["message"] == "margin -1.5 degC"


def test_units_of_columns_are_their_metadata_where_files_have_such(folder: StudyFolder) -> None:
    schema = pq.read_table(pa.BufferReader(to_parquet(folder))).schema
    assert schema.field("controller.kp").metadata == {b"unit": b"1/s"}
    assert schema.field("sum(cost)").metadata == {b"unit": b"EUR"}
    assert to_frame(folder).attrs["units"]["sum(cost)"] == "EUR"


def test_json_is_strict_and_holds_the_definition(folder: StudyFolder) -> None:
    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    document = json.loads(to_json(folder), parse_constant=refuse)
    assert document["definition"]["study"] == "gains"
    assert document["fingerprint"] == folder.header.fingerprint
    assert [run["run"] for run in document["runs"]] == [0, 1, 2, 4]
    assert document["runs"][0]["metrics"] == {"overshoot": 0.1 + 0.2, "rise_time": None}
    assert document["runs"][1]["metrics"]["rise_time"] == "inf"
    assert document["runs"][1]["requirements"]["R1"] == {"verdict": "fail", "margin": -1.5}
    assert document["runs"][2]["problem"].startswith("world")


def test_parquet_holds_what_the_csv_holds(folder: StudyFolder) -> None:
    table = pq.read_table(pa.BufferReader(to_parquet(folder)))
    rows = list(csv.reader(io.StringIO(to_csv(folder).decode())))
    assert table.column_names == [heading.partition(" [")[0] for heading in rows[0]]
    assert table.column("overshoot").to_pylist()[:2] == [0.1 + 0.2, -5e-324]
    assert table.column("R1.verdict").to_pylist() == ["pass", "fail", "failed to run", "pass"]


def test_a_data_frame_holds_what_the_csv_holds(folder: StudyFolder) -> None:
    frame = to_frame(folder)
    text = frame.reset_index().to_csv(index=False, lineterminator="\n")
    listed = pd.read_csv(io.BytesIO(to_csv(folder))).rename(columns=lambda heading: heading.partition(" [")[0])
    assert pd.read_csv(io.StringIO(text)).equals(listed)
    assert frame.index.name == "run"


def test_junit_has_a_suite_per_configuration_and_a_case_per_requirement_and_run(folder: StudyFolder) -> None:
    root = ET.fromstring(to_junit(folder))  # noqa: S314  # our own bytes
    first, second = root.findall("testsuite")
    assert first.attrib == {"name": "c1", "tests": "6", "failures": "1", "errors": "2", "skipped": "2"}
    assert second.attrib == {"name": "c2", "tests": "2", "failures": "0", "errors": "0", "skipped": "1"}
    cases = {case.attrib["name"]: case for case in first.findall("testcase")}
    assert len(cases["R1 run 0 (controller.kp = 0.1 1/s)"]) == 0
    failure = cases["R1 run 1 (controller.kp = 0.2 1/s)"].find("failure")
    assert failure is not None
    assert failure.attrib["message"] == "margin -1.5"
    error = cases["R1 run 2 (controller.kp = 0.3 1/s)"].find("error")
    assert error is not None
    assert error.attrib["message"] == 'world: "t" < 3 s? & more'


def test_junit_of_a_bench_without_requirements_tells_which_runs_failed(
    tmp_path: Path, definition: StudyDefinition, runs: list[Run]
) -> None:
    from dse.storage.rows import Measures, block_of

    bare = replace(definition, requirements=())
    with StudyFolder.create(tmp_path / "bare", bare) as folder:
        folder.ask(0, [RunRequest(n, "c1", {}) for n in range(3)] + [RunRequest(n, "c2", {}) for n in range(3, 6)], 6)
        for run in runs:
            block = block_of((run,), Measures(("overshoot", "rise_time")))
            folder.add(run.request.configuration, [tuple(run.request.point.values())], block)
        root = ET.fromstring(to_junit(folder))  # noqa: S314  # our own bytes
    assert [suite.attrib["tests"] for suite in root] == ["3", "1"]
    assert len(root.findall(".//error")) == 1
