"""The ways to write a constraint → the one condition that must hold, as text in which every character is located."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dse.domain.component import Component, Kind
from dse.domain.expression import Binary, Conditional, Expression, Name, Node, Number, Unary
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.formats.yaml import Document, Path_
from dse.loading.documents import ConstraintSection
from dse.loading.passages import Passage, added, joined, listed, written
from dse.loading.values import read_quantity

FORMS = ("require", "forbid", "require_with", "same_choice", "at_least", "at_most", "exactly", "range")
"""The keys of a constraint that say what must hold."""

FindParts = Callable[[str], tuple[str, str, Sequence[Component]] | None]
"""``place.name`` as its place, the name and what can stand there; None if there is no such place."""


def condition(document: Document, at: Path_, section: ConstraintSection, find: FindParts) -> Passage:
    """What the constraint at *at* asks for. Raises DseError with every problem in it."""
    given = [form for form in FORMS if getattr(section, form) is not None]
    if len(given) != 1:
        what = "says nothing" if not given else f"says {' and '.join(given)}"
        raise fail(f"constraint '{at[-1]}' {what}", document.key(at), f"give one of {', '.join(FORMS)}")
    (form,) = given
    here = (*at, form)
    match form:
        case "require":
            return _written(document, here, section.require or "")
        case "forbid":
            return _forbidden(document, here, section.forbid or [])
        case "require_with":
            return _required_with(document, here, section.require_with or {})
        case "same_choice":
            return _same_choice(document, here, section.same_choice or [])
        case "range":
            return _ranges(document, here, section.range or {}, find)
    return _counted(document, here, getattr(section, form))


def _forbidden(document: Document, at: Path_, entries: list[str]) -> Passage:
    if not entries:
        raise fail("'forbid' needs at least one condition", document.place(at), "forbid: [place is x, other is y]")
    together = _conjunction(_parsed(document, at, entries))
    return joined(added("not (", together.where), together, added(")", together.where))


def _required_with(document: Document, at: Path_, sides: dict[str, str | list[str]]) -> Passage:
    form = "{if: place is x, then: other is y}, each a condition or a list of them"
    problems = [
        Problem(f"unknown key '{key}'", document.key((*at, key)), closest(key, ("if", "then")))
        for key in sides
        if key not in ("if", "then")
    ]
    raise_if_any(problems)
    raise_if_any(
        Problem(f"'{key}' is empty", document.key((*at, key)), form)
        if key in sides
        else Problem(f"'{key}' is missing", document.key(at), form)
        for key in ("if", "then")
        if not sides.get(key)
    )
    found: list[Passage] = []
    for key in ("if", "then"):
        entry = sides[key]
        here = (*at, key)
        texts = [_written(document, here, entry)] if isinstance(entry, str) else _texts(document, here, entry)
        side = _checked(texts)
        found.append(_bracketed(*side[0], ("implies", "iff")) if len(side) == 1 else _conjunction(side))
    return joined(found[0], added(" implies ", found[1].where), found[1])


def _counted(document: Document, at: Path_, entries: dict[str, list[str]]) -> Passage:
    form = f"{at[-1]}: {{2: [a is x, b is y, c is z]}}"
    if len(entries) != 1:
        raise fail(f"'{at[-1]}' needs one number with its conditions", document.key(at), form)
    ((number, conditions),) = entries.items()
    key = document.key((*at, number))
    if not (number.isascii() and number.isdigit() and len(number) < _LONGEST):
        raise fail(f"'{number}' is not a whole number, 0 or more", key, form)
    if not conditions:
        raise fail(f"'{at[-1]}' needs at least one condition", key, form)
    if at[-1] != "at_most" and int(number) > len(conditions):
        raise fail(f"{number} of {len(conditions)} conditions can never hold", key, "write a smaller number")
    arguments = [passage for passage, _ in _parsed(document, (*at, number), conditions)]
    head = joined(added(f"{at[-1]}(", document.key(at)), written(str(int(number)), key))
    return joined(head, added(", ", arguments[0].where), listed(", ", arguments), added(")", arguments[-1].where))


_LONGEST = 9


def _same_choice(document: Document, at: Path_, places: list[str]) -> Passage:
    form = "same_choice: [front.tyre, rear.tyre]"
    if len(places) < 2:
        raise fail("'same_choice' needs at least two places", document.place(at), form)
    entries = _parsed(document, at, places)
    raise_if_any(
        Problem(f"'{passage.text}' is not a place", passage.where, f"the form is {form}")
        for passage, root in entries
        if not isinstance(root, Name)
    )
    passages = [passage for passage, _ in entries]
    head = added("same_choice(", passages[0].where)
    return joined(head, listed(", ", passages), added(")", passages[-1].where))


def _ranges(document: Document, at: Path_, ranges: dict[str, list[str | int | float]], find: FindParts) -> Passage:
    if not ranges:
        raise fail("'range' names nothing", document.place(at), "range: {sensor.range: [100 m, 250 m]}")
    found: list[Passage] = []
    problems: list[Problem] = []
    for name, ends in ranges.items():
        try:
            found.append(_range(document, (*at, name), name, ends, find))
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    return listed(" and ", found)


def _range(document: Document, at: Path_, name: str, ends: list[str | int | float], find: FindParts) -> Passage:
    key = document.key(at)
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
        raise fail(f"'{own}' is a property and a parameter of what stands at '{place}'", key, advice)
    if own in stated:
        low, high = _quantities(document, at, ends, "")
        return joined(named, added(" between ", low.where), low, added(" and ", high.where), high)
    if own not in settable:
        where = Location(key.file, key.line, key.column + len(name) - len(own))
        what = f"nothing at '{place}' has a property or parameter '{own}'"
        raise fail(what, where, closest(own, stated | settable))
    low, high = _quantities(document, at, ends, _unit(components, own, key))
    parts = (named, added(".min <= ", low.where), low, added(" and ", high.where), named, added(".max >= ", high.where))
    return joined(*parts, high)


def _unit(components: Sequence[Component], name: str, where: Location) -> str:
    """The unit that a bare number has for the parameter; "?" if the components differ."""
    types = [parameter.type for component in components if (parameter := component.parameter(name))]
    for type_ in types:
        if type_.kind not in (Kind.REAL, Kind.INTEGER):
            raise fail(f"'{name}' is {type_}, which has no range", where, "only real and int parameters have one")
    symbols = {type_.unit.symbol for type_ in types}
    return symbols.pop() if len(symbols) == 1 else "?"


def _quantities(document: Document, at: Path_, ends: list[str | int | float], unit: str) -> tuple[Passage, Passage]:
    if len(ends) != 2:
        raise fail(f"'{at[-1]}': expected two ends, found {len(ends)}", document.place(at), "write it as [low, high]")
    low, high = (_quantity(document, (*at, number), raw, unit) for number, raw in enumerate(ends))
    (lower, least), (upper, most) = low, high
    if least.unit.dimension == most.unit.dimension and least.si > most.si:
        raise fail(f"the range of '{at[-1]}' is empty: {lower.text} … {upper.text}", lower.where, "low, then high")
    return lower, upper


def _quantity(document: Document, at: Path_, raw: str | int | float, unit: str) -> tuple[Passage, Number]:
    where = document.place(at)
    if not isinstance(raw, str):
        read_quantity(raw, where)
    passage = _written(document, at, raw if isinstance(raw, str) else repr(raw))
    number = _literal(passage.parse())
    if number is None:
        raise fail(f"'{raw}' is not a quantity", where, "write a number and a unit, as '70 km/h'")
    if number.unit.symbol or not unit:
        return passage, number
    if unit == "?":
        what = f"'{at[-2]}' has different units in different components"
        raise fail(what, where, f"write {raw} with its unit")
    passage = joined(passage, added(f" {unit}", where))
    return passage, _literal(passage.parse()) or number


def _literal(expression: Expression) -> Number | None:
    match expression.root:
        case Number() as number:
            return number
        case Unary("-", Number() as number):
            return Number(-number.si, number.unit, number.span)
    return None


def _written(document: Document, at: Path_, text: str) -> Passage:
    return written(text, document.origin(at))


def _texts(document: Document, at: Path_, entries: list[str]) -> list[Passage]:
    return [_written(document, (*at, number), entry) for number, entry in enumerate(entries)]


def _parsed(document: Document, at: Path_, entries: list[str]) -> list[tuple[Passage, Node]]:
    return _checked(_texts(document, at, entries))


def _checked(passages: list[Passage]) -> list[tuple[Passage, Node]]:
    """The passages with their trees: each must be an expression by itself, before they are put together."""
    found: list[tuple[Passage, Node]] = []
    problems: list[Problem] = []
    for passage in passages:
        try:
            found.append((passage, passage.parse().root))
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    return found


def _conjunction(entries: list[tuple[Passage, Node]]) -> Passage:
    if len(entries) == 1:
        return entries[0][0]
    return listed(" and ", [_bracketed(passage, root, ("or", "xor", "implies", "iff")) for passage, root in entries])


def _bracketed(passage: Passage, root: Node, weak: tuple[str, ...]) -> Passage:
    """*passage* with brackets around it if it binds as weakly as the operators *weak*."""
    if isinstance(root, Conditional) or (isinstance(root, Binary) and root.operator in weak):
        return joined(added("(", passage.where), passage, added(")", passage.where))
    return passage
