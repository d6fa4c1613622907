"""Reads design spaces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dse.domain.component import Interface
from dse.domain.design import Alternative, Compound, DesignSpace, Node, Part, candidates, walk
from dse.errors import Problem, Problems, raise_if_any
from dse.formats import Entry
from dse.loading.design.constraints import ConstraintSetSection, Rules, read_constraints, read_sets
from dse.loading.design.forms import ConstraintSection
from dse.loading.design.scope import Scope
from dse.loading.design.tree import FindComponent, read_tree
from dse.loading.include import read_document
from dse.loading.sections import Section, read_section
from dse.loading.units import UnitsSection, read_units
from dse.units import known_units, own_units


class DesignFile(Section):
    """``designs/*.yaml``. The tree below *root* is read by hand: its shape depends on what it says."""

    design: str
    title: str = ""
    units: UnitsSection = {}
    root: dict[str, Any]
    constraints: dict[str, ConstraintSection] = {}
    constraint_sets: dict[str, ConstraintSetSection] = {}


def read_design(
    path: Path,
    find: FindComponent,
    interfaces: Mapping[str, Interface],
    stand_ins: Mapping[str, Entry],
    inside: Path,
) -> DesignSpace:
    """One file of ``designs/`` of the workspace *inside*. Raises DseError with every problem in it.

    Its own units add to those that are known already.
    Components whose interface is one of *stand_ins* become the architectures that stand there.
    Among the problems are alternatives whose ports do not fit their place; what the names in constraints and the
    ends of connections mean is `dse.space.check`'s business.
    """
    entry = read_document(path, inside)
    file = read_section(entry, DesignFile)
    with own_units(read_units([(entry["units"], file.units)])):
        return _design(entry, file, find, interfaces, stand_ins)


def _design(
    entry: Entry,
    file: DesignFile,
    find: FindComponent,
    interfaces: Mapping[str, Interface],
    stand_ins: Mapping[str, Entry],
) -> DesignSpace:
    problems = Problems()
    tree = read_tree(entry["root"], file.design, file.root, find, interfaces, stand_ins, problems)
    is_sound = not problems
    sets = read_sets(entry["constraint_sets"], file.constraint_sets, problems)
    of_the_whole = (Rules(entry["constraints"], Scope(), ()),) if file.constraints else ()
    # What a part that could not be read lacks is not said.
    components = None if tree.root is None or problems else candidates(tree.root)
    structure = tree.structure if is_sound else ()
    rules = (*of_the_whole, *tree.rules)
    constraints = read_constraints(rules, structure, tree.root, components, sets, problems)
    if tree.root is not None and is_sound:
        problems += misfits(tree.root)
    raise_if_any(problems)
    assert tree.root is not None  # noqa: S101  # no problem was found, so the root was read
    return DesignSpace(
        file.design,
        tree.root,
        tuple(constraint for constraint in constraints if not constraint.set or sets[constraint.set].on),
        file.title,
        entry["design"].where,
        tuple(sets.values()),
        constraints,
        known_units(),
    )


# Whether what can stand at a place fits it: alternatives are exchangeable, so they have the same ports.


def misfits(root: Compound) -> list[Problem]:
    """Every alternative in *root* whose ports differ from those of the others, each with both interfaces' names.

    Alternatives may do without an interface if all of them do.
    """
    return [problem for path, node in walk(root) for problem in _misfits(path, node)]


def _misfits(path: str, node: Node) -> Iterator[Problem]:
    if not isinstance(node, Alternative):
        return
    first = next((option for option in node.options if option.interface), None)
    expected = first.interface if first else None
    if first is None or expected is None:
        return
    for option in node.options:
        where = option.where or node.where
        if option.interface is None:
            yield _without(path, option, first, expected)
        elif not _alike(option.interface, expected):
            what = (
                f"alternatives at '{path}' have different interfaces: "
                f"'{first.name}' is a {expected.name}, '{option.name}' a {option.interface.name}"
            )
            difference = _difference(option.name, option.interface, expected)
            yield Problem(what, where, f"alternatives must be exchangeable: {difference}")


def _without(path: str, option: Part | Compound, first: Part | Compound, expected: Interface) -> Problem:
    if isinstance(option, Compound):
        what = f"'{option.name}' at '{path}' is an architecture among alternatives without an interface"
        return Problem(what, option.where, f"add implements: {expected.name}, as '{first.name}' has")
    what = f"'{option.name}' at '{path}' implements no interface, '{first.name}' is a {expected.name}"
    at = f" in {option.component.where.file}" if option.component.where else ""
    return Problem(what, option.where, f"add implements: {expected.name}{at}")


def _alike(one: Interface, other: Interface) -> bool:
    return one is other or (one.name == other.name and set(one.ports) == set(other.ports))


def _difference(name: str, own: Interface, expected: Interface) -> str:
    """What *own*, the interface of the alternative *name*, lacks, has besides, and has otherwise."""
    mine = {port.name: port for port in own.ports}
    wanted = {port.name: port for port in expected.ports}
    said = []
    if missing := [f"{port} ({wanted[port].causality})" for port in wanted if port not in mine]:
        said.append(f"lacks {', '.join(missing)}")
    if further := [f"{port} ({mine[port].causality})" for port in mine if port not in wanted]:
        said.append(f"has {', '.join(further)} besides")
    said += [
        f"has {port} as {mine[port].causality} {mine[port].type}, not {wanted[port].causality} {wanted[port].type}"
        for port in wanted
        if port in mine and mine[port] != wanted[port]
    ]
    return f"'{name}' {', '.join(said)}" if said else "the ports are the same, so let both implement one interface"
