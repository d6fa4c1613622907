"""Lines that FMUs log, made readable."""

from __future__ import annotations

import re
from collections.abc import Sequence

from dse.domain.fmu import FmuModel

_REFERENCE = re.compile(r"#(?:([ribs])(\d+)#|#)")
_TYPES = {"r": "Real", "i": "Integer", "b": "Boolean", "s": "String"}


def expanded(lines: Sequence[str], model: FmuModel) -> tuple[str, ...]:
    """*lines* with the names of variables in place of FMI 1 and 2's ``#r1365#``, and ``#`` for ``##``."""
    if model.version > 2 or not any("#" in line for line in lines):  # FMI 3 has no such references
        return tuple(lines)
    names: dict[tuple[str, int], str] = {}
    for variable in model.variables.values():
        names.setdefault((variable.fmi_type, variable.reference), variable.name)

    def name(match: re.Match[str]) -> str:
        kind, reference = match.groups()
        if kind is None:
            return "#"
        return names.get((_TYPES[kind], int(reference)), match.group())

    return tuple(_REFERENCE.sub(name, line) for line in lines)
