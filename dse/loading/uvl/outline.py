"""A design space as an outline of features, and which feature stands for what.

* A compound is a feature, and so is every place that alternatives share. A part is one feature if it is called as
  its place, else the place is one with the component below it.
* What the reader of UVL makes of one feature becomes one feature again: the part ``<feature>_itself`` its numbers,
  the place ``<feature>_choice`` its alternative group.
* The name of a place or component that stands in the space several times is made longer by the places above it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from dse.domain.component import Component
from dse.domain.design import Alternative, Compound, DesignSpace, Node, Optional, Part, walk
from dse.loading.uvl.names import is_spelled


@dataclass(slots=True, eq=False)
class Outline:
    """A feature; *groups* are its children as (how they are bound, features), *component* states its numbers.

    *path* is that of its children.
    """

    name: str
    always: bool
    path: str = ""
    component: Component | None = None
    groups: list[tuple[str, list[Outline]]] = field(default_factory=list)

    def child(self, group: str, name: str, path: str) -> Outline:
        """A new feature in the last group, if that is of the same kind, else in a new one."""
        feature = Outline(name, self.always and group == "mandatory", path)
        if not self.groups or self.groups[-1][0] != group:
            self.groups.append((group, []))
        self.groups[-1][1].append(feature)
        return feature

    def below(self) -> Iterator[Outline]:
        """The feature and all below it, parents first."""
        stack = [self]
        while stack:
            feature = stack.pop()
            yield feature
            stack += [child for _, children in reversed(feature.groups) for child in reversed(children)]


@dataclass(frozen=True, slots=True)
class Outlined:
    """The outline, the features that stand for a choice at a place, and those below which all of a place is.

    *own* are the places that state just the feature's own numbers.
    """

    root: Outline
    standing: dict[str, list[tuple[str, Outline]]]
    tops: dict[str, list[Outline]]
    own: frozenset[str]


def outline(space: DesignSpace) -> Outlined:
    """The features of *space*."""
    builder = _Builder(space)
    builder.compound(space.root, builder.root)
    return Outlined(builder.root, builder.standing, builder.tops, frozenset(builder.own))


class _Builder:
    def __init__(self, space: DesignSpace) -> None:
        # A name is given as it is if nothing else in the space has it.
        nodes = list(walk(space.root))
        words = [node.name for path, node in nodes if isinstance(node, Part | Compound) and _last(path) != node.name]
        words += {path: _last(path) for path, _ in nodes if path}.values()
        self.often = Counter(words)
        self.taken: set[str] = set()
        self.standing: dict[str, list[tuple[str, Outline]]] = {}
        self.tops: dict[str, list[Outline]] = {}
        self.own: set[str] = set()
        self.titled = Counter(filter(None, (_title(node) for _, node in nodes if not _states_numbers(node))))
        # The root is called as the design space, whatever else is.
        self.taken.add(space.root.name)
        title = space.root.title
        self.root = Outline(title if is_spelled(title, space.root.name) else space.root.name, True)

    def unique(self, name: str, path: str, node: Node | None = None) -> str:
        title = _title(node) if node else ""
        if title and self.titled[title] == 1 and is_spelled(title, name) and title not in self.taken:
            self.taken.add(title)
            return title
        alone = self.often[name] <= 1 and name not in self.taken
        wanted = name if alone or not path else "_".join([*path.split("."), name])
        found, number = wanted, 2
        while found in self.taken:
            found, number = f"{wanted}_{number}", number + 1
        self.taken.add(found)
        return found

    def compound(self, compound: Compound, feature: Outline) -> None:
        for name, node in compound.parts.items():
            path = f"{feature.path}.{name}" if feature.path else name
            content = node.content if isinstance(node, Optional) else node
            if isinstance(node, Part) and _made_of(name, compound.name, "itself") and feature.component is None:
                feature.component = node.component
                self.note(path, node.name, feature)
                self.own.add(path)
            elif isinstance(content, Alternative) and _made_of(name, compound.name, "choice"):
                group = "[0..1]" if isinstance(node, Optional) else "alternative"
                # Two of them side by side are two groups, not one.
                feature.groups.append((group, []))
                self.options(content, feature, group, path)
            else:
                group = "optional" if isinstance(node, Optional) else "mandatory"
                self.place(content, feature.child(group, self.unique(name, feature.path, content), path), name)

    def place(self, node: Node, feature: Outline, name: str) -> None:
        """Fill in *feature*, which stands for the place called *name*."""
        match node:
            case Compound():
                self.note(feature.path, node.name, feature)
                self.compound(node, feature)
            case Part() if node.name == name:
                self.note(feature.path, name, feature)
                feature.component = node.component
            case Part():
                self.tops.setdefault(feature.path, []).append(feature)
                self.option(node, feature, "mandatory", feature.path)
            case Alternative():
                self.tops.setdefault(feature.path, []).append(feature)
                for option in node.options:
                    self.option(option, feature, "alternative", feature.path)

    def options(self, node: Alternative, feature: Outline, group: str, path: str) -> None:
        for option in node.options:
            self.tops.setdefault(path, []).append(self.option(option, feature, group, path))

    def option(self, option: Part | Compound, feature: Outline, group: str, path: str) -> Outline:
        chosen = feature.child(group, self.unique(option.name, path, option), path)
        self.standing.setdefault(path, []).append((option.name, chosen))
        if isinstance(option, Compound):
            self.compound(option, chosen)
        else:
            chosen.component = option.component
        return chosen

    def note(self, path: str, choice: str, feature: Outline) -> None:
        self.standing.setdefault(path, []).append((choice, feature))
        self.tops.setdefault(path, []).append(feature)


def _states_numbers(node: Node) -> bool:
    """Whether it is but a part of what the reader made of a feature."""
    return isinstance(node, Part) and node.name.rstrip("0123456789").rstrip("_").endswith("_itself")


def _title(node: Node) -> str:
    """What the feature model that *node* was read from calls it, if that is no name."""
    match node:
        case Part(component=component):
            return component.title
        case Compound(title=title):
            return title
    return ""


def _made_of(name: str, parent: str, ending: str) -> bool:
    wanted = f"{parent}_{ending}"
    return name == wanted or (name.startswith(f"{wanted}_") and name[len(wanted) + 1 :].isdigit())


def _last(path: str) -> str:
    return path.rpartition(".")[2]
