"""Whether components are what their FMUs are: the kind of FMU, and connectors that match its variables."""

from __future__ import annotations

from collections.abc import Container, Iterator

from dse.domain.fmu import FmiInterface, Variable
from dse.errors import DseError, Problem, closest
from dse.formats import shown
from dse.interchange.resolving.network import Endpoint, HopNetwork
from dse.interchange.structure import Connector, SspComponent


def of_fmu(component: SspComponent, problem: Problem) -> Problem:
    """*problem* with the FMU of *component* where that is named, which a person can change."""
    place = str(problem.where).replace(shown(component.fmu), component.source) if problem.where else component.source
    return Problem(f"{place}: {problem.what}", component.where, problem.hint)


def interface_problems(network: HopNetwork) -> Iterator[Problem]:
    """Components whose FMU is not of the kind they ask for."""
    for way, component in network.components.items():
        wanted = component.implementation
        if wanted != "any" and network.models[way].interface != FmiInterface(wanted):
            yield Problem(f"{'.'.join(way)}: its FMU has no {wanted}", component.where, 'use implementation="any"')


def connector_problems(network: HopNetwork, given: Container[Endpoint], ignored: list[Problem]) -> Iterator[Problem]:
    """Connectors of components that do not match their FMU.

    Those that are not connected, *given* a value or recorded are taken out of *network*, and *ignored* is told of them.
    """
    connected = {node for hop in network.hops.values() for node in (hop.source, hop.target)}
    for node, connector in list(network.connectors.items()):
        problems = list(_mismatches(network, node, connector)) if node.way in network.models else []
        is_recorded = connector.gives and network.variable(node) is not None
        if node in connected or node in given or is_recorded:
            yield from problems
        elif problems:
            ignored += [Problem(problem.what, problem.where) for problem in problems]
            del network.connectors[node]


def _mismatches(network: HopNetwork, node: Endpoint, connector: Connector) -> Iterator[Problem]:
    model = network.models[node.way]
    variable = model.variables.get(node.connector)
    if variable is None:
        hint = closest(node.connector, model.variables)
        yield Problem(f"the FMU of {'.'.join(node.way)} has no variable '{node.connector}'", connector.where, hint)
        return
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
