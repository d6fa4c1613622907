"""The start of a test bench: every input of the design that nothing feeds has a value, and outputs are measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import gcd, lcm
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from dse.api.templates.wires import wires
from dse.api.templates.write import headed
from dse.domain.component import Causality, Component, Interface, Kind, Port
from dse.domain.design import Compound, DesignSpace, Part, candidates, split_path, walk
from dse.domain.labels import array_of, is_part
from dse.errors import Location, fail, some_of

if TYPE_CHECKING:
    from dse.loading import Workspace

_MOST_RECORDED = 6
_IN = Causality.INPUT
_STEP = Fraction(10)
"""Milliseconds between two communication points, where no component samples faster."""


def new_bench(workspace: Workspace, name: str, design: str, around: str | None = None) -> dict[PurePosixPath, str]:
    """The file of a bench *name* for the design space *design*, with the component *around* as what is around it.

    That is connected by the names of ports. Raises DseError if no part has an output, or an input cannot be fed.
    """
    space = workspace.design(design)
    world = workspace.component(around, Location("--around")) if around else None
    places = {path: interface for path, interface in _interfaces(space) if "." not in path}
    if world is not None and world.name in places:
        raise fail(f"the design has a part '{world.name}'", space.where, "write the bench by hand")
    unfed = _unfed(space)
    if world is not None:
        unfed |= {f"{world.name}.{array_of(p.name) or p.name}": p for p in world.interface.ports if p.causality is _IN}
    joined = wires(places | ({world.name: world.interface} if world else {}))
    connected = {target: source for source, target in joined if target in unfed}
    unfed = {label: port for label, port in unfed.items() if label not in connected}
    _require_settable(space, unfed, world)
    recorded = _outputs(({world.name: [world]} if world else {}) | candidates(space.root))
    if not recorded:
        what = f"no part of '{space.name}' has an output that is a real number"
        raise fail(what, space.where, "a bench measures waveforms: add a component that has one")
    first, port = next(iter(recorded.items()))
    word, unit = first.replace(".", "_"), str(port.type.unit)
    said = f", unit: {unit}" if unit else ""
    inputs = [f"  {label}: {_value(one)}\n" for label, one in unfed.items()]
    values = f"parameters:{' ' * 21}# unconnected inputs, and parameters\n{''.join(inputs)}" if inputs else ""
    bound = f"1 {unit}".rstrip()
    text = (
        f"testbench: {name}\ntitle: {name}\ndesign: {space.name}\n"
        f"{_around(world, connected)}{values}"
        f"simulation:\n  stop: 10 s\n  step: {_step(space)}\n  record: [{', '.join(recorded)}]\n"
        "metrics:                         # 'dse docs formats' lists the functions\n"
        f"  final_{word}: {{expression: final({first}){said}, title: {first} at the end}}\n"
        f"  largest_{word}: {{expression: maximum({first}){said}, title: largest {first}}}\n"
        "# requirements:                  # a bound gives a verdict\n"
        f"#   R1: {{metric: final_{word}, at_most: {bound}}}\n"
        f"figures:\n  {word}: {{current: {first}, title: {first}}}\n"
    )
    return {PurePosixPath("testbenches", f"{name}.yaml"): headed(text, 1, "bench")}


def _require_settable(space: DesignSpace, unfed: Mapping[str, Port], world: Component | None) -> None:
    """Raise DseError for inputs of architectures: what is given a value is an input of a component."""
    known = {*candidates(space.root), *({world.name} if world else ())}
    odd = [label for label in unfed if split_path(label, known) is None]
    if odd:
        what = f"{some_of(odd, 4)}: they are not connected, and inputs of architectures cannot be given a value"
        raise fail(what, space.where, "give --around a component that has outputs with these names")


def _around(world: Component | None, connected: Mapping[str, str]) -> str:
    if world is None:
        return (
            "# test_components:               # the environment of the design: a road, a load, a plant\n"
            "#   world: {component: NAME, parameters: {}}\n"
            "# connections: [world.output -> part.input]\n"
        )
    lines = ["test_components:", f"  {world.name}: {{component: {world.name}}}"]
    lines += ["connections:"] * bool(connected) + [f"  - {source} -> {target}" for target, source in connected.items()]
    return "\n".join(lines) + "\n"


def _outputs(places: Mapping[str, Sequence[Component]]) -> dict[str, Port]:
    """The first real outputs of single values that every alternative of a place has."""
    found = {}
    for place, components in places.items():
        for port in components[0].interface.ports:
            single = port.causality is Causality.OUTPUT and port.type.kind is Kind.REAL and "[" not in port.name
            if single and all(component.interface.port(port.name) for component in components):
                found[f"{place}.{port.name}"] = port
    return dict(list(found.items())[:_MOST_RECORDED])


def _unfed(space: DesignSpace) -> dict[str, Port]:
    """Inputs of parts that no connection of the design leads to, an array by its name."""
    compounds = [(path, node) for path, node in walk(space.root) if isinstance(node, Compound)]
    fed = [_joined(path, wire.target) for path, node in compounds for wire in node.connections]
    found: dict[str, Port] = {}
    for path, interface in _interfaces(space):
        for port in interface.ports:
            label = _joined(path, port.name)
            if port.causality is _IN and not any(is_part(label, whole) for whole in fed):
                found[array_of(label) or label] = port
    return found


def _interfaces(space: DesignSpace) -> Iterator[tuple[str, Interface]]:
    for path, node in walk(space.root):
        if path and isinstance(node, Part | Compound) and node.interface is not None:
            yield path, node.interface


def _joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _value(port: Port) -> str:
    match port.type.kind:
        case Kind.REAL:
            return f"0 {port.type.unit}".rstrip()
        case Kind.BOOLEAN:
            return "false"
        case Kind.INTEGER:
            return "0"
        case Kind.ENUMERATION:
            return f"{port.type.items[0]}{' ' * 4}# or {', '.join(port.type.items[1:])}"
        case _:
            return '""'


def _step(space: DesignSpace) -> str:
    """A step of which the sample times of all components are multiples."""
    sources = (component.source for several in candidates(space.root).values() for component in several)
    samples = [Fraction(str(source.sample_time)) * 1000 for source in sources if source and source.sample_time]
    numbers = [_STEP, *samples]
    below = lcm(*(number.denominator for number in numbers))
    step = Fraction(gcd(*(int(number * below) for number in numbers)), below)
    return f"{float(step):g} ms"
