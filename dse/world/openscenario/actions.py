"""Actions → rows of the tables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime

from dse.errors import closest, fail
from dse.formats import shortened
from dse.world.openscenario.document import Node
from dse.world.openscenario.expressions import Number, constant
from dse.world.openscenario.positions import Layout
from dse.world.openscenario.tables import NONE

Row = dict[str, object]

SHAPES = {"step": "STEP", "linear": "LINEAR", "cubic": "CUBIC", "sinusoidal": "SINUSOIDAL"}
_DIMENSIONS = {"time": "BY_TIME", "rate": "BY_RATE", "distance": "BY_DISTANCE"}
_NO_FLAG = "0"
_SIDES = {"any": _NO_FLAG, "leadingReferencedEntity": "IS_LEADING", "trailingReferencedEntity": "IS_TRAILING"}
_LATERAL_SIDES = {"any": _NO_FLAG, "leftToReferencedEntity": "IS_LEADING", "rightToReferencedEntity": "IS_TRAILING"}
_SYSTEMS = {"entity": _NO_FLAG, **dict.fromkeys(("lane", "road", "trajectory"), "IS_ALONG_ROAD")}
_DEFAULT_LATERAL_ACCELERATION = 0.5  # m/s2, of a lane offset without one; assumed
_NO_LIMIT = -1.0


@dataclass(frozen=True, slots=True)
class Actions:
    """Makes rows of actions."""

    layout: Layout

    def private(self, action: Node, actor: int) -> list[Row]:
        """The rows of a <PrivateAction> for one entity; none if it does not matter to a simulation.

        Raises DseError located at what is not supported.
        """
        kind = action.only()
        if kind.tag in {"LongitudinalAction", "LateralAction", "RoutingAction"}:
            kind = kind.only()
        make = _PRIVATE.get(kind.tag)
        if make is None:
            raise kind.unsupported()
        row = make(self, kind, actor)
        return [] if row is None else [self._row(actor, row)]

    def global_(self, action: Node) -> list[Row]:
        """The rows of a <GlobalAction>, as `private`."""
        kind = action.only()
        make = _GLOBAL.get(kind.tag)
        if make is None:
            raise kind.unsupported()
        row = make(self, kind)
        return [] if row is None else [self._row(NONE, row)]

    def _row(self, actor: int, given: Row) -> Row:
        row: Row = {
            "kind": "DO_NOTHING", "controls": 0, "actor": actor, "entity": NONE, "position": NONE,
            "other_position": NONE, "shape": "STEP", "dimension": "BY_TIME", "flags": _NO_FLAG, "target": 0, "count": 0,
            "numbers": [],
        }  # fmt: skip
        row |= given
        numbers = row["numbers"]
        assert isinstance(numbers, list)  # noqa: S101  # by construction
        row["numbers"] = [*(self.layout.tables.number(each) for each in numbers), *[0] * (4 - len(numbers))]
        return row

    def _dynamics(self, node: Node) -> tuple[Row, Number]:
        shape = node.word("dynamicsShape", SHAPES)
        dimension = node.word("dynamicsDimension", _DIMENSIONS, "time")
        value = constant(0.0) if shape == "STEP" and not node.has("value") else node.number("value")
        return {"shape": shape, "dimension": dimension}, value

    def speed(self, node: Node, _: int) -> Row:
        """<SpeedAction>."""
        row, value = self._dynamics(node.need("SpeedActionDynamics"))
        target = node.need("SpeedActionTarget").only()
        row |= {"kind": "DO_SPEED", "controls": "LONGITUDINAL", "numbers": [value, target.number("value")]}
        if target.tag == "RelativeTargetSpeed":
            kind = target.word("speedTargetValueType", {"delta": _NO_FLAG, "factor": "IS_FACTOR"}, "delta")
            row |= {
                "entity": self.layout.entity(target),
                "flags": _flags(kind, IS_CONTINUOUS=target.flag("continuous")),
            }
        return row

    def speed_profile(self, node: Node, _: int) -> Row:
        """<SpeedProfileAction>."""
        tables = self.layout.tables
        limits = node.child("DynamicConstraints")
        entries = list(node.all("SpeedProfileEntry"))
        if node.has("entityRef"):
            raise fail("a speed profile relative to an entity is not supported", node.where)
        if limits is not None:
            self._without_jerk(limits)
        first = tables.count("entries")
        for i, entry in enumerate(entries):
            has_time = entry.has("time") or (limits is None and i == 0)
            time = tables.number(entry.number("time", 0.0)) if has_time else NONE
            tables.add("entries", (time, tables.number(entry.number("speed"))))
        most = limits.number("maxAcceleration", _NO_LIMIT) if limits else constant(_NO_LIMIT)
        least = limits.number("maxDeceleration", _NO_LIMIT) if limits else constant(_NO_LIMIT)
        numbers = [constant(0.0), most, least]
        return {
            "kind": "DO_SPEED_PROFILE",
            "controls": "LONGITUDINAL",
            "target": first,
            "count": len(entries),
            "numbers": numbers,
        }

    def longitudinal_distance(self, node: Node, _: int) -> Row:
        """<LongitudinalDistanceAction>."""
        is_time = node.has("timeGap")
        side = node.word("displacement", _SIDES, "trailingReferencedEntity")
        flags = _flags(side, node.word("coordinateSystem", _SYSTEMS, "entity"), IS_TIME_GAP=is_time)
        gap = node.number("timeGap" if is_time else "distance")
        return self._kept(node, gap, flags, "DO_LONGITUDINAL_DISTANCE", "LONGITUDINAL")

    def lateral_distance(self, node: Node, _: int) -> Row:
        """<LateralDistanceAction>."""
        side = node.word("displacement", _LATERAL_SIDES, "any")
        return self._kept(node, node.number("distance", 0.0), side, "DO_LATERAL_DISTANCE", "LATERAL")

    def _without_jerk(self, limits: Node) -> None:
        if limits.has("maxAccelerationRate") or limits.has("maxDecelerationRate"):
            limits.ignore("the acceleration changes without a limit of its rate")

    def _kept(self, node: Node, gap: Number, flags: str, kind: str, controls: str) -> Row:
        limits = node.child("DynamicConstraints")
        names = "maxAcceleration", "maxDeceleration", "maxSpeed"
        numbers = [limits.number(name, _NO_LIMIT) if limits else constant(_NO_LIMIT) for name in names]
        if limits is not None:
            self._without_jerk(limits)
        flags = _flags(
            flags, HAS_LIMITS=limits is not None, IS_FREESPACE=node.flag("freespace"),
            IS_CONTINUOUS=node.flag("continuous"),
        )  # fmt: skip
        row: Row = {"kind": kind, "controls": controls, "entity": self.layout.entity(node)}
        return {**row, "flags": flags, "numbers": [gap, *numbers]}

    def lane_change(self, node: Node, _: int) -> Row:
        """<LaneChangeAction>."""
        row, value = self._dynamics(node.need("LaneChangeActionDynamics"))
        target = node.need("LaneChangeTarget").only()
        offset = node.number("targetLaneOffset", 0.0)
        row |= {
            "kind": "DO_LANE_CHANGE",
            "controls": "LATERAL",
            "target": target.whole("value"),
            "numbers": [value, offset],
        }
        if target.tag == "RelativeTargetLane":
            row["entity"] = self.layout.entity(target)
        return row

    def lane_offset(self, node: Node, _: int) -> Row:
        """<LaneOffsetAction>."""
        dynamics = node.need("LaneOffsetActionDynamics")
        target = node.need("LaneOffsetTarget").only()
        acceleration = dynamics.number("maxLateralAcc", _DEFAULT_LATERAL_ACCELERATION)
        row: Row = {
            "kind": "DO_LANE_OFFSET",
            "controls": "LATERAL",
            "shape": dynamics.word("dynamicsShape", SHAPES),
            "flags": _flags(IS_CONTINUOUS=node.flag("continuous")),
            "numbers": [target.number("value"), acceleration],
        }
        if target.tag == "RelativeTargetLaneOffset":
            row["entity"] = self.layout.entity(target)
        return row

    def teleport(self, node: Node, actor: int) -> Row:
        """<TeleportAction>."""
        return {"kind": "DO_TELEPORT", "position": self.layout.position(node.need("Position"), actor)}

    def trajectory(self, node: Node, _: int) -> Row:
        """<FollowTrajectoryAction>."""
        line = node.child("Trajectory", "CatalogReference") or node.need("TrajectoryRef").only()
        number = self.layout.trajectory(line.resolved())
        timing = node.child("TimeReference")
        timing = timing.only() if timing and timing.element.children else None
        flags, scale, offset = _NO_FLAG, constant(1.0), constant(0.0)
        row = self.layout.tables.rows["trajectories"][number]
        assert isinstance(row, dict)  # noqa: S101  # by construction
        if timing is not None and timing.tag == "Timing":
            if not row["is_timed"]:
                timing.ignore("the trajectory has no times, it is followed at the speed of the entity")
            else:
                domains = {"absolute": _NO_FLAG, "relative": "IS_RELATIVE_TIME"}
                flags = _flags("IS_TIMED", timing.word("domainAbsoluteRelative", domains, "relative"))
                mode = node.child("TrajectoryFollowingMode")
                if mode and row["kind"] == "POLYLINE":
                    modes = {"follow": "IS_ACCELERATED", "position": _NO_FLAG}
                    flags = _flags(flags, mode.word("followingMode", modes, "position"))
                scale, offset = timing.number("scale", 1.0), timing.number("offset", 0.0)
        numbers = [node.number("initialDistanceOffset", 0.0), scale, offset]
        controls = "LATERAL" if flags == _NO_FLAG else "BOTH"
        return {"kind": "DO_TRAJECTORY", "controls": controls, "target": number, "flags": flags, "numbers": numbers}

    def synchronize(self, node: Node, actor: int) -> Row:
        """<SynchronizeAction>."""
        master = self.layout.entity(node, "masterEntityRef")
        row: Row = {
            "kind": "DO_SYNCHRONIZE",
            "controls": "LONGITUDINAL",
            "entity": master,
            "position": self.layout.position(node.need("TargetPositionMaster"), master),
            "other_position": self.layout.position(node.need("TargetPosition"), actor),
        }
        final, flags = node.child("FinalSpeed"), _NO_FLAG
        speed = steady = constant(0.0)
        if final is not None:
            target = final.only()
            flags, speed = "HAS_FINAL_SPEED", target.number("value")
            if target.tag == "RelativeSpeedToMaster":
                flags = _flags(flags, target.word("speedTargetValueType", {"delta": "IS_FACTOR"}, "delta"))
            kept = target.child("TargetDistanceSteadyState", "TargetTimeSteadyState")
            if kept is not None:
                by_time = kept.tag == "TargetTimeSteadyState"
                flags = _flags(flags, "STEADY_TIME" if by_time else "STEADY_DISTANCE")
                steady = kept.number("time" if by_time else "distance")
        tolerances = [node.number("targetToleranceMaster", 0.0), node.number("targetTolerance", 0.0)]
        return {**row, "flags": flags, "numbers": [speed, steady, *tolerances]}

    def assign_route(self, node: Node, actor: int) -> Row:
        """<AssignRouteAction> and <AcquirePositionAction>."""
        network = self.layout.network(node.where)
        start = self.layout.starts.get(actor)
        if node.tag == "AcquirePositionAction":
            if start is None or not start.road:
                raise fail("the entity starts on no road", node.where)
            roads = [start.road, self.layout.road_place(node.need("Position"))[0]]
            roads, lane = roads if roads[0] != roads[1] else roads[:1], start.lane
        else:
            roads, lane, _ = self.layout.route_roads(node.need("Route", "CatalogReference").resolved())
        return {"kind": "DO_ROUTE", "target": network.along_route(roads, lane, node.where)}

    def see(self, node: Node, _: int) -> Row:
        """<VisibilityAction>: whether sensors can detect the entity."""
        return {"kind": "DO_SEE", "flags": _flags(IS_HIDDEN=not node.flag("sensors", default=True))}

    def nothing(self, node: Node, *_: int) -> None:
        """What does not change how road users move; the bench's own components take its place."""
        node.ignore("has no effect here")

    def environment(self, node: Node) -> Row | None:
        """<EnvironmentAction>: of it, only the time of day has an effect."""
        node.ignore("the weather component of the bench sets weather, visibility and friction")
        clock = node.need("Environment", "CatalogReference").resolved().child("TimeOfDay")
        if clock is None:
            return None
        time = constant(seconds(clock, "dateTime"))
        return {"kind": "DO_CLOCK", "flags": _flags(IS_CONTINUOUS=clock.flag("animation")), "numbers": [time]}

    def signals(self, node: Node) -> Row:
        """<InfrastructureAction>."""
        kind, tables = node.need("TrafficSignalAction").only(), self.layout.tables
        if kind.tag == "TrafficSignalStateAction":
            signal = tables.signal("TrafficSignal", kind.text("name"))
            return {"kind": "DO_SET", "target": signal, "numbers": [tables.compared(kind.text("state"))]}
        if kind.tag != "TrafficSignalControllerAction":
            raise kind.unsupported()
        controller, phase = self.layout.phase(kind)
        return {"kind": "DO_PHASE", "target": controller, "count": phase}

    def entity(self, node: Node) -> Row:
        """<EntityAction>."""
        number, kind = self.layout.entity(node), node.only()
        if kind.tag == "DeleteEntityAction":
            return {"kind": "DO_DELETE", "actor": number}
        return {"kind": "DO_ADD", "actor": number, "position": self.layout.position(kind.need("Position"), number)}

    def variable(self, node: Node) -> Row:
        """<VariableAction> and <ParameterAction>."""
        name = node.text("variableRef" if node.tag == "VariableAction" else "parameterRef")
        if name not in self.layout.tables.variables:
            raise fail(f"there is no variable '{name}'", node.where, closest(name, self.layout.tables.variables))
        change, row = node.only(), {"target": self.layout.tables.variable(name)}
        if change.tag == "SetAction":
            return {**row, "kind": "DO_SET", "numbers": [self.layout.tables.compared(change.value("value"))]}
        rule = change.need("Rule").only()
        kind = "DO_INCREASE" if rule.tag == "AddValue" else "DO_MULTIPLY"
        return {**row, "kind": kind, "numbers": [rule.number("value")]}


def seconds(node: Node, name: str) -> float:
    """An attribute that is a date with a time, as seconds since 1970; without a time zone in UTC."""
    text = node.text(name)
    try:
        date = datetime.fromisoformat(text)
    except ValueError as error:
        what = f"<{node.tag}>: '{name}' is '{shortened(text)}', not a date with a time"
        raise fail(what, node.where, "for example 2026-11-28T12:00:00") from error
    return (date if date.tzinfo else date.replace(tzinfo=UTC)).timestamp()


def _flags(*names: str, **others: bool) -> str:
    """The C of flags: *names*, and those of *others* that are true."""
    return (
        " | ".join(name for name in (*names, *(other for other in others if others[other])) if name != _NO_FLAG)
        or _NO_FLAG
    )


_PRIVATE: dict[str, Callable[[Actions, Node, int], Row | None]] = {
    "SpeedAction": Actions.speed,
    "SpeedProfileAction": Actions.speed_profile,
    "LongitudinalDistanceAction": Actions.longitudinal_distance,
    "LateralDistanceAction": Actions.lateral_distance,
    "LaneChangeAction": Actions.lane_change,
    "LaneOffsetAction": Actions.lane_offset,
    "TeleportAction": Actions.teleport,
    "FollowTrajectoryAction": Actions.trajectory,
    "SynchronizeAction": Actions.synchronize,
    "AssignRouteAction": Actions.assign_route,
    "AcquirePositionAction": Actions.assign_route,
    "VisibilityAction": Actions.see,
    "ControllerAction": Actions.nothing,
    "ActivateControllerAction": Actions.nothing,
    "AssignControllerAction": Actions.nothing,
    "AppearanceAction": Actions.nothing,
}
_GLOBAL: dict[str, Callable[[Actions, Node], Row | None]] = {
    "EnvironmentAction": Actions.environment,
    "InfrastructureAction": Actions.signals,
    "EntityAction": Actions.entity,
    "VariableAction": Actions.variable,
    "ParameterAction": Actions.variable,
}
PRIVATE_ACTIONS, GLOBAL_ACTIONS = frozenset(_PRIVATE), frozenset(_GLOBAL)
WITHOUT_EFFECT = frozenset({name for name, make in _PRIVATE.items() if make is Actions.nothing})
