"""SSP packages written by hand, as other programs write them, and FMUs that are only described."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

from dse.domain.component import Kind
from dse.domain.fmu import FmuModel, UnitDefinition, Variable
from dse.fmu.unpack import open_fmu
from dse.interchange.reading.open import open_ssp
from dse.interchange.resolving.resolve import ResolvedSystem, system_of
from dse.interchange.structure import SspSystem

NAMESPACES = " ".join(
    f'xmlns:{short}="http://ssp-standard.org/SSP1/SystemStructure{name}"'
    for short, name in (
        ("ssd", "Description"),
        ("ssc", "Common"),
        ("ssv", "ParameterValues"),
        ("ssm", "ParameterMapping"),
        ("ssb", "SignalDictionary"),
    )
)


def description(system: str, after: str = "", *, version: str = "1.0", name: str = "example") -> str:
    """A system structure description whose top-level system holds *system*; *after* stands behind it."""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ssd:SystemStructureDescription {NAMESPACES} version="{version}" name="{name}">\n'
        f'<ssd:System name="top">\n{system}\n</ssd:System>\n{after}\n</ssd:SystemStructureDescription>\n'
    )


def connectors(*kinds_and_names: str) -> str:
    """Connectors without a type: ``input u``, ``output y``."""
    lines = [entry.split(" ", 1) for entry in kinds_and_names]
    inner = "".join(f'<ssd:Connector name="{name}" kind="{kind}"/>' for kind, name in lines)
    return f"<ssd:Connectors>{inner}</ssd:Connectors>"


def component(name: str, *kinds_and_names: str, source: str = "", more: str = "") -> str:
    """A component with its connectors; *more* stands behind them. Its FMU is called as it is, if nothing is said."""
    said = connectors(*kinds_and_names) if kinds_and_names else ""
    return f'<ssd:Component name="{name}" source="{source or f"resources/{name}.fmu"}">{said}{more}</ssd:Component>'


def connection(start: str, end: str, inner: str = "", **attributes: str) -> str:
    """A connection of ``element.connector`` or, with a dot in front, of the system's own connector."""
    ends = {}
    for word, text in (("start", start), ("end", end)):
        element, _, connector = text.partition(".")
        if element:
            ends[f"{word}Element"] = element
        ends[f"{word}Connector"] = connector
    said = " ".join(f'{key}="{value}"' for key, value in {**ends, **attributes}.items())
    return f"<ssd:Connection {said}>{inner}</ssd:Connection>"


def parameter_set(*values: str, more: str = "", version: str = "1.0") -> str:
    """An ``ssv:ParameterSet``; values are written ``name Real 1.5 [unit]``."""
    lines = []
    for entry in values:
        name, type_, value, *unit = entry.split(" ")
        said = f' unit="{unit[0]}"' if unit else ""
        lines.append(f'<ssv:Parameter name="{name}"><ssv:{type_} value="{value}"{said}/></ssv:Parameter>')
    inner = "".join(lines)
    head = f'<ssv:ParameterSet {NAMESPACES} version="{version}" name="set">'
    return f"{head}<ssv:Parameters>{inner}</ssv:Parameters>{more}</ssv:ParameterSet>"


def mapping(*entries: str) -> str:
    """An ``ssm:ParameterMapping`` that holds these ``<ssm:MappingEntry>``."""
    return f'<ssm:ParameterMapping {NAMESPACES} version="1.0">{"".join(entries)}</ssm:ParameterMapping>'


def entry(source: str, target: str, inner: str = "", **attributes: str) -> str:
    said = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return f'<ssm:MappingEntry source="{source}" target="{target}"{said}>{inner}</ssm:MappingEntry>'


def bindings(*inner: str) -> str:
    return f"<ssd:ParameterBindings>{''.join(inner)}</ssd:ParameterBindings>"


def binding(values: str, mapped: str = "", **attributes: str) -> str:
    """A binding of an inline set, with an inline mapping if there is one."""
    said = "".join(f' {key}="{value}"' for key, value in attributes.items())
    rules = f"<ssd:ParameterMapping>{mapped}</ssd:ParameterMapping>" if mapped else ""
    return (
        f"<ssd:ParameterBinding{said}><ssd:ParameterValues>{values}</ssd:ParameterValues>{rules}</ssd:ParameterBinding>"
    )


def elements(*inner: str) -> str:
    return f"<ssd:Elements>{''.join(inner)}</ssd:Elements>"


def connections(*inner: str) -> str:
    return f"<ssd:Connections>{''.join(inner)}</ssd:Connections>"


def pack(path: Path, files: Mapping[str, str | bytes]) -> Path:
    """Write a package of *files* by path."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def variable(name: str, causality: str, kind: Kind | None = Kind.REAL, **more: object) -> Variable:
    fmi_type = {
        Kind.REAL: "Float64",
        Kind.INTEGER: "Int32",
        Kind.BOOLEAN: "Boolean",
        Kind.ENUMERATION: "Int64",
        None: "String",
    }[kind]
    fields = {"reference": zlib.crc32(name.encode()) % 2**31, "fmi_type": fmi_type} | more
    return Variable(name=name, causality=causality, kind=kind, **fields)  # type: ignore[arg-type]


def model(identifier: str, *variables: Variable, units: Mapping[str, UnitDefinition] | None = None) -> FmuModel:
    """An FMU that is not there: enough to resolve a system with it."""
    nowhere = Path("nowhere")
    return FmuModel(
        nowhere,
        nowhere,
        nowhere,
        3,
        identifier,
        "{}",
        {v.name: v for v in variables},
        units=units or {},
        content_hash=identifier,
    )


METRES_PER_SECOND = {
    "m/s": UnitDefinition(exponents={"m": 1, "s": -1}),
    "km/h": UnitDefinition(1 / 3.6, exponents={"m": 1, "s": -1}),
}


def opened(
    folder: Path, files: Mapping[str, str | bytes], fmus: Mapping[str, FmuModel], variant: str | None = None
) -> SspSystem:
    """The package of *files*, with a file for each of *fmus*, as it is read."""
    there = {f"resources/{name}.fmu": b"" for name in fmus} | dict(files)
    return open_ssp(pack(folder / "example.ssp", there), folder / "unpacked", variant)


def resolved(
    folder: Path, files: Mapping[str, str | bytes] | str, fmus: Mapping[str, FmuModel], **options: object
) -> ResolvedSystem:
    """The package's system; *files* is the description if it is one text. *fmus* are by their files' names.

    Any other file of the package is opened as the FMU it is said to be.
    """
    ssp = opened(folder, {"SystemStructure.ssd": files} if isinstance(files, str) else files, fmus)
    models = {
        c.key: fmus[c.fmu.stem] if c.fmu.stem in fmus else open_fmu(c.fmu, cache=folder / "cache")
        for c in ssp.places.values()
    }
    return system_of(ssp, models, **options)  # type: ignore[arg-type]
