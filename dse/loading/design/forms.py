"""The ways to write a constraint → the one condition that must hold, as text in which every character is located."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dse.domain.component import Component, Kind
from dse.domain.expression import Binary, Conditional, Expression, Name, Node, Number, Unary
from dse.errors import Location, Problem, Problems, closest, fail, raise_if_any
from dse.formats import Entry
from dse.loading.design.instances import OVER_PLACES
from dse.loading.design.located_text import Passage, added, joined, listed, written
from dse.loading.sections import Plain, Section
from dse.loading.values import read_quantity


class ConstraintSection(Section):
    """One static constraint: exactly one of the keys before *because*."""

    require: str | None = None
    forbid: list[str] | None = None
    require_with: dict[str, str | list[str]] | None = None
    same_choice: list[str] | None = None
    all_different: list[str] | None = None
    ordered: list[str] | None = None
    at_least: dict[str, list[str]] | None = None
    at_most: dict[str, list[str]] | None = None
    exactly: dict[str, list[str]] | None = None
    range: dict[str, list[Plain]] | None = None
    because: str = ""
    set: str | None = None


FORMS = ("require", "forbid", "require_with", *OVER_PLACES, "at_least", "at_most", "exactly", "range")
"""The keys of a constraint that say what must hold."""

FindParts = Callable[[str], tuple[str, str, Sequence[Component]] | None]
"""``place.name`` as its place, the name and what can stand there; None if there is no such place."""


def condition(entry: Entry, section: ConstraintSection, find: FindParts) -> Passage:
    """What the constraint at *entry* asks for. Raises DseError with every problem in it."""
    given = [form for form in FORMS if getattr(section, form) is not None]
    if len(given) != 1:
        what = "is empty" if not given else f"has {' and '.join(given)}"
        raise fail(f"constraint '{entry.name}' {what}", entry.key, f"give one of {', '.join(FORMS)}")
    (form,) = given
    here = entry[form]
    match form:
        case "require":
            return written(section.require or "", here.origin)
        case "forbid":
            return _forbidden(here, section.forbid or [])
        case "require_with":
            return _required_with(here, section.require_with or {})
        case "same_choice" | "all_different" | "ordered":
            return _compared(here, form, getattr(section, form))
        case "range":
            return _ranges(here, section.range or {}, find)
    return _counted(here, getattr(section, form))


def _forbidden(entry: Entry, conditions: list[str]) -> Passage:
    if not conditions:
        raise fail("'forbid' needs at least one condition", entry.where, "forbid: [place is x, other is y]")
    return _enclosed("not (", _conjunction(_parsed(entry, conditions)))


def _required_with(entry: Entry, sides: dict[str, str | list[str]]) -> Passage:
    form = "{if: place is x, then: other is y}, each a condition or a list of them"
    keys = ("if", "then")
    raise_if_any(Problem(f"unknown key '{k}'", entry[k].key, closest(k, keys)) for k in sides if k not in keys)
    raise_if_any(
        Problem(f"'{key}' is empty", entry[key].key, form)
        if key in sides
        else Problem(f"'{key}' is missing", entry.key, form)
        for key in keys
        if not sides.get(key)
    )
    found: list[Passage] = []
    for key in keys:
        side = sides[key]
        parsed = _checked([written(side, entry[key].origin)]) if isinstance(side, str) else _parsed(entry[key], side)
        found.append(_bracketed(*parsed[0], ("implies", "iff")) if len(parsed) == 1 else _conjunction(parsed))
    return joined(found[0], added(" implies ", found[1].where), found[1])


def _counted(entry: Entry, counts: dict[str, list[str]]) -> Passage:
    word = entry.name
    form = f"{word}: {{2: [a is x, b is y, c is z]}}"
    if len(counts) != 1:
        raise fail(f"'{word}' needs one number with its conditions", entry.key, form)
    ((number, conditions),) = counts.items()
    key = entry[number].key
    if not (number.isascii() and number.isdigit() and len(number) < _LONGEST):
        raise fail(f"'{number}' is not a whole number, 0 or more", key, form)
    if not conditions:
        raise fail(f"'{word}' needs at least one condition", key, form)
    if word != "at_most" and int(number) > len(conditions):
        raise fail(f"{number} of {len(conditions)} conditions can never hold", key, "write a smaller number")
    arguments = [passage for passage, _ in _parsed(entry[number], conditions)]
    head = joined(added(f"{word}(", entry.key), written(str(int(number)), key))
    return joined(head, added(", ", arguments[0].where), listed(", ", arguments), added(")", arguments[-1].where))


_LONGEST = 9


def _compared(entry: Entry, word: str, places: list[str]) -> Passage:
    form = f"{word}: [front.tyre, rear.tyre]"
    if not places:
        raise fail(f"'{word}' needs at least two places, or a repeated one", entry.where, form)
    parsed = _parsed(entry, places)
    raise_if_any(
        Problem(f"'{passage.text}' is not a place", passage.where, f"the form is {form}")
        for passage, root in parsed
        if not isinstance(root, Name)
    )
    passages = [passage for passage, _ in parsed]
    head = added(f"{word}(", passages[0].where)
    return joined(head, listed(", ", passages), added(")", passages[-1].where))


def _ranges(entry: Entry, ranges: dict[str, list[str | int | float]], find: FindParts) -> Passage:
    if not ranges:
        raise fail("'range' names nothing", entry.where, "range: {sensor.range: [100 m, 250 m]}")
    found: list[Passage] = []
    problems = Problems()
    for name, ends in ranges.items():
        with problems:
            found.append(_range(entry[name], ends, find))
    raise_if_any(problems)
    return listed(" and ", found)


def _range(entry: Entry, ends: list[str | int | float], find: FindParts) -> Passage:
    name, key = entry.name, entry.key
    split = find(name)
    if split is None:
        what = f"'{name}' names no part" if "." in name else f"'{name}' gives no property or parameter"
        raise fail(what, key, "the form is place.property or place.parameter: [low, high]")
    place, own, components = split
    stated = {known for component in components for known in component.properties}
    settable = {parameter.name for component in components for parameter in component.parameters}
    named = written(name, key)
    if own in stated and own in settable:
        advice = f"write require: {name} between … and …, or {name}.min <= … and {name}.max >= …"
        raise fail(f"'{own}' is a property and a parameter of what is at '{place}'", key, advice)
    if own in stated:
        low, high = _quantities(entry, ends, "")
        return joined(named, added(" between ", low.where), low, added(" and ", high.where), high)
    if own not in settable:
        where = Location(key.file, key.line, key.column + len(name) - len(own))
        what = f"nothing at '{place}' has a property or parameter '{own}'"
        raise fail(what, where, closest(own, stated | settable))
    low, high = _quantities(entry, ends, _unit(components, own, key))
    parts = (named, added(".min <= ", low.where), low, added(" and ", high.where), named, added(".max >= ", high.where))
    return joined(*parts, high)


def _unit(components: Sequence[Component], name: str, where: Location) -> str:
    """The unit that a bare number has for the parameter; "?" if the components differ."""
    types = [parameter.type for component in components if (parameter := component.parameter(name))]
    for type_ in types:
        if type_.kind not in (Kind.REAL, Kind.INTEGER):
            raise fail(f"'{name}' is {type_}, which has no range", where, "only real and int parameters have one")
    symbols = {str(type_.unit) for type_ in types}
    return symbols.pop() if len(symbols) == 1 else "?"


def _quantities(entry: Entry, ends: list[str | int | float], unit: str) -> tuple[Passage, Passage]:
    if len(ends) != 2:
        raise fail(f"'{entry.name}': expected two ends, found {len(ends)}", entry.where, "write it as [low, high]")
    low, high = (_quantity(entry[number], raw, unit, entry.name) for number, raw in enumerate(ends))
    (lower, least), (upper, most) = low, high
    if least.unit.dimension == most.unit.dimension and least.si > most.si:
        raise fail(f"the range of '{entry.name}' is empty: {lower.text} … {upper.text}", lower.where, "low, then high")
    return lower, upper


def _quantity(entry: Entry, raw: str | int | float, unit: str, name: str) -> tuple[Passage, Number]:
    where = entry.where
    if not isinstance(raw, str):
        read_quantity(raw, where)
    passage = written(raw if isinstance(raw, str) else repr(raw), entry.origin)
    number = _literal(passage.parse())
    if number is None:
        raise fail(f"'{raw}' is not a quantity", where, "write a number and a unit, as '70 km/h'")
    if number.unit.symbol or not unit:
        return passage, number
    if unit == "?":
        raise fail(f"'{name}' has different units in different components", where, f"write {raw} with its unit")
    passage = joined(passage, added(f" {unit}", where))
    return passage, _literal(passage.parse()) or number


def _literal(expression: Expression) -> Number | None:
    match expression.root:
        case Number() as number:
            return number
        case Unary("-", Number() as number):
            return Number(-number.si, number.unit, number.span)
    return None


def _parsed(entry: Entry, texts: list[str]) -> list[tuple[Passage, Node]]:
    """The conditions listed at *entry* with their trees."""
    return _checked([written(text, entry[number].origin) for number, text in enumerate(texts)])


def _checked(passages: list[Passage]) -> list[tuple[Passage, Node]]:
    """The passages with their trees: each must be an expression by itself, before they are put together."""
    found: list[tuple[Passage, Node]] = []
    problems = Problems()
    for passage in passages:
        with problems:
            found.append((passage, passage.parse().root))
    raise_if_any(problems)
    return found


def _conjunction(entries: list[tuple[Passage, Node]]) -> Passage:
    if len(entries) == 1:
        return entries[0][0]
    return listed(" and ", [_bracketed(passage, root, ("or", "xor", "implies", "iff")) for passage, root in entries])


def _bracketed(passage: Passage, root: Node, weak: tuple[str, ...]) -> Passage:
    """*passage* with brackets around it if it binds as weakly as the operators *weak*."""
    if isinstance(root, Conditional) or (isinstance(root, Binary) and root.operator in weak):
        return _enclosed("(", passage)
    return passage


def _enclosed(opening: str, passage: Passage) -> Passage:
    return joined(added(opening, passage.where), passage, added(")", passage.where))
