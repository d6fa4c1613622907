"""``dse import scenario``: a scenario and its cases become components that are whole."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import run_dse
from opendrive_texts import geometry, opendrive, road
from scenario_texts import (
    car,
    catalog,
    declared,
    lane,
    listed,
    private,
    ranged,
    scenario,
    speed,
    stochastic,
    teleport,
    together,
    variation,
)  # fmt: skip
from workspaces import written

from dse.domain.component import Component
from dse.errors import DseError
from dse.interchange import ImportedScenario, import_scenario
from dse.kinds import RoadSource, ScenarioSource, roads_of
from dse.loading import Workspace, kind_of

INTERFACES = Path(__file__).parents[3] / "components" / "interfaces.yaml"
SHORT, LONG = (opendrive(road("0", geometry(0.0, 0.0, 0.0, 0.0, x), x)) for x in (500.0, 900.0))
ENTRY = '<CatalogReference catalogName="cars" entryName="$entry"/>'
CAR = car("x").removeprefix('<ScenarioObject name="x">').removesuffix("</ScenarioObject>\n")
BASE = scenario(
    car("Ego") + f'<ScenarioObject name="Other">{ENTRY}</ScenarioObject>',
    private("Ego", teleport(lane("$s")), speed("$v")) + private("Other", teleport(lane(90)), speed("$twice")),
    parameters=declared(s=50, v=20, twice="${2 * $v}", entry="car", net="../roads/short.xodr").replace(
        'value="20"/>', 'value="20"><ConstraintGroup><ValueConstraint rule="greaterThan" value="0"/>'
        '<ValueConstraint rule="lessOrEqual" value="40"/></ConstraintGroup></ParameterDeclaration>'),
    road="$net",
    catalogs='<VehicleCatalog><Directory path="../catalogs"/></VehicleCatalog>',
)  # fmt: skip
FILES = {
    "from/files/base.xosc": BASE,
    "from/roads/short.xodr": SHORT,
    "from/roads/long.xodr": LONG,
    "from/roads/unused.xodr": SHORT,
    "from/catalogs/cars.xosc": catalog("cars", CAR, CAR.replace('name="car"', 'name="van"')),
    "from/catalogs/unused.xosc": catalog("others", CAR),
    "work/components/interfaces.yaml": INTERFACES.read_bytes(),
}


def imported(tmp_path: Path, *distributions: str, runs: int = 0, host: str | None = None) -> ImportedScenario:
    written(tmp_path, FILES)
    file = tmp_path / "from" / "files" / "base.xosc"
    if distributions:
        file = tmp_path / "from" / "files" / "variation.xosc"
        file.write_text(variation("base.xosc", *distributions, stochastic=runs), encoding="utf-8")
    return import_scenario(file, tmp_path / "work", "cut", host)


def read(tmp_path: Path, name: str) -> Component:
    """The component as the workspace has it, which its kind has checked."""
    component = Workspace(tmp_path / "work").component(name)
    kind = kind_of(component)
    assert kind is not None
    kind.check(component, component.source)
    return component


@pytest.mark.thorough
def test_a_scenario_is_copied_with_what_it_uses_and_checked(tmp_path: Path) -> None:
    made = imported(tmp_path)
    work = tmp_path / "work"
    assert sorted(str(path.relative_to(work)) for path in made.files) == [
        "components/roads/cut_road/component.yaml",
        "components/traffic/cut/component.yaml",
        "scenarios/cut/catalogs/cars.xosc",
        "scenarios/cut/files/base.xosc",
        "scenarios/cut/roads/short.xodr",
    ]
    assert all(path.is_file() for path in made.files)
    assert sum(path.is_file() for path in (work / "scenarios").rglob("*")) == 3
    traffic, driven = read(tmp_path, "cut"), read(tmp_path, "cut_road")
    assert [p.name for p in traffic.parameters] == ["drives_host", "host_front", "s", "v"]
    speed = traffic.parameter("v")
    assert speed is not None
    assert (speed.start, speed.minimum, speed.maximum, speed.tunable) == (20.0, 0.0, 40.0, False)
    assert isinstance(driven.source, RoadSource)
    assert roads_of(driven.source).roads["0"].length == 500.0
    (one,) = made.traffic
    assert (one.road, one.count, one.varied, one.cases) == ("cut_road", 1, {}, None)


def test_cases_become_a_table_and_what_does_not_vary_a_start(tmp_path: Path) -> None:
    made = imported(tmp_path, listed("s", 70), together({"v": 10, "twice": 1}, {"v": 15, "twice": 2.5}))
    (one,) = made.traffic
    assert one.cases == tmp_path / "work" / "scenarios" / "cut" / "cases.csv"
    assert one.cases.read_text("utf-8") == "traffic.v,traffic.twice\n10,1\n15,2.5\n"
    assert (one.count, one.is_product) == (2, False)
    traffic = read(tmp_path, "cut")
    assert {p.name: p.start for p in traffic.parameters[2:]} == {"s": 70.0, "v": 10.0, "twice": 1.0}
    assert isinstance(traffic.source, ScenarioSource)
    assert dict(traffic.source.values) == {"twice": "1"}  # otherwise it follows from another parameter


def test_all_combinations_of_levels_are_recognized(tmp_path: Path) -> None:
    (one,) = imported(tmp_path, ranged("v", 10, 20, 5), listed("s", 1, 2)).traffic
    assert (one.count, one.is_product) == (6, True)
    assert one.varied == {"s": (1.0, 2.0), "v": (10.0, 15.0, 20.0)}


@pytest.mark.thorough
def test_values_that_are_decided_when_an_fmu_is_built_give_a_component_each(tmp_path: Path) -> None:
    made = imported(
        tmp_path,
        together({"net": "../roads/short.xodr", "entry": "car"}, {"net": "../roads/long.xodr", "entry": "van"}),
        listed("v", 10, 20),
    )
    assert [each.component.name for each in made.traffic] == ["cut_car", "cut_van"]
    assert [each.road for each in made.traffic] == ["cut_road", "cut_van_road"]
    assert [each.cases and each.cases.name for each in made.traffic] == ["cases_car.csv", "cases_van.csv"]
    lengths = []
    for each in made.traffic:
        read(tmp_path, each.component.name)
        driven = read(tmp_path, each.road)
        assert isinstance(driven.source, RoadSource)
        lengths.append(roads_of(driven.source).roads["0"].length)
    assert lengths == [500.0, 900.0]


def test_components_on_one_road_share_it(tmp_path: Path) -> None:
    made = imported(tmp_path, listed("entry", "car", "van"))
    assert [each.road for each in made.traffic] == ["cut_road", "cut_road"]


def test_uncertain_parameters_keep_the_ends_of_their_distribution(tmp_path: Path) -> None:
    limits = '<Range lowerLimit="22" upperLimit="90"/>'
    normal = stochastic("v", f'<NormalDistribution expectedValue="30" variance="9">{limits}</NormalDistribution>')
    (one,) = imported(tmp_path, normal, runs=50).traffic
    assert one.runs == 50
    assert {name: dict(each.numbers) for name, each in one.uncertain.items()} == {"v": {"mean": 30.0, "sd": 3.0}}
    speed = read(tmp_path, "cut").parameter("v")
    assert speed is not None
    assert (speed.start, speed.minimum, speed.maximum) == (22.0, 22.0, 40.0)


@pytest.mark.thorough
def test_another_entity_can_be_the_host_and_without_one_there_is_no_road(tmp_path: Path) -> None:
    imported(tmp_path, host="Other")
    for name in ("cut", "cut_road"):
        source = read(tmp_path, name).source
        assert isinstance(source, ScenarioSource | RoadSource)
        assert source.host == "Other"
    file = tmp_path / "from" / "files" / "base.xosc"
    file.write_text(BASE.replace("Ego", "Someone"), encoding="utf-8")
    (one,) = import_scenario(file, tmp_path / "work", "nobody").traffic
    assert (one.road, one.no_road) == ("", "the scenario has no host on a road")


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("distributions", "what"),
    [
        ([listed("v", 20, 50)], "a case has 50 for 'v', which its constraints do not allow"),
        ([listed("v", 20, "fast")], "a case has 'fast' for 'v', which is not a finite number"),
        ([listed("v", "INF")], "a case has 'INF' for 'v', which is not a finite number"),
        ([listed("w", 1)], "the scenario has no parameter 'w'"),
        ([listed("entry", "tank")], "no catalogue 'cars' has an entry 'tank'"),
        ([listed("net", "../../secret.xodr")], "the road network '../../secret.xodr' does not exist"),
    ],
)
def test_wrong_cases_are_refused_and_nothing_is_written(tmp_path: Path, distributions: list[str], what: str) -> None:
    with pytest.raises(DseError) as error:
        imported(tmp_path, *distributions)
    (problem,) = error.value.problems
    assert what in problem.what
    assert problem.where is not None
    assert problem.where.line > 0
    assert sorted(path.name for path in (tmp_path / "work").rglob("*")) == ["components", "interfaces.yaml"]


def test_what_a_workspace_lacks_is_named(tmp_path: Path) -> None:
    written(tmp_path, FILES)
    with pytest.raises(DseError) as error:
        import_scenario(tmp_path / "from" / "files" / "base.xosc", tmp_path / "new")
    assert [problem.what for problem in error.value.problems] == [
        "the workspace has no interface 'scenario'",
        "the workspace has no interface 'road'",
    ]
    assert not (tmp_path / "new").exists()


def test_a_file_that_a_copy_would_not_find_is_refused(tmp_path: Path) -> None:
    written(tmp_path, FILES)
    road_file = tmp_path / "from" / "roads" / "short.xodr"
    file = tmp_path / "from" / "files" / "base.xosc"
    file.write_text(BASE.replace("../roads/short.xodr", str(road_file)), encoding="utf-8")
    with pytest.raises(DseError, match="is an absolute path or leads through a link"):
        import_scenario(file, tmp_path / "work")
    (tmp_path / "from" / "linked").symlink_to(tmp_path / "from" / "roads")
    file.write_text(BASE.replace("../roads/short", "../linked/short"), encoding="utf-8")
    with pytest.raises(DseError, match="is an absolute path or leads through a link"):
        import_scenario(file, tmp_path / "work")


def test_ways_are_not_for_scenarios_nor_values_for_other_roads(tmp_path: Path) -> None:
    imported(tmp_path)
    path = tmp_path / "work" / "components" / "roads" / "cut_road" / "component.yaml"
    text = path.read_text("utf-8")
    for old, new, what in (
        ('.xosc"', '.xosc", route: [0]', "'route' is not for a scenario"),
        ("files/base.xosc", "roads/short.xodr", ""),
        ('files/base.xosc"', 'roads/short.xodr", host: Ego', "'host' is for a scenario"),
    ):
        assert old in text
        path.write_text(text.replace(old, new), encoding="utf-8")
        if what:
            with pytest.raises(DseError, match=what):
                read(tmp_path, "cut_road")


@pytest.mark.thorough
def test_the_command_prints_what_design_bench_and_study_need(tmp_path: Path, cache: Path) -> None:
    imported(tmp_path, ranged("v", 10, 20, 5))
    done = run_dse(
        tmp_path, "import", "scenario", "from/files/variation.xosc", "-o", "work", "--name", "again", cache=cache
    )
    assert done.returncode == 0, done.stderr
    assert "compound: {road: again_road}" in done.stdout
    assert "test_components: {traffic: {component: again}}" in done.stdout
    assert "traffic.v: {values: [10, 15, 20]}" in done.stdout
    assert done.stdout.endswith("next: dse check\n")
    done = run_dse(tmp_path / "work", "check", cache=cache)
    assert done.returncode == 0, done.stderr
    twice = run_dse(
        tmp_path, "import", "scenario", "from/files/variation.xosc", "-o", "work", "--name", "again", cache=cache
    )
    assert twice.returncode == 1
    assert "the file already exists" in twice.stderr
