"""Test procedures: what is read, each mistake at its place, and verdicts that follow the bounds."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from command_line import run_dse
from rated_cars import FILES
from workspaces import written

from dse.domain.bench import Verdict
from dse.domain.sampler import Role
from dse.errors import DseError
from dse.loading.bench.procedure import read_procedure
from dse.rating import CaseVerdict, Verification
from dse.rating.verification import worst_first
from dse.testbench import check_bench, one_configuration

# Stationary target of UN R152: impact speeds by the closing speed.
ALLOWED = (
    "if target.host_speed < 41 km/h then 0 km/h else if target.host_speed < 43 km/h then 10 km/h"
    " else if target.host_speed < 46 km/h then 15 km/h else target.host_speed - 25 km/h"
)
SPEEDS = [10, 20, 30, 40, 42, 45, 50, 55, 60]
PROCEDURE = f"""\
procedure: r152
source: UN R152
tests:
  standing:
    testbench: wall
    conditions:
      target.host_speed: {{values: [{", ".join(f"{speed} km/h" for speed in SPEEDS)}], title: speed}}
      target.fog: {{derived: 1 km + 0 s * target.host_speed}}
    parameters: {{target.speed: 0 km/h}}
    metrics:
      twice: {{expression: 2 * impact_speed, unit: km/h}}
    requirements:
      impact: {{title: impact speed, metric: impact_speed, at_most: {ALLOWED}}}
      double: {{metric: twice, at_most: 20 km/h, exercised_when: impact_speed > 0 km/h}}
"""


def problems_of(text, workspace, tmp_path):
    path = tmp_path / "r152.procedure.yaml"
    path.write_text(text, encoding="utf-8")
    try:
        procedure = read_procedure(path, workspace.bench, tmp_path)
        for test in procedure.tests:
            check_bench(test.bench, one_configuration(test.bench.design, None))
    except DseError as error:
        return [f"{problem.where.line}:{problem.where.column} {problem.what}" for problem in error.problems]
    return procedure


def test_a_test_is_a_study_whose_requirements_are_those_of_the_procedure(workspace, tmp_path):
    procedure = problems_of(PROCEDURE, workspace, tmp_path)
    (test,) = procedure.tests
    (variable,) = test.variables
    assert (variable.name, variable.role, len(variable.values)) == ("target.host_speed", Role.CONDITION, len(SPEEDS))
    assert [follower.name for follower in test.bench.derived] == ["target.fog"]
    assert test.bench.test_components[0].parameters["speed"] == 0.0
    impact, double = test.bench.requirements
    assert (impact.metric, impact.of, impact.at_least) == ("impact_margin", "impact_speed", 0.0)
    assert (double.metric, double.of, double.at_most) == ("twice", "", pytest.approx(20 / 3.6))
    assert workspace.bench("wall").requirements == ()


MISTAKES = [
    ("testbench: wall", "testbench: wal", "5:16 unknown test bench 'wal'"),
    ("target.fog:", "target.frog:", "8:7 'target' has no port or parameter 'frog'"),
    ("{target.speed: 0 km/h}", "{target.host_speed: 9 km/h}", "7:7 'target.host_speed' is under 'parameters', too"),
    ("twice:", "place:", "11:7 'place' is a metric of wall"),
    ("metric: twice", "metric: twicer", "14:24 unknown metric 'twicer'"),
    ("at_most: 20 km/h", "at_most: 20 kmh", "14:40 unknown unit 'kmh'"),
    ("at_most: 20 km/h", "at_most: twice + fast", "14:48 unknown name 'fast'"),
    ("at_most: 20 km/h", "at_most: twice * 1 s", "14:40 'double_at_most' is length and cannot be shown in km/h"),
    ("at_most: 20 km/h", "at_most: twice, at_least: 1 km/h", "14:7 one bound of 'double' varies, the other does not"),
    ("      twice:", "      impact_margin: impact_speed\n      twice:", "14:7 'impact_margin' is computed"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "expected"), MISTAKES)
def test_a_mistake_is_one_error_at_its_place(workspace, tmp_path, old, new, expected):
    assert old in PROCEDURE
    found = problems_of(PROCEDURE.replace(old, new), workspace, tmp_path)
    assert isinstance(found, list)
    assert found[0].startswith(expected)


def case(verdict: Verdict, value: float, bound: float, number: int = 0) -> CaseVerdict:
    return CaseVerdict(
        "a", "t", "c", "r", "r", verdict, value, math.nan, bound, bound - value, "km/h", Path(), number
    )  # fmt: skip


def test_the_worst_verdict_is_first_whatever_its_unit():
    cases = [
        case(Verdict.PASS, 1.0, 10.0),
        case(Verdict.PASS, 99.0, 100.0),
        case(Verdict.FAIL, 101.0, 100.0),
        case(Verdict.FAIL, 3.0, 0.0),
        case(Verdict.NOT_EXERCISED, 5.0, 0.0),
        case(Verdict.FAIL, math.nan, 1.0),
        case(Verdict.FAILED_TO_RUN, math.nan, 1.0),
    ]
    assert [cases.index(each) for each in worst_first(cases)] == [6, 5, 3, 2, 4, 1, 0]
    found = Verification(None, None, tuple(cases), (), 0)  # type: ignore[arg-type]
    assert (found.count(Verdict.FAIL), found.count(Verdict.FAIL, "b"), found.count(Verdict.PASS, "a", "t")) == (3, 0, 2)


@pytest.fixture(scope="module")
def cars(tmp_path_factory):
    """A car whose brake takes off 35 km/h, one without a brake, and an ideal one."""
    files = {**FILES, "testbenches/r152.procedure.yaml": PROCEDURE}
    for name, strength in (("none", "0 km/h"), ("ideal", "200 km/h")):
        for path in ("component.yaml", "brake.h", "brake.c"):
            text = FILES[f"components/brake/{path}"].replace("component: brake", f"component: {name}")
            text = text.replace("brake.c]", "brake.c], struct: brake").replace("35 km/h", strength)
            files[f"components/{name}/{path}"] = text
    files["designs/car.yaml"] = "design: car\nroot: {compound: {brake: {alternatives: [brake, none, ideal]}}}\n"
    return written(tmp_path_factory.mktemp("cars"), files)


@pytest.mark.thorough
def test_without_brakes_every_case_fails_with_ideal_ones_none_and_a_verdict_flips_with_its_bound(cars, tmp_path):
    def checked(brake, *more):
        words = ("verify", "r152", "--where", f"brake is {brake}", "-o", str(tmp_path / brake), "--format", "json")
        done = run_dse(cars, *words, *more, cache=tmp_path / "cache")
        assert done.returncode in (0, 3), done.stderr
        found = json.loads(done.stdout)
        impacts = {round(3.6 * v["value"]): v for v in found["verdicts"] if v["requirement"] == "impact"}
        return done.returncode, found, impacts

    code, found, impacts = checked("none", "--gate")
    assert code == 3
    assert {v["verdict"] for v in found["verdicts"] if v["requirement"] == "impact"} == {"fail"}
    assert sorted(impacts) == SPEEDS
    # Bounds by hand from the table of the regulation.
    bounds = dict(zip(SPEEDS, [0, 0, 0, 0, 10, 15, 25, 30, 35], strict=True))
    for speed, each in impacts.items():
        assert 3.6 * each["at_most"] == pytest.approx(bounds[speed], abs=1e-9)
        assert 3.6 * each["margin"] == pytest.approx(bounds[speed] - speed, abs=1e-9)
    assert found["note"] == "An engineering check by simulation, no conformity"
    assert checked("none")[0] == 0
    code, found, _ = checked("ideal", "--gate")
    assert code == 0
    assert found["counts"]["fail"] == 0
    assert found["counts"]["not exercised"] == len(SPEEDS)  # the second requirement
    # 40 km/h are 5 km/h at the impact, and 0 are allowed; 42 are 7 and 10 are allowed.
    by_case = {v["case"]: v["verdict"] for v in checked("brake")[1]["verdicts"] if v["requirement"] == "impact"}
    assert (by_case["speed 40 km/h"], by_case["speed 42 km/h"]) == ("fail", "pass")
    flipped = cars / "testbenches" / "r152.procedure.yaml"
    flipped.write_text(PROCEDURE.replace("then 10 km/h", "then 6.9 km/h"), encoding="utf-8")
    by_case = {v["case"]: v["verdict"] for v in checked("brake")[1]["verdicts"] if v["requirement"] == "impact"}
    assert by_case["speed 42 km/h"] == "fail"
    table = run_dse(cars, "verify", "r152", "-o", str(tmp_path / "brake"), cache=tmp_path / "cache").stdout
    assert table.splitlines()[3].startswith("fail")
    assert "An engineering check by simulation, no conformity" in table
