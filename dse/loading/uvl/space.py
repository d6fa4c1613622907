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
class Layout:
    """The tree as a design space has it, with *spots* and *properties* by the words of the model.

    *counted* are the groups that need a constraint.
    """

    root: Compound
    spots: dict[str, Spot]
    properties: dict[str, str]
    counted: Sequence[Group]


def lay_out(source: Source, features: Sequence[Feature]) -> Layout:
    """The design space of *features*, which are in order, parents first, and of different names."""
    names = Names(feature.name for feature in features)
    keys = Names(key for feature in features for key in feature.numbers)
    properties = {key: keys.of(key) for feature in features for key in feature.numbers}
    spots = {feature.name: Spot(feature, names.of(feature.name)) for feature in features}
    root = spots[features[0].name]
    root.always = True
    places: dict[int, str] = {}
    owners: dict[str, str] = {}
    counted: list[Group] = []
    for feature in features:
        spot = spots[feature.name]
        spot.numbers = {properties[key]: value for key, value in feature.numbers.items()}
        spot.inside = set(spot.numbers)
        spot.itself = spot.path
        if spot.numbers and (feature.groups or spot is root):
            owners[feature.name] = names.new(f"{spot.name}_itself")
            spot.itself = _join(spot.path, owners[feature.name])
        for group in feature.groups:
            kind = kind_of(group)
            if kind == "counted":
                counted.append(group)
            choice = names.new(f"{spot.name}_choice") if kind in ("alternative", "at most one") else ""
            places[id(group)] = choice
            for child in group.features:
                below = spots[child.name]
                spot.children.append(below)
                below.path = _join(spot.path, choice or below.name)
                below.choice = below.name if choice else ""
                below.always = spot.always and kind == "mandatory"
    nodes: dict[str, Part | Compound] = {}
    for feature in reversed(features):
        spot = spots[feature.name]
        for inner in spot.children:
            spot.inside |= inner.inside
        nodes[feature.name] = _node(source, spot, owners.get(feature.name, ""), spots, nodes, places)
    tree = nodes[features[0].name]
    if isinstance(tree, Part):
        tree = Compound(tree.name, {owners.get(features[0].name) or names.new(f"{root.name}_itself"): tree})
    return Layout(tree, spots, properties, counted)


def kind_of(group: Group) -> str:
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


def _node(
    source: Source,
    spot: Spot,
    owner: str,
    spots: dict[str, Spot],
    nodes: dict[str, Part | Compound],
    places: dict[int, str],
) -> Part | Compound:
    feature = spot.feature
    where = source.location(feature.start)
    title = feature.name if feature.name != spot.name else ""
    if not feature.groups:
        return Part(Component(spot.name, NO_INTERFACE, title, properties=spot.numbers, where=where), where)
    parts: dict[str, Node] = {}
    if owner:
        parts[owner] = Part(Component(owner, NO_INTERFACE, title, properties=spot.numbers, where=where), where)
    for group in feature.groups:
        kind = kind_of(group)
        options = [nodes.pop(child.name) for child in group.features]
        at = source.location(group.start)
        if choice := places[id(group)]:
            alternative = Alternative(tuple(options), at)
            parts[choice] = alternative if kind == "alternative" else Optional(alternative, at)
            continue
        for child, option in zip(group.features, options, strict=True):
            parts[spots[child.name].name] = option if kind == "mandatory" else Optional(option, option.where)
    return Compound(spot.name, parts, where=where)


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name
