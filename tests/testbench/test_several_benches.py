"""One study on several benches, each a condition of every design; and parameters that are enumerations."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from port_workspaces import write

import dse
from dse.api import listing, what_if_run
from dse.domain.sampler import Role
from dse.errors import DseError
from dse.loading import Workspace
from dse.report.content.reading import read_content
from dse.storage import EXPORTS, StudyFolder, Units

RAMP = {
    "components/interfaces.yaml": "interfaces: {plant: {outputs: {y: m}}}\n",
    "components/ramp/component.yaml": """\
component: ramp
implements: plant
source: {kind: c, files: [ramp.c], step: 100 ms}
parameters:
  slope: {start: 1 m/s, min: -10, max: 10}
  shape: {enum: [single, double, triple], start: single}
  target: {start: 4 m}
""",
    "components/ramp/ramp.h": """\
#pragma once
#include <stdint.h>
typedef struct { struct { double y; } out; struct { double slope; int32_t shape; double target; } par; int k; } ramp;
void ramp_init(ramp *self);
void ramp_step(ramp *self);
""",
    "components/ramp/ramp.c": """\
#include "ramp.h"
static void show(ramp *s) { s->out.y = s->par.slope * 0.1 * s->k * (s->par.shape + 1); }
void ramp_init(ramp *self) { show(self); }
void ramp_step(ramp *self)
{
    self->k++;
    show(self);
    if (self->par.slope > 8 && self->k > 12)
        *(volatile int *)0 = 1;
}
""",
    "designs/one.yaml": "design: one\nroot: {compound: {plant: ramp}}\n",
}
BENCH = """\
testbench: %s
design: one
parameters: {plant.target: %s}
simulation: {stop: %s, step: 100 ms, record: [plant.y], record_every: 100 ms}
metrics: {%s}
requirements: {R1: {metric: reached, %s}}
figures: {y: {current: plant.y, target: plant.target}}
"""
SHORT = BENCH % ("short", "2 m", "1 s", "reached: final(plant.y)", "at_least: 2 m")
LONG = BENCH % ("long", "5 m", "3 s", "reached: 1 * final(plant.y)", "at_least: 2 m")
STUDY = """\
study: both
testbench: [short, long]
design_variables:
  plant.slope: {values: [1, 2]}
  plant.shape: {values: [triple, single]}
sampler: full_factorial
keep_waveforms: all
"""


def workspace(folder: Path, study: str = STUDY, long: str = LONG) -> Path:
    benches = {"testbenches/short.yaml": SHORT, "testbenches/long.yaml": long, "testbenches/both.pet.yaml": study}
    return write(folder, {**RAMP, **benches})


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return workspace(tmp_path_factory.mktemp("several"))


@pytest.fixture(scope="module")
def explored(root: Path) -> Path:
    dse.open(root).studies["both"].explore(root / "out", workers=1)
    return root / "out"


def rows(folder: Path) -> list[dict[str, str]]:
    with StudyFolder.open(folder) as stored:
        read = csv.DictReader(io.StringIO(EXPORTS["csv"](stored).decode()))
        return [{name.partition(" [")[0]: cell for name, cell in row.items()} for row in read]


def test_every_design_is_run_on_every_bench_with_its_own_time_and_formulas(explored: Path) -> None:
    found = {(r["plant.slope"], r["plant.shape"], r["testbench"]): float(r["reached"]) for r in rows(explored)}
    times, factors = {"short": 1.0, "long": 3.0}, {"single": 1.0, "triple": 3.0}
    expected = {
        (slope, shape, bench): float(slope) * factors[shape] * times[bench]
        for slope in ("1.0", "2.0")
        for shape in factors
        for bench in times
    }
    assert found == pytest.approx(expected, rel=1e-12)


def test_the_benches_are_a_condition_of_the_study(root: Path) -> None:
    study = Workspace(root).study("both")
    (condition,) = (variable for variable in study.variables if variable.role is Role.CONDITION)
    assert condition.labels == ("short", "long")
    assert [bench.name for bench in study.benches] == ["short", "long"]


def test_a_listing_names_every_bench_of_a_study(root: Path) -> None:
    (study,) = (each for each in listing(Workspace(root)).studies if each.name == "both")
    assert study.facts["testbench"] == "short + long"


def test_waveforms_end_with_their_bench_and_have_its_target(explored: Path) -> None:
    content = read_content(explored)
    (figure,) = content.figures
    short = [row["testbench"] == "short" for row in rows(explored)]
    assert figure.current.shape == (8, 31)
    assert [bool(line[11:].max() != line[11:].max()) for line in figure.current] == short
    assert figure.target is not None
    assert figure.target.tolist() == [2.0 if is_short else 5.0 for is_short in short]


@pytest.mark.thorough
def test_a_run_on_the_second_bench_is_replayed_bit_for_bit(
    root: Path, explored: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(root)
    for row in rows(explored)[:2]:
        again = dse.results(explored).replay(int(row["run"]))
        assert (again.different, again.changed) == ((), ())


@pytest.mark.thorough
def test_a_point_on_either_bench_and_of_any_item_can_be_tried(root: Path, explored: Path) -> None:
    results = dse.results(explored)
    for number in range(len(results)):
        run = results.run(number)
        shown = {name: float(value) for name, value in run.point.items()}
        tried = what_if_run(results.definition, run.configuration, shown, workspace=root)
        assert (tried.run.metrics, tried.run.verdicts, tried.changed) == (run.metrics, run.verdicts, ())


@pytest.mark.thorough
def test_the_runs_of_a_bench_are_those_of_a_study_of_that_bench_alone(root: Path, explored: Path) -> None:
    alone = write(root, {"testbenches/alone.pet.yaml": STUDY.replace("both", "alone").replace("[short, long]", "long")})
    dse.open(alone).studies["alone"].explore(root / "alone", workers=1)

    def shown(found: list[dict[str, str]]) -> list[dict[str, str]]:
        kept = ({key: value for key, value in row.items() if key not in ("run", "testbench")} for row in found)
        return sorted(kept, key=str)

    assert shown(rows(root / "alone")) == shown([row for row in rows(explored) if row["testbench"] == "long"])


@pytest.mark.thorough
def test_fused_or_with_error_bars_the_benches_give_the_same(root: Path, explored: Path) -> None:
    dse.open(root).studies["both"].explore(root / "fused", workers=1, fuse=True, fresh=True)
    assert rows(root / "fused") == rows(explored)


@pytest.mark.thorough
def test_a_part_that_crashes_is_named_with_the_bench_it_crashed_on(tmp_path: Path) -> None:
    study = STUDY.replace("values: [1, 2]", "values: [1, 9]").replace("[triple, single]", "[double, single]")
    root = workspace(tmp_path, study)
    dse.open(root).studies["both"].explore(root / "out", workers=1)
    found = rows(root / "out")
    problems = {(row["plant.slope"], row["testbench"]): row["problem"] for row in found}
    assert problems.pop(("9.0", "long")).endswith("on long")
    assert set(problems.values()) == {""}


def test_a_study_may_vary_nothing_but_the_bench(tmp_path: Path) -> None:
    root = workspace(tmp_path, "study: both\ntestbench: [short, long]\n")
    dse.open(root).studies["both"].explore(root / "out", workers=1)
    assert [(row["testbench"], float(row["reached"])) for row in rows(root / "out")] == [("short", 1.0), ("long", 3.0)]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("record_every: 100 ms", "record_every: 200 ms"), "records at other times than 'short'"),
        (("at_least: 2 m", "at_least: 3 m"), "the requirement 'R1' is not the same in 'short' and 'long'"),
        (
            ("current: plant.y, target: plant.target", "current: plant.y"),
            "the figure 'y' shows something else in 'long'",
        ),
    ],
)
def test_benches_that_cannot_share_a_table_are_refused_by_name(tmp_path: Path, change: Any, said: str) -> None:
    root = workspace(tmp_path, long=LONG.replace(*change))
    with pytest.raises(DseError, match=r"both\.pet\.yaml:2:20") as raised:
        Workspace(root).study("both")
    assert said in str(raised.value)


def test_a_metric_of_another_dimension_is_refused_where_nobody_wrote_its_unit(tmp_path: Path) -> None:
    odd = LONG.replace("1 * final(plant.y)", "final(plant.y) * 1 m").replace("requirements: {R1", "#")
    root = workspace(tmp_path, long=odd)
    short = SHORT.replace("requirements: {R1", "#")
    write(root, {"testbenches/short.yaml": short})
    with pytest.raises(DseError, match=r"the metric 'reached' is in m\^2 on 'long', and in m on 'short'"):
        dse.open(root).studies["both"].explore(root / "out", workers=1)


def test_a_value_that_is_no_item_of_the_enumeration_is_refused(tmp_path: Path) -> None:
    root = workspace(tmp_path, STUDY.replace("triple, single", "tripple"))
    with pytest.raises(DseError, match="found 'tripple'") as raised:
        Workspace(root).study("both")
    assert "did you mean 'triple'" in str(raised.value)


def test_an_enumeration_is_shown_by_its_items_wherever_they_stand(explored: Path) -> None:
    content = read_content(explored)
    assert content.variable("plant.shape").labels == ("single", "", "triple")
    with StudyFolder.open(explored) as stored:
        (defined,) = (v for v in stored.header.definition.variables if v.name == "plant.shape")
    assert (defined.label(2.0), defined.label(1.0), replace(defined, labels=()).label(2.0)) == ("triple", "", "")


def test_a_table_of_points_names_items_by_name(tmp_path: Path) -> None:
    study = STUDY.replace("[triple, single]", "[single, triple]").replace(
        "full_factorial", "{csv: {file: ../points.csv}}"
    )
    root = workspace(tmp_path, study)
    write(root, {"points.csv": "plant.slope [m/s],plant.shape\n1,single\n2,triple\n"})
    dse.open(root).studies["both"].explore(root / "out", workers=1)
    found = [(row["plant.shape"], row["testbench"], float(row["reached"])) for row in rows(root / "out")]
    assert found == [
        ("single", "short", 1.0),
        ("single", "long", 3.0),
        ("triple", "short", 6.0),
        ("triple", "long", 18.0),
    ]
    write(root, {"points.csv": "plant.slope [m/s],plant.shape\n1,singel\n"})
    with pytest.raises(DseError, match="'singel' is not a value of"):
        dse.open(root).studies["both"].explore(root / "out", workers=1)


# Requirements that belong to some of the benches.


ON = {
    **RAMP,
    "testbenches/short.yaml": SHORT,
    "testbenches/long.yaml": LONG.replace(
        "reached: 1 * final(plant.y)", "reached: 1 * final(plant.y), top: maximum(plant.y)"
    ).replace(
        "requirements: {", "requirements: {R2: {metric: top, at_most: 5 m, text: no more than five, severity: major}, "
    ),
    "testbenches/both.pet.yaml": STUDY,
}


@pytest.fixture(scope="module")
def partly(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = write(tmp_path_factory.mktemp("partly"), ON)
    dse.open(root).studies["both"].explore(root / "out", workers=1)
    return root / "out"


@pytest.mark.thorough
def test_a_requirement_of_one_bench_is_not_counted_on_another(partly: Path) -> None:
    found = {
        (r["plant.slope"], r["plant.shape"], r["testbench"]): (r["R2.verdict"], r["verdict"]) for r in rows(partly)
    }
    assert {verdict for (_, _, bench), (verdict, _) in found.items() if bench == "short"} == {"does not apply"}
    assert found["2.0", "triple", "long"] == ("fail", "fail")
    assert found["1.0", "single", "long"] == ("pass", "pass")
    assert found["2.0", "triple", "short"] == ("does not apply", "pass")
    assert {r["top"] for r in rows(partly) if r["testbench"] == "short"} == {""}
    summary = dse.Results(partly).summary
    assert sum(summary.verdicts["R2"].values()) == 4
    assert "does not apply" not in summary.verdicts["R2"]
    content = read_content(partly)
    assert content.requirements[0].applies is None
    assert content.requirements[1].applies is not None
    assert content.requirements[1].applies.sum() == 4
    told = [each.text for each in dse.Results(partly).findings() if each.about == "R2" and " met " in each.text]
    assert any("1 of 4 designs" in text for text in told), told
    junit = EXPORTS["junit"](StudyFolder.open(partly)).decode()
    assert junit.count('name="R2') == 4


def test_the_stored_requirement_says_where_it_applies_and_where_it_comes_from(partly: Path) -> None:
    definition = dse.Results(partly).definition
    first, second = definition.requirements
    assert (first.on, second.on) == ((), ("long",))
    assert (second.text, second.severity) == ("no more than five", "major")


def test_a_review_gets_a_table_of_the_requirements(partly: Path) -> None:
    with StudyFolder.open(partly) as stored:
        sheet = [*csv.DictReader(io.StringIO(EXPORTS["requirements"](stored, Units.SHOWN).decode()))]
    first, second = sheet
    assert (second["id"], second["text"], second["severity"], second["benches"]) == (
        "R2",
        "no more than five",
        "major",
        "long",
    )
    assert (second["verdict"], second["points"], second["pass"], second["fail"]) == ("fail", "4", "1", "3")
    assert (float(second["least margin"]), second["at most"], second["unit"]) == (pytest.approx(-13.0), "5.0", "m")
    assert (first["points"], first["met in"]) == ("8", "")


def test_on_names_benches_that_there_are(tmp_path: Path) -> None:
    wrong = SHORT.replace("at_least: 2 m}", "at_least: 2 m, on: [shrt]}")
    write(tmp_path, {**RAMP, "testbenches/short.yaml": wrong})
    with pytest.raises(DseError, match=r"unknown test bench 'shrt'.*\n.*short"):
        Workspace(tmp_path).bench("short")


def test_a_requirement_on_other_benches_is_left_out_with_what_it_needs(tmp_path: Path) -> None:
    shared = SHORT.replace("at_least: 2 m}", "at_least: 2 m}, R9: {metric: not_here, at_most: 1 m, on: long}")
    write(tmp_path, {**RAMP, "testbenches/short.yaml": shared, "testbenches/long.yaml": LONG})
    assert [each.name for each in Workspace(tmp_path).bench("short").requirements] == ["R1"]


def test_an_objective_is_a_metric_of_every_bench(tmp_path: Path) -> None:
    write(tmp_path, {**ON, "testbenches/both.pet.yaml": STUDY + "objectives: [minimize top]\n"})
    with pytest.raises(DseError, match="'top' is not a metric of short"):
        Workspace(tmp_path).study("both")


def test_benches_and_values_have_weights_in_the_order_they_are_listed(tmp_path: Path) -> None:
    weighted = STUDY.replace("design_variables:", "bench_weights: [1, 20]\ndesign_variables:")
    assert weighted != STUDY
    more = "conditions: {plant.target: {values: [3 m, 1 m, 2 m], weights: [0.5, 20 %, 0.3]}}\n"
    write(tmp_path, {**ON, "testbenches/both.pet.yaml": weighted + more})
    study = Workspace(tmp_path).study("both")
    found = {variable.name: (variable.values, variable.weights) for variable in study.variables if variable.weights}
    assert found == {"plant.target": ((1, 2, 3), (0.2, 0.3, 0.5)), "testbench": ((0, 1), (1, 20))}


def test_an_expected_value_needs_a_sampler_that_asks_for_all_cases(tmp_path: Path) -> None:
    asked = STUDY + 'objectives: ["minimize expected(reached)"]\n'
    write(tmp_path, {**ON, "testbenches/both.pet.yaml": asked})
    assert Workspace(tmp_path).study("both").objectives[0].is_expected
    searching = asked.replace("sampler: full_factorial", "sampler: {nsga2: {population: 4, evaluations: 8}}")
    write(tmp_path, {**ON, "testbenches/both.pet.yaml": searching})
    with pytest.raises(DseError, match="needs all cases of a design at once: 'nsga2' asks for a few"):
        Workspace(tmp_path).study("both")


@pytest.mark.thorough
def test_changed_weights_are_stored_without_a_run(tmp_path: Path) -> None:
    objective = 'objectives: ["minimize expected(reached)"]\n'
    write(tmp_path, {**ON, "testbenches/both.pet.yaml": STUDY + objective})
    results = dse.open(tmp_path).studies["both"].explore(tmp_path / "out", workers=1)
    frame = results.to_pandas()
    designs = [frame["plant.slope"], frame["plant.shape"]]

    def shown() -> list[float]:
        (column,) = read_content(tmp_path / "out").composites
        return sorted(set(column.values.tolist()))

    assert shown() == pytest.approx(sorted(frame["reached"].groupby(designs).mean()))
    write(tmp_path, {**ON, "testbenches/both.pet.yaml": STUDY + objective + "bench_weights: [1, 3]\n"})
    again = dse.open(tmp_path).studies["both"].explore(tmp_path / "out", workers=1)
    assert again.explored is not None
    assert again.explored.simulated == 0
    weights = frame["testbench"].map({"short": 1.0, "long": 3.0})
    weighted = (weights * frame["reached"]).groupby(designs).sum() / 4
    assert shown() == pytest.approx(sorted(weighted))
