"""A scenario file → the tables of its road users and its storyboard."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from dse.errors import Problem, Problems, closest, fail, raise_if_any
from dse.expression import KEYWORDS
from dse.formats import shown
from dse.loading import Workspace, find_root, is_identifier
from dse.world.opendrive.reading import read_network
from dse.world.opendrive.structure import Network
from dse.world.openscenario.actions import Actions, seconds
from dse.world.openscenario.document import MOST_ELEMENTS, Context, Document, Node, Parameter, open_document
from dse.world.openscenario.expressions import Number, constant
from dse.world.openscenario.paths import Paths, ScenarioPath
from dse.world.openscenario.positions import Layout
from dse.world.openscenario.stories import Element, Stories
from dse.world.openscenario.tables import NONE, Tables
from dse.world.road_reader import open_roads

MOST_ENTITIES = 48
OWN_PARAMETERS = ("drives_host", "host_front")
"""Of a component of a scenario, besides those of the file."""
_MOST_PASSES = 4
_MOST_CONTROLLERS = 100
_DESCRIPTIONS = ("Vehicle", "Pedestrian", "MiscObject")
_CLASSES = {
    "car": 1, "van": 1, "truck": 2, "semitrailer": 2, "trailer": 2, "bus": 2, "tram": 2, "train": 2, "motorbike": 3,
    "bicycle": 4,
}  # fmt: skip
PEDESTRIAN, OBSTACLE = 5, 6
_MACRO = re.compile(
    r"NAN|NULL|INFINITY|HUGE_VAL|(SB|M|FP|MATH|SCENARIO|U?INT|U?INTPTR|PTRDIFF|SIZE)[A-Z0-9]*_[A-Z0-9_]*"
)


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """A scenario: what its FMU is made of.

    *parameters* can be tuned, *decided* ones are texts that were fixed. *entities* are in the order of the file, *host*
    is the number of the one that is simulated, or NONE. *elements* are those of the storyboard, in the order of their
    states. *ignored* does not matter to a simulation. *files* are the road network and the catalogues that are used,
    each with its name, or that of its folder, as it is written.
    """

    parameters: tuple[Parameter, ...]
    decided: Mapping[str, str]
    entities: tuple[str, ...]
    host: int
    elements: tuple[Element, ...]
    paths: tuple[ScenarioPath, ...]
    tables: Tables
    ignored: tuple[Problem, ...]
    network: Network | None
    files: Mapping[Path, str]


def read_scenario(
    path: Path, given: Mapping[str, str] | None = None, host: str | None = None, inside: Path | None = None
) -> Scenario:
    """The scenario in the OpenSCENARIO file at *path*, with *given* values of parameters.

    *host* is the entity that the configuration under test drives, "Ego" by default if there is one. Files that the
    scenario names are *inside* a folder, if that is given. Raises DseError with everything that is wrong or not
    supported, each located in its file.
    """
    fixed: frozenset[str] = frozenset()
    for _ in range(_MOST_PASSES):
        context = Context(path, given or {}, fixed, inside)
        document = open_document(context)
        unfit = {each.name for each in document.parameters if not _is_c_name(each.name)}
        scenario = None if unfit - fixed else _Compiler(document).scenario(host)
        decided = frozenset(context.found_fixed) | fixed | unfit
        if decided == fixed and scenario is not None:
            return scenario
        fixed = decided
    raise fail("its parameters depend on each other", document.root.where)


def _is_c_name(name: str) -> bool:
    """Whether a parameter of an FMU from C can have the name."""
    is_word = is_identifier(name) and name not in KEYWORDS
    return is_word and name not in OWN_PARAMETERS and not _MACRO.fullmatch(name)


@dataclass(slots=True)
class _Compiler:
    document: Document
    tables: Tables = field(default_factory=Tables)
    problems: Problems = field(default_factory=Problems)

    def scenario(self, host: str | None) -> Scenario:
        """All of it."""
        root = self.document.root
        for name, value in root.scope.items():
            self.tables.variables[name] = self.tables.compared(value)
        declared = root.child("VariableDeclarations")
        for each in declared.all("VariableDeclaration") if declared else ():
            self.tables.variables[each.text("name")] = self.tables.compared(each.value("value"))
        paths = self._roads(root)
        entities: dict[str, int] = {}
        listed = root.need("Entities")
        for each in listed.children():
            with self.problems:
                if each.tag != "ScenarioObject":
                    raise each.unsupported()
                name = each.text("name")
                if name in entities:
                    raise fail(f"there is another entity '{name}'", each.where)
                entities[name] = len(entities)
        described = self._described(listed, entities)
        if len(entities) > MOST_ENTITIES:
            raise fail(f"{len(entities)} entities: a scenario has at most {MOST_ENTITIES}", listed.where)
        layout = Layout(self.tables, entities, paths)
        self._signals(root, layout)
        actions = Actions(layout)
        storyboard = root.need("Storyboard")
        count = sum(len(private.element.children) for private in self._privates(storyboard))
        if count > MOST_ELEMENTS:
            raise fail(f"<Init> has at most {MOST_ELEMENTS} actions", storyboard.where)
        self._starts(storyboard, layout)
        for number, (node, tow, hitch) in enumerate(described):
            with self.problems:
                start = layout.starts.get(number)
                path = NONE if start is None or tow != NONE else start.path
                self.tables.add("entities", self._entity(node, path) | {"tow": tow, "hitch": hitch})
        self._init(storyboard, actions)
        stories = Stories(actions, self.problems, storyboard.where)
        stories.read(storyboard)
        if any(isinstance(row, dict) and row["kind"] == "IF_CLOCK" for row in self.tables.rows["conditions"]):
            with self.problems:
                self.tables.clock = seconds(root.need("FileHeader"), "date")
        raise_if_any(self.problems)
        found = self._host(host, entities)
        changes = any(isinstance(row, dict) and row["kind"] == "DO_LANE_CHANGE" for row in self.tables.rows["actions"])
        for branch in paths.branches() if paths and changes else ():
            fields = {"path": branch.path, "station": branch.station, "lane": branch.lane, "to": branch.to}
            self.tables.add("branches", fields)
        made = tuple(paths.made) if paths else ()
        self._lanes(made)
        ignored = tuple(dict.fromkeys(root.context.ignored))
        return Scenario(
            self.document.parameters, self.document.decided, tuple(entities), found, tuple(stories.elements), made,
            self.tables, ignored, paths.network if paths else None, root.context.files,
        )  # fmt: skip

    def _roads(self, root: Node) -> Paths | None:
        network = root.child("RoadNetwork")
        logic = network.child("LogicFile") if network else None
        if logic is None or not logic.has("filepath"):
            return None
        name = logic.text("filepath")
        path = root.context.file(name, logic.where, "the road network")
        root.context.files[path] = name
        kind, inside = path.suffix.lower(), root.context.inside or find_root(path.parent)
        if kind == ".xodr":
            return Paths(read_network(path, shown(path)))
        if kind == ".yaml" and inside is not None:
            return Paths(open_roads(str(path), Workspace(inside)))
        hint = "supported: OpenDRIVE (.xodr), and in a workspace its roads (.yaml)"
        raise fail(f"the road network '{name}' is not supported", logic.where, hint)

    def _signals(self, root: Node, layout: Layout) -> None:
        """Controllers of traffic signals, each *delay* s after the one that it refers to."""
        network, tables = root.child("RoadNetwork"), self.tables
        signals = network.child("TrafficSignals") if network else None
        begun: dict[str, Number] = {}
        listed = list(signals.all("TrafficSignalController")) if signals else []
        if len(listed) > _MOST_CONTROLLERS:
            what = f"{len(listed)} controllers of traffic signals: a scenario has at most {_MOST_CONTROLLERS}"
            raise fail(what, listed[0].where)
        for node in listed:
            with self.problems:
                name, phases = node.text("name"), list(node.all("Phase"))
                if not phases or name in layout.controllers:
                    raise fail(
                        f"the controller '{name}' " + ("exists already" if phases else "has no phase"), node.where
                    )
                delay, other = node.number("delay", 0.0), node.text("reference", "")
                if other and other not in begun:
                    what = f"there is no controller '{other}' before this one"
                    raise fail(what, node.where, closest(other, begun))
                before = begun[other] if other else constant(0.0)
                text = f"({before.c} + {delay.c})"
                begun[name] = Number(delay.value + before.value, text, delay.names | before.names)
                names = tuple(each.text("name") for each in phases)
                row = {"phase": tables.count("phases"), "phases": len(phases), "begun": tables.number(begun[name])}
                row["variable"] = tables.signal("TrafficSignalController", name)
                layout.controllers[name] = tables.add("controllers", row), names
                for phase in phases:
                    first = tables.count("states")
                    for each in phase.all("TrafficSignalState"):
                        signal = tables.signal("TrafficSignal", each.text("trafficSignalId"))
                        tables.add("states", (signal, tables.number(tables.compared(each.text("state")))))
                    tables.add("phases", {
                        "name": tables.number(tables.compared(phase.text("name"))),
                        "duration": tables.number(phase.number("duration")),
                        "state": first, "states": tables.count("states") - first,
                    })  # fmt: skip

    def _host(self, wanted: str | None, entities: Mapping[str, int]) -> int:
        if wanted is None:
            return entities.get("Ego", NONE)
        if wanted not in entities:
            raise fail(f"the scenario has no entity '{wanted}'", self.document.root.where, closest(wanted, entities))
        return entities[wanted]

    def _described(self, listed: Node, entities: dict[str, int]) -> list[tuple[Node, int, float]]:
        """Each entity's description, who tows it and where its hitch is; trailers without a name get one."""
        found: list[tuple[Node, int, float]] = []
        for each in listed.all("ScenarioObject"):
            with self.problems:
                node = each.need(*_DESCRIPTIONS, "CatalogReference", "ExternalObjectReference").resolved()
                if node.tag not in _DESCRIPTIONS:
                    raise node.unsupported()
                found.append((node, NONE, 0.0))
        raise_if_any(self.problems)
        names, number = list(entities), 0
        while number < len(found):
            node = found[number][0]
            trailer, hitch = node.child("Trailer"), node.child("TrailerHitch")
            choice = next(trailer.children(), None) if trailer else None
            at = (number, hitch.real("dx") if hitch else 0.0)
            if choice is not None and choice.tag in {"TrailerRef", "EntityRef"}:
                name = choice.text("entityRef", "")
                if name:
                    other = entities.get(name, NONE)
                    if other == NONE:
                        raise fail(f"the trailer '{name}' is no entity", choice.where, closest(name, entities))
                    ahead = number
                    while ahead not in {NONE, other}:
                        ahead = found[ahead][1]
                    if ahead == other or found[other][1] != NONE:
                        raise fail(f"the trailer '{name}' has a tow already, or is its own", choice.where)
                    found[other] = (found[other][0], *at)
            elif choice is not None:
                whole = choice.need("Vehicle", "CatalogReference") if choice.tag == "Trailer" else choice
                names.append(f"{names[number]}+")
                entities[names[-1]] = len(found)
                found.append((whole.resolved(), *at))
            number += 1
        return found

    def _entity(self, described: Node, path: int) -> dict[str, object]:
        category = described.text("vehicleCategory", "car") if described.tag == "Vehicle" else ""
        class_ = PEDESTRIAN if described.tag == "Pedestrian" else _CLASSES.get(category, OBSTACLE)
        performance = described.child("Performance")
        names = {"top_speed": "maxSpeed", "top_acceleration": "maxAcceleration", "top_deceleration": "maxDeceleration"}
        limits = {key: performance.real(name, 0.0) if performance else 0.0 for key, name in names.items()}
        limits = {key: value if value < 1e9 else 0.0 for key, value in limits.items()}
        box = described.need("BoundingBox")
        centre, size = box.need("Center"), box.need("Dimensions")
        coupler = described.child("TrailerCoupler")
        return {
            "class": class_, "path": path, "length": size.real("length"), "width": size.real("width"),
            "height": size.real("height"), "centre_x": centre.real("x"), "centre_y": centre.real("y"), **limits,
            "coupler": coupler.real("dx") if coupler else 0.0,
        }  # fmt: skip

    def _starts(self, storyboard: Node, layout: Layout) -> None:
        """Where entities start, those by another entity after it."""
        places = []
        for private in self._privates(storyboard):
            for action in private.all("PrivateAction"):
                place = action.only()
                routing = place.only() if place.tag == "RoutingAction" else place
                target = routing.child("Position") if routing.tag == "TeleportAction" else None
                if target is not None:
                    places.append((private, target))
        known = -1
        while known < len(layout.starts) and not self.problems:
            known = len(layout.starts)
            for private, target in places:
                with self.problems:
                    layout.start(target, layout.entity(private))
        if self.problems:
            return
        routes = [
            (private, action.only().only())
            for private in self._privates(storyboard)
            for action in private.all("PrivateAction")
            if action.only().tag == "RoutingAction"
        ]
        for private, routing in routes:
            if routing.tag in {"AssignRouteAction", "AcquirePositionAction"}:
                with self.problems:
                    actor = layout.entity(private)
                    path = Actions(layout).assign_route(routing, actor)["target"]
                    if actor in layout.starts and isinstance(path, int):
                        layout.starts[actor].path = path

    def _privates(self, storyboard: Node) -> Iterator[Node]:
        init = storyboard.need("Init").child("Actions")
        return init.all("Private") if init else iter(())

    def _init(self, storyboard: Node, actions: Actions) -> None:
        init = storyboard.need("Init").child("Actions")
        rows = []
        for each in init.children() if init else ():
            with self.problems:
                if each.tag == "GlobalAction":
                    rows += actions.global_(each)
                elif each.tag == "UserDefinedAction":
                    each.ignore("commands of other programs have no effect here")
                elif each.tag == "Private":
                    actor = actions.layout.entity(each)
                    for action in each.all("PrivateAction"):
                        with self.problems:
                            rows += actions.private(action, actor)
                else:
                    raise each.unsupported()
        for row in rows:
            self.tables.add("actions", row)
        self.tables.init_count = len(rows)

    def _lanes(self, paths: tuple[ScenarioPath, ...]) -> None:
        for number, path in enumerate(paths):
            for row in path.rows:
                fields = {"start": row.start, "id": row.id, "number": row.number, "sense": row.sense, "road": row.road}
                self.tables.add("lanes", {"path": number, **fields})
