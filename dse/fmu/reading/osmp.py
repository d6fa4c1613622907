"""Binaries in FMI 2, which has none: what the OSI Sensor Model Packaging (OSMP, by ASAM and PMSF) passes as integers.

A binary ``X`` is an address in the process in two halves, ``X.base.lo`` and ``X.base.hi``, and a size, ``X.size``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from dse.domain.fmu import Variable
from dse.fmu.reading.variables import Listed
from dse.formats import XmlElement

_ROLES = ("base.lo", "base.hi", "size")
_TOOL = "net.pmsf.osmp"
_CAUSALITIES = ("input", "output", "parameter", "calculatedParameter")


def binaries(listed: Sequence[Listed | None]) -> Iterator[Variable]:
    """The binaries that integers of FMI 2 stand for: inputs, outputs and parameters.

    They are told by OSMP's annotations, else by the three names.
    """
    found: dict[str, dict[str, Variable]] = {}
    media: dict[str, str] = {}
    for one in listed:
        if one is None or one.variable.fmi_type != "Integer" or one.variable.causality not in _CAUSALITIES:
            continue
        for name, role, told in (*_annotated(one.element), *_named(one.variable.name)):
            found.setdefault(name, {}).setdefault(role, one.variable)
            media.setdefault(name, told)
            break
    taken = {one.variable.name for one in listed if one is not None}
    for name, parts in found.items():
        whole = [parts[role] for role in _ROLES if role in parts]
        if len(whole) == len(_ROLES) and len({part.causality for part in whole}) == 1 and name not in taken:
            integers = tuple((part.name, part.reference) for part in whole)
            yield replace(
                whole[0], name=name, fmi_type="Binary", kind=None, start=(), media=media[name], integers=integers
            )


def dependencies(found: Sequence[Variable], told: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """*told* with what the binaries among *found* depend on, and that others depend on them."""
    owner = {name: variable.name for variable in found for name, _ in variable.integers}
    known = {name: (*on, *dict.fromkeys(owner[one] for one in on if one in owner)) for name, on in told.items()}
    for variable in found:
        parts = [name for name, _ in variable.integers]
        if variable.causality == "output" and all(part in known for part in parts):
            known[variable.name] = tuple(dict.fromkeys(one for part in parts for one in known[part]))
    return known


def _annotated(element: XmlElement) -> Iterator[tuple[str, str, str]]:
    for tool in element.below("Annotations", "Tool"):
        if tool.get("name") == _TOOL:
            for said in tool.all("osmp-binary-variable"):
                if said.get("name") and said.get("role") in _ROLES:
                    yield said.get("name"), said.get("role"), " ".join(said.get("mime-type").split())


def _named(name: str) -> Iterator[tuple[str, str, str]]:
    for role in _ROLES:
        if name.endswith(f".{role}"):
            yield name.removesuffix(f".{role}"), role, ""
