"""Triggers and their conditions → rows of the tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from dse.errors import closest, fail
from dse.world.openscenario.actions import Actions, seconds
from dse.world.openscenario.document import Node
from dse.world.openscenario.tables import NONE

Row = dict[str, object]

_RULES = {
    "greaterThan": "GREATER", "lessThan": "LESS", "equalTo": "EQUAL", "greaterOrEqual": "GREATER_OR_EQUAL",
    "lessOrEqual": "LESS_OR_EQUAL", "notEqualTo": "NOT_EQUAL",
}  # fmt: skip
_EDGES = {"none": "NO_EDGE", "rising": "RISING", "falling": "FALLING", "risingOrFalling": "RISING_OR_FALLING"}
_DISTANCES = {
    "longitudinal": "LONGITUDINALLY", "lateral": "LATERALLY", "cartesianDistance": "EUCLIDIAN",
    "euclidianDistance": "EUCLIDIAN",
}  # fmt: skip
_SYSTEMS = {"entity": "OF_ENTITY", "lane": "OF_ROAD", "road": "OF_ROAD", "trajectory": "OF_ROAD"}
_STATES = {
    "standbyState": "ON_STANDBY", "runningState": "ON_RUNNING", "completeState": "ON_COMPLETE",
    "startTransition": "ON_START", "endTransition": "ON_END", "stopTransition": "ON_STOP", "skipTransition": "ON_SKIP",
}  # fmt: skip
_MEASURING = {"IF_REACHED", "IF_DISTANCE", "IF_RELATIVE_DISTANCE", "IF_HEADWAY", "IF_TIME_TO_COLLISION"}
_DIRECTIONS = {"longitudinal": "LONGITUDINALLY", "lateral": "LATERALLY"}
_ELEMENTS = {
    "story": "STORY", "act": "ACT", "maneuverGroup": "GROUP", "maneuver": "MANEUVER", "event": "EVENT",
    "action": "ACTION",
}  # fmt: skip
ElementNames = Mapping[str, Sequence[tuple[str, int]]]
"""Elements by kind: their full names, with "/" between the levels, and their rows."""


@dataclass(slots=True)
class Conditions:
    """Makes rows of triggers; *elements* are known once the storyboard was read."""

    actions: Actions
    elements: ElementNames

    def trigger(self, node: Node | None) -> int:
        """The row of a <StartTrigger> or <StopTrigger>; NONE where there is none, or no condition in it."""
        tables = self.actions.layout.tables
        groups = [list(group.all("Condition")) for group in node.all("ConditionGroup")] if node else []
        if not any(groups):
            return NONE
        # Rows of a group are side by side, and so are the groups.
        rows = [[self._condition(each) for each in group] for group in groups]
        ranges = []
        for group in rows:
            first = tables.count("conditions")
            for row in group:
                tables.add("conditions", row)
            ranges.append({"first": first, "count": len(group)})
        first = tables.count("groups")
        for each in ranges:
            tables.add("groups", each)
        return tables.add("triggers", {"first": first, "count": len(ranges)})

    def _condition(self, node: Node) -> Row:
        tables = self.actions.layout.tables
        row: Row = {
            "kind": "IF_ALWAYS", "edge": node.word("conditionEdge", _EDGES, "none"), "rule": "EQUAL",
            "delay": tables.number(node.number("delay", 0.0)), "needs_all": False,
            "first": 0, "count": 0, "entity": NONE, "position": NONE, "variable": 0, "element": 0, "state": NONE,
            "distance": "LONGITUDINALLY", "system": "OF_ENTITY", "direction": NONE, "is_freespace": False,
            "takes_opposite": False, "listed": 0, "listed_count": 0,
            "numbers": [0] * 4,
        }  # fmt: skip
        choice = node.only()
        if choice.tag == "ByValueCondition":
            kind = choice.only()
            make_value = _BY_VALUE.get(kind.tag)
            if make_value is None:
                raise kind.unsupported()
            return row | make_value(self, kind)
        if choice.tag != "ByEntityCondition":
            raise choice.unsupported()
        who = choice.need("TriggeringEntities")
        entities = [self.actions.layout.entity(each) for each in who.all("EntityRef")]
        row["needs_all"] = who.word("triggeringEntitiesRule", {"any": False, "all": True}, "any")
        kind = choice.need("EntityCondition").only()
        make = _BY_ENTITY.get(kind.tag)
        if make is None:
            raise kind.unsupported()
        row |= make(self, kind)
        row["first"], row["count"] = tables.count("triggering"), len(entities)
        for each in entities:
            key = each, *(row[name] for name in ("entity", "position", "distance", "system", "is_freespace"))
            gap = tables.gaps.setdefault(key, len(tables.gaps)) if row["kind"] in _MEASURING else NONE
            tables.add("triggering", {"entity": each, "gap": gap})
        return row

    def _numbers(self, node: Node, *names: str) -> list[int]:
        return [self.actions.layout.tables.number(node.number(name)) for name in names] + [0] * (4 - len(names))

    def _compared(self, node: Node, kind: str, name: str = "value") -> Row:
        return {"kind": kind, "rule": node.word("rule", _RULES), "numbers": self._numbers(node, name)}

    def time(self, node: Node) -> Row:
        """<SimulationTimeCondition>."""
        return self._compared(node, "IF_TIME")

    def variable(self, node: Node) -> Row:
        """<VariableCondition> and <ParameterCondition>."""
        tables = self.actions.layout.tables
        reference = "variableRef" if node.tag == "VariableCondition" else "parameterRef"
        if not node.has(reference):  # some programs keep criteria of their own so
            node.ignore("names nothing, and is never true")
            return {"kind": "IF_TIME", "rule": "LESS", "numbers": [tables.number(-1.0), 0, 0, 0]}
        name = node.text(reference)
        if name not in tables.variables:
            raise fail(f"there is no variable '{name}'", node.where, closest(name, tables.variables))
        rule = node.word("rule", _RULES)
        number = tables.number(tables.compared(node.value("value")))
        return {"kind": "IF_VARIABLE", "rule": rule, "variable": tables.variable(name), "numbers": [number, 0, 0, 0]}

    def clock(self, node: Node) -> Row:
        """<TimeOfDayCondition>."""
        tables = self.actions.layout.tables
        number = tables.number(seconds(node, "dateTime"))
        return {"kind": "IF_CLOCK", "rule": node.word("rule", _RULES), "numbers": [number, 0, 0, 0]}

    def signal(self, node: Node) -> Row:
        """<TrafficSignalCondition> and <TrafficSignalControllerCondition>."""
        tables = self.actions.layout.tables
        if node.tag == "TrafficSignalCondition":
            kind, name, shown = "TrafficSignal", node.text("name"), node.text("state")
        else:
            self.actions.layout.phase(node)
            kind, name, shown = "TrafficSignalController", node.text("trafficSignalControllerRef"), node.text("phase")
        number = tables.number(tables.compared(shown))
        return {"kind": "IF_VARIABLE", "variable": tables.signal(kind, name), "numbers": [number, 0, 0, 0]}

    def state(self, node: Node) -> Row:
        """<StoryboardElementStateCondition>."""
        kind = node.word("storyboardElementType", {k: k for k in _ELEMENTS})
        name = node.text("storyboardElementRef").replace("::", "/")
        listed = self.elements.get(kind, ())
        found = [row for full, row in listed if full == name or full.endswith("/" + name)]
        if not found:
            names = [full.rsplit("/", 1)[-1] for full, _ in listed]
            raise fail(f"the storyboard has no {kind} '{name}'", node.where, closest(name, names))
        return {"kind": "IF_STATE", "element": found[0], "state": node.word("state", _STATES)}

    def speed(self, node: Node) -> Row:
        """<SpeedCondition>, <RelativeSpeedCondition> and <AccelerationCondition>."""
        kinds = {"SpeedCondition": "IF_SPEED", "RelativeSpeedCondition": "IF_RELATIVE_SPEED"}
        row = self._compared(node, kinds.get(node.tag, "IF_ACCELERATION"))
        if node.has("direction"):
            row["direction"] = node.word("direction", _DIRECTIONS)
        return row | self._entity(node)

    def _entity(self, node: Node) -> Row:
        return {"entity": self.actions.layout.entity(node)} if node.has("entityRef") else {}

    def lasting(self, node: Node) -> Row:
        """<StandStillCondition>, <EndOfRoadCondition> and <OffroadCondition>."""
        kinds = {"StandStillCondition": "IF_STANDSTILL", "EndOfRoadCondition": "IF_END_OF_ROAD"}
        kind = kinds.get(node.tag, "IF_OFF_ROAD")
        self.actions.layout.tables.has_off_road |= kind == "IF_OFF_ROAD"
        return {"kind": kind, "numbers": self._numbers(node, "duration")}

    def travelled(self, node: Node) -> Row:
        """<TraveledDistanceCondition>."""
        return {"kind": "IF_TRAVELLED", "numbers": self._numbers(node, "value")}

    def reached(self, node: Node) -> Row:
        """<ReachPositionCondition>."""
        position = self.actions.layout.position(node.need("Position"))
        numbers = self._numbers(node, "tolerance")
        return {"kind": "IF_REACHED", "position": position, "distance": "EUCLIDIAN", "numbers": numbers}

    def distance(self, node: Node) -> Row:
        """<DistanceCondition>, <RelativeDistanceCondition> and <TimeHeadwayCondition>."""
        kinds = {"DistanceCondition": "IF_DISTANCE", "RelativeDistanceCondition": "IF_RELATIVE_DISTANCE"}
        row = self._compared(node, kinds.get(node.tag, "IF_HEADWAY")) | self._measured(node) | self._entity(node)
        if node.tag == "DistanceCondition":
            row["position"] = self.actions.layout.position(node.need("Position"))
        return row

    def _measured(self, node: Node) -> Row:
        along = node.flag("alongRoute")
        system = "lane" if along else "entity"
        default = "longitudinal" if along else "euclidianDistance"
        return {
            "distance": node.word("relativeDistanceType", _DISTANCES, default),
            "system": node.word("coordinateSystem", _SYSTEMS, system),
            "is_freespace": node.flag("freespace"),
        }

    def time_to_collision(self, node: Node) -> Row:
        """<TimeToCollisionCondition>."""
        row = self._compared(node, "IF_TIME_TO_COLLISION") | self._measured(node)
        target = node.need("TimeToCollisionConditionTarget").only()
        if target.tag == "EntityRef":
            return row | {"entity": self.actions.layout.entity(target)}
        return row | {"position": self.actions.layout.position(target)}

    def collision(self, node: Node) -> Row:
        """<CollisionCondition>."""
        target = node.only()
        if target.tag == "EntityRef":
            return {"kind": "IF_COLLISION", "entity": self.actions.layout.entity(target)}
        classes = {"pedestrian": 5, "miscellaneous": 6}
        kind = target.text("type")
        return {"kind": "IF_COLLISION", "state": classes.get(kind, NONE)}

    def angle(self, node: Node) -> Row:
        """<AngleCondition> and <RelativeAngleCondition>."""
        if node.text("angleType", "heading") != "heading":
            raise fail(
                f"<{node.tag}>: angleType '{node.text('angleType')}' is not supported", node.where, "possible: heading"
            )
        row: Row = {
            "kind": "IF_ANGLE" if node.tag == "AngleCondition" else "IF_RELATIVE_ANGLE",
            "numbers": self._numbers(node, "angle", "angleTolerance"),
            "system": node.word("coordinateSystem", {**_SYSTEMS, "world": "OF_ENTITY"}, "world"),
        }
        return row | self._entity(node)

    def clearance(self, node: Node) -> Row:
        """<RelativeClearanceCondition>."""
        tables = self.actions.layout.tables
        lanes = node.child("RelativeLaneRange")
        numbers = [
            tables.number(node.number("distanceForward", 0.0)),
            tables.number(node.number("distanceBackward", 0.0)),
            tables.number(lanes.number("from", -100.0) if lanes else -100.0),
            tables.number(lanes.number("to", 100.0) if lanes else 100.0),
        ]
        first = tables.count("triggering")
        for each in node.all("EntityRef"):
            tables.add("triggering", {"entity": self.actions.layout.entity(each), "gap": NONE})
        return {
            "kind": "IF_CLEARANCE", "numbers": numbers, "system": "OF_ROAD", "is_freespace": node.flag("freeSpace"),
            "takes_opposite": node.flag("oppositeLanes"), "listed": first,
            "listed_count": tables.count("triggering") - first,
        }  # fmt: skip


_BY_VALUE: dict[str, Callable[[Conditions, Node], Row]] = {
    "SimulationTimeCondition": Conditions.time,
    "VariableCondition": Conditions.variable,
    "ParameterCondition": Conditions.variable,
    "StoryboardElementStateCondition": Conditions.state,
    "TimeOfDayCondition": Conditions.clock,
    "TrafficSignalCondition": Conditions.signal,
    "TrafficSignalControllerCondition": Conditions.signal,
}
_BY_ENTITY: dict[str, Callable[[Conditions, Node], Row]] = {
    "SpeedCondition": Conditions.speed,
    "RelativeSpeedCondition": Conditions.speed,
    "AccelerationCondition": Conditions.speed,
    "StandStillCondition": Conditions.lasting,
    "EndOfRoadCondition": Conditions.lasting,
    "OffroadCondition": Conditions.lasting,
    "TraveledDistanceCondition": Conditions.travelled,
    "ReachPositionCondition": Conditions.reached,
    "DistanceCondition": Conditions.distance,
    "RelativeDistanceCondition": Conditions.distance,
    "TimeHeadwayCondition": Conditions.distance,
    "TimeToCollisionCondition": Conditions.time_to_collision,
    "CollisionCondition": Conditions.collision,
    "AngleCondition": Conditions.angle,
    "RelativeAngleCondition": Conditions.angle,
    "RelativeClearanceCondition": Conditions.clearance,
}
CONDITIONS = frozenset(_BY_VALUE) | frozenset(_BY_ENTITY)
