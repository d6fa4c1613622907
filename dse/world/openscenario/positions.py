"""Positions and trajectories → rows of the tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from dse.errors import Location, closest, fail
from dse.formats import XmlElement
from dse.world.openscenario.document import Node
from dse.world.openscenario.expressions import Number
from dse.world.openscenario.paths import Paths
from dse.world.openscenario.tables import CHORDS, NONE, Tables

POSITIONS = frozenset(
    {
        *("LanePosition", "RoadPosition", "WorldPosition", "RelativeLanePosition", "RelativeRoadPosition"),
        *("RelativeObjectPosition", "RelativeWorldPosition", "TrajectoryPosition", "RoutePosition"),
    }
)
TRAJECTORY_SHAPES = frozenset({"Polyline", "Clothoid", "ClothoidSpline", "Nurbs"})
_MOST_ORDER = 8
_NURBS_CHORDS = 200
_MOST_VERTICES = 10_000
_MOST_WAYPOINTS = 1000


@dataclass(slots=True)
class Placed:
    """Where an entity starts: on a path, or by another entity; *road*, *lane* and *s* with the default parameters."""

    path: int
    road: str = ""
    lane: int = 0
    s: float = 0.0


@dataclass(slots=True)
class Layout:
    """What positions refer to: *entities* by name, *paths* of the network (None: there is no road)."""

    tables: Tables
    entities: Mapping[str, int]
    paths: Paths | None
    starts: dict[int, Placed] = field(default_factory=dict)
    controllers: dict[str, tuple[int, tuple[str, ...]]] = field(default_factory=dict)
    """Of traffic signals: their row, and their phases."""
    open: list[XmlElement] = field(default_factory=list)
    """Trajectories that are being read."""

    def entity(self, node: Node, name: str = "entityRef") -> int:
        """The number of the entity that an attribute names. Raises DseError located at the element."""
        text = node.text(name)
        if text not in self.entities:
            raise fail(f"there is no entity '{text}'", node.where, closest(text, self.entities))
        return self.entities[text]

    def phase(self, node: Node) -> tuple[int, int]:
        """The numbers of the controller and of its phase that an element names. Raises DseError: there is none."""
        name, phase = node.text("trafficSignalControllerRef"), node.text("phase")
        if name not in self.controllers:
            what = f"there is no controller '{name}' of traffic signals"
            raise fail(what, node.where, closest(name, self.controllers))
        row, phases = self.controllers[name]
        if phase not in phases:
            raise fail(f"the controller '{name}' has no phase '{phase}'", node.where, closest(phase, phases))
        return row, phases.index(phase)

    def network(self, where: Location) -> Paths:
        """The paths. Raises DseError where the scenario has no road network."""
        if self.paths is None:
            raise fail("the scenario has no road network", where, "name it: <RoadNetwork><LogicFile filepath=…/>")
        return self.paths

    def position(self, node: Node, actor: int = NONE) -> int:
        """The row of a <Position>; *actor* is the entity that is placed there. Raises DseError where unsupported."""
        return self.tables.add("positions", self._row(node.only().resolved(), actor))

    def start(self, node: Node, actor: int) -> None:
        """Remember where *actor* starts, for its path; the first place counts."""
        if actor in self.starts or self.paths is None:
            return
        place = node.only().resolved()
        found = self._placed(place)
        if found is not None:
            self.starts[actor] = found

    def _placed(self, place: Node) -> Placed | None:
        paths = self.paths
        if paths is None:
            return None
        if place.tag == "LanePosition":
            road, lane, s = self._lane_place(place)
            return Placed(paths.through(road, lane, s, place.where), road, lane, s)
        if place.tag == "RoadPosition":
            road, s, t = place.text("roadId"), place.number("s").value, place.number("t").value
            left = paths.road(road, place.where).left_hand
            return Placed(paths.through(road, -1 if (t < 0) != left else 1, s, place.where), road, -1, s)
        if place.tag == "RoutePosition":
            return self._on_route(place)
        if place.tag in {"RelativeLanePosition", "RelativeRoadPosition"}:
            other = self.starts.get(self.entity(place))
            return None if other is None else Placed(other.path)
        if place.tag == "WorldPosition":
            return self._nearest(place)
        return None

    def _lane_place(self, place: Node) -> tuple[str, int, float]:
        """Road, lane and station of a <LanePosition>. Raises DseError where there is no such lane."""
        road, lane, s = place.text("roadId"), place.whole("laneId"), place.number("s").value
        found = self.network(place.where).road(road, place.where)
        lanes = {0} | {id_ for section in found.sections for id_ in section.lanes}
        if lane not in lanes:
            listed = ", ".join(map(str, sorted(lanes)))
            raise fail(f"road '{road}' has no lane {lane}", place.where, f"possible: {listed}")
        return road, lane, s

    def _nearest(self, place: Node) -> Placed | None:
        found = self._nearest_lane(place)
        if found is None or abs(found[3]) > 20.0:
            return None
        road, lane, s, _ = found
        return Placed(self.network(place.where).through(road, lane, s, place.where), road, lane, s)

    def _nearest_lane(self, place: Node) -> tuple[str, int, float, float] | None:
        """Where a <WorldPosition> is; a z chooses among roads above each other."""
        x, y = (place.number(name).value for name in "xy")
        return self.network(place.where).nearest(x, y, place.number("z").value if place.has("z") else None)

    def _on_route(self, place: Node) -> Placed:
        route = place.need("RouteRef").only().resolved()
        at = place.need("InRoutePosition").only()
        roads, first_lane, _ = self.route_roads(route)
        path = self.network(place.where).along_route(roads, first_lane, route.where)
        stretch = self.network(place.where).made[path].stretches
        first = next(each for each in stretch if each.road == roads[0])
        if at.tag == "FromLaneCoordinates":
            lane, s = at.whole("laneId"), at.number("pathS").value
        elif at.tag == "FromRoadCoordinates":
            lane, s = NONE, at.number("pathS").value
        else:
            raise at.unsupported()
        return Placed(path, first.road, lane, s)

    def route_roads(self, route: Node) -> tuple[list[str], int, float]:
        """The roads of the waypoints of a <Route>, and lane and station of the first."""
        if len(route.element.children) > _MOST_WAYPOINTS:
            raise fail(f"a route has at most {_MOST_WAYPOINTS} waypoints", route.where)
        places = [self.road_place(waypoint.need("Position")) for waypoint in route.all("Waypoint")]
        if not places:
            raise fail("<Route> has no <Waypoint>", route.where)
        roads = [road for i, (road, _, _) in enumerate(places) if i == 0 or road != places[i - 1][0]]
        return roads, places[0][1], places[0][2]

    def road_place(self, position: Node) -> tuple[str, int, float]:
        """Road, lane and station of a <Position> on a road, with the default parameters. Raises DseError elsewhere."""
        place = position.only().resolved()
        if place.tag == "LanePosition":
            return self._lane_place(place)
        if place.tag == "RoadPosition":
            return place.text("roadId"), 0, place.number("s").value
        if place.tag != "WorldPosition":
            raise place.unsupported()
        found = self._nearest_lane(place)
        if found is None:
            raise fail("the position is on no road", place.where)
        return found[:3]

    def _path_with(self, road: str, lane: int, s: float, actor: int, where: Location) -> tuple[int, float, int]:
        """A path that has the station of a road, the actor's own if it does: its number, the base and the sense."""
        paths = self.network(where)
        paths.road(road, where)
        own = self.starts[actor].path if actor in self.starts else NONE
        numbers = [own, *range(len(paths.made))] if own != NONE else [*range(len(paths.made))]
        for number in numbers:
            stretch = paths.made[number].stretch(road, s)
            inside = stretch and stretch.start - 1e-6 <= stretch.base + stretch.sense * s <= stretch.end + 1e-6
            if stretch is not None and (inside or number == own):
                return number, stretch.base, stretch.sense
        number = paths.through(road, lane, s, where)
        stretch = paths.made[number].stretch(road, s)
        assert stretch is not None  # noqa: S101  # it leads through the road
        return number, stretch.base, stretch.sense

    def _row(self, place: Node, actor: int) -> dict[str, object]:
        t = self.tables
        row: dict[str, object] = {
            "kind": "AT_WORLD", "entity": NONE, "path": NONE, "base": 0.0, "sense": 1, "lane": 0, "trajectory": NONE,
            "numbers": [0, 0], "heading": 0, "has_heading": False, "is_relative": False,
        }  # fmt: skip
        turned = place.child("Orientation")
        if turned is not None:
            row["heading"] = t.number(turned.number("h", 0.0))
            row["has_heading"] = turned.has("h")
            row["is_relative"] = turned.text("type", "absolute") == "relative"
        match place.tag:
            case "LanePosition":
                road, lane, _ = self._lane_place(place)
                row |= self._at_road(place, road, lane, place.number("s"), actor)
                row["kind"] = "AT_LANE"
                row["numbers"] = [t.number(place.number("s")), t.number(place.number("offset", 0.0))]
            case "RoadPosition":
                lane = -1 if place.number("t").value < 0 else 1
                row |= self._at_road(place, place.text("roadId"), lane, place.number("s"), actor)
                row["kind"] = "AT_ROAD"
                row["numbers"] = [t.number(place.number("s")), t.number(place.number("t"))]
            case "WorldPosition":
                row["numbers"] = [t.number(place.number("x")), t.number(place.number("y"))]
                row |= {"heading": t.number(place.number("h", 0.0)), "has_heading": place.has("h")}
            case "RelativeLanePosition":
                kind = "BY_DRIVEN_LANE" if place.has("dsLane") else "BY_LANE"
                row |= {"kind": kind, "entity": self.entity(place), "lane": place.whole("dLane")}
                ds = place.number("dsLane" if place.has("dsLane") else "ds")
                row["numbers"] = [t.number(ds), t.number(place.number("offset", 0.0))]
            case "RelativeRoadPosition":
                row |= {"kind": "BY_ROAD", "entity": self.entity(place)}
                row["numbers"] = [t.number(place.number("ds")), t.number(place.number("dt"))]
            case "RelativeObjectPosition" | "RelativeWorldPosition":
                kind = "BY_OBJECT" if place.tag == "RelativeObjectPosition" else "BY_WORLD"
                row |= {"kind": kind, "entity": self.entity(place)}
                row["numbers"] = [t.number(place.number("dx")), t.number(place.number("dy", 0.0))]
            case "TrajectoryPosition":
                line = self.trajectory(place.need("TrajectoryRef").only().resolved())
                row |= {"kind": "ON_TRAJECTORY", "trajectory": line}
                row["numbers"] = [t.number(place.number("s")), t.number(place.number("t", 0.0))]
            case "RoutePosition":
                row |= self._at_route(place)
            case _:
                raise place.unsupported()
        return row

    def _at_road(self, place: Node, road: str, lane: int, s: Number, actor: int) -> dict[str, object]:
        path, base, sense = self._path_with(road, lane, s.value, actor, place.where)
        return {"path": path, "base": base, "sense": sense, "lane": lane}

    def _at_route(self, place: Node) -> dict[str, object]:
        """A station along a route counts from its first waypoint."""
        found = self._on_route(place)
        roads, _, s = self.route_roads(place.need("RouteRef").only().resolved())
        at = place.need("InRoutePosition").only()
        stretch = self.network(place.where).made[found.path].stretch(roads[0], s)
        assert stretch is not None  # noqa: S101  # the route begins there
        base = stretch.base + stretch.sense * s
        t = self.tables
        path_s = t.number(at.number("pathS"))
        if at.tag == "FromLaneCoordinates":
            offset = t.number(at.number("laneOffset", 0.0))
            wanted = at.whole("laneId")
            return {"kind": "AT_LANE", "path": found.path, "base": base, "lane": wanted, "numbers": [path_s, offset]}
        return {"kind": "AT_ROAD", "path": found.path, "base": base, "numbers": [path_s, t.number(at.number("t"))]}

    def trajectory(self, node: Node) -> int:
        """The row of a <Trajectory>."""
        shape, t = node.need("Shape").only(), self.tables
        if shape.element in self.open:
            raise fail("the trajectory refers to itself", shape.where)
        if len(shape.element.children) > _MOST_VERTICES:
            raise fail(f"a trajectory has at most {_MOST_VERTICES} vertices or segments", shape.where)
        self.open.append(shape.element)
        try:
            return t.add("trajectories", self._trajectory(node, shape))
        finally:
            self.open.pop()

    def _trajectory(self, node: Node, shape: Node) -> dict[str, object]:
        t = self.tables
        row: dict[str, object] = {
            "kind": "POLYLINE", "order": 0, "knot": 0, "knots": 0, "is_closed": node.flag("closed"), "is_timed": False,
        }  # fmt: skip
        match shape.tag:
            case "Polyline":
                vertices = [self._vertex(each) for each in shape.all("Vertex")]
                if len(vertices) < 2:
                    raise fail("<Polyline> has fewer than two vertices", shape.where)
                points = len(vertices) + (1 if row["is_closed"] else 0)
                row["is_timed"] = all(each.has("time") for each in shape.all("Vertex"))
            case "Clothoid":
                vertices = self._clothoids(shape, [shape])
                points = 1 + CHORDS
                row["kind"] = "CLOTHOIDS"
            case "ClothoidSpline":
                segments = [each for each in shape.children() if each.tag in {"ClothoidSplineSegment", "Segment"}]
                vertices = self._clothoids(shape, segments)
                points = 1 + CHORDS * len(segments)
                row["kind"] = "CLOTHOIDS"
            case "Nurbs":
                vertices, extra = self._nurbs(shape)
                points = 1 + _NURBS_CHORDS
                row |= extra
            case _:
                raise shape.unsupported()
        first = t.count("vertices")
        for vertex in vertices:
            t.add("vertices", vertex)
        row |= {"vertex": first, "vertices": len(vertices), "point": t.points, "points": points}
        t.points += points
        return row

    def _vertex(self, vertex: Node) -> dict[str, object]:
        position = self.position(vertex.need("Position"))
        return {"time": self.tables.number(vertex.number("time", 0.0)), "position": position, "numbers": [0] * 4}

    def _clothoids(self, shape: Node, segments: list[Node]) -> list[dict[str, object]]:
        t = self.tables
        if not segments:
            raise fail(f"<{shape.tag}> has no segment", shape.where)
        start = segments[0].child("PositionStart", "Position")
        position = NONE if start is None else self.position(start)
        rows: list[dict[str, object]] = [{"time": 0, "position": position, "numbers": [0] * 4}]
        for i, each in enumerate(segments):
            if i and each.child("PositionStart") is not None:
                raise fail("only the first segment of a clothoid spline may have a <PositionStart>", each.where)
            length = each.number("length")
            if each.tag == "Clothoid":
                first = each.number("curvature")
                prime = each.number("curvaturePrime" if each.has("curvaturePrime") else "curvatureDot")
                last = Number(
                    first.value + prime.value * length.value,
                    f"({first.c} + {prime.c} * {length.c})",
                    first.names | prime.names | length.names,
                )
            else:
                first, last = each.number("curvatureStart"), each.number("curvatureEnd")
            numbers = [t.number(n) for n in (first, last, length, each.number("hOffset", 0.0))]
            rows.append({"time": 0, "position": NONE, "numbers": numbers})
        return rows

    def _nurbs(self, shape: Node) -> tuple[list[dict[str, object]], dict[str, object]]:
        t, order = self.tables, shape.whole("order")
        controls = list(shape.all("ControlPoint"))
        knots = [each.number("value") for each in shape.all("Knot")]
        if not 2 <= order <= _MOST_ORDER or len(controls) < order or len(knots) != len(controls) + order:
            what = f"a NURBS of order {order} with {len(controls)} control points and {len(knots)} knots"
            hint = f"order 2 to {_MOST_ORDER}, at least as many control points, and as many knots as both together"
            raise fail(what + " is not supported", shape.where, hint)
        vertices: list[dict[str, object]] = [
            {
                "time": t.number(each.number("time", 0.0)),
                "position": self.position(each.need("Position")),
                "numbers": [t.number(each.number("weight", 1.0)), 0, 0, 0],
            }
            for each in controls
        ]
        first = t.count("knots")
        for knot in knots:
            t.add("knots", t.number(knot))
        return vertices, {"kind": "NURBS", "order": order, "knot": first, "knots": len(knots)}
