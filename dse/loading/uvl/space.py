"""Turns the features of a UVL model into containers and parts.

* A leaf is a part, whose component states the feature's numbers as properties and has no ports.
* A feature with children is a compound. Its own numbers belong to a part of it, ``<feature>_itself``, so that
  roll-ups count them.
* A mandatory child is a part of the compound, an optional one an optional part, both under the child's name. An
  alternative group is an alternative called ``<feature>_choice``; the group ``[0..1]`` is one that may be left out.
* The children of any other group are optional parts, and a constraint, ``<feature>_group``, says how many of them
  are there when the feature is.

So there is one configuration for each valid selection of features.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import Alternative, Compound, Node, Optional, Part
from dse.loading.uvl.names import Names
from dse.loading.uvl.tokens import Source
from dse.loading.uvl.tree import Feature, Group
from dse.units import Quantity


@dataclass(slots=True)
class Spot:
    """Where a feature stands in the design space.

    Its place is *path*, where the name *choice* is chosen if it shares the place with alternatives; empty is the
    root. *below* is the path of everything in it, *itself* that of the part that states its own *numbers* (by the
    name of the property), *inside* the names of all properties stated in it.
    """

    feature: Feature
    name: str
    path: str = ""
    choice: str = ""
    always: bool = False
    itself: str = ""
    numbers: dict[str, Quantity] = field(default_factory=dict)
    inside: set[str] = field(default_factory=set)
    children: list[Spot] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Translation:
    """The tree as a design space has it, with *spots* and *properties* by the words of the model.

    *counted* are the groups that need a constraint.
    """

    root: Compound
    spots: dict[str, Spot]
    properties: dict[str, str]
    counted: Sequence[Group]


def translate(source: Source, features: Sequence[Feature]) -> Translation:
    """The design space of *features*, which are in order, parents first, and of different names."""
    translator = _Translator(source, features)
    return Translation(translator.root(), translator.spots, translator.properties, translator.counted)


class _Translator:
    def __init__(self, source: Source, features: Sequence[Feature]) -> None:
        self.source = source
        self.names = Names(feature.name for feature in features)
        keys = Names(key for feature in features for key in feature.numbers)
        self.properties = {key: keys.of(key) for feature in features for key in feature.numbers}
        self.spots = {feature.name: Spot(feature, self.names.of(feature.name)) for feature in features}
        self.counted: list[Group] = []
        self.top = self.spots[features[0].name]
        self.top.always = True

    def root(self) -> Compound:
        node = self.node(self.top)
        if isinstance(node, Compound):
            return node
        own = self.top.itself or self.names.new(f"{self.top.name}_itself")
        return Compound(node.name, {own: node}, title=_title(self.top))

    def node(self, spot: Spot) -> Part | Compound:
        """What stands at *spot*, with all that is below it."""
        feature = spot.feature
        spot.numbers = {self.properties[key]: value for key, value in feature.numbers.items()}
        spot.itself, own = spot.path, ""
        if spot.numbers and (feature.groups or spot is self.top):
            own = self.names.new(f"{spot.name}_itself")
            spot.itself = _join(spot.path, own)
        groups = [self.group(spot, group) for group in feature.groups]
        parts: dict[str, Node] = {own: self.part(spot, own)} if own else {}
        for group, (kind, choice) in zip(feature.groups, groups, strict=True):
            options = {child.name: self.node(self.spots[child.name]) for child in group.features}
            at = self.source.location(group.start)
            if choice:
                alternative = Alternative(tuple(options.values()), at)
                parts[choice] = alternative if kind == "alternative" else Optional(alternative, at)
            else:
                for name, option in options.items():
                    parts[self.spots[name].name] = option if kind == "mandatory" else Optional(option, option.where)
        spot.inside = set(spot.numbers).union(*(child.inside for child in spot.children))
        if not feature.groups:
            return self.part(spot, spot.name)
        return Compound(spot.name, parts, where=self.source.location(feature.start), title=_title(spot))

    def group(self, spot: Spot, group: Group) -> tuple[str, str]:
        """The kind of a group below *spot*, and the name of the place that its features share, "" for none."""
        kind = _kind(group)
        if kind == "counted":
            self.counted.append(group)
        choice = self.names.new(f"{spot.name}_choice") if kind in ("alternative", "at most one") else ""
        for child in (self.spots[feature.name] for feature in group.features):
            spot.children.append(child)
            child.path = _join(spot.path, choice or child.name)
            child.choice = child.name if choice else ""
            child.always = spot.always and kind == "mandatory"
        return kind, choice

    def part(self, spot: Spot, name: str) -> Part:
        """A part that states the numbers of the feature at *spot*."""
        where = self.source.location(spot.feature.start)
        return Part(Component(name, NO_INTERFACE, _title(spot), properties=spot.numbers, where=where), where)


def _title(spot: Spot) -> str:
    return spot.feature.name if spot.feature.name != spot.name else ""


def _kind(group: Group) -> str:
    """What a group is for a design space: mandatory, optional, alternative, at most one, or counted."""
    size = len(group.features)
    high = size if group.high is None else min(group.high, size)
    if group.word in ("mandatory", "optional"):
        return group.word
    if group.low == size:
        return "mandatory"
    if group.low == high == 1:
        return "alternative"
    if group.low == 0 and high == size:
        return "optional"
    return "at most one" if (group.low, high) == (0, 1) else "counted"


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name
