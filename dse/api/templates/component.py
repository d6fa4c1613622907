"""The start of a component: its ``component.yaml``, its code, and an interface if it has one of its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from dse.api.templates.write import headed
from dse.domain.component import Causality, Interface, Kind, Port, Type
from dse.domain.labels import c_member
from dse.domain.outline import Outlined, outline
from dse.domain.python_source import class_name
from dse.errors import closest, fail
from dse.formats import write_text

if TYPE_CHECKING:
    from dse.loading import Workspace

C, MODELICA, PYTHON = "c", "modelica", "python"
_CODE = {C: ".c", MODELICA: ".mo", PYTHON: ".py"}
_ELSEWHERE = {
    "fmu": "'dse import fmu FILE.fmu' imports an FMU as a component",
    "road": "write only a component.yaml that names the road's file: 'dse docs world'",
    "time_series": "a bench reads columns of a file under its 'inputs': 'dse docs formats'",
}
_C_TYPES = {Kind.REAL: "double", Kind.BOOLEAN: "bool", Kind.INTEGER: "int32_t", Kind.ENUMERATION: "int32_t"}
_MODELICA_TYPES = {Kind.REAL: "Real", Kind.BOOLEAN: "Boolean", Kind.INTEGER: "Integer"}
_OWN_INTERFACE = """\
# Ports and their units (SI) of components that can replace each other. 'dse docs formats' has all types.
interfaces:
  {name}:
    title: Force from a speed error
    inputs: {{speed: m/s, set_speed: m/s}}
    outputs: {{force: N}}
"""


def new_component(workspace: Workspace, name: str, kind: str, implements: str | None) -> dict[PurePosixPath, str]:
    """The files of a component *name*, by their paths in *workspace*; without *implements* with its own interface.

    Raises DseError for a kind or an interface that no start can be written for.
    """
    if kind not in _CODE:
        hint = _ELSEWHERE.get(kind) or closest(kind, _CODE)
        raise fail(f"there is no template for components of the kind '{kind}'", hint=hint)
    folder = PurePosixPath("components", name)
    interface = _own(name) if implements is None else _known(workspace, implements)
    files = {folder / "interfaces.yaml": headed(_OWN_INTERFACE.format(name=name), 2, "interfaces")}
    if implements is not None or interface.name in workspace.interfaces:
        files = {}
    _require_written(interface, _MODELICA_TYPES if kind == MODELICA else _C_TYPES)
    keys = f"model: {name}, " if kind == MODELICA else ""
    step = "" if kind == MODELICA else ", step: 10 ms"
    source = f"{{kind: {kind}, {keys}files: [{name}{_CODE[kind]}]{step}}}"
    yaml = _yaml(name, interface, source, kind, is_own=implements is None)
    files[folder / "component.yaml"] = headed(yaml, 2, "component")
    if kind == C:
        files[folder / f"{name}.h"] = _header(name, interface, is_own=implements is None)
        files[folder / f"{name}.c"] = _code(name, interface, is_own=implements is None)
    else:
        start = _model if kind == MODELICA else _class
        files[folder / f"{name}{_CODE[kind]}"] = start(name, interface, is_own=implements is None)
    return files


def _own(name: str) -> Interface:
    from dse.units import parse_unit

    def port(label: str, causality: Causality, unit: str) -> Port:
        return Port(label, causality, Type(Kind.REAL, parse_unit(unit)))

    speed, wanted = port("speed", Causality.INPUT, "m/s"), port("set_speed", Causality.INPUT, "m/s")
    return Interface(name, (speed, wanted, port("force", Causality.OUTPUT, "N")))


def _known(workspace: Workspace, name: str) -> Interface:
    if name not in workspace.interfaces:
        raise fail(f"unknown interface '{name}'", hint=closest(name, workspace.interfaces))
    return workspace.interfaces[name]


def _require_written(interface: Interface, types: Mapping[Kind, str]) -> None:
    """Raise DseError for a port that the start has no words for."""
    odd = [port for port in interface.ports if port.type.kind not in types]
    arrays = [port for port in interface.ports if "[" in port.name] if types is _MODELICA_TYPES else []
    for port in (*odd, *arrays):
        what = f"'{interface.name}' has the port {port.name} ({port.type}): there is no template for such a port"
        raise fail(what, interface.where, "write the component by hand: 'dse docs formats'")


def _offset(interface: Interface) -> Port | None:
    """The output that the start's parameter goes to."""
    found = (p for p in interface.ports if p.causality is Causality.OUTPUT and p.type.kind is Kind.REAL)
    return next(found, None)


def _parameter(interface: Interface, *, is_own: bool) -> str:
    """The start's parameter as YAML, "" if there is none."""
    if is_own:
        return "  gain: {start: 800 kg/s, min: 0 kg/s, max: 5000 kg/s, title: force per speed error}\n"
    port = _offset(interface)
    if port is None:
        return ""
    unit = f" {port.type.unit}".rstrip()
    title = write_text(f"value of {port.name}")
    return f"  offset: {{start: 0{unit}, min: -1{unit}, max: 1{unit}, title: {title}}}\n"


def _yaml(name: str, interface: Interface, source: str, kind: str, *, is_own: bool) -> str:
    lines = [
        f"component: {name}\n",
        f"title: {name}\n",
        f"implements: {interface.name}{' ' * 16}# its ports; other components that implement it can replace it\n",
        f"source: {source}\n",
    ]
    names = dict.fromkeys(_top(port.name) for port in interface.ports)
    groups = [label for label in names if any(port.name.startswith(f"{label}.") for port in interface.ports)]
    if kind == MODELICA and groups:
        dotted = [port.name for port in interface.ports if "." in port.name]
        inside = ", ".join(f"{label}: {_flat(label)}" for label in dotted)
        lines.append(f"map: {{{inside}}}{' ' * 4}# ports that have other names in the model\n")
    parameter = _parameter(interface, is_own=is_own)
    if parameter:
        lines.append(
            f"parameters:{' ' * 21}# what a bench can set and a study can vary; see {name}{_CODE[kind]}\n{parameter}"
        )
    lines.append("properties: {cost: 0 EUR, mass: 0 kg}   # values for the constraints of a design space\n")
    return "".join(lines)


def _header(name: str, interface: Interface, *, is_own: bool) -> str:
    body = "".join(_side(interface, causality, word) for causality, word in _SIDES)
    parameter = "gain; /* kg/s */" if is_own else f"offset; /* {_offset_unit(interface)} */"
    if is_own or _offset(interface):
        body += f"    struct {{\n        double {parameter}\n    }} par;\n"
    guard = f"{name.upper()}_H"
    return (
        f"/* {name}: the ports of {interface.name} and the parameters of component.yaml, by their names, in SI. */\n"
        f"#ifndef {guard}\n#define {guard}\n\n#include <stdbool.h>\n#include <stdint.h>\n\n"
        f"typedef struct {{\n{body}    /* Add the state that is kept from step to step here. */\n}} {name};\n\n"
        f"void {name}_init({name} *self);\nvoid {name}_step({name} *self);\n\n#endif\n"
    )


_SIDES = ((Causality.INPUT, "in"), (Causality.OUTPUT, "out"))


def _offset_unit(interface: Interface) -> str:
    port = _offset(interface)
    return str(port.type) if port else ""


def _side(interface: Interface, causality: Causality, word: str) -> str:
    ports = [port for port in interface.ports if port.causality is causality]
    if not ports:
        return ""
    types = {str(port.type): _C_TYPES[port.type.kind] for port in ports}
    members = outline((port.name, str(port.type)) for port in ports)
    return f"    struct {{\n{''.join(_members(members.items(), types, 2))}    }} {word};\n"


def _members(members: Iterable[tuple[str, Outlined]], types: Mapping[str, str], level: int) -> Iterator[str]:
    pad = "    " * level
    for name, member in members:
        sizes = "".join(f"[{size}]" for size in member.shape)
        if member.members:
            yield f"{pad}struct {{\n{''.join(_members(member.members, types, level + 1))}{pad}}} {name}{sizes};\n"
        else:
            yield f"{pad}{types[member.type]} {name}{sizes}; /* {member.type} */\n"


def _code(name: str, interface: Interface, *, is_own: bool) -> str:
    if is_own:
        work = "    self->out.force = self->par.gain * (self->in.set_speed - self->in.speed);\n"
    else:
        outputs = [port for port in interface.ports if port.causality is Causality.OUTPUT]
        work = "".join(
            f"    self->out.{c_member(port.name)} = {'self->par.offset' if port is _offset(interface) else '0'};"
            f"{_meaning(port.type)}\n"
            for port in outputs
        )
    return (
        f'#include "{name}.h"\n\n'
        f"/* Before the first step: inputs and parameters have their values. */\n"
        f"void {name}_init({name} *self) {{\n    {name}_step(self);\n}}\n\n"
        f"/* Every 10 ms, as component.yaml defines. No globals, no allocation, nothing from libc but math.h. */\n"
        f"void {name}_step({name} *self) {{\n{work or '    (void)self;' + chr(10)}}}\n"
    )


def _meaning(type_: Type) -> str:
    if type_.kind is not Kind.ENUMERATION:
        return ""
    return f" /* {', '.join(f'{number}: {item}' for number, item in enumerate(type_.items))} */"


def _model(name: str, interface: Interface, *, is_own: bool) -> str:
    lines = []
    if is_own:
        lines.append('  parameter Real gain(unit = "kg/s") = 800 "force per speed error";\n')
    elif _offset(interface):
        lines.append(f'  parameter Real offset(unit = "{_offset_unit(interface)}") = 0;\n')
    for port in interface.ports:
        unit = f'(unit = "{port.type}")' if port.type.kind is Kind.REAL else ""
        lines.append(f"  {port.causality} {_MODELICA_TYPES[port.type.kind]} {_flat(port.name)}{unit};\n")
    lines.append("equation\n")
    if is_own:
        lines.append("  force = gain*(set_speed - speed);\n")
    for port in () if is_own else interface.ports:
        if port.causality is Causality.OUTPUT:
            value = "offset" if port is _offset(interface) else "false" if port.type.kind is Kind.BOOLEAN else "0"
            lines.append(f"  {_flat(port.name)} = {value};\n")
    return f'model {name} "Description of the model"\n{"".join(lines)}end {name};\n'


def _class(name: str, interface: Interface, *, is_own: bool) -> str:
    outputs = [port for port in interface.ports if port.causality is Causality.OUTPUT]
    offset = 'self.parameters["offset"]'
    lines = [
        f'            "{port.name}": {offset if port is _offset(interface) else _plain_value(port.type)},\n'
        for port in outputs
    ]
    own = '            "force": self.parameters["gain"] * (inputs["set_speed"] - inputs["speed"]),\n'
    return f'''\
"""{name}: ports and parameters by their names in {interface.name} and component.yaml, in SI."""


class {class_name(name)}:
    def __init__(self, parameters):
        self.parameters = parameters  # always with the present values

    def step(self, inputs, h):
        """The outputs; *h* is the time since the last step in s, and 0 at the start of a run."""
        return {{
{own if is_own else "".join(lines)}        }}
'''


def _plain_value(type_: Type) -> str:
    if type_.kind is Kind.ENUMERATION:
        return f'"{type_.items[0]}"'
    return {Kind.BOOLEAN: "False", Kind.INTEGER: "0"}.get(type_.kind, "0.0")


def _top(label: str) -> str:
    return label.partition(".")[0]


def _flat(label: str) -> str:
    return label.replace(".", "_")
