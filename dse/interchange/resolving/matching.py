"""Whether components are what their FMUs are: the kind of FMU, and connectors that match its variables."""

from __future__ import annotations

from collections.abc import Iterator

from dse.domain.fmu import FmiInterface, Variable
from dse.errors import DseError, Problem, closest
from dse.interchange.resolving.network import Network


def interface_problems(network: Network) -> Iterator[Problem]:
    """Components whose FMU is not of the kind they ask for."""
    for way, component in network.components.items():
        wanted = component.implementation
        if wanted != "any" and network.models[way].interface != FmiInterface(wanted):
            yield Problem(f"{'.'.join(way)}: its FMU has no {wanted}", component.where, 'use implementation="any"')


def connector_problems(network: Network) -> Iterator[Problem]:
    """Connectors of components that do not match their FMU."""
    for node, connector in network.connectors.items():
        model = network.models.get(node.way)
        if model is None:
            continue
        variable = model.variables.get(node.connector)
        if variable is None:
            hint = closest(node.connector, model.variables)
            yield Problem(f"the FMU of {'.'.join(node.way)} has no variable '{node.connector}'", connector.where, hint)
            continue
        if not _fits(connector.kind, variable):
            what = f"{node} is a connector of the kind {connector.kind}, the FMU's variable is {variable.causality}"
            yield Problem(what, connector.where)
        sizes = connector.sizes
        if sizes and (
            len(sizes) != len(variable.shape)
            or any(said not in (None, size) for said, size in zip(sizes, variable.shape, strict=True))
        ):
            shape = " x ".join(map(str, variable.shape)) or "a scalar"
            yield Problem(f"{node}: its dimensions are not those of the FMU's variable, {shape}", connector.where)
        try:
            network.form(node)
        except DseError as error:
            yield from error.problems


def _fits(kind: str, variable: Variable) -> bool:
    if kind == "constant":
        return variable.variability == "constant"
    # FMI 1.0 knows parameters as internal variables (A reads them as parameter), FMI 3 structural ones besides.
    allowed = {"parameter": ("parameter", "structuralParameter"), "output": ("output", "calculatedParameter")}
    return variable.causality in allowed.get(kind, (kind,))
