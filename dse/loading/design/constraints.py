"""Reads the constraints of a design space and of the containers in it, and the sets they belong to."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from dse.domain.component import Component
from dse.domain.design import Compound, Constraint, ConstraintSet, split_path
from dse.errors import Problems, closest
from dse.formats import Entry
from dse.loading.design.forms import ConstraintSection, FindParts, condition
from dse.loading.design.instances import Instances, unfold
from dse.loading.design.repetition import StructureRule
from dse.loading.design.scope import Scope, constraint_name, inside
from dse.loading.names import check_name
from dse.loading.sections import Section, read_section


class ConstraintSetSection(Section):
    """A set of constraints that is switched on and off as one."""

    on: bool = True
    title: str = ""


@dataclass(frozen=True, slots=True)
class Rules:
    """A mapping of constraints at *entry* in the file, that of the container of *scope* with these *parts*."""

    entry: Entry
    scope: Scope
    parts: Collection[str]


def read_constraints(
    found: Sequence[Rules],
    structure: Sequence[StructureRule],
    root: Compound | None,
    components: Mapping[str, Sequence[Component]] | None,
    sets: Mapping[str, ConstraintSet],
    problems: Problems,
) -> tuple[Constraint, ...]:
    """The rules of the *structure* below *root*, then the constraints of all mappings *found*, in their order.

    What is wrong with them is added to *problems*.

    *components* are what can stand at every place; None, if that is not known, leaves out ranges.
    """
    constraints: dict[str, Constraint] = {}
    known = Instances(root or Compound("", {}))
    for rule in structure:
        with problems:
            constraint = rule.constraint()
            constraints[constraint.name] = replace(constraint, rule=unfold(constraint.rule, known))
    for rules in found:
        for entry, section in _sections(rules.entry, problems):
            if components is None and section.range is not None:
                continue
            with problems:
                constraint = _constraint(entry, section, rules, components or {})
                if components is not None:
                    constraint = replace(constraint, rule=unfold(constraint.rule, known))
                if constraint.name in constraints:
                    what = f"there is a constraint '{constraint.name}' already"
                    problems.add(what, constraint.where, f"see {constraints[constraint.name].where}; rename one")
                if section.set is not None and section.set not in sets:
                    advice = closest(section.set, sets) or f"constraint_sets: {{{section.set}: {{on: true}}}}"
                    problems.add(f"unknown set '{section.set}'", entry["set"].where, advice)
                constraints.setdefault(constraint.name, constraint)
    return tuple(constraints.values())


def read_sets(
    entry: Entry, sections: Mapping[str, ConstraintSetSection], problems: Problems
) -> dict[str, ConstraintSet]:
    """The constraint sets of the file by name; what is wrong is added to *problems*."""
    for name in sections:
        check_name(name, entry[name].key, problems)
    return {name: ConstraintSet(name, section.on, section.title, entry[name].key) for name, section in sections.items()}


def _sections(entry: Entry, problems: Problems) -> Iterator[tuple[Entry, ConstraintSection]]:
    if not isinstance(entry.data, dict):
        form = "constraints: {budget: {require: sum(cost) <= 9 EUR}}"
        problems.add("'constraints' must be a mapping", entry.where, form)
        return
    for name in entry.data:
        check_name(name, entry[name].key, problems)
        with problems:
            yield entry[name], read_section(entry[name], ConstraintSection)


def _constraint(
    entry: Entry, section: ConstraintSection, rules: Rules, components: Mapping[str, Sequence[Component]]
) -> Constraint:
    passage = condition(entry, section, _finder(rules.scope.path, components))
    rule = inside(rules.scope, rules.parts, passage).parse()
    name = constraint_name(rules.scope, entry.name)
    return Constraint(name, rule, section.because, entry.key, section.set or "", entry.data)


def _finder(path: str, components: Mapping[str, Sequence[Component]]) -> FindParts:
    def find(name: str) -> tuple[str, str, Sequence[Component]] | None:
        split = split_path(f"{path}.{name}" if path else name, components)
        return (*split, components[split[0]]) if split else None

    return find
