"""UnitDefinitions of an FMU: what its units are in SI."""

from __future__ import annotations

import math
from collections.abc import Mapping

from dse.domain.fmu import UnitDefinition
from dse.errors import Problem
from dse.formats import XmlElement

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def read_units(root: XmlElement, problems: list[Problem]) -> Mapping[str, UnitDefinition]:
    """The units whose relation to SI an FMI 2.0 or 3.0 description gives, by name.

    Units without a BaseUnit are left out, as are all of FMI 1.0, which has names only.
    """
    units: dict[str, UnitDefinition] = {}
    for unit in root.below("UnitDefinitions", "Unit"):
        name = unit.required("name", problems)
        base = unit.child("BaseUnit")
        if base is None:
            continue
        told = base_unit(base, problems)
        if units.setdefault(name, told) != told:
            problems.append(Problem(f"unit '{name}' is there twice, with different meanings", unit.where))
    return units


def base_unit(base: XmlElement, problems: list[Problem]) -> UnitDefinition:
    """What a ``BaseUnit`` element of FMI 2.0, FMI 3.0 or SSP says."""
    exponents = {name: base.whole(name, problems, least=-100, most=100) for name in BASE_UNITS}
    factor, offset = base.real("factor", problems), base.real("offset", problems)
    if factor is not None and (factor == 0 or not math.isfinite(factor)):
        problems.append(Problem(f"<{base.tag}>: the factor cannot be {factor:g}", base.where))
        factor = None
    if offset is not None and not math.isfinite(offset):
        problems.append(Problem(f"<{base.tag}>: the offset cannot be {offset:g}", base.where))
        offset = None
    return UnitDefinition(
        factor=1.0 if factor is None else factor,
        offset=0.0 if offset is None else offset,
        exponents={name: number for name, number in exponents.items() if number},
    )
