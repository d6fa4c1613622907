"""Reads design spaces."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dse.domain.component import Interface
from dse.domain.design import DesignSpace
from dse.errors import raise_if_any
from dse.loading.design.constraints import Rules, components_of, read_constraints, read_sets
from dse.loading.design.interfaces import misfits
from dse.loading.design.scope import Spot
from dse.loading.design.tree import FindComponent, read_tree
from dse.loading.documents import DesignFile
from dse.loading.fields import read_section
from dse.loading.include import read_document


def read_design(
    path: Path, find: FindComponent, interfaces: Mapping[str, Interface], inside: Path | None = None
) -> DesignSpace:
    """One file of ``designs/`` of the workspace *inside*. Raises DseError with every problem in it.

    Among the problems are alternatives whose ports do not fit their place; what the names in constraints and the
    ends of connections mean is `dse.space.check`'s business.
    """
    document = read_document(path, inside)
    file = read_section(document, DesignFile)
    tree = read_tree(document, file.design, file.root, find, interfaces)
    root, problems = tree.root, list(tree.problems)
    sets = read_sets(document, file.constraint_sets, problems)
    of_the_whole = (Rules(("constraints",), Spot(), ()),) if file.constraints else ()
    # What a part that could not be read lacks is not said.
    components = None if root is None or problems else components_of(root)
    constraints, found = read_constraints(document, (*of_the_whole, *tree.rules), components, sets)
    problems += found
    if root is not None and not tree.problems:
        problems += misfits(root)
    raise_if_any(problems)
    assert root is not None  # noqa: S101  # no problem was found, so the root was read
    return DesignSpace(
        file.design,
        root,
        tuple(constraint for constraint in constraints if not constraint.set or sets[constraint.set].on),
        file.title,
        document.place(("design",)),
        tuple(sets.values()),
        constraints,
    )
