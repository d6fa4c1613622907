"""Components without a source, many of them in one file, and what fits where."""

from __future__ import annotations

import pytest
from command_line import run_dse

from dse.domain.component import NO_INTERFACE
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.loading.workspace import Workspace
from dse.space.check import check_space
from dse.space.space import open_space


def problems(action, *arguments):
    with pytest.raises(DseError) as caught:
        action(*arguments)
    return [(str(problem.where), problem.what, problem.hint) for problem in caught.value.problems]


def test_many_components_stand_in_one_file_each_at_its_place(files):
    files.write(
        "components/library/tyres.yaml",
        "components:\n  slick: {title: No tread, properties: {cost: 9 EUR}}\n"
        "  winter: {implements: sensor, parameters: {wear: {start: 2 mm, max: 8 mm}}}\n",
    )
    workspace = Workspace(files.root)
    slick, winter = workspace.component("slick"), workspace.component("winter")
    assert (slick.title, slick.interface, slick.source) == ("No tread", NO_INTERFACE, None)
    assert str(slick.properties["cost"]) == "9 EUR"
    assert winter.interface == workspace.interfaces["sensor"]
    assert winter.parameter("wear").maximum == 0.008
    assert str(winter.where) == "components/library/tyres.yaml:3:3"
    assert set(workspace.component_files) == {"radar", "pd", "road", "slick", "winter"}


@pytest.mark.parametrize(
    ("text", "where", "what"),
    [
        ("components:\n  radar: {}\n", "components/more.yaml:2:3", "component 'radar' is defined twice"),
        ("components:\n  a: {source: {kind: c}}\n", "components/more.yaml:2:7", "unknown key 'source'"),
        ("components:\n  a: {implements: senser}\n", "components/more.yaml:2:19", "unknown interface 'senser'"),
        ("components:\n  a b: {}\n", "components/more.yaml:2:3", "'a b' cannot be a name"),
        ("components:\n  a: {properties: {cost: 3 EURO}}\n", "components/more.yaml:2:26", "unknown unit 'EURO'"),
        ("parts: {}\n", "components/more.yaml:1:1", "'components' is missing"),
    ],
)
def test_a_file_with_many_components_is_checked_like_any_other(files, text, where, what):
    files.write("components/more.yaml", text)
    (found, *_) = problems(Workspace(files.root).component, "radar")
    assert found[0] == where
    assert what in found[1]


def test_one_name_in_two_files_is_refused_with_both_places(files):
    files.write("components/one.yaml", "components: {slick: {}}\n")
    files.write("components/two.yaml", "components: {slick: {}}\n")
    ((where, what, hint),) = problems(Workspace(files.root).component, "slick")
    assert (where, what) == ("components/two.yaml:1:14", "component 'slick' is defined twice")
    assert hint == "see components/one.yaml"


def test_a_file_whose_name_starts_with_an_underscore_is_only_for_including(files):
    files.write("components/_common.yaml", "components: {slick: {}}\n")
    files.write("components/all.yaml", "include: [_common.yaml]\ncomponents: {winter: {}}\n")
    assert Workspace(files.root).component("slick").where.file == "components/_common.yaml"


def test_a_component_with_a_source_needs_an_interface(files):
    files.edit("components/pd/component.yaml", "implements: controller\n", "")
    ((where, what, hint),) = problems(Workspace(files.root).component, "pd")
    assert where == "components/pd/component.yaml:2:1"
    assert what.startswith("'implements' is missing")
    assert hint == "possible: controller, sensor, world"


def test_what_has_no_source_is_refused_by_name_when_it_is_built(files):
    files.write("components/tyres.yaml", "components: {slick: {}}\n")
    ((where, what, hint),) = problems(build, Workspace(files.root).component("slick"))
    assert where == "components/tyres.yaml:1:14"
    assert what == "component 'slick' has no source, so there is nothing to build"
    assert "kind c, fmu, modelica, python, road, scenario, simulink, sumo, time_series or udp" in hint


def test_a_bench_that_wants_to_simulate_a_component_without_source_names_it(files):
    files.write("components/cheap.yaml", "components:\n  cheap: {implements: sensor, properties: {cost: 1 EUR}}\n")
    files.edit("designs/car.yaml", "[radar]", "[cheap]")
    assert [c.choices for c in open_space(Workspace(files.root).design("car")).configurations()] == [
        {"sensor": "cheap"}
    ]
    done = run_dse(files.root, "simulate", "following", cache=files.root / "cache")
    assert done.returncode == 1
    assert "components/cheap.yaml:2:3: component 'cheap' has no source, so there is nothing to build" in done.stderr
    assert "hint: it can be counted and listed only" in done.stderr


def test_what_implements_nothing_cannot_be_connected(files):
    files.write("components/cheap.yaml", "components: {cheap: {}}\n")
    files.edit("designs/car.yaml", "[radar]", "[cheap]")
    (problem,) = check_space(Workspace(files.root).design("car"))
    assert str(problem.where) == "designs/car.yaml:7:7"
    assert "'cheap' has no interface, so nothing can be connected to it" in problem.what
    ((_, what, _),) = problems(list, open_space(Workspace(files.root).design("car")).configurations())
    assert "'cheap' has no interface" in what


def test_alternatives_all_have_an_interface_or_none(files):
    files.write("components/cheap.yaml", "components: {cheap: {}}\n")
    files.edit("designs/car.yaml", "[radar]", "[radar, cheap]")
    ((where, what, hint),) = problems(Workspace(files.root).design, "car")
    assert where == "designs/car.yaml:4:36"
    assert what == "'cheap' at 'sensor' implements no interface, 'radar' is a sensor"
    assert hint == "add implements: sensor in components/cheap.yaml"


def test_an_alternative_that_does_not_fit_is_refused_when_the_design_is_read(files):
    files.edit("designs/car.yaml", "[radar]", "[radar, pd]")
    ((where, what, hint),) = problems(Workspace(files.root).design, "car")
    assert where == "designs/car.yaml:4:36"
    assert what == "alternatives at 'sensor' have different interfaces: 'radar' is a sensor, 'pd' a controller"
    assert "'pd' lacks scene.range (input), scene.visible (input)" in hint
    assert "has target.gap as input m, not output m" in hint
    assert "set_gap (input), torque (output), mode (output) besides" in hint


def test_a_connection_inside_an_alternative_that_is_not_the_first_is_checked_for_its_units(files):
    files.write(
        "components/more.yaml",
        "components: {engine: {implements: engine}, gearbox: {implements: gearbox}, direct: {implements: drive}}\n",
    )
    files.write(
        "components/powertrains/interfaces.yaml",
        "interfaces:\n  drive: {inputs: {demand: N}, outputs: {force: N}}\n"
        "  engine: {inputs: {demand: N}, outputs: {shaft: N.m}}\n"
        "  gearbox: {inputs: {shaft: N}, outputs: {force: N}}\n",
    )
    files.write(
        "designs/van.yaml",
        "design: van\nroot:\n  compound:\n    drive:\n      alternatives:\n        - direct\n        - geared:\n"
        "            implements: drive\n            compound: {engine: engine, gearbox: gearbox}\n"
        "            connections: [demand -> engine.demand, engine.shaft -> gearbox.shaft, gearbox.force -> force]\n",
    )
    (problem,) = check_space(Workspace(files.root).design("van"))
    assert str(problem.where) == "designs/van.yaml:10:52"
    assert problem.what == "drive.engine.shaft -> drive.gearbox.shaft: units differ: N.m and N"
