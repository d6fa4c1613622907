"""What says nothing does not stop a file: it is listed as ignored."""

from __future__ import annotations

from pathlib import Path

from scenario_texts import car, private, scenario, teleport, world

from dse.world import read_scenario

EVENT = """
<Story name="s"><Act name="a"><ManeuverGroup name="g" maximumExecutionCount="1">
  <Actors selectTriggeringEntities="false"><EntityRef entityRef="One"/></Actors>
  <Maneuver name="m"><Event name="e" priority="override"><Action name="empty"/>
    <StartTrigger><ConditionGroup><Condition name="criterion" delay="0" conditionEdge="rising"><ByValueCondition>
      <ParameterCondition parameterRef="" value="" rule="lessThan"/>
    </ByValueCondition></Condition></ConditionGroup></StartTrigger>
  </Event></Maneuver>
</ManeuverGroup></Act></Story>
"""


def test_an_empty_action_and_a_condition_that_names_nothing_are_ignored(tmp_path: Path) -> None:
    path = tmp_path / "x.xosc"
    path.write_text(scenario(car("One"), private("One", teleport(world(0, 0))), EVENT), "utf-8")
    read = read_scenario(path)
    assert [problem.what.partition(":")[0] for problem in read.ignored] == ["<Action>", "<ParameterCondition>"]
    assert [element.kind for element in read.elements][-2:] == ["event", "action"]
