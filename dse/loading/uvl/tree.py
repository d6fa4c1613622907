"""Reads the feature tree of a UVL file: features, their attributes and the groups below them."""

from __future__ import annotations

from dataclasses import dataclass, field

from dse.errors import DseError, closest
from dse.loading.uvl.cursor import Cursor, number
from dse.loading.uvl.tokens import Line, Source, Token
from dse.units import Quantity

DEEPEST = 100
"""Levels of features a tree may have, so that whoever walks it can recurse."""

GROUPS = ("mandatory", "optional", "alternative", "or")
"""The groups that have a name; the others have a range, ``[1..3]``."""


@dataclass(slots=True)
class Feature:
    """A feature; *numbers* are its attributes that are numbers, *others* says what the other attributes are.

    The name of an attribute within an attribute is dotted. *rules* are constraints that stand among the attributes.
    """

    name: str
    start: int
    group: Group | None = None
    numbers: dict[str, Quantity] = field(default_factory=dict)
    others: dict[str, str] = field(default_factory=dict)
    rules: list[list[Token]] = field(default_factory=list)
    groups: list[Group] = field(default_factory=list)


@dataclass(slots=True)
class Group:
    """From *low* to *high* of *features*, whenever *parent* is selected; *high* None is all of them.

    *word* is how the group is written. ``mandatory`` and ``optional`` bound each feature for itself.
    """

    word: str
    low: int
    high: int | None
    start: int
    parent: Feature
    features: list[Feature] = field(default_factory=list)


def read_tree(source: Source, lines: list[Line]) -> list[Feature]:
    """The features of the lines below ``features``, parents first; what cannot be understood is noted in *source*."""
    features: list[Feature] = []
    stack: list[tuple[int, Feature | Group]] = []
    for line in lines:
        first = line.tokens[0]
        closed = line.indent
        while stack and stack[-1][0] >= line.indent:
            closed = stack.pop()[0]
        if closed != line.indent:
            source.note(first.start, "the indentation fits no line above", "align it with the lines it belongs to")
        above = stack[-1][1] if stack else None
        if len(stack) >= 2 * DEEPEST:
            raise source.error(first.start, f"more than {DEEPEST} levels of features", "flatten the tree")
        if isinstance(above, Feature):
            stack.append((line.indent, _group_line(source, line, above)))
            continue
        if above is None and features:
            source.note(first.start, "a second root feature", f"a tree has one root, and that is '{features[0].name}'")
        feature = _feature_line(source, line, above)
        features.append(feature)
        stack.append((line.indent, feature))
    _check(source, features)
    return features


def _group_line(source: Source, line: Line, parent: Feature) -> Group:
    first, rest = line.tokens[0], line.tokens[1:]
    group = Group(first.text, 0, None, first.start, parent)
    if first.kind == "name" and first.text in GROUPS:
        group.low = 0 if first.text == "optional" else 1
        group.high = 1 if first.text == "alternative" else None
        if rest:
            source.note(rest[0].start, f"unexpected {rest[0]} after '{first.text}'", "write it in a line of its own")
    elif first.text == "[" and first.kind == "symbol":
        reader = Cursor(source, line.tokens)
        try:
            group.low, group.high = _range(reader)
            reader.end()
        except DseError as error:
            source.add(error)
        group.word = source.text[first.start : line.tokens[-1].end]
    else:
        advice = closest(first.text, GROUPS) if len(line.tokens) == 1 else ""
        what = f"expected a group below feature '{parent.name}', found {first}"
        mend = "write mandatory, optional, alternative, or, or a range [1..3] above it"
        source.note(first.start, what, advice if advice.startswith("did") else mend)
        # Some group, so that the lines below it are still read.
        group.word = "optional"
    parent.groups.append(group)
    return group


def _feature_line(source: Source, line: Line, group: Group | None) -> Feature:
    first = line.tokens[0]
    feature = Feature(first.text, first.start, group)
    if group:
        group.features.append(feature)
    try:
        _read_feature(Cursor(source, line.tokens), feature)
    except DseError as error:
        source.add(error)
    return feature


def _read_feature(reader: Cursor, feature: Feature) -> None:
    first = reader.peek()
    following = reader.tokens[1] if len(reader.tokens) > 1 else None
    if first.kind == "name" and first.text in _TYPES and following and following.kind in ("name", "quoted"):
        if first.text != "Boolean":
            what = f"features of type {first.text} are not supported"
            raise reader.source.error(first.start, what, "a feature is there or not; give it a number as an attribute")
        reader.take()
    name = reader.name("a feature's name")
    feature.name, feature.start = name.text, name.start
    if reader.is_next("."):
        what = f"'{name.text}. …' is a feature of another model, and imports are not supported"
        raise reader.source.error(name.start, what, "put the models into one file")
    if reader.is_next("cardinality") and reader.peek().kind == "name":
        what = f"feature '{name.text}' has a cardinality, and features that are there several times are not supported"
        raise reader.source.error(reader.peek().start, what, "write one feature for each of them")
    if reader.is_next("{"):
        _attributes(reader, feature, "", 0)
    reader.end()


_TYPES = ("String", "Integer", "Real", "Boolean")
_NESTING = 20


def _range(reader: Cursor) -> tuple[int, int | None]:
    reader.expect("[")
    start = reader.peek().start
    low = _whole(reader)
    high: int | None = low
    if reader.is_next(".."):
        reader.take()
        if reader.is_next("*"):
            reader.take()
            high = None
        else:
            high = _whole(reader)
    reader.expect("]")
    if high is not None and high < low:
        raise reader.source.error(start, f"the range [{low}..{high}] is empty", f"write [{high}..{low}]")
    return low, high


def _whole(reader: Cursor) -> int:
    token = reader.peek()
    if token.kind != "number" or not token.text.isdigit() or len(token.text) > 9:
        raise reader.unexpected("a whole number", "a group has a range, [1..3], or a number, [2]")
    return int(reader.take().text)


def _attributes(reader: Cursor, feature: Feature, prefix: str, nesting: int) -> None:
    if nesting > _NESTING:
        raise reader.source.error(reader.peek().start, f"attributes more than {_NESTING} deep", "flatten them")
    reader.expect("{")
    while not reader.is_next("}"):
        _attribute(reader, feature, prefix, nesting)
        if not reader.is_next("}"):
            if not reader.is_next(","):
                raise reader.unexpected("',' or '}'")
            reader.take()
    reader.take()


def _attribute(reader: Cursor, feature: Feature, prefix: str, nesting: int) -> None:
    key = reader.name("an attribute's name")
    if key.kind == "name" and key.text == "constraint":
        feature.rules.append(_until(reader, ("}", ",")))
        return
    if key.kind == "name" and key.text == "constraints" and reader.is_next("["):
        reader.take()
        while not reader.is_next("]"):
            feature.rules.append(_until(reader, ("]", ",")))
            if reader.is_next(","):
                reader.take()
        reader.take()
        return
    name = f"{prefix}{key.text}"
    if name in feature.numbers or name in feature.others:
        raise reader.source.error(key.start, f"attribute '{name}' is defined twice at '{feature.name}'", "remove one")
    value = reader.peek()
    negative = reader.is_next("-")
    if negative:
        reader.take()
    if reader.peek().kind == "number":
        feature.numbers[name] = number(reader, negative=negative)
    elif negative:
        raise reader.unexpected("a number")
    elif reader.is_next("{"):
        feature.others[name] = "a group of attributes"
        _attributes(reader, feature, f"{name}.", nesting + 1)
    elif reader.is_next("["):
        feature.others[name] = "a list"
        _vector(reader)
    elif value.kind in ("text", "quoted"):
        feature.others[name] = "text"
        reader.take()
    else:
        feature.others[name] = "true or false"
        if reader.is_next("true") or reader.is_next("false"):
            reader.take()
        elif not (reader.is_next(",") or reader.is_next("}")):
            raise reader.unexpected("a value", "text is written in quotes: 'red'")


def _vector(reader: Cursor) -> None:
    """Skip a list: its values mean nothing to a design space, and its brackets are known to be closed."""
    reader.take()
    depth = 1
    while depth:
        token = reader.take()
        if token.kind == "end":
            raise reader.unexpected("']'")
        if token.kind == "symbol":
            depth += (token.text in "[{(") - (token.text in "]})")


def _until(reader: Cursor, stops: tuple[str, ...]) -> list[Token]:
    """The tokens up to one of *stops* that stands in no bracket."""
    taken: list[Token] = []
    depth = 0
    while depth or not (reader.peek().kind == "symbol" and reader.peek().text in stops):
        token = reader.take()
        if token.kind == "end":
            raise reader.unexpected(f"'{stops[0]}'")
        if token.kind == "symbol":
            depth += (token.text in "[{(") - (token.text in "]})")
        taken.append(token)
    if not taken:
        raise reader.unexpected("a constraint")
    return taken


def _check(source: Source, features: list[Feature]) -> None:
    first: dict[str, Feature] = {}
    for feature in features:
        known = first.setdefault(feature.name, feature)
        if known is not feature:
            where = source.location(known.start)
            source.note(
                feature.start, f"feature '{feature.name}' is defined twice", f"first defined in line {where.line}"
            )
        for group in feature.groups:
            size = len(group.features)
            if not size:
                advice = "indent its features further than the group"
                source.note(group.start, f"the group '{group.word}' has no features", advice)
            elif group.low > size:
                what = f"{group.word} asks for {group.low} features of a group of {size}"
                source.note(group.start, what, f"at most [{size}..{size}]")
