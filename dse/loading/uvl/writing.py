"""Writes a design space as a feature model in UVL.

Containers become groups of features as `dse.loading.uvl.outline` tells. Properties become attributes, in SI if all
of them have finite decimals there, else in a unit of theirs in which they have; UVL has no units, so a comment
names that of each, and constraints are written in SI. Constraints that are on are written in the language of UVL,
which has no names for them; one that counts optional parts side by side becomes a range of their group. What UVL
cannot say is refused with the name of the constraint. Ports, connections, parameters and sources are left out:
a feature model has no place for them.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from dse.domain.design import Constraint, DesignSpace
from dse.domain.expression import Binary, Call, Chosen, Node, Number, Truth
from dse.errors import DseError, Problem, raise_if_any
from dse.expression import decimal
from dse.loading.uvl.outline import Outline, Outlined, outline
from dse.loading.uvl.rules import quoted, write_rule
from dse.units import Quantity, Unit, describe

Siblings = dict[int, tuple[Outline, list[Outline]]]
"""By the id of an optional feature: its parent, and all features of its group."""

_INDENT = "    "


def to_uvl(space: DesignSpace) -> str:
    """The text of a UVL file. Raises DseError with every constraint and number that UVL cannot express."""
    outlined = outline(space)
    units = _units(outlined)
    factors = {name: unit.factor for name, unit in units.items()}
    beside = {
        id(feature): (parent, children)
        for parent in outlined.root.below()
        for word, children in parent.groups
        if word == "optional"
        for feature in children
    }
    problems: list[Problem] = []
    ranges: dict[int, list[tuple[list[Outline], str]]] = {}
    rules: list[str] = []
    for constraint in space.constraints:
        found = _as_range(constraint, outlined, beside)
        if found and not any(feature in taken for taken, _ in ranges.get(id(found[0]), []) for feature in found[1]):
            ranges.setdefault(id(found[0]), []).append(found[1:])
            continue
        try:
            rules.append(write_rule(constraint.rule, outlined, factors))
        except DseError as error:
            problems += [
                Problem(f"constraint '{constraint.name}': {p.what}", p.where or constraint.where, p.hint)
                for p in error.problems
            ]
    lines = [f"// {name} is in {unit}" for name, unit in units.items() if unit.dimension]
    lines += [f"namespace {quoted(space.name)}", "", "features"]
    _write_tree(outlined.root, ranges, units, lines, problems)
    raise_if_any(problems)
    if rules:
        lines += ["constraints", *(f"{_INDENT}{rule}" for rule in rules)]
    return "\n".join(lines) + "\n"


def _units(outlined: Outlined) -> dict[str, Unit]:
    """The unit each property is written in."""
    stated: dict[str, list[Quantity]] = {}
    for feature in outlined.root.below():
        for name, quantity in feature.component.properties.items() if feature.component else ():
            stated.setdefault(name, []).append(quantity)
    found = {}
    for name, quantities in stated.items():
        dimension = quantities[0].unit.dimension
        coherent = Unit(f"SI base units ({describe(dimension)})", Fraction(1), Fraction(0), dimension)
        units = [coherent, *(quantity.unit for quantity in quantities if not quantity.unit.offset)]
        fitting = (unit for unit in units if all(decimal(quantity.si / unit.factor) for quantity in quantities))
        found[name] = next(fitting, coherent)
    return found


def _write_tree(
    root: Outline,
    ranges: dict[int, list[tuple[list[Outline], str]]],
    units: dict[str, Unit],
    lines: list[str],
    problems: list[Problem],
) -> None:
    stack: list[tuple[Outline | str, int]] = [(root, 1)]
    while stack:
        entry, level = stack.pop()
        if isinstance(entry, str):
            lines.append(f"{_INDENT * level}{entry}")
            continue
        lines.append(f"{_INDENT * level}{quoted(entry.name)}{_attributes(entry, units, problems)}")
        following: list[tuple[Outline | str, int]] = []
        for word, children in entry.groups:
            for group, some in _split(word, children, ranges.get(id(entry), [])):
                following += [(group, level + 1), *((child, level + 2) for child in some)]
        stack += reversed(following)


def _attributes(feature: Outline, units: dict[str, Unit], problems: list[Problem]) -> str:
    stated = []
    component = feature.component
    for name, quantity in component.properties.items() if component else ():
        text = decimal(quantity.si / units[name].factor)
        if text is None:
            what = f"'{name}' of '{feature.name}' is {quantity}, which has no finite decimals in {units[name]}"
            advice = "give all components this property in one unit"
            problems.append(Problem(what, component.where if component else None, advice))
        stated.append(f"{quoted(name)} {text}")
    return f" {{{', '.join(stated)}}}" if stated else ""


def _split(
    word: str, children: list[Outline], ranges: list[tuple[list[Outline], str]]
) -> Iterator[tuple[str, list[Outline]]]:
    """A group as several: those of *ranges* that are in it, and what stands between them."""
    rest: list[Outline] = []
    starts = {id(some[0]): (some, group) for some, group in ranges}
    skip = 0
    for child in children:
        if skip:
            skip -= 1
        elif id(child) in starts:
            if rest:
                yield word, rest
                rest = []
            some, group = starts[id(child)]
            yield group, some
            skip = len(some) - 1
        else:
            rest.append(child)
    if rest:
        yield word, rest


def _as_range(
    constraint: Constraint, outlined: Outlined, beside: Siblings
) -> tuple[Outline, list[Outline], str] | None:
    """The constraint as (parent, optional features side by side below it, range); None if it is no such thing."""
    guard, node = None, constraint.rule.root
    if isinstance(node, Binary) and node.operator == "implies":
        guard, node = node.left, node.right
    counts = [node]
    if isinstance(node, Binary) and node.operator == "and":
        counts = [node.left, node.right]
    low, high = 0, None
    conditions: tuple[Node, ...] | None = None
    for count in counts:
        if not isinstance(count, Call) or not count.arguments or not isinstance(count.arguments[0], Number):
            return None
        number, *others = count.arguments
        paths = tuple(other.place for other in others if isinstance(other, Chosen) and other.options == ("present",))
        if count.function not in ("at_least", "at_most", "exactly") or len(paths) != len(others):
            return None
        if conditions is not None and _places(conditions) != paths:
            return None
        conditions = tuple(others)
        if not isinstance(number, Number) or number.si.denominator != 1:
            return None
        low = int(number.si) if count.function != "at_most" else low
        high = int(number.si) if count.function != "at_least" else high
    features = _optional(_places(conditions or ()), outlined)
    parent = _parent(features, beside)
    if parent is None or not _is_guard(guard, parent, outlined):
        return None
    high = len(features) if high is None else high
    if not 0 <= low <= high <= len(features):
        return None
    word = "or" if low == 1 and high == len(features) else f"[{low}..{high}]"
    return parent, features, word


def _places(conditions: tuple[Node, ...]) -> tuple[str, ...]:
    return tuple(condition.place for condition in conditions if isinstance(condition, Chosen))


def _optional(paths: tuple[str, ...], outlined: Outlined) -> list[Outline]:
    standing = [outlined.standing.get(path, []) for path in paths]
    if not all(len(some) == 1 for some in standing):
        return []
    return [some[0][1] for some in standing]


def _parent(features: list[Outline], beside: Siblings) -> Outline | None:
    """The feature that has *features* side by side in an optional group; None if none has."""
    if len(features) < 2 or id(features[0]) not in beside:
        return None
    parent, children = beside[id(features[0])]
    start = children.index(features[0])
    return parent if children[start : start + len(features)] == features else None


def _is_guard(guard: Node | None, parent: Outline, outlined: Outlined) -> bool:
    """Whether *guard* says no more and no less than that *parent* is there."""
    if guard is None or (isinstance(guard, Truth) and guard.value):
        return parent.always
    if not isinstance(guard, Chosen):
        return False
    standing = outlined.standing.get(guard.place, [])
    meant = [feature for choice, feature in standing if choice in guard.options or "present" in guard.options]
    return meant == [parent] and "absent" not in guard.options
