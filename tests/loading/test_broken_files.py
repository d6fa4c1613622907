"""Every kind of broken input gives one located message with a hint."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from dse.errors import DseError, Problem
from dse.loading.workspace import Workspace


def problems(load: object, *arguments: str) -> tuple[Problem, ...]:
    with pytest.raises(DseError) as caught:
        load(*arguments)  # type: ignore[operator]
    return caught.value.problems


def everything(root: Path) -> None:
    workspace = Workspace(root)
    workspace.study("gains")


def one_problem(root: Path) -> tuple[str, str, str]:
    found = problems(everything, root)
    assert len(found) == 1, found
    (problem,) = found
    return str(problem.where), problem.what, problem.hint


def test_the_unbroken_workspace_loads(files):
    study = Workspace(files.root).study("gains")
    assert study.variables[0].high == 3.0
    assert study.bench.design.root.parts["sensor"].options[0].component.parameter("range").start == 150.0
    assert study.bench.simulation.stride == 10


CASES = [
    # what is broken: file, old text, new text, place, message, part of the hint
    ("unknown key", "components/pd/component.yaml", "unit: 1/s", "units: 1/s", "components/pd/component.yaml:5:36", "unknown key 'units'", "unit"),
    ("unknown key at the top", "testbenches/following.yaml", "design: car", "design: car\nscenario: x", "testbenches/following.yaml:3:1", "unknown key 'scenario'", "possible"),
    ("wrong unit", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 kg}", "testbenches/following.yaml:8:34", "wrong unit in '40 kg': expected length, found mass", "write it in m"),
    ("unknown unit", "components/radar/component.yaml", "mass: 300 g", "mass: 300 gs", "components/radar/component.yaml:8:34", "unknown unit 'gs'", "number and a unit"),
    ("no quantity", "components/radar/component.yaml", "cost: 45 EUR", "cost: cheap", "components/radar/component.yaml:8:20", "'cheap' is not a quantity: write a number and a unit, as '70 km/h'", ""),
    ("unknown component", "designs/car.yaml", "[radar]", "[rader]", "designs/car.yaml:4:29", "unknown component 'rader'", "did you mean 'radar'?"),
    ("unknown interface", "components/pd/component.yaml", "implements: controller", "implements: controler", "components/pd/component.yaml:2:13", "unknown interface 'controler'", "controller"),
    ("unknown design", "testbenches/following.yaml", "design: car", "design: cart", "testbenches/following.yaml:2:9", "unknown design 'cart'", "car"),
    ("unknown bench", "testbenches/gains.pet.yaml", "testbench: following", "testbench: followin", "testbenches/gains.pet.yaml:2:12", "unknown test bench 'followin'", "following"),
    ("unknown parameter", "testbenches/gains.pet.yaml", "controller.kp:", "controller.kq:", "testbenches/gains.pet.yaml:4:3", "'controller' has no port or parameter 'kq'", "kp"),
    ("unknown part", "testbenches/gains.pet.yaml", "controller.kp:", "contoller.kp:", "testbenches/gains.pet.yaml:4:3", "'contoller.kp' names no part", "controller"),
    ("empty range of a parameter", "components/pd/component.yaml", "max: 5", "max: -5", "components/pd/component.yaml:5:25", "the range of 'kp' is empty: min 0 > max -5", ""),
    ("start outside the range", "components/pd/component.yaml", "start: 0.8", "start: 8", "components/pd/component.yaml:5:15", "start of 'kp' is outside its range 0 … 5", "widen"),
    ("impossible range", "testbenches/gains.pet.yaml", "[0.1, 3.0]", "[3.0, 0.1]", "testbenches/gains.pet.yaml:4:26", "the range of 'controller.kp' is empty: 3.0 … 0.1", "low, then high"),
    ("range beyond the component's", "testbenches/gains.pet.yaml", "[0.1, 3.0]", "[0.1, 6.0]", "testbenches/gains.pet.yaml:4:26", "the range of 'controller.kp' leaves what component pd allows", "max 5"),
    ("range with one end", "testbenches/gains.pet.yaml", "[0.1, 3.0]", "[0.1]", "testbenches/gains.pet.yaml:4:26", "'design_variables.controller.kp.range': list should have at least 2 items after validation, not 1, found [0.1]", ""),
    ("value outside the range", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 m, controller.kp: 9}", "testbenches/following.yaml:8:55", "kp = 9 is outside its range 0 … 5 1/s", "set by component pd"),
    ("missing key", "testbenches/following.yaml", "{stop: 10 s, ", "{", "testbenches/following.yaml:9:1", "'stop' is missing in 'simulation'", "add 'stop: …'"),
    ("stop no multiple of step", "testbenches/following.yaml", "stop: 10 s", "stop: 10.05 s", "testbenches/following.yaml:9:20", "'stop' (10.05 s) is not a multiple of 'record_every' (100 ms)", "equal steps"),
    ("unknown metric", "testbenches/following.yaml", "metric: gap_undershoot", "metric: gap_undershot", "testbenches/following.yaml:13:16", "unknown metric 'gap_undershot'", "gap_undershoot"),
    ("requirement without a bound", "testbenches/following.yaml", ", at_most: 1 %", "", "testbenches/following.yaml:13:3", "requirement 'R1' has no bound", "at_most"),
    ("not a connection", "testbenches/following.yaml", "controller.torque -> world.torque", "controller.torque world.torque", "testbenches/following.yaml:7:5", "'controller.torque world.torque' is not a connection", "->"),
    ("part named twice", "testbenches/following.yaml", "world: {component: road}", "world: {component: road}\n  sensor: {component: road}", "testbenches/following.yaml:5:3", "'sensor' is a part of the design already", "rename"),
    ("unknown sampler", "testbenches/gains.pet.yaml", "full_factorial", "full_factoral", "testbenches/gains.pet.yaml:5:10", "unknown sampler 'full_factoral'", "full_factorial"),
    ("unknown source kind", "components/pd/component.yaml", "kind: c", "kind: cpp", "components/pd/component.yaml:3:16", "unknown kind of source 'cpp'", "c"),
    ("missing source file", "components/pd/component.yaml", "[pd.c]", "[pe.c]", "components/pd/component.yaml:3:27", "no such file: components/pd/pe.c", "relative to"),
    ("enumeration item", "testbenches/following.yaml", "set_gap: 40 m}", "set_gap: 40 m, sensor.setting: close}", "testbenches/following.yaml:8:56", "'close' is not one of enum[near, far]", "near"),
    ("constraint that says two things", "designs/car.yaml", "because: target price", "forbid: [sensor is radar]", "designs/car.yaml:9:3", "constraint 'budget' says require and forbid", "one of"),
    ("text for a list", "testbenches/following.yaml", "record: [world.gap]", "record: world.gap", "testbenches/following.yaml:9:47", "'simulation.record': expected a list, found 'world.gap'", "[a, b]"),
    ("yes is text in YAML 1.2", "components/pd/component.yaml", "unit: 1/s", "unit: 1/s, tunable: yes", "components/pd/component.yaml:5:56", "'parameters.kp.tunable': expected true or false, found 'yes'", "YAML 1.2"),
    ("port without a unit", "components/road/interfaces.yaml", "gap: m, speed", "gap: [m], speed", "components/road/interfaces.yaml:4:20", "port 'gap' needs a unit or a type", "m/s"),
    ("port in a unit that is not SI", "components/road/interfaces.yaml", "speed: m/s", "speed: km/h", "components/road/interfaces.yaml:4:30", "port 'speed' must be in a coherent SI unit, not 'km/h'", "SI inside"),
    ("syntax of a constraint", "designs/car.yaml", "sum(cost) <= 100 EUR", "sum(cost <= 100 EUR", "designs/car.yaml", "", ""),
]  # fmt: skip


@pytest.mark.parametrize(
    ("file", "old", "new", "where", "what", "hint"), [case[1:] for case in CASES], ids=[case[0] for case in CASES]
)
def test_broken_input_is_named_where_it_stands(files, file, old, new, where, what, hint):
    files.edit(file, old, new)
    at, said, advice = one_problem(files.root)
    assert at.startswith(where)
    assert what in said
    assert hint in advice


def test_a_duplicate_key_names_both_lines(files):
    files.edit("components/pd/component.yaml", "implements: controller", "implements: controller\nimplements: sensor")
    where, what, hint = one_problem(files.root)
    assert where == "components/pd/component.yaml:3:1"
    assert what == "duplicate key 'implements'"
    assert "line 2" in hint


def test_not_yaml_names_the_place(files):
    files.edit("components/pd/component.yaml", "[pd.c]", "[pd.c")
    where, what, _ = one_problem(files.root)
    assert where == "components/pd/component.yaml:3:44"
    assert what.startswith("not valid YAML:")


def test_an_empty_file_says_so(files):
    files.write("designs/car.yaml", "")
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml", "the file is empty")


def test_a_list_at_the_top_is_refused(files):
    files.write("designs/car.yaml", "- a\n- b\n")
    where, what, _ = one_problem(files.root)
    assert where == "designs/car.yaml:1:1"
    assert "expected a mapping" in what


def test_a_folder_is_not_a_file(files):
    (problem,) = problems(Workspace(files.root).design, "designs")
    assert str(problem) == "designs: this is a folder, not a file\n    hint: name one of the YAML files in it"


def test_a_missing_file_hints_at_a_similar_name(files):
    (problem,) = problems(Workspace(files.root).design, "designs/cat.yaml")
    assert str(problem) == "designs/cat.yaml: no such file\n    hint: did you mean car.yaml?"


def test_a_file_that_is_not_utf8_is_refused(files):
    (files.root / "designs/car.yaml").write_bytes(b"design: caf\xe9\n")
    where, what, _ = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml", "not UTF-8 text (byte 11)")


def test_an_unreadable_file_says_why(files, monkeypatch):
    path = files.root / "designs/car.yaml"
    if os.name == "nt" or os.geteuid() == 0:
        # Permissions do not bind an administrator: the system's answer is given in its place.
        real = Path.read_bytes

        def refuse(self: Path) -> bytes:
            if self.name == "car.yaml":
                raise PermissionError(13, "Permission denied")
            return real(self)

        monkeypatch.setattr(Path, "read_bytes", refuse)
    else:
        path.chmod(0)
    where, what, hint = one_problem(files.root)
    assert (where, what) == ("designs/car.yaml", "cannot be read: Permission denied")
    assert "permissions" in hint


def test_files_that_include_each_other_are_refused(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    files.write("designs/more.yaml", "include: [car.yaml]\nconstraints: {}\n")
    where, what, _ = one_problem(files.root)
    assert where == "designs/more.yaml:1:11"
    assert what == "files include each other in a circle: designs/car.yaml -> designs/more.yaml -> designs/car.yaml"


def test_an_included_file_that_is_missing_is_named_at_the_include(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    where, what, _ = one_problem(files.root)
    assert where == "designs/car.yaml:1:11"
    assert what == "included file designs/more.yaml does not exist"


def test_included_constraints_keep_their_own_place(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    files.write("designs/more.yaml", "constraints:\n  mass: {require: sum(mass <= 1 kg}\n")
    where, _, _ = one_problem(files.root)
    assert where.startswith("designs/more.yaml:2:")


def test_a_constraint_in_both_files_is_refused(files):
    files.edit("designs/car.yaml", "design: car", "include: [more.yaml]\ndesign: car")
    files.write("designs/more.yaml", "constraints:\n  budget: {require: sum(cost) <= 1 EUR}\n")
    where, what, hint = one_problem(files.root)
    assert where == "designs/more.yaml:2:3"
    assert "stands in an including file too" in what
    assert "designs/car.yaml:10:3" in hint


def test_all_problems_of_a_file_are_found_at_once(files):
    files.edit("components/radar/component.yaml", "start: 150 m", "start: 150 kg")
    files.edit("components/radar/component.yaml", "cost: 45 EUR", "cost: 45 EURO")
    found = problems(Workspace(files.root).component, "radar")
    assert [p.where.line for p in found] == [6, 8]


def test_aliases_that_stand_for_billions_of_values_are_refused(files):
    lines = ["a: &a [x, x, x, x, x, x, x, x, x, x]"]
    names = "abcdefghij"
    lines += [f"{names[i]}: &{names[i]} [{', '.join([f'*{names[i - 1]}'] * 10)}]" for i in range(1, 10)]
    files.write("designs/car.yaml", "\n".join(lines))
    _, what, _ = one_problem(files.root)
    assert "too large or nested too deeply" in what


def test_no_tag_runs_a_constructor(files):
    files.write("designs/car.yaml", "design: !!python/object/apply:os.getcwd []\n")
    with pytest.raises(DseError):
        Workspace(files.root).design("designs/car.yaml")


def test_deep_nesting_is_refused(files):
    files.write("designs/car.yaml", "a: " + "[" * 5000)
    with pytest.raises(DseError):
        Workspace(files.root).design("designs/car.yaml")


def test_outside_a_workspace_the_hint_is_to_make_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (problem,) = problems(Workspace.around, tmp_path)
    assert "dse init" in problem.hint
