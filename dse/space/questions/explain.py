"""Why a configuration is excluded: the constraints it breaks, and the values they look at."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from dse.domain.design import Constraint, DesignSpace
from dse.domain.expression import Between, Binary, Call, Chosen, Expression, Name, Node, Number
from dse.expression.sorts import Form
from dse.expression.tree import children, descend
from dse.space.decisions import Choices, sites
from dse.space.language.evaluate import Evaluate, compile_in, compile_value
from dse.space.language.interpret import interpret
from dse.space.language.places import Places
from dse.units import Dimension, Unit

_COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")


@dataclass(frozen=True, slots=True)
class Seen:
    """Something a constraint looks at, as it is written, and what it is in the configuration."""

    what: str
    value: str


@dataclass(frozen=True, slots=True)
class Broken:
    """A constraint that does not hold, and what it looks at."""

    constraint: Constraint
    seen: tuple[Seen, ...]


def explain(space: DesignSpace, choices: Choices) -> tuple[Broken, ...]:
    """The constraints that complete *choices* break, in the order of the file; empty for a valid configuration.

    Raises DseError if a constraint cannot be understood.
    """
    places = Places(space)
    return tuple(
        Broken(constraint, tuple(_seen(space, places, constraint.rule, choices)))
        for constraint in space.constraints
        if compile_in(constraint.rule, places).outcome(choices) is False
    )


def _seen(space: DesignSpace, places: Places, rule: Expression, choices: Choices) -> Iterator[Seen]:
    standing = {site.path: site.name for site in sites(space) if site.is_there(choices)}
    units = _units(space, rule)
    told = set()
    for node in _looked_at(rule.root):
        for what, value in _read(space, places, node, rule, choices, standing, units):
            if what not in told:
                told.add(what)
                yield Seen(what, value)


def _read(
    space: DesignSpace,
    places: Places,
    node: Node,
    rule: Expression,
    choices: Choices,
    standing: dict[str, str],
    units: dict[Dimension, Unit],
) -> Iterator[tuple[str, str]]:
    if isinstance(node, Chosen):
        yield node.place, standing.get(node.place, "absent")
        return
    if isinstance(node, Call) and node.function == "same_choice":
        for place in node.arguments:
            if isinstance(place, Name):
                yield place.path, standing.get(place.path, "absent")
        return
    part = Expression(rule.text, node, rule.where, rule.pieces)
    sort, _ = interpret(part, places)
    if sort.form is Form.NUMBER:
        yield _text(node, rule), _shown(compile_value(part, space), choices, units.get(sort.dimension))


def _looked_at(root: Node) -> Iterator[Node]:
    """Choices, and the sides of comparisons that are not written out as numbers."""
    for node in descend(root):
        match node:
            case Chosen() | Call(function="same_choice"):
                yield node
            case Binary(operator) if operator in _COMPARISONS:
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


def _shown(evaluate: Evaluate[Choices], choices: Choices, unit: Unit | None) -> str:
    value = evaluate(choices)
    if value is None or isinstance(value, str):
        return "undefined"
    number = float(value) if unit is None else unit.from_si(float(value))
    return f"{number:.10g} {unit or ''}".rstrip()
