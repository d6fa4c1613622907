"""Random small design spaces with every construct of the language, and rows and rules by brute force.

Spaces have nested alternatives and options, architectures whose parts have the same names (so that two decisions
share a path), components without some property, and constraints over all of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from dse.domain.component import Component, Interface, Kind, Parameter, Type
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Node, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.decisions import Site, combinations as ways, sites
from dse.space.flat import NO_VALUE, Bools, Clause, FlatSpace, Fold, Gather, Linear, Rows, Rule, Table
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places
from dse.units import parse_quantity

ANY = Interface("any", ())
MOST_CONFIGURATIONS = 3000
_UNITS = {"cost": "EUR", "mass": "kg", "factor": "", "rate": ""}
_NUMBERS = ("0", "1", "2", "3", "0.5", "1.5", "-1", "2.25", "7")


@st.composite
def design_spaces(draw: st.DrawFn, most_constraints: int = 3, most: int = MOST_CONFIGURATIONS) -> DesignSpace:
    """A design space of at most *most* configurations, constraints aside, with up to *most_constraints*."""
    bare = bare_space(draw, most)
    constraints = []
    for number in range(draw(st.integers(1, most_constraints))):
        expression = parse_expression(condition(draw, bare))
        try:
            compile_in(expression, Places(bare))
        except DseError:
            continue
        constraints.append(Constraint(f"c{number}", expression))
    return replace(bare, constraints=tuple(constraints))


def bare_space(draw: st.DrawFn, most: int = MOST_CONFIGURATIONS) -> DesignSpace:
    """A design space without constraints."""
    components = [_component(draw, name) for name in "abcde"[: draw(st.integers(2, 5))]]
    parts: dict[str, Node] = {}
    for name in "pqrstuv"[: draw(st.integers(2, 7))]:
        grown = {**parts, name: _node(draw, components, 2)}
        if ways(DesignSpace("random", Compound("random", grown))) > most:
            break
        parts = grown
    return DesignSpace("random", Compound("random", parts or {"p": Part(components[0])}))


def _component(draw: st.DrawFn, name: str) -> Component:
    stated = ["mass", *(other for other in ("cost", "factor", "rate") if draw(st.integers(0, 3)))]
    properties = {one: f"{draw(st.sampled_from(_NUMBERS))} {_UNITS[one]}".strip() for one in stated}
    if draw(st.booleans()):
        properties["mass"] = f"{draw(st.integers(1, 4))} kg"
    low = float(draw(st.integers(-2, 2)))
    gain = Parameter("gain", Type(Kind.REAL), low, low, draw(st.sampled_from([3.0, 4.5])))
    quantities = {one: parse_quantity(text) for one, text in properties.items()}
    return Component(name, ANY, parameters=(gain,), properties=quantities)


def _node(draw: st.DrawFn, components: list[Component], depth: int) -> Node:
    match draw(st.integers(0, 5)):
        case 0 | 1 | 2:
            return _alternative(draw, components, depth)
        case 3:
            return _option(draw, components, depth)
        case 4:
            return Optional(_option(draw, components, depth))
    return Optional(_alternative(draw, components, depth))


def _alternative(draw: st.DrawFn, components: list[Component], depth: int) -> Alternative:
    options = [_option(draw, components, depth) for _ in range(draw(st.integers(1, 4)))]
    return Alternative(tuple({option.name: option for option in options}.values()))


def _option(draw: st.DrawFn, components: list[Component], depth: int) -> Part | Compound:
    if depth and draw(st.integers(0, 2)) == 0:
        names = [name for name in ("x", "y") if draw(st.booleans())] or ["x"]
        parts = {name: _node(draw, components, depth - 1) for name in names}
        return Compound(draw(st.sampled_from(["h", "i"])), parts, (), ANY)
    return Part(components[draw(st.integers(0, len(components) - 1))])


def condition(draw: st.DrawFn, space: DesignSpace) -> str:
    """A condition on *space*; most make sense."""
    return _Author(draw, space).condition(3)


def agreement(draw: st.DrawFn, space: DesignSpace) -> str:
    """A condition on what is chosen, most of them with ``same_choice``; never undefined."""
    return _Author(draw, space).agreement(2)


def number(draw: st.DrawFn, space: DesignSpace) -> str:
    """A value that depends on what is chosen; most make sense."""
    author = _Author(draw, space)
    return author.number(author.one(*_UNITS), 2)


class _Author:
    """Writes expressions over the names of one space."""

    def __init__(self, draw: st.DrawFn, space: DesignSpace) -> None:
        self.draw = draw
        found = list(sites(space))
        self.paths = sorted({site.path for site in found})
        self.names = {path: sorted({site.name for site in found if site.path == path}) for path in self.paths}
        components = {path: [site.component for site in found if site.path == path] for path in self.paths}
        self.ranged = [path for path in self.paths if all(components[path])]
        self.stated = {
            name: [path for path in self.ranged if all(name in component.properties for component in components[path])]
            for name in _UNITS
        }
        self.below = {name: [path for path in ("", *self.paths) if _is_below(found, path, name)] for name in _UNITS}

    def one(self, *choices: str) -> str:
        return self.draw(st.sampled_from(choices))

    def several(self, write: Callable[[], str], least: int, most: int) -> list[str]:
        return [write() for _ in range(self.draw(st.integers(least, most)))]

    def condition(self, depth: int) -> str:
        form = self.draw(st.integers(0, 12 if depth else 2))
        below = depth - 1
        match form:
            case 0:
                return self.chosen()
            case 1:
                return self.alike()
            case 2 | 3 | 4:
                return self.compared(min(depth, self.draw(st.integers(0, 2))))
            case 5 | 6:
                word = self.one("and", "or", "implies", "iff", "xor")
                return f"({self.condition(below)} {word} {self.condition(below)})"
            case 7:
                return f"not ({self.condition(below)})"
            case 8:
                return f"(if {self.condition(below)} then {self.condition(below)} else {self.condition(below)})"
            case 9:
                return self.quota(self.chosen)
            case 10:
                return self.quota(lambda: self.condition(below))
            case 11:
                return f"({' or '.join(self.several(self.chosen, 2, 5))})"
        return self.one(f"(({self.condition(below)}) == ({self.condition(below)}))", "true", "false")

    def alike(self) -> str:
        return f"same_choice({', '.join(self.several(lambda: self.one(*self.paths), 2, 4))})"

    def agreement(self, depth: int) -> str:
        """A condition that is never undefined: places are compared, and what is chosen there."""
        below = depth - 1
        match self.draw(st.integers(0, 7 if depth else 2)):
            case 0:
                return self.chosen()
            case 1 | 2:
                return self.alike()
            case 3 | 4:
                return f"not ({self.agreement(below)})"
            case 5:
                return self.quota(lambda: self.agreement(below))
            case 6:
                return f"(if {self.agreement(below)} then {self.agreement(below)} else {self.agreement(below)})"
        word = self.one("and", "or", "implies", "iff", "xor")
        return f"({self.agreement(below)} {word} {self.agreement(below)})"

    def chosen(self) -> str:
        path = self.one(*self.paths)
        options = self.several(lambda: self.one(*self.names[path], "present", "absent"), 1, 3)
        return f"{path} is {options[0]}" if len(options) == 1 else f"{path} in [{', '.join(options)}]"

    def quota(self, write: Callable[[], str]) -> str:
        texts = self.several(write, 1, 5)
        return (
            f"{self.one('at_least', 'at_most', 'exactly')}({self.draw(st.integers(0, len(texts)))}, {', '.join(texts)})"
        )

    def compared(self, depth: int) -> str:
        name = self.one(*_UNITS)
        number, relation = self.number(name, depth), self.one("<", "<=", ">", ">=", "==", "!=")
        match self.draw(st.integers(0, 4)):
            case 0:
                return f"{self.literal(name)} {relation} {number}"
            case 1:
                return f"{number} between {self.literal(name)} and {self.literal(name)}"
            case 2:
                return f"{number} {relation} {self.number(name, depth)}"
        return f"{number} {relation} {self.literal(name)}"

    def number(self, name: str, depth: int) -> str:
        """A number of the unit of the property *name*."""
        plain = not _UNITS[name]
        form = self.draw(st.integers(0, 18 if plain and depth else 13 if depth else 5))
        below = depth - 1
        match form:
            case 0 if self.stated[name]:
                return f"{self.one(*self.stated[name])}.{name}"
            case 1 if plain and self.ranged:
                return f"{self.one(*self.ranged)}.gain.{self.one('min', 'max', 'start')}"
            case 2 | 3 | 4 | 5 if self.below[name]:
                function = self.one("sum", "sum", "min", "max", "mean", *(("product", "count") if plain else ()))
                place = self.one(*self.below[name])
                return f"{function}({name}, {place})" if place else f"{function}({name})"
            case 6 | 7:
                return f"({self.number(name, below)} {self.one('+', '-')} {self.number(name, below)})"
            case 8:
                return f"({self.number(name, below)} {self.one('*', '/')} {self.number('factor', below)})"
            case 9:
                return f"({self.one(*_NUMBERS)} * {self.number(name, below)})"
            case 10:
                return f"(-{self.number(name, below)})"
            case 11:
                return f"abs({self.number(name, below)})"
            case 12:
                first = f"{self.literal(name)} + {self.number(name, below)}"
                return f"{self.one('min', 'max')}({first}, {self.number(name, below)})"
            case 13:
                return f"(if {self.condition(below)} then {self.number(name, below)} else {self.number(name, below)})"
            case 14 | 15:
                return f"({self.number('mass', below)} / {self.number('mass', below)})"
            case 16:
                return f"floor({self.number(name, below)})"
            case 17:
                return f"({self.number(name, below)} ^ {self.one('2', '3', '-1', '0', self.number(name, below))})"
            case 18:
                return f"sqrt(abs({self.number(name, below)}))"
        return self.literal(name)

    def literal(self, name: str) -> str:
        return f"{self.one(*_NUMBERS)} {_UNITS[name]}".strip()


def _is_below(found: list[Site], path: str, name: str) -> bool:
    below = [site for site in found if not path or site.path == path or site.path.startswith(f"{path}.")]
    return any(site.component and name in site.component.properties for site in below)


def spelled_out(text: str, space: DesignSpace) -> str:
    """*text* with every ``same_choice`` in other words: one name stands at all its places, or nothing at any."""
    names: dict[str, set[str]] = {}
    for site in sites(space):
        names.setdefault(site.path, set()).add(site.name)

    def spelled(call: re.Match[str]) -> str:
        paths = call[1].split(", ")
        common = sorted(set.intersection(*(names[path] for path in paths)))
        return f"({' or '.join(' and '.join(f'{path} is {name}' for path in paths) for name in [*common, 'absent'])})"

    return re.sub(r"same_choice\(([^)]*)\)", spelled, text)


def rows_of(flat: FlatSpace) -> Rows:
    """Every row of the hierarchy, rules aside; shape (rows, variables)."""

    def grow(row: list[int]) -> Iterator[list[int]]:
        if len(row) == len(flat.variables):
            yield row
            return
        variable = flat.variables[len(row)]
        exists = variable.parent is None or row[variable.parent[0]] == variable.parent[1]
        for value in range(len(variable.values)) if exists else (-1,):
            yield from grow([*row, value])

    rows = list(grow([]))
    return np.array(rows, np.int16).reshape(len(rows), len(flat.variables))


def holding(rule: Rule, rows: Rows) -> Bools:
    """Which rows meet the rule, by the rule's own arrays and its exact judge."""
    match rule:
        case Table(scope, allowed):
            return np.broadcast_to(allowed[tuple(rows[:, variable] for variable in scope)], len(rows))
        case Clause(literals):
            return np.logical_or.reduce([mask[rows[:, variable]] for variable, mask in literals])
        case Linear(weights, low, high):
            total = np.zeros(len(rows), np.int64)
            for variable, values in weights.items():
                total += values[rows[:, variable]]
            return (low is None or total >= low) & (high is None or total <= high)
    folds = zip(*(folded(fold, rows) for fold in rule.folds), strict=True) if rule.folds else [()] * len(rows)
    return np.array([rule.judge.holds(row) for row in folds], bool)


def folded(fold: Fold, rows: Rows) -> list[int]:
    """The fold of every row."""
    combine = {Gather.MIN: min, Gather.MAX: max, Gather.PRODUCT: lambda a, b: a * b, Gather.SUM: lambda a, b: a + b}
    found = []
    for row in rows.tolist():
        value = fold.start
        for variable, values in fold.values.items():
            contribution = int(values[row[variable]])
            if fold.gather is not Gather.SUM and contribution == NO_VALUE:
                continue
            nothing = fold.gather is not Gather.SUM and value == NO_VALUE
            value = contribution if nothing else combine[fold.gather](value, contribution)
        found.append(int(value))
    return found
