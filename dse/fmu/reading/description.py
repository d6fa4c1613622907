"""modelDescription.xml as it comes, in FMI 1.0, 2.0 or 3.0: every variable, and what the FMU can do.

What this program cannot simulate, and what the file lacks or contradicts, is told by line and all at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from dse.domain.fmu import Capabilities, Exchange, Experiment, FmiInterface, UnitDefinition, Variable
from dse.errors import DseError, Location, Problem, fail
from dse.fmu.reading.declared_types import read_types
from dse.fmu.reading.interfaces import choose_interface, read_experiment
from dse.fmu.reading.model_structure import catalog, direct_dependencies, read_exchange, read_structure
from dse.fmu.reading.variables import Listed, read_variables
from dse.formats import XmlElement, read_xml_file, shortened, shown

_FILE = "modelDescription.xml"
_MOST_TOLD = 20
_MOST_VALUES = 50_000_000


@dataclass(frozen=True, slots=True)
class Description:
    """What modelDescription.xml says of one interface of an FMU; the fields are those of FmuModel.

    *source_files* are the files to compile, if FMI 2.0's description lists them; *where* is the file. *ignored* is what
    contradicts itself and nothing needs.
    """

    version: int
    identifier: str
    token: str
    variables: Mapping[str, Variable]
    capabilities: Capabilities
    fixed_step: float | None
    interface: FmiInterface
    exchange: Exchange | None
    depends: Mapping[str, tuple[str, ...]]
    initially_depends: Mapping[str, tuple[str, ...]]
    units: Mapping[str, UnitDefinition]
    experiment: Experiment
    title: str
    source_files: tuple[str, ...]
    where: Location
    ignored: tuple[Problem, ...] = ()


def read_description(folder: Path, name: str | None = None, *, interface: FmiInterface | None = None) -> Description:
    """Read ``modelDescription.xml`` in *folder*, which messages call *name*.

    *interface* is the one that is asked for; without, co-simulation comes before model exchange. Raises DseError,
    located in the file: not XML, with a document type or entities, an unknown version, without an interface that can
    be used, or with anything missing, doubled or contradictory that a simulation depends on.
    """
    name = shown(folder) if name is None else name
    file = f"{name}/{_FILE}"
    if not (folder / _FILE).is_file():
        inner = sorted(path.parent.name for path in folder.glob(f"*/{_FILE}"))
        hint = f"there is one in its folder '{inner[0]}': zip what is in that folder" if inner else ""
        raise fail(f"there is no {_FILE} in it, so it is not an FMU", Location(name), hint)
    ignored: list[Problem] = []
    root = read_xml_file(folder / _FILE, file, ignored)
    if root.tag != "fmiModelDescription":
        what = f"it does not describe an FMU: its root is <{shortened(root.tag)}>, not <fmiModelDescription>"
        raise fail(what, root.where)
    version = _version(root)
    problems: list[Problem] = []
    experiment = read_experiment(root, problems)
    offered = choose_interface(root, version, interface, experiment, problems)
    token = _token(root, version, problems)
    units = read_units(root, problems) if version > 1 else {}
    types = read_types(root, version, problems)
    listed = read_variables(root, version, types, problems)
    if version < 3:
        listed = list(_one_input_each(listed))
    doubled = dict(_doubled_locals(listed))
    problems += _contradictions(listed, version, file, doubled)
    ignored += doubled.values()
    _raise_some(problems, file)
    variables = catalog(listed, version)
    structure = direct_dependencies(listed) if version == 1 else read_structure(root, variables)
    osmp = tuple(binaries(listed)) if version == 2 else ()
    exchange = None
    if offered.interface is FmiInterface.MODEL_EXCHANGE:
        needs = offered.needs_completed_step
        exchange = read_exchange(root, variables, needs_completed_step=needs, problems=problems)
    _raise_some(problems, file)
    return Description(
        version=version,
        identifier=offered.identifier,
        token=token,
        variables={v.name: v for v in (*(one.variable for one in listed if one), *osmp) if v.name not in doubled},
        capabilities=offered.capabilities,
        fixed_step=offered.fixed_step,
        interface=offered.interface,
        exchange=exchange,
        depends=dependencies(osmp, structure.depends),
        initially_depends=dependencies(osmp, structure.initially_depends),
        units=units,
        experiment=experiment,
        title=root.get("description") or root.get("modelName"),
        source_files=tuple(file.get("name") for file in offered.element.below("SourceFiles", "File")),
        where=Location(file),
        ignored=tuple(ignored),
    )


def _version(root: XmlElement) -> int:
    text = root.get("fmiVersion").strip()
    if re.fullmatch(r"1\.0(\.\d+)?", text):
        return 1
    if re.fullmatch(r"2\.0(\.\d+)?", text):
        return 2
    if re.fullmatch(r"3\.\d+(\.\d+)?", text):
        return 3
    what = (
        f"the FMU is of the unknown FMI version '{shortened(text)}'" if text else "it does not declare its fmiVersion"
    )
    raise fail(what, root.where, "export it for FMI 2.0 or 3.0")


def _token(root: XmlElement, version: int, problems: list[Problem]) -> str:
    """The text by which a library and a description know that they belong together; it may be empty."""
    name = "instantiationToken" if version == 3 else "guid"
    if name not in root.attributes:
        problems.append(Problem(f"there is no {name}", root.where))
    return root.get(name)


def _one_input_each(listed: Iterable[Listed | None]) -> Iterator[Listed | None]:
    """Of inputs that share a value reference all but the first become other names of it."""
    inputs: dict[tuple[str, int], str] = {}
    for one in listed:
        if one is None or one.variable.causality != "input" or one.variable.alias_of:
            yield one
            continue
        variable = one.variable
        first = inputs.setdefault((variable.fmi_type, variable.reference), variable.name)
        yield one if first == variable.name else replace(one, variable=replace(variable, alias_of=first))


def _doubled_locals(listed: Iterable[Listed | None]) -> Iterator[tuple[str, Problem]]:
    """Names that only internal variables have, and several of them: which is meant is unknown."""
    named: dict[str, list[Listed]] = {}
    for one in listed:
        if one is not None:
            named.setdefault(one.variable.name, []).append(one)
    for name, several in named.items():
        if len(several) > 1 and all(one.variable.causality == "local" for one in several):
            what = f"the internal variable '{shortened(name)}' is there twice, so that it cannot be used"
            yield name, Problem(what, several[1].element.where)


def _contradictions(
    listed: Iterable[Listed | None], version: int, file: str, doubled: Collection[str]
) -> Iterator[Problem]:
    """What no variable is to blame for alone: names and references that are taken."""
    names: set[str] = set()
    references: dict[int, str] = {}
    values = 0
    for one in listed:
        if one is None:
            continue
        variable, where = one.variable, one.element.where
        if variable.name in names and variable.name not in doubled:
            yield Problem(f"variable '{shortened(variable.name)}' is there twice", where)
        names.add(variable.name)
        values += variable.size
        # Up to FMI 2.0 variables share references by being aliases; from FMI 3.0 on aliases are written otherwise.
        if variable.alias_of or version < 3:
            continue
        taken = references.setdefault(variable.reference, variable.name)
        if taken != variable.name:
            what = (
                f"variable '{variable.name}' has the value reference {variable.reference}, which is that of '{taken}'"
            )
            yield Problem(what, where)
    if values > _MOST_VALUES:
        yield Problem(f"all arrays together have more than {_MOST_VALUES:,} elements", Location(file))


def _raise_some(problems: list[Problem], file: str) -> None:
    """Raise what there is; of a flood only the beginning, and how much it is."""
    if len(problems) > _MOST_TOLD:
        head = Problem(f"{len(problems)} problems, of which these are the first {_MOST_TOLD}", Location(file))
        raise DseError(head, *problems[:_MOST_TOLD])
    if problems:
        raise DseError(*problems)


# Binaries in FMI 2, which has none: what the OSI Sensor Model Packaging (OSMP, by ASAM and PMSF) passes as integers.
#
# A binary ``X`` is an address in the process in two halves, ``X.base.lo`` and ``X.base.hi``, and a size, ``X.size``.


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


# UnitDefinitions of an FMU: what its units are in SI.


BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def read_units(root: XmlElement, problems: list[Problem]) -> Mapping[str, UnitDefinition]:
    """The units whose relation to SI an FMI 2.0 or 3.0 description gives, by name.

    Units without a BaseUnit are left out, as are all of FMI 1.0, which has names only.
    """
    units: dict[str, UnitDefinition] = {}
    for unit in root.below("UnitDefinitions", "Unit"):
        name = unit.required("name", problems)
        base = unit.child("BaseUnit")
        if base is None:
            continue
        told = base_unit(base, problems)
        if units.setdefault(name, told) != told:
            problems.append(Problem(f"unit '{name}' is there twice, with different meanings", unit.where))
    return units


def base_unit(base: XmlElement, problems: list[Problem]) -> UnitDefinition:
    """What a ``BaseUnit`` element of FMI 2.0, FMI 3.0 or SSP says."""
    exponents = {name: base.whole(name, problems, least=-100, most=100) for name in BASE_UNITS}
    factor, offset = base.real("factor", problems), base.real("offset", problems)
    if factor is not None and (factor == 0 or not math.isfinite(factor)):
        problems.append(Problem(f"<{base.tag}>: the factor cannot be {factor:g}", base.where))
        factor = None
    if offset is not None and not math.isfinite(offset):
        problems.append(Problem(f"<{base.tag}>: the offset cannot be {offset:g}", base.where))
        offset = None
    return UnitDefinition(
        factor=1.0 if factor is None else factor,
        offset=0.0 if offset is None else offset,
        exponents={name: number for name, number in exponents.items() if number},
    )
