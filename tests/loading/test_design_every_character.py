"""Whatever is broken in a design file of 500 lines is reported at that character."""

from __future__ import annotations

import pytest

from dse.errors import DseError
from dse.loading.workspace import Workspace
from dse.space.check import check_space

COMPONENTS = """\
components:
  radar: {implements: sensor, properties: {cost: 45 EUR, range: 150 m}, parameters: {gain: {start: 2, min: 1, max: 5}}}
  lidar: {implements: sensor, properties: {cost: 400 EUR, range: 250 m}, parameters: {gain: {start: 2, min: 1, max: 9}}}
  pd: {implements: controller, properties: {cost: 10 EUR}}
  motor: {implements: drive, properties: {cost: 300 EUR, mass: 20 kg}}
  gear: {implements: drive, properties: {cost: 700 EUR, mass: 50 kg}}
"""
INTERFACES = """\
interfaces:
  sensor: {outputs: {target: {gap: m, speed: m/s}}}
  controller: {inputs: {target: {gap: m, speed: m/s}}, outputs: {demand: N}}
  drive: {inputs: {demand: N}, outputs: {force: N}}
"""


def unit(number: int) -> str:
    """25 lines of parts and wiring."""
    return f"""\
    unit{number}:
      compound:
        sensor:
          alternatives:
            - radar
            - lidar
        controller: pd
        spare:
          optional: gear
        drive:
          alternatives:
            - motor
            - gear
            - geared:
                implements: drive
                compound:
                  engine: motor
                  final:   {{optional: gear}}
                connections:
                  - demand   ->   engine.demand
                  - engine.force -> force
                constraints:
                  light{number}: {{require: engine.mass < 50 kg and sum(cost) <= 1200 EUR}}
      connections:
        - sensor.target -> controller.target
        - 'controller.demand -> drive.demand'
"""


def rules(number: int) -> str:
    """22 lines of constraints."""
    n = f"unit{number}"
    return f"""\
  budget{number}: {{require: "sum(cost, {n}) <= 2500 EUR", because: 'it''s the price', set: eu}}
  folded{number}:
    require: >-
      {n}.sensor is lidar implies
      {n}.drive is geared
      or {n}.spare.mass * 2 >= 90 kg
      or count(mass, {n}.drive) == 1
  literal{number}:
    require: |
      {n}.sensor.range between 100 m
          and 260 m
      and {n}.sensor.gain.max >= 3
  quoted{number}:
    require: '{n}.sensor is radar or
      {n}.sensor in [lidar, radar]   and {n}.drive is not gear'
  escaped{number}: {{require: "\\x75nit{number}.sensor is radar \\
      or {n}.sensor is lidar"}}
  plain{number}:
    forbid: [{n}.sensor is radar, {n}.spare is present, {n}.controller.cost > 20 EUR]
  pair{number}: {{require_with: {{if: [{n}.spare is present], then: '{n}.drive is gear or true'}}}}
  some{number}: {{at_least: {{1: [{n}.drive is gear, {n}.drive is motor, true or false]}}}}
  span{number}: {{range: {{{n}.sensor.range: [10 m, 260 m], {n}.sensor.gain: [1, 2]}}}}
  same{number}: {{same_choice: [{n}.drive, {n}.spare]}}
"""


UNITS = 10
TEXT = (
    "design: car\ntitle: A long one\nroot:\n  compound:\n"
    + "".join(unit(number) for number in range(UNITS))
    + "constraint_sets:\n  eu: {on: true}\nconstraints:\n"
    + "".join(rules(number) for number in range(UNITS))
)

CASES = [
    # what is found in unit 7 or its rules, what stands there instead with § at the character to be told, the message
    ("            - lidar\n", "            - §lidra\n", "unknown component 'lidra'"),
    ("            - lidar\n", "            - §pd\n", "different interfaces"),
    ("            - lidar\n", "            - §radar\n", "is listed twice"),
    ("            - lidar\n", "            - §3\n", "expected a component's name"),
    ("            - lidar\n", "           §- lidar\n", "not valid YAML"),
    ("          alternatives:\n            - radar", "          §alternative:\n            - radar", "expected a component or a container"),
    ("        controller: pd\n", "        controller: §pdd\n", "unknown component 'pdd'"),
    ("        controller: pd\n", "        §con-troller: pd\n", "'con-troller' cannot be a name"),
    ("        controller: pd\n", "        §sensor: pd\n", "duplicate key 'sensor'"),
    ("        controller: pd\n", "        §and: pd\n", "a word of the expression language"),
    ("          optional: gear\n", "          optional: §gaer\n", "unknown component 'gaer'"),
    ("          optional: gear\n", "          optional: gear\n          §wheels: 4\n", "unknown key 'wheels'"),
    ("                implements: drive\n", "                implements: §drvie\n", "unknown interface 'drvie'"),
    ("                implements: drive\n", "                §implement: drive\n", "unknown key 'implement'"),
    ("- geared:\n                implements: drive\n", "- §geared:\n                implements: sensor\n", "'geared' a sensor"),
    ("                  engine: motor\n", "                  engine: §moter\n", "unknown component 'moter'"),
    ("final:   {optional: gear}", "final:   §{optional: gear", "not valid YAML: { is never closed"),
    ("final:   {optional: gear}", "final:   {optional: §geer}", "unknown component 'geer'"),
    ("- demand   ->   engine.demand", "- demand   ->   engine.§demnad", "has no port 'demnad'"),
    ("- demand   ->   engine.demand", "- §demnad   ->   engine.demand", "has no port 'demnad'"),
    ("- demand   ->   engine.demand", "- demand   ->   §enigne.demand", "has no port 'enigne.demand'"),
    ("- demand   ->   engine.demand", "- §demand   ~   engine.demand", "is not a connection"),
    ("- demand   ->   engine.demand", "- §force   ->   engine.demand", "no signal goes this way"),
    ("- engine.force -> force", "- engine.force -> §forces", "has no port 'forces'"),
    ("- engine.force -> force", "- engine.§torque -> force", "has no port 'torque'"),
    ("- sensor.target -> controller.target", "- sensor.target -> controller.§tagret", "has no port 'tagret'"),
    ("- sensor.target -> controller.target", "- §snesor.target -> controller.target", "unknown part 'snesor'"),
    ("- 'controller.demand -> drive.demand'", "- 'controller.demand -> drive.§damend'", "has no port 'damend'"),
    ("- 'controller.demand -> drive.demand'", "- §'controller.demand -> drive.demand", "is never closed"),
    ("{require: engine.mass < 50 kg", "{require: §enigne.mass < 50 kg", "'enigne' is not a part of 'unit7.drive.geared'"),
    ("{require: engine.mass < 50 kg", "{require: engine.§mas < 50 kg", "nothing at 'unit7.drive.engine' states 'mas'"),
    ("{require: engine.mass < 50 kg", "{require: engine.mass < §50 m", "cannot compare mass and length"),
    ("{require: engine.mass < 50 kg", "{require: engine.mass < 50 §kgs", "unknown unit 'kgs'"),
    ("sum(cost) <= 1200 EUR}", "sum(§csot) <= 1200 EUR}", "no component states 'csot'"),
    ("sum(cost) <= 1200 EUR}", "sum§(cost <= 1200 EUR}", "'(' is never closed"),
    ("sum(cost) <= 1200 EUR}", "§smu(cost) <= 1200 EUR}", "unknown function 'smu'"),
    ("sum(cost) <= 1200 EUR}", "sum(cost) §<> 1200 EUR}", "'<>' is not known here"),
    ("sum(cost) <= 1200 EUR}", "§sum(cost)}", "expected a condition"),
    ('"sum(cost, unit7) <= 2500 EUR"', '"sum(cost, §unti7) <= 2500 EUR"', "unknown place 'unti7'"),
    ('"sum(cost, unit7) <= 2500 EUR"', '"sum(cost, unit7) §= 2500 EUR"', "'=' gives an option"),
    ('"sum(cost, unit7) <= 2500 EUR"', '"sum§(cost, unit7 <= 2500 EUR"', "'(' is never closed"),
    ('"sum(cost, unit7) <= 2500 EUR"', "§5", "expected text, found 5"),
    ("because: 'it''s the price', set: eu", "§becuase: 'it''s the price', set: eu", "unknown key 'becuase'"),
    ("because: 'it''s the price', set: eu", "because: 'it''s the price', set: §ue", "unknown set 'ue'"),
    ("      unit7.drive is geared\n", "      unit7.drive is §gaered\n", "'gaered' cannot be chosen"),
    ("      unit7.drive is geared\n", "      unit7.§dirve is geared\n", "unknown place 'unit7.dirve'"),
    ("      or unit7.spare.mass * 2 >= 90 kg\n", "      or unit7.spare.mass * 2 >= §90 s\n", "cannot compare mass and time"),
    ("      or unit7.spare.mass * 2 >= 90 kg\n", "      or unit7.spare.mass * 2 §=> 90 kg\n", "'=>' is not known here"),
    ("      or unit7.spare.mass * 2 >= 90 kg\n", "      or §(unit7.spare.mass * 2 >= 90 kg\n", "'(' is never closed"),
    ("      or count(mass, unit7.drive) == 1\n", "      or count(mass, unit7.§driv) == 1\n", "unknown place 'unit7.driv'"),
    ("      or count(mass, unit7.drive) == 1\n", "      or count(mass, unit7.drive) == §1 kg\n", "cannot compare a plain number and mass"),
    ("          and 260 m\n", "          and 260 §mmm\n", "unknown unit 'mmm'"),
    ("          and 260 m\n", "          §nad 260 m\n", "expected 'and', found 'nad'"),
    ("      and unit7.sensor.gain.max >= 3\n", "      and unit7.sensor.§gian.max >= 3\n", "has a parameter 'gian'"),
    ("      and unit7.sensor.gain.max >= 3\n", "      and unit7.sensor.gain.max >= §3 m\n", "cannot compare a plain number and length"),
    ("[lidar, radar]   and unit7.drive is not gear'", "[lidar, §radra]   and unit7.drive is not gear'", "'radra' cannot be chosen"),
    ("[lidar, radar]   and unit7.drive is not gear'", "[lidar, radar   §and unit7.drive is not gear'", "']', found 'and'"),
    ("[lidar, radar]   and unit7.drive is not gear'", "[lidar, radar]   and unit7.drive is not §gaer'", "'gaer' cannot be chosen"),
    ('\\x75nit7.sensor is radar \\\n      or unit7.sensor is lidar"', '\\x75nit7.sensor is radar \\\n      or unit7.sensor is §lidra"', "'lidra' cannot be chosen"),
    ('\\x75nit7.sensor is radar \\\n', '\\x75nit7.§snesor is radar \\\n', "unknown place 'unit7.snesor'"),
    ("unit7.controller.cost > 20 EUR]", "unit7.controller.cost > §20 km]", "cannot compare currency and length"),
    ("unit7.controller.cost > 20 EUR]", "unit7.controller.§csot > 20 EUR]", "states 'csot'"),
    ("unit7.controller.cost > 20 EUR]", "unit7.controller.cost §» 20 EUR]", "'»' is not known here"),
    ("{if: [unit7.spare is present]", "{if: [unit7.spare is §presnt]", "'presnt' cannot be chosen"),
    ("{if: [unit7.spare is present]", "{§fi: [unit7.spare is present]", "unknown key 'fi'"),
    ("then: 'unit7.drive is gear or true'", "then: 'unit7.drive is gear or §tru'", "unknown name 'tru'"),
    ("then: 'unit7.drive is gear or true'", "then: 'unit7.drive is gear or§'", "expected a value, found the end"),
    ("{1: [unit7.drive is gear,", "{§4: [unit7.drive is gear,", "4 of 3 conditions can never hold"),
    ("{1: [unit7.drive is gear,", "{1: [unit7.drive is §gaer,", "'gaer' cannot be chosen"),
    ("[10 m, 260 m]", "[10 §mq, 260 m]", "unknown unit 'mq'"),
    ("[10 m, 260 m]", "[§10 kg, 260 kg]", "cannot compare mass and length"),
    ("unit7.sensor.gain: [1, 2]", "unit7.sensor.§gian: [1, 2]", "property or parameter 'gian'"),
    ("same_choice: [unit7.drive, unit7.spare]", "same_choice: [unit7.drive, unit7.§spaer]", "unknown place 'unit7.spaer'"),
    ("same_choice: [unit7.drive, unit7.spare]", "same_choice: [unit7.drive, §3]", "expected text, found 3"),
    ("same_choice: [unit7.drive, unit7.spare]", "§sane_choice: [unit7.drive, unit7.spare]", "unknown key 'sane_choice'"),
]  # fmt: skip


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    root = tmp_path_factory.mktemp("long")
    (root / "components").mkdir()
    (root / "designs").mkdir()
    (root / "components/parts.yaml").write_text(COMPONENTS, encoding="utf-8")
    (root / "components/interfaces.yaml").write_text(INTERFACES, encoding="utf-8")
    return root


def problems(workspace, text):
    (workspace / "designs/car.yaml").write_text(text, encoding="utf-8")
    try:
        return list(check_space(Workspace(workspace).design("car")))
    except DseError as error:
        return list(error.problems)


def test_the_unbroken_file_has_500_lines_and_no_problem(workspace):
    assert TEXT.count("\n") >= 500 - 30
    assert problems(workspace, TEXT) == []


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("old", "new", "what"), CASES, ids=[new.strip() for _, new, _ in CASES])
def test_the_character_that_is_broken_is_told(workspace, old, new, what):
    start = TEXT.index("    unit7:") if old in unit(7) else TEXT.index("  budget7:")
    at = TEXT.index(old, start)
    broken = TEXT[:at] + new + TEXT[at + len(old) :]
    mark = broken.index("§")
    expected = (broken.count("\n", 0, mark) + 1, mark - broken.rfind("\n", 0, mark))
    found = problems(workspace, broken.replace("§", ""))
    assert found
    told = [(problem.where.line, problem.where.column, problem.what) for problem in found]
    assert expected == told[0][:2], told
    assert what in told[0][2]
