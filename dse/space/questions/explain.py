"""Why a configuration is excluded: the constraints it breaks, the values they look at, and what is next to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from dse.domain.design import Constraint, DesignSpace
from dse.domain.expression import Between, Binary, Call, Chosen, Expression, Name, Node, Number
from dse.expression import COMPARISON_OPERATORS, Form, children, descend
from dse.space.configurations.ids import identify
from dse.space.decisions import Choices, sites
from dse.space.language.evaluate import compile_in, compile_value
from dse.space.language.interpret import interpret
from dse.space.language.places import Places
from dse.units import Dimension, Unit

if TYPE_CHECKING:
    from dse.space.questions.nearest import Nearest


@dataclass(frozen=True, slots=True)
class SeenValue:
    """Something a constraint looks at, as it is written, and what it is in the configuration."""

    what: str
    value: str


@dataclass(frozen=True, slots=True)
class Broken:
    """A constraint that does not hold, and what it looks at."""

    constraint: Constraint
    seen: tuple[SeenValue, ...]


@dataclass(frozen=True, slots=True)
class Explanation:
    """Whether what is *chosen* is possible, and why not.

    If that is a whole configuration (*is_whole*), *choices* are its, *broken* the constraints it breaks and *nearest*
    the valid configuration next to it. Else *choices* are those of the first valid configuration that has it, None if
    there is none; then *conflict* are the constraints that prevent it, none if the choices exclude each other.
    """

    chosen: Choices
    is_whole: bool
    choices: Choices | None
    broken: tuple[Broken, ...] = ()
    nearest: Nearest | None = None
    conflict: tuple[Constraint, ...] = ()

    @property
    def is_valid(self) -> bool:
        """Whether a valid configuration has the choices."""
        return self.choices is not None and not self.broken

    @property
    def id(self) -> str:
        """The id of the configuration with *choices*; "" if there is none."""
        return identify(self.choices) if self.choices is not None else ""

    def __repr__(self) -> str:
        if self.is_whole:
            said = f"breaks {', '.join(entry.constraint.name for entry in self.broken)}" if self.broken else "valid"
            return f"<Explanation of {self.id}: {said}>"
        said = f"completed by {self.id}" if self.is_valid else f"excluded by {', '.join(c.name for c in self.conflict)}"
        return f"<Explanation of {', '.join(f'{path}={name}' for path, name in self.chosen.items())}: {said}>"


def broken_by(space: DesignSpace, choices: Choices) -> tuple[Broken, ...]:
    """The constraints that complete *choices* break, in the order of the file; empty for a valid configuration.

    Raises DseError if a constraint cannot be understood.
    """
    places = Places(space)
    return tuple(
        Broken(constraint, _Look(space, places, constraint.rule, choices).seen())
        for constraint in space.constraints
        if compile_in(constraint.rule, places).outcome(choices) is False
    )


class _Look:
    """What *rule* looks at in the configuration of *choices*."""

    def __init__(self, space: DesignSpace, places: Places, rule: Expression, choices: Choices) -> None:
        self.space, self.places, self.rule, self.choices = space, places, rule, choices
        self.standing = {site.path: site.name for site in sites(space) if site.is_there(choices)}
        self.units = _units(space, rule)

    def seen(self) -> tuple[SeenValue, ...]:
        """Everything once, as far as it is a choice or a number."""
        found: dict[str, str] = {}
        for node in _looked_at(self.rule.root):
            for what, value in self._read(node):
                found.setdefault(what, value)
        return tuple(SeenValue(what, value) for what, value in found.items())

    def _read(self, node: Node) -> Iterator[tuple[str, str]]:
        match node:
            case Chosen():
                yield node.place, self.standing.get(node.place, "absent")
            case Call("same_choice"):
                paths = [place.path for place in node.arguments if isinstance(place, Name)]
                yield from ((path, self.standing.get(path, "absent")) for path in paths)
            case _:
                part = Expression(self.rule.text, node, self.rule.where, self.rule.pieces)
                sort, _ = interpret(part, self.places)
                if sort.form is Form.NUMBER:
                    value = compile_value(part, self.space)(self.choices)
                    yield _text(node, self.rule), _shown(value, self.units.get(sort.dimension))


def _looked_at(root: Node) -> Iterator[Node]:
    """Choices, and the sides of comparisons that are not written out as numbers."""
    for node in descend(root):
        match node:
            case Chosen() | Call(function="same_choice"):
                yield node
            case Binary(operator) if operator in COMPARISON_OPERATORS:
                yield from (side for side in children(node) if not isinstance(side, Number))
            case Between():
                yield from (side for side in children(node) if not isinstance(side, Number))


def _text(node: Node, rule: Expression) -> str:
    if isinstance(node, Name):
        return node.path
    if isinstance(node, Call) and all(isinstance(argument, Name) for argument in node.arguments):
        return f"{node.function}({', '.join(a.path for a in node.arguments if isinstance(a, Name))})"
    start, end = node.span
    return " ".join(rule.text[start:end].split())


def _units(space: DesignSpace, rule: Expression) -> dict[Dimension, Unit]:
    """The unit to show each kind of value in: that of the rule's own numbers, else that of the components."""
    units = {node.unit.dimension: node.unit for node in descend(rule.root) if isinstance(node, Number)}
    for site in sites(space):
        for quantity in site.component.properties.values() if site.component else ():
            units.setdefault(quantity.unit.dimension, quantity.unit)
    return units


def _shown(value: Fraction | float | str | None, unit: Unit | None) -> str:
    if value is None or isinstance(value, str):
        return "undefined"
    number = float(value) if unit is None else unit.from_si(float(value))
    return f"{number:.10g} {unit or ''}".rstrip()
