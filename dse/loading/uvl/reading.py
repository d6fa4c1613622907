"""Reads feature models in UVL, the Universal Variability Language (https://universal-variability-language.github.io).

Understood are the Boolean level with group cardinalities, attributes, constraints among the attributes, and the
arithmetic level with ``sum``, ``avg``, ``floor`` and ``ceil``. Refused by name are imported models, features of a
type other than Boolean, features with a cardinality, and constraints on texts. Attributes that are no numbers
describe a feature and decide nothing; they are read over. How features become containers: `dse.loading.uvl.space`.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from dse.domain.design import Constraint, DesignSpace
from dse.domain.expression import Binary, Call, Expression, Node, Number
from dse.errors import DseError, closest, raise_if_any
from dse.expression import show_expression
from dse.loading.uvl.constraints import chained, presence, read_constraint
from dse.loading.uvl.names import Names
from dse.loading.uvl.space import Translation, translate
from dse.loading.uvl.tokens import Line, Source, Token, read_source, split
from dse.loading.uvl.tree import Group, read_tree
from dse.units import DIMENSIONLESS


def read_uvl(path: Path) -> DesignSpace:
    """The design space of the feature model in the file at *path*, called after its root feature.

    Its constraints say the words of the file as their reason. Raises DseError with every problem found, at the
    character.
    """
    return read_uvl_text(read_source(path))


def read_uvl_text(source: Source) -> DesignSpace:
    """Like `read_uvl`, of the text in *source*."""
    sections = _sections(source, split(source))
    for section in ("imports", "include"):
        if section in sections:
            (_note_imports if section == "imports" else _check_levels)(source, sections[section][1:])
    if "features" not in sections:
        # A section of a wrong name, which is told already, may be the one that is missing.
        raise_if_any(source.problems)
        raise source.error(0, "there is no section 'features'", "features, and below it the tree, indented")
    features = read_tree(source, sections["features"][1:])
    if not features:
        source.note(sections["features"][0].tokens[0].start, "there are no features", "indent them below 'features'")
    raise_if_any(source.problems)
    model = translate(source, features)
    written = [tokens for feature in features for tokens in feature.rules]
    written += [line.tokens for line in sections.get("constraints", [])[1:]]
    constraints = _constraints(source, written, model)
    raise_if_any(source.problems)
    name, namespace = model.root.name, _title(sections)
    return DesignSpace(name, model.root, constraints, namespace if namespace != name else "", model.root.where)


_SECTIONS = ("namespace", "include", "imports", "features", "constraints")
_LEVELS = {
    "Boolean": ("group-cardinality",),
    "Arithmetic": ("aggregate-function", "feature-cardinality"),
    "Type": ("string-constraints",),
}


def _sections(source: Source, lines: list[Line]) -> dict[str, list[Line]]:
    """The lines of each section, the one that opens it first."""
    sections: dict[str, list[Line]] = {}
    current: list[Line] = []
    for line in lines:
        first = line.tokens[0]
        if line.indent and current:
            current.append(line)
            continue
        current = [line]
        if first.kind != "name" or first.text not in _SECTIONS:
            source.note(first.start, f"{first} is not a section", closest(first.text, _SECTIONS))
        elif first.text in sections:
            source.note(first.start, f"a second section '{first.text}'", "join the two")
        else:
            sections[first.text] = current
            if first.text != "namespace" and len(line.tokens) > 1:
                extra = line.tokens[1]
                source.note(extra.start, f"unexpected {extra} after '{first.text}'", "write it in a line below")
    return sections


def _title(sections: dict[str, list[Line]]) -> str:
    words = sections["namespace"][0].tokens[1:] if "namespace" in sections else []
    return "".join(token.text for token in words)


def _note_imports(source: Source, lines: list[Line]) -> None:
    for line in lines:
        what = f"the import of '{line.tokens[0].text}' is not supported"
        source.note(line.tokens[0].start, what, "put the models into one file")


def _check_levels(source: Source, lines: list[Line]) -> None:
    """Language levels switch nothing here, yet an unknown one may promise what cannot be read."""
    for line in lines:
        first = line.tokens[0]
        level, _, minor = source.text[first.start : line.tokens[-1].end].partition(".")
        if level not in _LEVELS:
            source.note(first.start, f"unknown language level '{level}'", closest(level, _LEVELS))
        elif minor not in ("", "*", *_LEVELS[level]):
            source.note(first.start, f"unknown language level '{level}.{minor}'", closest(minor, _LEVELS[level]))


def _constraints(source: Source, written: list[list[Token]], model: Translation) -> tuple[Constraint, ...]:
    """The constraints of the user, c1, c2, … in the order of the file, and those of the groups, after their feature."""
    found: list[tuple[int, str, Constraint]] = []
    names = Names(f"c{number}" for number in range(1, len(written) + 1))
    for number, tokens in enumerate(written, 1):
        try:
            rule = read_constraint(source, tokens, model)
        except DseError as error:
            source.add(error)
            continue
        because = " ".join(rule.text.split())
        found.append((tokens[0].start, "", Constraint(f"c{number}", rule, because, rule.where)))
    for group in model.counted:
        name = names.new(f"{model.spots[group.parent.name].name}_group")
        rule = _group_rule(source, group, model)
        because = f"group {group.word} below '{group.parent.name}'"
        found.append((group.start, name, Constraint(name, rule, because, rule.where)))
    found.sort(key=lambda entry: entry[:2])
    return tuple(constraint for _, _, constraint in found)


def _group_rule(source: Source, group: Group, model: Translation) -> Expression:
    nowhere = (0, 0)
    parent = model.spots[group.parent.name]
    there = [presence(model.spots[child.name], nowhere) for child in group.features]

    def counted(function: str, number: int) -> Node:
        return Call(function, (Number(Fraction(number), DIMENSIONLESS, nowhere), *there), (), nowhere)

    high = len(there) if group.high is None else min(group.high, len(there))
    if group.low == high:
        rules = [counted("exactly", high)]
    else:
        rules = [counted("at_least", group.low)] if group.low else []
        rules += [counted("at_most", high)] if high < len(there) else []
    rule = chained("and", rules, nowhere)
    if not parent.always:
        rule = Binary("implies", presence(parent, nowhere), rule, nowhere)
    return Expression(show_expression(rule), rule, source.location(group.start))
