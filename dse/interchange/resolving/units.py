"""Units that a package's own files do not define, and one of its FMUs does."""

from __future__ import annotations

from dataclasses import replace

from dse.domain.fmu import UnitDefinition
from dse.errors import Location, Problem
from dse.interchange.resolving.conversion import is_known
from dse.interchange.resolving.network import Endpoint, HopNetwork, Way
from dse.interchange.structure import Assignment, NamedUnit


def take_declared_units(network: HopNetwork, given: dict[Endpoint, Assignment]) -> list[Problem]:
    """Define units of connectors, signals and values *given* as an FMU of *network* does; a note for each unit.

    The FMU at hand counts first, else all that declare the name must mean the same by it.
    """
    others: dict[str, UnitDefinition | None] = {}
    for model in network.models.values():
        for name, told in model.units.items():
            others[name] = told if others.setdefault(name, told) == told else None
    notes: dict[str, Problem] = {}

    def declared(unit: NamedUnit | None, way: Way, where: Location | None) -> NamedUnit | None:
        if unit is None or is_known(unit):
            return None
        model = network.models.get(way)
        found = (model.units.get(unit.name) if model else None) or others.get(unit.name)
        if found is None:
            return None
        what = f"the unit '{unit.name}' is not defined in the package: it means what its FMUs declare"
        notes.setdefault(unit.name, Problem(what, where))
        return NamedUnit(unit.name, found)

    for node, connector in list(network.connectors.items()):
        if connector.type and (unit := declared(connector.type.unit, node.way, connector.where)):
            network.connectors[node] = replace(connector, type=replace(connector.type, unit=unit))
    for node, form in list(network.forms.items()):
        if unit := declared(form.unit, node.way, None):
            network.forms[node] = replace(form, unit=unit)
    for node, assigned in list(given.items()):
        if unit := declared(assigned.value.unit, node.way, assigned.where):
            given[node] = replace(assigned, value=replace(assigned.value, unit=unit))
    return list(notes.values())
