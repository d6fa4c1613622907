"""modelDescription.xml as it comes, in FMI 2.0 or 3.0: every variable, and what the FMU can do.

What this program cannot simulate is refused here, by name and all at once.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.component import Kind
from dse.domain.fmu import Variable
from dse.errors import DseError, Location, Problem, fail

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_FILE = "modelDescription.xml"
_MAXIMUM_SIZE = 256 * 2**20


@dataclass(frozen=True, slots=True)
class Description:
    """What modelDescription.xml says of a co-simulation FMU. *fixed_step* is set if no other step is possible."""

    version: int
    identifier: str
    token: str
    variables: Mapping[str, Variable]
    can_handle_variable_step: bool
    can_save_state: bool
    once_per_process: bool
    fixed_step: float | None


def read_description(folder: Path, where: Location | None = None) -> Description:
    """Read ``modelDescription.xml`` in *folder*.

    Raises DseError, located at *where* or at the file: not XML, with a document type or entities, FMI 1.0, no
    co-simulation, needs a tool, has arrays, or does not say what FMI requires.
    """
    path = folder / _FILE
    where = where or Location(str(path))
    root = _parse(path, where)
    version = _version(root, where)
    problems: list[Problem] = []
    interface = root.find("CoSimulation")
    if interface is None:
        raise fail(_no_co_simulation(root), where, "export the model as an FMU for co-simulation")
    identifier = interface.get("modelIdentifier", "")
    if not re.fullmatch(r"\w[\w.\-]*", identifier):
        problems.append(Problem(f"{_FILE}: '{identifier}' is not a modelIdentifier", where))
    if _flag(interface, "needsExecutionTool"):
        hint = "export it so that it runs by itself"
        problems.append(Problem(f"the FMU needs an execution tool: it only connects to '{_tool(root)}'", where, hint))
    token = root.get("guid" if version == 2 else "instantiationToken")
    if token is None:
        problems.append(Problem(f"{_FILE}: there is no {'guid' if version == 2 else 'instantiationToken'}", where))
    variables: dict[str, Variable] = {}
    for found in _variables(root, version, where):
        if isinstance(found, Problem):
            problems.append(found)
        elif found.name in variables:
            problems.append(Problem(f"{_FILE}: variable '{found.name}' is there twice", where))
        else:
            variables[found.name] = found
    if problems:
        raise DseError(*problems)
    can_handle_variable_step = _flag(interface, "canHandleVariableCommunicationStepSize")
    return Description(
        version=version,
        identifier=identifier,
        token=token or "",
        variables=variables,
        can_handle_variable_step=can_handle_variable_step,
        can_save_state=_flag(interface, "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState"),
        once_per_process=_flag(interface, "canBeInstantiatedOnlyOncePerProcess"),
        fixed_step=None if can_handle_variable_step else _fixed_step(root, interface),
    )


def _parse(path: Path, where: Location) -> Element:
    # Here, because no command but those that open FMUs needs it.
    import defusedxml
    import defusedxml.ElementTree as DefusedTree

    try:
        if path.stat().st_size > _MAXIMUM_SIZE:
            raise fail(f"{_FILE} is larger than {_MAXIMUM_SIZE // 2**20} MiB", where)
        root: Element | None = DefusedTree.fromstring(path.read_bytes(), forbid_dtd=True)
    except FileNotFoundError as error:
        raise fail(f"there is no {_FILE} in it, so it is not an FMU", where) from error
    except OSError as error:
        raise fail(f"{_FILE} cannot be read: {error.strerror}", where) from error
    except defusedxml.DefusedXmlException as error:
        raise fail(f"{_FILE} declares a document type or entities, which is refused as unsafe", where) from error
    except (DefusedTree.ParseError, ValueError, LookupError) as error:
        raise fail(f"{_FILE} is not XML: {error}", where) from error
    if root is None or root.tag != "fmiModelDescription":
        raise fail(f"{_FILE} does not describe an FMU: its root is not fmiModelDescription", where)
    return root


def _version(root: Element, where: Location) -> int:
    text = root.get("fmiVersion", "")
    if re.fullmatch(r"2\.0(\.\d+)?", text):
        return 2
    if re.fullmatch(r"3\.\d+(\.\d+)?", text):
        return 3
    if text == "1.0":
        raise fail("the FMU is of FMI 1.0, which is not supported", where, "export it for FMI 2.0 or 3.0")
    raise fail(f"the FMU is of the unknown FMI version '{text}'", where, "export it for FMI 2.0 or 3.0")


def _no_co_simulation(root: Element) -> str:
    if root.find("ModelExchange") is not None:
        return "the FMU is for model exchange only, which is not supported"
    if root.find("ScheduledExecution") is not None:
        return "the FMU is for scheduled execution only, which is not supported"
    return f"{_FILE} has no CoSimulation element"


def _flag(element: Element, name: str) -> bool:
    return element.get(name, "false").strip() in ("true", "1")


def _tool(root: Element) -> str:
    return root.get("generationTool", "its tool")


def _fixed_step(root: Element, interface: Element) -> float | None:
    experiment = root.find("DefaultExperiment")
    text = interface.get("fixedInternalStepSize") or (experiment.get("stepSize") if experiment is not None else None)
    try:
        step = float(text or "nan")
    except ValueError:
        return None
    return step if 0.0 < step < float("inf") else None


_KINDS_2: Mapping[str, tuple[str, Kind | None]] = {
    "Real": ("Real", Kind.REAL),
    "Integer": ("Integer", Kind.INTEGER),
    "Boolean": ("Boolean", Kind.BOOLEAN),
    "Enumeration": ("Integer", Kind.ENUMERATION),
    "String": ("String", None),
}
_WHOLE_3 = tuple(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64))
_KINDS_3: Mapping[str, tuple[str, Kind | None]] = {
    "Float32": ("Float32", Kind.REAL),
    "Float64": ("Float64", Kind.REAL),
    **{name: (name, Kind.INTEGER) for name in _WHOLE_3},
    "Boolean": ("Boolean", Kind.BOOLEAN),
    "Enumeration": ("Int64", Kind.ENUMERATION),
    "String": ("String", None),
    "Binary": ("Binary", None),
    "Clock": ("Clock", None),
}


def _variables(root: Element, version: int, where: Location) -> Iterator[Variable | Problem]:
    units = dict(_type_units(root, version))
    for element in root.iterfind("ModelVariables/*"):
        name = element.get("name", "")
        typed = next((child for child in element if child.tag in _KINDS_2), None) if version == 2 else element
        kinds = _KINDS_2 if version == 2 else _KINDS_3
        if typed is None or typed.tag not in kinds:
            yield Problem(f"{_FILE}: variable '{name}' has no type this program knows", where)
            continue
        if version == 3 and element.find("Dimension") is not None:
            hint = "export it with one scalar variable per element"
            yield Problem(f"variable '{name}' is an array, which is not supported", where, hint)
            continue
        reference = element.get("valueReference", "")
        if not name or not re.fullmatch(r"\s*\d{1,10}\s*", reference) or int(reference) >= 2**32:
            yield Problem(f"{_FILE}: variable '{name}' has no name or no proper value reference", where)
            continue
        fmi_type, kind = kinds[typed.tag]
        yield Variable(
            name=name,
            reference=int(reference),
            fmi_type=fmi_type,
            causality=element.get("causality", "local"),
            kind=kind,
            unit=typed.get("unit") or units.get(typed.get("declaredType", ""), ""),
            start=_start(typed),
        )


def _start(typed: Element) -> str | None:
    child = typed.find("Start")
    return child.get("value") if child is not None else typed.get("start")


def _type_units(root: Element, version: int) -> Iterable[tuple[str, str]]:
    """The units of declared types, by the type's name."""
    for element in root.iterfind("TypeDefinitions/*"):
        typed = element.find("Real") if version == 2 else element
        if typed is not None and typed.get("unit"):
            yield element.get("name", ""), typed.get("unit", "")
