"""The design spaces that the figures are about: S, L, Lf, Ltight, an empty L, and a chain of places.

S has 8 places of 5 components, two sums and compatible neighbours. L has six subsystems, each with four places of
8 and an optional one; the first place of each also offers two architectures with parts of their own: 54
decisions, 3.6e28 combinations, 40 rules, three sums. Lf has properties a hundred times finer. The bounds of
Ltight lie four standard deviations out, those of the empty one seven.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.expression.parse import parse_expression
from dse.units import parse_quantity

PROPERTIES: Mapping[str, tuple[int, str]] = {"cost": (20, "EUR"), "mass": (12, "kg"), "power": (15, "W")}
Numbers = Mapping[str, int]

ANY = Interface("any", ())


def space_s() -> DesignSpace:
    """8 places of 5; 67,057 of 390,625 are valid."""
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    places = {f"s{i}": [_component(f"s{i}_{a}", draw, 5) for a in range(5)] for i in range(8)}
    ports = [[draw.randint(0, 2) for _ in range(5)] for _ in range(8)]
    rules = {}
    for i, j in ((0, 1), (2, 3), (4, 5), (6, 7), (1, 4), (3, 6)):
        fitting = [
            f"s{i} is s{i}_{a} and s{j} is s{j}_{b}"
            for a in range(5)
            for b in range(5)
            if abs(ports[i][a] - ports[j][b]) <= 1
        ]
        rules[f"ports_{i}_{j}"] = " or ".join(fitting)
    for name in ("cost", "mass"):
        mean, deviation = _spread([[numbers(part)[name] for part in options] for options in places.values()])
        rules[f"{name}_bound"] = f"sum({name}) <= {round(mean + 0.3 * deviation)} {PROPERTIES[name][1]}"
    return _space("S", {place: Alternative(tuple(options)) for place, options in places.items()}, rules)


def space_l(*, name: str = "L", scale: int = 1, tightness: float = -0.5, sums: int = 3) -> DesignSpace:
    """54 decisions; 1003325110148026384508655 of 3.6e28 are valid with the defaults."""
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    systems = [_subsystem(f"u{number}", draw, scale) for number in range(6)]
    values = [
        [(f"u{number}.{place}", _names(node)) for place, node in system.parts.items()]
        for number, system in enumerate(systems)
    ]
    rules = {}
    for number in range(40):
        if number < 32:
            inside = values[number % 6]
            first, second = (inside[index] for index in draw.sample(range(5), 2))
        else:
            one, other = draw.sample(range(6), 2)
            first, second = draw.choice(values[one]), draw.choice(values[other])
        given, needed = draw.sample(range(8), 2), draw.sample(range(8), 5)
        rules[f"rule_{number}"] = f"{_choice(first, given)} implies {_choice(second, needed)}"
    bounds = (("cost", "<=", 1), ("mass", "<=", 1), ("power", ">=", -1))
    for quantity, operator, sign in bounds[:sums]:
        nodes = [node for system in systems for node in system.parts.values()]
        mean, deviation = _spread([_contributions(node, quantity) for node in nodes])
        bound = round(mean + sign * tightness * deviation)
        rules[f"{quantity}_bound"] = f"sum({quantity}) {operator} {bound} {PROPERTIES[quantity][1]}"
    return _space(name, {f"u{number}": system for number, system in enumerate(systems)}, rules)


def space_l_fine() -> DesignSpace:
    """L with properties a hundred times finer."""
    return space_l(name="Lf", scale=100)


def space_l_tight() -> DesignSpace:
    """L with bounds four standard deviations out: 5,340,209 are valid."""
    return space_l(name="Ltight", tightness=-4)


def space_l_empty() -> DesignSpace:
    """L with bounds that nothing meets."""
    return space_l(name="Lempty", tightness=-7)


def space_chain(places: int = 30) -> DesignSpace:
    """A chain of places of 8, each compatible with some of its neighbour's, and three small sums."""
    draw = random.Random(3)  # noqa: S311  # reproducible, not secret
    fits = [[[draw.random() < 0.6 for _ in range(8)] for _ in range(8)] for _ in range(places - 1)]
    sizes = {q: [[draw.randint(0, 5) for _ in range(8)] for _ in range(places)] for q in PROPERTIES}
    nodes = {
        f"p{i}": Alternative(tuple(_part(f"p{i}_{a}", {q: sizes[q][i][a] for q in PROPERTIES}) for a in range(8)))
        for i in range(places)
    }
    rules = {}
    for i, table in enumerate(fits):
        for a, row in enumerate(table):
            fitting = [f"p{i + 1}_{b}" for b, fit in enumerate(row) if fit]
            needed = f"p{i + 1} in [{', '.join(fitting)}]" if fitting else "false"
            rules[f"fit_{i}_{a}"] = f"p{i} is p{i}_{a} implies {needed}"
    rules |= {"cost": "sum(cost) <= 70 EUR", "mass": "sum(mass) <= 70 kg", "power": "sum(power) >= 80 W"}
    return _space("chain", nodes, rules)


def numbers(part: Part) -> Numbers:
    """The properties of a part as the whole numbers they were made from."""
    return {name: int(quantity.si) for name, quantity in part.component.properties.items()}


def _subsystem(name: str, draw: random.Random, scale: int) -> Compound:
    architectures = [
        Compound(
            f"{name}_arch{k}",
            {
                "frame": _component(f"{name}_arch{k}_frame", draw, scale),
                "x": Alternative(tuple(_component(f"{name}_arch{k}_x{a}", draw, scale) for a in range(2))),
                "o": Optional(_component(f"{name}_arch{k}_oc", draw, scale)),
            },
            interface=ANY,
        )
        for k in range(2)
    ]
    plain = [_component(f"{name}_s0_{a}", draw, scale) for a in range(6)]
    places: dict[str, Alternative | Optional] = {"s0": Alternative((*plain, *architectures))}
    for j in range(1, 4):
        places[f"s{j}"] = Alternative(tuple(_component(f"{name}_s{j}_{a}", draw, scale) for a in range(8)))
    places["s4"] = Optional(Alternative(tuple(_component(f"{name}_s4_{a}", draw, scale) for a in range(7))))
    return Compound(name, places)


def _component(name: str, draw: random.Random, scale: int) -> Part:
    return _part(name, {quantity: draw.randint(1, most * scale) for quantity, (most, _) in PROPERTIES.items()})


def _part(name: str, sizes: Numbers) -> Part:
    properties = {quantity: parse_quantity(f"{size} {PROPERTIES[quantity][1]}") for quantity, size in sizes.items()}
    return Part(Component(name, ANY, properties=properties))


def _space(name: str, places: Mapping[str, Alternative | Compound | Optional], rules: Mapping[str, str]) -> DesignSpace:
    constraints = tuple(Constraint(rule, parse_expression(text)) for rule, text in rules.items())
    return DesignSpace(name, Compound(name, places), constraints)


def _names(node: Alternative | Optional) -> list[str]:
    if isinstance(node, Optional):
        return [*_names(node.content), "absent"]
    return [option.name for option in node.options]


def _choice(place: tuple[str, list[str]], values: Sequence[int]) -> str:
    path, names = place
    return f"{path} in [{', '.join(names[value] for value in sorted(values))}]"


def _contributions(node: Alternative | Optional, quantity: str) -> list[int]:
    """What each value of a top-level place adds, the choices inside architectures left aside."""
    if isinstance(node, Optional):
        return [*_contributions(node.content, quantity), 0]
    frames = [option if isinstance(option, Part) else option.parts["frame"] for option in node.options]
    return [numbers(frame)[quantity] for frame in frames]


def _spread(columns: Sequence[Sequence[int]]) -> tuple[float, float]:
    means = [sum(column) / len(column) for column in columns]
    variances = [
        sum((x - mean) ** 2 for x in column) / len(column) for column, mean in zip(columns, means, strict=True)
    ]
    return sum(means), math.sqrt(sum(variances))
