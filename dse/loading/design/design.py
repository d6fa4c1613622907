"""Reads design spaces."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dse.domain.component import Interface
from dse.domain.design import DesignSpace, candidates
from dse.errors import Problems, raise_if_any
from dse.formats import Entry
from dse.loading.design.constraints import ConstraintSetSection, Rules, read_constraints, read_sets
from dse.loading.design.exchangeability import misfits
from dse.loading.design.forms import ConstraintSection
from dse.loading.design.scope import Scope
from dse.loading.design.tree import FindComponent, read_tree
from dse.loading.include import read_document
from dse.loading.sections import Section, read_section


class DesignFile(Section):
    """``designs/*.yaml``. The tree below *root* is read by hand: its shape depends on what it says."""

    design: str
    title: str = ""
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

    Components whose interface is one of *stand_ins* become the architectures that stand there.
    Among the problems are alternatives whose ports do not fit their place; what the names in constraints and the
    ends of connections mean is `dse.space.check`'s business.
    """
    entry = read_document(path, inside)
    file = read_section(entry, DesignFile)
    problems = Problems()
    tree = read_tree(entry["root"], file.design, file.root, find, interfaces, stand_ins, problems)
    is_sound = not problems
    sets = read_sets(entry["constraint_sets"], file.constraint_sets, problems)
    of_the_whole = (Rules(entry["constraints"], Scope(), ()),) if file.constraints else ()
    # What a part that could not be read lacks is not said.
    components = None if tree.root is None or problems else candidates(tree.root)
    constraints = read_constraints((*of_the_whole, *tree.rules), components, sets, problems)
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
    )
