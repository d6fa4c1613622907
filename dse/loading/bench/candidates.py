"""What a dotted name means, given the components that can stand at the places of a design and its bench."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from dse.domain.bench import TestComponent
from dse.domain.component import Causality, Component, Type
from dse.domain.design import Compound, DesignSpace, candidates, split_path, walk
from dse.errors import Location, closest, fail

Candidates = Mapping[str, Sequence[Component]]
"""The components that can stand at each place, by its path."""


def bench_candidates(design: DesignSpace, parts: Iterable[TestComponent]) -> Candidates:
    """For every place of the design and the bench, the components that can stand there."""
    found = candidates(design.root)
    for part in parts:
        found.setdefault(part.name, []).append(part.component)
    return found


def observable(design: DesignSpace, components: Candidates) -> Candidates:
    """*components*, and where a compound with an interface can stand, its ports under its own path."""
    found = {path: list(some) for path, some in components.items()}
    for path, node in walk(design.root):
        if path and isinstance(node, Compound) and node.interface is not None:
            found.setdefault(path, []).append(Component(node.name, node.interface))
    return found


def split_name(name: str, components: Candidates, where: Location) -> tuple[str, str]:
    """``part.port`` as (place, port): the longest place that fits. Raises DseError naming what is near."""
    split = split_path(name, components)
    if split is None:
        raise fail(f"'{name}' names no part", where, closest(name.split(".", maxsplit=1)[0], components))
    return split


def types_of(name: str, components: Candidates, where: Location) -> list[tuple[Component, Type]]:
    """The type of port or parameter *name* in each component that has it. Raises DseError if none has."""
    place, port = split_name(name, components, where)
    found = [(c, named.type) for c in components[place] if (named := c.parameter(port) or c.interface.port(port))]
    if not found:
        known = {parameter.name for c in components[place] for parameter in c.parameters}
        known |= {signal.name for c in components[place] for signal in c.interface.ports}
        raise fail(f"'{place}' has no port or parameter '{port}'", where, closest(port, known))
    return found


def settable(name: str, components: Candidates, where: Location) -> list[tuple[Component, Type]]:
    """The type of parameter or input *name* in each component that has it. Raises DseError if none has."""
    port = split_name(name, components, where)[1]
    found = [(c, type_) for c, type_ in types_of(name, components, where) if port not in outputs([c])]
    if not found:
        hint = "only parameters, and inputs that nothing is connected to, can be given a value"
        raise fail(f"'{name}' is an output", where, hint)
    return found


def outputs(components: Iterable[Component]) -> dict[str, Type]:
    """The outputs that *components* have, by name; the type is that of the first that has it."""
    ports = [port for c in components for port in c.interface.ports if port.causality is Causality.OUTPUT]
    return {port.name: port.type for port in reversed(ports)}
