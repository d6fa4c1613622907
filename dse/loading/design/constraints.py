"""Reads the constraints of a design space and of the containers in it, and the sets they belong to."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from dse.domain.component import Component
from dse.domain.design import Compound, Constraint, ConstraintSet, Part, split_path, walk
from dse.errors import DseError, Problem, closest
from dse.formats.yaml import Document, Path_
from dse.loading.design.forms import FindParts, condition
from dse.loading.design.scope import Spot, constraint_name, inside
from dse.loading.documents import ConstraintSection, ConstraintSetSection
from dse.loading.fields import read_section
from dse.loading.names import check_name


@dataclass(frozen=True, slots=True)
class Rules:
    """A mapping of constraints at *at* in the file, that of the container at *spot* with these *parts*."""

    at: Path_
    spot: Spot
    parts: Collection[str]


def read_constraints(
    document: Document,
    found: Sequence[Rules],
    components: Mapping[str, Sequence[Component]] | None,
    sets: Mapping[str, ConstraintSet],
) -> tuple[tuple[Constraint, ...], list[Problem]]:
    """The constraints of all mappings *found*, in their order, and what is wrong with them.

    *components* are what can stand at every place; None, if that is not known, leaves out ranges.
    """
    constraints: dict[str, Constraint] = {}
    problems: list[Problem] = []
    for rules in found:
        for at, section in _sections(document, rules.at, problems):
            if components is None and section.range is not None:
                continue
            try:
                constraint = _constraint(document, at, section, rules, components or {})
            except DseError as error:
                problems += error.problems
                continue
            if constraint.name in constraints:
                first = constraints[constraint.name].where
                what = f"there is a constraint '{constraint.name}' already"
                problems.append(Problem(what, constraint.where, f"see {first}; rename one"))
            if section.set is not None and section.set not in sets:
                advice = closest(section.set, sets) or f"constraint_sets: {{{section.set}: {{on: true}}}}"
                problems.append(Problem(f"unknown set '{section.set}'", document.place((*at, "set")), advice))
            constraints.setdefault(constraint.name, constraint)
    return tuple(constraints.values()), problems


def read_sets(
    document: Document, sections: Mapping[str, ConstraintSetSection], problems: list[Problem]
) -> dict[str, ConstraintSet]:
    """The constraint sets of the file by name; what is wrong is added to *problems*."""
    for name in sections:
        check_name(name, document.key(("constraint_sets", name)), problems)
    return {
        name: ConstraintSet(name, section.on, section.title, document.key(("constraint_sets", name)))
        for name, section in sections.items()
    }


def components_of(root: Compound) -> dict[str, list[Component]]:
    """The components that can stand at every place."""
    found: dict[str, list[Component]] = {}
    for path, node in walk(root):
        if isinstance(node, Part):
            found.setdefault(path, []).append(node.component)
    return found


def _sections(document: Document, at: Path_, problems: list[Problem]) -> Iterator[tuple[Path_, ConstraintSection]]:
    entries: object = document.data
    for step in at:
        entries = entries[step]  # type: ignore[index]  # the tree was followed to here
    if not isinstance(entries, dict):
        form = "constraints: {budget: {require: sum(cost) <= 9 EUR}}"
        problems.append(Problem("'constraints' must be a mapping", document.place(at), form))
        return
    for name in entries:
        here = (*at, name)
        check_name(name, document.key(here), problems)
        try:
            yield here, read_section(document, ConstraintSection, here)
        except DseError as error:
            problems += error.problems


def _constraint(
    document: Document,
    at: Path_,
    section: ConstraintSection,
    rules: Rules,
    components: Mapping[str, Sequence[Component]],
) -> Constraint:
    passage = condition(document, at, section, _finder(rules.spot.path, components))
    rule = inside(rules.spot, rules.parts, passage).parse()
    name = constraint_name(rules.spot, str(at[-1]))
    return Constraint(name, rule, section.because, document.key(at), section.set or "")


def _finder(path: str, components: Mapping[str, Sequence[Component]]) -> FindParts:
    def find(name: str) -> tuple[str, str, Sequence[Component]] | None:
        split = split_path(f"{path}.{name}" if path else name, components)
        if split is None:
            return None
        place, own = split
        return place, own, components[place]

    return find
