"""The ways to write a constraint, in files: what each comes down to, and which configurations it leaves."""

from __future__ import annotations

import pytest

from dse.domain.component import NO_INTERFACE
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.loading.workspace import Workspace
from dse.space.check import check_space
from dse.space.restriction.constraint_sets import switched
from dse.space.space import open_space

COMPONENTS = """\
components:
  radar: {properties: {cost: 45 EUR, range: 150 m}, parameters: {gain: {start: 2, min: 1, max: 5}, delay: {start: 1 s, min: 0 s, max: 3 s}}}
  lidar: {properties: {cost: 400 EUR, range: 250 m}, parameters: {gain: {start: 2, min: 2, max: 9}, delay: {start: 1 s, min: 0 s, max: 9 s}}}
  camera: {properties: {cost: 20 EUR, range: 80 m}, parameters: {gain: {start: 2, min: 0.5, max: 3}, delay: {start: 1 s, min: 1 s, max: 9 s}}}
  pd: {properties: {cost: 10 EUR}}
  pi: {properties: {cost: 30 EUR}}
  otto: {properties: {cost: 900 EUR, mass: 90 kg}}
  diesel: {properties: {cost: 1200 EUR, mass: 140 kg}}
  small: {properties: {cost: 300 EUR, mass: 20 kg}}
  large: {properties: {cost: 700 EUR, mass: 50 kg}}
"""
DESIGN = """\
design: car
root:
  compound:
    sensor: {alternatives: [radar, lidar, camera]}
    spare: {optional: camera}
    controller: {alternatives: [pd, pi]}
    drive:
      alternatives:
        - otto
        - hybrid:
            compound:
              engine: {alternatives: [otto, diesel]}
              machine: {alternatives: [small, large]}
            constraints: INNER
        - electric:
            compound: {machine: {alternatives: [small, large]}}
    trailer:
      optional:
        compound: {axle: {alternatives: [small, large]}, hitch: {optional: small}}
        constraints: TRAILER
constraint_sets: SETS
constraints: RULES
"""


@pytest.fixture
def design(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "components").mkdir()
    (tmp_path / "designs").mkdir()
    (tmp_path / "components/parts.yaml").write_text(COMPONENTS, encoding="utf-8")

    def read(rules="{}", inner="{}", trailer="{}", sets="{}"):
        text = DESIGN
        for name, given in {"RULES": rules, "INNER": inner, "TRAILER": trailer, "SETS": sets}.items():
            text = text.replace(name, given)
        (tmp_path / "designs/car.yaml").write_text(text, encoding="utf-8")
        return Workspace(tmp_path).design("car")

    return read


def left(space):
    assert check_space(space) == []
    return {configuration.id for configuration in open_space(space).configurations()}


def text_of(space):
    (constraint,) = space.constraints
    assert parse_expression(constraint.rule.text).root == constraint.rule.root, "the text says what the tree says"
    return constraint.rule.text


def refused(read, *arguments, **options):
    with pytest.raises(DseError) as caught:
        read(*arguments, **options)
    return [(f"{p.where.line}:{p.where.column}", p.what, p.hint) for p in caught.value.problems]


FORMS = [
    ("{require: sum(cost) <= 9 EUR}", "sum(cost) <= 9 EUR"),
    ("{forbid: [sensor is radar]}", "not (sensor is radar)"),
    ("{forbid: [sensor is radar, controller is pd or drive is otto]}", "not (sensor is radar and (controller is pd or drive is otto))"),
    ("{require_with: {if: sensor is lidar, then: controller is pi}}", "sensor is lidar implies controller is pi"),
    ("{require_with: {if: [sensor is lidar, true xor false], then: [controller is pi, drive is otto]}}", "sensor is lidar and (true xor false) implies controller is pi and drive is otto"),
    ("{require_with: {if: true implies false, then: if true then false else true}}", "(true implies false) implies (if true then false else true)"),
    ("{same_choice: [drive.machine, trailer.axle]}", "same_choice(drive.machine, trailer.axle)"),
    ("{at_least: {2: [sensor is radar, controller is pd, drive is otto]}}", "at_least(2, sensor is radar, controller is pd, drive is otto)"),
    ("{at_most: {1: [sensor is radar or sensor is lidar, drive is otto]}}", "at_most(1, sensor is radar or sensor is lidar, drive is otto)"),
    ("{exactly: {0: [spare is present]}}", "exactly(0, spare is present)"),
    ("{range: {sensor.range: [100 m, 250 m]}}", "sensor.range between 100 m and 250 m"),
    ("{range: {sensor.range: [-1 km, 250 m], sensor.cost: [0 EUR, 1 kEUR]}}", "sensor.range between -1 km and 250 m and sensor.cost between 0 EUR and 1 kEUR"),
    ("{range: {sensor.gain: [1, 3]}}", "sensor.gain.min <= 1 and sensor.gain.max >= 3"),
    ("{range: {sensor.delay: [0.5, 3000 ms]}}", "sensor.delay.min <= 0.5 s and sensor.delay.max >= 3000 ms"),
]  # fmt: skip


@pytest.mark.parametrize(("form", "condition"), FORMS, ids=[form for form, _ in FORMS])
def test_every_form_is_one_condition_with_the_same_configurations(design, form, condition):
    space = design(f"{{rule: {form}}}")
    assert text_of(space) == condition
    assert left(space) == left(design(f'{{rule: {{require: "{condition}"}}}}'))


def test_a_range_of_a_parameter_keeps_the_components_that_cover_it(design):
    space = design("{gains: {range: {sensor.gain: [1, 3]}}, delays: {range: {sensor.delay: [0.5 s, 2 s]}}}")
    assert {configuration.choices["sensor"] for configuration in open_space(space).configurations()} == {"radar"}


def test_at_least_two_of_three_leaves_what_counting_by_hand_leaves(design):
    space = design("{two: {at_least: {2: [sensor is radar, controller is pd, spare is present]}}}")
    kept = [c.choices for c in open_space(space).configurations()]
    whole = [c.choices for c in open_space(design()).configurations()]
    assert kept == [c for c in whole if (c["sensor"] == "radar") + (c["controller"] == "pd") + ("spare" in c) >= 2]


WITHIN = [
    ("inner", "sum(mass) <= 150 kg", "drive is hybrid implies sum(mass, drive) <= 150 kg"),
    ("inner", "mass <= 150 kg", "drive is hybrid implies sum(mass, drive) <= 150 kg"),
    ("inner", "engine.mass < 2 * machine.mass", "drive is hybrid implies drive.engine.mass < 2 * drive.machine.mass"),
    ("inner", "max(cost, engine) <= 1 kEUR", "drive is hybrid implies max(cost, drive.engine) <= 1 kEUR"),
    ("inner", "min(engine.mass, 30 kg) >= 30 kg", "drive is hybrid implies min(drive.engine.mass, 30 kg) >= 30 kg"),
    ("inner", "(engine) is otto iff machine in [small]", "drive is hybrid implies ((drive.engine) is otto iff drive.machine in [small])"),
    ("inner", "same_choice(engine, machine) implies count((cost)) == 2", "drive is hybrid implies same_choice(drive.engine, drive.machine) implies count((cost), drive) == 2"),
    ("trailer", "hitch is present", "trailer is present implies trailer.hitch is present"),
    ("trailer", "at_most(1, axle is small, hitch is small)", "trailer is present implies at_most(1, trailer.axle is small, trailer.hitch is small)"),
]  # fmt: skip


@pytest.mark.parametrize(("where", "own", "whole"), WITHIN, ids=[own for _, own, _ in WITHIN])
def test_a_constraint_in_a_container_has_its_names_and_holds_where_it_is_there(design, where, own, whole):
    space = design(**{where: f'{{rule: {{require: "{own}"}}}}'})
    assert text_of(space) == whole
    assert left(space) == left(design(f'{{rule: {{require: "{whole}"}}}}'))


def test_a_constraint_in_an_architecture_leaves_the_other_architectures_alone(design):
    everything = list(open_space(design()).configurations())
    kept = left(design(inner="{none: {require: 1 > 2}}"))
    assert kept == {c.id for c in everything if c.choices["drive"] != "hybrid"}
    kept = left(design(trailer="{none: {forbid: [axle is small]}}"))
    assert kept == {c.id for c in everything if c.choices.get("trailer.axle") != "small"}


def test_a_constraint_in_a_container_is_named_after_it(design):
    space = design(
        "{budget: {require: 1 < 2}}", inner="{budget: {require: 1 < 2}}", trailer="{budget: {require: 1 < 2}}"
    )
    assert [c.name for c in space.constraints] == ["budget", "drive.hybrid: budget", "trailer: budget"]


def test_nested_architectures_guard_with_every_choice_on_the_way(tmp_path, design):
    inner = "{alternatives: [small, {twin: {compound: {left: small, right: large}, constraints: {same: {same_choice: [left, right]}}}}]}"
    text = DESIGN.replace("{alternatives: [otto, diesel]}", inner)
    for name in ("RULES", "INNER", "TRAILER", "SETS"):
        text = text.replace(name, "{}")
    (tmp_path / "designs/car.yaml").write_text(text, encoding="utf-8")
    space = Workspace(tmp_path).design("car")
    assert text_of(space) == (
        "drive is hybrid and drive.engine is twin implies same_choice(drive.engine.left, drive.engine.right)"
    )
    assert space.constraints[0].name == "drive.hybrid.engine.twin: same"
    assert all(c.choices.get("drive.engine") != "twin" for c in open_space(space).configurations())


def test_constraints_of_the_root_and_of_the_file_share_their_names(tmp_path, design):
    design("{budget: {require: 1 < 2}}")
    path = tmp_path / "designs/car.yaml"
    text = path.read_text(encoding="utf-8").replace("root:\n", "root:\n  constraints: {budget: {require: 1 > 2}}\n")
    path.write_text(text, encoding="utf-8")
    ((where, what, hint),) = refused(lambda: Workspace(tmp_path).design("car"))
    assert where == "3:17"
    assert what == "there is a constraint 'budget' already"
    assert "designs/car.yaml:23:15" in hint


SETS = "{eu: {on: true, title: Europe}, us: {on: false}}"
RULES = (
    "{a: {require: sensor is radar, set: eu}, b: {require: controller is pi, set: us}, c: {require: spare is absent}}"
)


def test_only_constraints_that_are_on_count(design):
    space = design(RULES, sets=SETS)
    assert [c.name for c in space.constraints] == ["a", "c"]
    assert [c.name for c in space.all_constraints] == ["a", "b", "c"]
    assert [(s.name, s.on, s.title) for s in space.sets] == [("eu", True, "Europe"), ("us", False, "")]


@pytest.mark.parametrize(
    ("on", "off", "names"),
    [((), (), "ac"), (["us"], (), "abc"), (["us"], ["eu"], "bc"), ((), ["eu", "us"], "c"), (["eu"], (), "ac")],
)
def test_sets_are_switched_on_and_off(design, on, off, names):
    space = switched(design(RULES, sets=SETS), on, off)
    assert "".join(c.name for c in space.constraints) == names
    assert switched(space, ["eu"], ["us"]) == design(RULES, sets=SETS)


def test_a_container_constraint_may_belong_to_a_set(design):
    space = design(inner="{light: {require: sum(mass) <= 100 kg, set: us}}", sets=SETS)
    assert space.constraints == ()
    assert [c.name for c in switched(space, on=["us"]).constraints] == ["drive.hybrid: light"]


def test_a_set_that_does_not_exist_is_refused_with_the_one_that_is_meant(design):
    space = design(RULES, sets=SETS)
    with pytest.raises(DseError) as caught:
        switched(space, on=["euu", "us"], off=["us"])
    assert [p.what for p in caught.value.problems] == [
        "'car' has no constraint set 'euu'",
        "constraint set 'us' cannot be on and off",
    ]
    assert "did you mean 'eu'" in caught.value.problems[0].hint
    (found,) = refused(design, "{a: {require: 1 < 2, set: euu}}", sets=SETS)
    assert found == ("22:40", "unknown set 'euu'", "did you mean 'eu'?")


def test_what_is_wrong_in_a_set_that_is_off_is_found(design):
    space = design("{a: {require: sensr is radar, set: us}}", sets=SETS)
    assert [p.what for p in check_space(space)] == ["unknown place 'sensr'"]


def test_components_without_source_and_interface_are_enumerated(design):
    space = design()
    assert all(
        part.interface == NO_INTERFACE and part.source is None
        for part in next(open_space(space).configurations()).parts.values()
    )
    assert check_space(space) == []


REFUSED = [
    # the constraint, what is said, part of the hint; the place is where § stands
    ("{§a: {because: x}}", "constraint 'a' is empty", "give one of require"),
    ("{§a: {require: tt, range: {sensor.range: [1 m, 2 m]}}}", "constraint 'a' has require and range", "one of"),
    ("{a: {require_with: {if: tt, §than: tt}}}", "unknown key 'than'", "then"),
    ("{a: {§require_with: {if: tt}}}", "'then' is missing", "then"),
    ("{a: {require_with: {if: tt, then: [tt, sensor §= radar]}}}", "'=' gives an option", "=="),
    ("{a: {§at_least: {1: [tt], 2: [tt]}}}", "'at_least' needs one number", "at_least"),
    ("{a: {require_with: {§if: [], then: [tt]}}}", "'if' is empty", "then"),
    ("{a: {at_least: {§-1: [tt]}}}", "'-1' is not a whole number, 0 or more", "at_least"),
    ("{a: {range: {§sensor: [0, 1]}}}", "'sensor' gives no property or parameter", "place.property"),
    ("{a: {require: §true}}", "expected text, found true", "quote"),
    ("{a: {forbid: [§null]}}", "expected text, found nothing", "quote"),
    ("{a: {require: §[c]}}", "expected text, found a list", "quote"),
    ("{a: {at_least: {§two: [tt]}}}", "'two' is not a whole number", "at_least"),
    ("{a: {at_least: {§3: [tt, ff]}}}", "3 of 2 conditions can never hold", "smaller"),
    ("{a: {exactly: {§1: []}}}", "'exactly' needs at least one condition", ""),
    ("{a: {exactly: {1: [tt, tru§)]}}}", "expected an operator", ""),
    ("{a: {at_least: {1: [tt and ff, 1 m <§]}}}", "expected a value", ""),
    ("{a: {forbid: §[]}}", "'forbid' needs at least one condition", ""),
    ("{a: {forbid: [tt§) or (tt]}}", "expected an operator or the end", ""),
    ("{a: {same_choice: §[]}}", "'same_choice' needs at least two places", ""),
    ("{a: {same_choice: [sensor, §sensor is radar]}}", "'sensor is radar' is not a place", "same_choice"),
    ("{a: {range: §{}}}", "'range' names nothing", ""),
    ("{a: {range: {§sensr.range: [1 m, 2 m]}}}", "'sensr.range' names no part", "place.property"),
    ("{a: {range: {sensor.§rang: [1 m, 2 m]}}}", "nothing at 'sensor' has a property or parameter 'rang'", "range"),
    ("{a: {range: {sensor.range: §[1 m]}}}", "'sensor.range': expected two ends, found 1", "low, high"),
    ("{a: {range: {sensor.range: [§2 m, 1 m]}}}", "the range of 'sensor.range' is empty: 2 m … 1 m", "low, then"),
    ("{a: {range: {sensor.range: [1 m, 2 §mm2x]}}}", "unknown unit 'mm2x'", ""),
    ("{a: {range: {sensor.range: [1 m, §sensor]}}}", "'sensor' is not a quantity", "70 km/h"),
    ("{a: {range: {sensor.range: [1 m, §.inf]}}}", "not a finite number", ""),
    ("{§2a: {require: tt}}", "'2a' cannot be a name", "letters"),
]  # fmt: skip


@pytest.mark.parametrize(("rules", "what", "hint"), REFUSED, ids=[rules for rules, *_ in REFUSED])
def test_a_form_that_makes_no_sense_is_refused_where_it_stands(design, rules, what, hint):
    found = refused(design, rules.replace("§", ""))
    where, said, advice = found[0]
    assert where == f"22:{len('constraints: ') + 1 + rules.index('§')}"
    assert what in said
    assert hint in advice


def test_names_in_a_container_are_its_own(design):
    found = refused(design, inner='{a: {require: "sensor is radar and engine.mass > 1 kg and moter.mass > 2 kg"}}')
    assert [(what, hint) for _, what, hint in found] == [
        ("'sensor' is not a part of 'drive.hybrid'", "possible: engine, machine"),
        ("'moter' is not a part of 'drive.hybrid'", "possible: engine, machine"),
    ]
    line = '            constraints: {a: {require: "'
    second = len("sensor is radar and engine.mass > 1 kg and ")
    assert [where for where, *_ in found] == [f"14:{len(line) + 1}", f"14:{len(line) + 1 + second}"]


def test_a_property_and_parameter_of_one_name_is_refused_as_a_range(design, tmp_path):
    path = tmp_path / "components/parts.yaml"
    path.write_text(COMPONENTS.replace("gain: {start: 2, min: 1", "range: {start: 2, min: 1"), encoding="utf-8")
    ((where, what, hint),) = refused(design, "{a: {range: {sensor.range: [1 m, 2 m]}}}")
    assert (where, what) == ("22:27", "'range' is a property and a parameter of what is at 'sensor'")
    assert "sensor.range.min" in hint


def test_what_is_wrong_inside_a_container_points_into_the_container(design):
    space = design(inner="{a: {require: sum(mass) <= 3 EUR}}")
    (problem,) = check_space(space)
    assert (problem.where.line, problem.where.column) == (14, 12 + len("constraints: {a: {require: sum(mass) <= ") + 1)
    assert "cannot compare mass and currency" in problem.what
