"""What can stand at the places of a design and its bench, and what a dotted name means there."""

from __future__ import annotations

from collections.abc import Mapping

from dse.domain.bench import TestComponent
from dse.domain.component import Causality, Component, Type
from dse.domain.design import DesignSpace, Part, split_path, walk
from dse.errors import DseError, Location, Problem, closest


def candidates(design: DesignSpace, parts: tuple[TestComponent, ...]) -> Mapping[str, tuple[Component, ...]]:
    """For every place of the design and the bench, the components that can stand there."""
    found: dict[str, list[Component]] = {}
    for path, node in walk(design.root):
        if isinstance(node, Part):
            found.setdefault(path, []).append(node.component)
    for part in parts:
        found.setdefault(part.name, []).append(part.component)
    return {path: tuple(components) for path, components in found.items()}


def split_name(name: str, components: Mapping[str, tuple[Component, ...]], where: Location) -> tuple[str, str]:
    """``part.port`` as (place, port): the longest place that fits. Raises DseError naming what is near."""
    split = split_path(name, components)
    if split is None:
        raise DseError(Problem(f"'{name}' names no part", where, closest(name.split(".", maxsplit=1)[0], components)))
    return split


def types_of(
    name: str, components: Mapping[str, tuple[Component, ...]], where: Location
) -> list[tuple[Component, Type]]:
    """The type of port or parameter *name* in each component that has it. Raises DseError if none has."""
    place, port = split_name(name, components, where)
    found = []
    for component in components[place]:
        parameter, signal = component.parameter(port), component.interface.port(port)
        if parameter:
            found.append((component, parameter.type))
        elif signal:
            found.append((component, signal.type))
    if not found:
        known = {parameter.name for c in components[place] for parameter in c.parameters}
        known |= {signal.name for c in components[place] for signal in c.interface.ports}
        raise DseError(Problem(f"'{place}' has no port or parameter '{port}'", where, closest(port, known)))
    return found


def settable(
    name: str, components: Mapping[str, tuple[Component, ...]], where: Location
) -> list[tuple[Component, Type]]:
    """The type of parameter or input *name* in each component that has it. Raises DseError if none has."""
    found = types_of(name, components, where)
    port = split_name(name, components, where)[1]
    result = [(component, type_) for component, type_ in found if not is_output(component, port)]
    if not result:
        hint = "only parameters, and inputs that nothing is connected to, can be given a value"
        raise DseError(Problem(f"'{name}' is an output", where, hint))
    return result


def is_output(component: Component, name: str) -> bool:
    """Whether *name* is an output of *component*."""
    signal = component.interface.port(name)
    return signal is not None and signal.causality is Causality.OUTPUT
