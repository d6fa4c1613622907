"""Design spaces and configurations."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from dse.domain.component import NO_INTERFACE, Component, Interface
from dse.domain.expression import Expression
from dse.errors import Location
from dse.units import OwnUnits, Quantity


@dataclass(frozen=True, slots=True)
class Connection:
    """``source -> target``, each a dotted path to a port or a group of ports; not yet resolved.

    *ends* says where the two stand, if that is known. One with *when* is there only where, at the place of that path,
    one of these names is chosen.
    """

    source: str
    target: str
    where: Location | None = None
    ends: tuple[Location, Location] | None = None
    when: tuple[str, tuple[str, ...]] | None = None

    def __str__(self) -> str:
        return f"{self.source} -> {self.target}"

    def place(self, end: str, steps: int = 0) -> Location | None:
        """Where *end*, the source or the target, stands, from its step number *steps* on."""
        if self.ends is None:
            return self.where
        start = self.ends[0 if end == self.source else 1]
        skipped = sum(len(step) + 1 for step in end.split(".")[:steps])
        return Location(start.file, start.line, start.column + skipped)


@dataclass(frozen=True, slots=True)
class Part:
    """A place filled by one component."""

    component: Component
    where: Location | None = None

    @property
    def name(self) -> str:
        """What the choice of this node is called."""
        return self.component.name

    @property
    def interface(self) -> Interface | None:
        """The interface this node offers to its surroundings; None if the component implements none."""
        return self.component.interface if self.component.interface != NO_INTERFACE else None


@dataclass(frozen=True, slots=True)
class Allocation:
    """Which functions are allocated to which hosts, each by what choices call it with its path beside the allocation.

    *pairs* are a function, a host, the path of the decision about both below the allocation, and what is chosen there
    where the host executes the function; "" stands for anything. Of each of *loads* the first property of the
    functions is bounded by the second one of the host. *stated* are those of functions that are only names.
    """

    functions: Mapping[str, str]
    hosts: Mapping[str, str]
    pairs: tuple[tuple[str, str, str, str], ...]
    loads: tuple[tuple[str, str], ...] = ()
    stated: Mapping[str, Mapping[str, Quantity]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Form:
    """What a file says of a compound: *data*, which means these *parts* and *connections*, and these constraints."""

    data: Mapping[str, Any]
    parts: Mapping[str, Node]
    connections: tuple[Connection, ...] = ()
    constraints: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Compound:
    """An architecture: named parts and their wiring.

    An end of a connection that does not start with a part's name is a port of *interface*. The parts of a *repeated*
    one are its instances. The parts of one with an *allocation* are its decisions. What *form* says is true only of
    what was not changed since.
    """

    name: str
    parts: Mapping[str, Node]
    connections: tuple[Connection, ...] = ()
    interface: Interface | None = None
    where: Location | None = None
    repeated: bool = False
    allocation: Allocation | None = None
    form: Form | None = field(default=None, compare=False)
    title: str = ""


@dataclass(frozen=True, slots=True)
class Alternative:
    """Exactly one of *options* is chosen; they share an interface."""

    options: tuple[Part | Compound, ...]
    where: Location | None = None

    @property
    def interface(self) -> Interface | None:
        """The interface all options share."""
        return self.options[0].interface


@dataclass(frozen=True, slots=True)
class Optional:
    """*content* is there or absent."""

    content: Node
    where: Location | None = None

    @property
    def interface(self) -> Interface | None:
        """The interface of the content, when it is there."""
        return self.content.interface


Node = Part | Compound | Alternative | Optional


@dataclass(frozen=True, slots=True)
class Constraint:
    """A static constraint: *rule* must hold in every configuration.

    One that stands in a container has the container in its name (``powertrain.hybrid_p2: budget``) and in its rule.
    *set* is the name of the constraint set it belongs to, "" for none. *form* is what its file says, {} of one that
    the structure imposes, None if it is not known.
    """

    name: str
    rule: Expression
    because: str = ""
    where: Location | None = None
    set: str = ""
    form: Mapping[str, Any] | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class ConstraintSet:
    """Constraints that are switched on and off together."""

    name: str
    on: bool
    title: str = ""
    where: Location | None = None


@dataclass(frozen=True, slots=True)
class DesignSpace:
    """All designs: a tree of containers and the rules that prune it.

    *constraints* are those that are on; *all_constraints*, by default the same, those of sets that are off as well,
    in the order of the file. *units* are those that its texts may use besides the usual ones.
    """

    name: str
    root: Compound
    constraints: tuple[Constraint, ...] = ()
    title: str = ""
    where: Location | None = None
    sets: tuple[ConstraintSet, ...] = ()
    all_constraints: tuple[Constraint, ...] = ()
    units: OwnUnits = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.all_constraints:
            object.__setattr__(self, "all_constraints", self.constraints)


@dataclass(frozen=True, slots=True)
class Configuration:
    """One resolved design.

    *choices* maps the path of every decision that exists to what was chosen (``powertrain.engine`` →
    ``otto_1l0``; an optional part that is left out is absent here and in *parts*). *parts* maps the path
    of every component that is there to the component. *id* depends on *choices* alone.
    """

    id: str
    choices: Mapping[str, str]
    parts: Mapping[str, Component] = field(default_factory=dict, repr=False)
    connections: tuple[Connection, ...] = field(default=(), repr=False)

    def total(self, name: str) -> float:
        """Sum of the property *name* over all parts that have it, in SI."""
        return float(sum(c.properties[name].si for c in self.parts.values() if name in c.properties))


def split_path(name: str, places: Container[str]) -> tuple[str, str] | None:
    """``place.port`` as (place, port): the longest of *places* that *name* starts with; None if there is none."""
    steps = name.split(".")
    for length in range(len(steps) - 1, 0, -1):
        place = ".".join(steps[:length])
        if place in places:
            return place, ".".join(steps[length:])
    return None


def candidates(root: Compound) -> dict[str, list[Component]]:
    """The components that can stand at each place below *root*, by its path."""
    found: dict[str, list[Component]] = {}
    for path, node in walk(root):
        if isinstance(node, Part):
            found.setdefault(path, []).append(node.component)
    return found


def walk(node: Node, path: str = "") -> Iterator[tuple[str, Node]]:
    """Every node below and including *node* with its path, parents first; options share their container's path."""
    yield path, node
    match node:
        case Compound():
            for name, child in node.parts.items():
                yield from walk(child, f"{path}.{name}" if path else name)
        case Alternative():
            for option in node.options:
                yield from walk(option, path)
        case Optional():
            yield from walk(node.content, path)
