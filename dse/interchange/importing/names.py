"""Names of a package as names of a workspace."""

from __future__ import annotations

import re
from collections.abc import Collection

from dse.domain.system import SystemStructure
from dse.expression.tokens import KEYWORDS

_TAKEN = frozenset({"absent", "present", "bonds"})


def part_names(structure: SystemStructure) -> dict[str, str]:
    """A name for a place in a design, for each element: ``outer.inner`` becomes ``outer_inner``."""
    names: dict[str, str] = {}
    for element in sorted(structure.elements, key=lambda e: e.name):
        names[element.name] = free_name(element.name, names.values())
    return names


def free_name(text: str, taken: Collection[str]) -> str:
    """*text* as a word that stands in paths and expressions, with a number if it is taken."""
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", text) or "x"
    if plain[0].isdigit():
        plain = f"x{plain}"
    if plain in KEYWORDS or plain in _TAKEN:
        plain += "_"
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain}_{number}", number + 1
    return name
