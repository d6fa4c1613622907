"""Stories of a scenario → rows of their elements, with actions and triggers."""

from __future__ import annotations

from dataclasses import dataclass, field

from dse.errors import Location, Problems, fail
from dse.world.openscenario.actions import Actions
from dse.world.openscenario.conditions import Conditions
from dse.world.openscenario.document import MOST_ELEMENTS, Node
from dse.world.openscenario.tables import NONE

_KINDS = {
    "STORY": "story",
    "ACT": "act",
    "GROUP": "maneuverGroup",
    "MANEUVER": "maneuver",
    "EVENT": "event",
    "ACTION": "action",
}


@dataclass(frozen=True, slots=True)
class Element:
    """An element of the storyboard: its *kind* as OpenSCENARIO calls it, and its *name* with those it is in."""

    kind: str
    name: str


@dataclass(slots=True)
class Stories:
    """Reads stories; *where* is the <Storyboard>. *elements* are in the order of their rows, *names* by kind."""

    actions: Actions
    problems: Problems
    where: Location
    names: dict[str, list[tuple[str, int]]] = field(default_factory=dict)
    elements: list[Element] = field(default_factory=list)
    _waiting: list[tuple[dict[str, object], str, Node]] = field(default_factory=list)

    def read(self, storyboard: Node) -> None:
        """Add all rows of a <Storyboard> but those of its <Init>."""
        for story in storyboard.all("Story"):
            self._element(story.resolved(), "STORY", NONE, "", [])
        conditions = Conditions(self.actions, self.names)
        for row, key, trigger in self._waiting:
            with self.problems:
                row[key] = conditions.trigger(trigger)
        with self.problems:
            self.actions.layout.tables.stop = conditions.trigger(storyboard.child("StopTrigger"))

    def _element(self, node: Node, kind: str, parent: int, prefix: str, actors: list[int] | None) -> None:
        """The rows of an element and of all that is in it."""
        full, number, row = self._row(kind, prefix, node.text("name", node.tag), parent)
        for key, tag in (("start", "StartTrigger"), ("stop", "StopTrigger")):
            trigger = node.child(tag)
            if trigger is not None:
                self._waiting.append((row, key, trigger))
        if kind in {"EVENT", "GROUP"}:
            row["most"] = min(node.whole("maximumExecutionCount", 1), 10**6) if node.has("maximumExecutionCount") else 1
        if kind == "EVENT":
            words = {"override": "OVERRIDE", "overwrite": "OVERRIDE", "skip": "SKIP", "parallel": "PARALLEL"}
            row["priority"] = node.word("priority", words, "parallel")
        if kind == "GROUP":
            with self.problems:
                actors = self._actors(node)
        for child in node.children():
            with self.problems:
                inner = _CHILDREN.get((kind, child.tag))
                if inner is not None:
                    self._element(child.resolved(), inner, number, full, actors)
                elif kind == "EVENT" and child.tag == "Action":
                    self._action(child, node, number, full, actors)
                elif child.tag not in _KNOWN:
                    raise child.unsupported()
        row["end"] = self.actions.layout.tables.count("elements")

    def _row(
        self, kind: str, prefix: str, name: str, parent: int, action: int = NONE
    ) -> tuple[str, int, dict[str, object]]:
        """Full name, number and new row of an element without others in it; that there are too many is one problem."""
        tables = self.actions.layout.tables
        if tables.count("elements") >= MOST_ELEMENTS:
            raise fail(f"a storyboard has at most {MOST_ELEMENTS} elements", self.where)
        row: dict[str, object] = {
            "kind": kind, "parent": parent, "end": tables.count("elements") + 1, "start": NONE, "stop": NONE, "most": 1,
            "priority": "PARALLEL", "action": action,
        }  # fmt: skip
        number, full = tables.add("elements", row), f"{prefix}/{name}" if prefix else name
        self.names.setdefault(_KINDS[kind], []).append((full, number))
        self.elements.append(Element(_KINDS[kind], full))
        return full, number, row

    def _actors(self, group: Node) -> list[int] | None:
        """None: those that trigger an event."""
        who = group.need("Actors")
        if who.flag("selectTriggeringEntities"):
            return None
        return [self.actions.layout.entity(each) for each in who.all("EntityRef")]

    def _action(self, node: Node, event: Node, parent: int, prefix: str, actors: list[int] | None) -> None:
        """A row for each actor, or each that may trigger the event; an action that does nothing ends at once."""
        choice = node.child("PrivateAction", "GlobalAction", "UserDefinedAction")
        is_chosen = actors is None and choice is not None and choice.tag == "PrivateAction"
        if actors is None:
            found = event.element.below("StartTrigger", "ConditionGroup", "Condition", "ByEntityCondition")
            named = (
                Node(each, event.scope, event.context).need("TriggeringEntities").all("EntityRef") for each in found
            )
            actors = [*dict.fromkeys(self.actions.layout.entity(each) for group in named for each in group)]
        if choice is None:
            node.ignore("is empty")
            rows = []
        elif choice.tag == "PrivateAction":
            rows = [row for actor in actors for row in self.actions.private(choice, actor)]
        elif choice.tag == "GlobalAction":
            rows = self.actions.global_(choice)
        else:
            choice.ignore("commands of other programs have no effect here")
            rows = []
        nothing: dict[str, object] = {"kind": "DO_NOTHING", "actor": NONE}
        for row in rows or [nothing]:
            action = self.actions.layout.tables.add("actions", row)
            _, _, element = self._row("ACTION", prefix, node.text("name", "Action"), parent, action)
            element["is_chosen"] = is_chosen and bool(rows)


_CHILDREN = {
    ("STORY", "Act"): "ACT",
    ("ACT", "ManeuverGroup"): "GROUP",
    ("GROUP", "Maneuver"): "MANEUVER",
    ("GROUP", "CatalogReference"): "MANEUVER",
    ("MANEUVER", "Event"): "EVENT",
}
_KNOWN = frozenset({"StartTrigger", "StopTrigger", "Actors", "ParameterDeclarations"})
