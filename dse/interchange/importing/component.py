"""Existing FMUs become components of a workspace."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

from dse.domain.component import Component, Interface, Value
from dse.domain.labels import array_of
from dse.errors import Location, Problem, raise_if_any
from dse.fmu import open_fmu
from dse.formats import shown, write_value
from dse.interchange.importing.files import write_new
from dse.interchange.importing.fmu_component import implementing, offer
from dse.interchange.names import numbered
from dse.kinds import FmuSource
from dse.loading import Workspace, check_choice, write_fmu_component, write_interfaces
from dse.units import DIMENSIONLESS


@dataclass(frozen=True, slots=True)
class ImportedComponent:
    """A component that was written to *path*.

    *starts* are the FMU's own values of its inputs, as a test bench gives them. *left_out* are variables it does
    without, each with the reason; *told* says what became something else than it is in the FMU.
    """

    component: Component
    path: Path
    has_own_interface: bool
    starts: tuple[str, ...]
    left_out: tuple[str, ...]
    told: tuple[str, ...]


def import_component(
    file: Path, folder: Path, name: str | None = None, *, cache: Path | None = None
) -> ImportedComponent:
    """Copy the FMU in *file* into the workspace *folder* and write its component beside it.

    It implements that interface of the workspace whose ports it has by name, kind and dimension if all its inputs are
    among them, else one of its own.
    Raises DseError: no FMU that can be simulated, a name that is none, a component that is there already, a workspace
    that cannot be read. Nothing is written then.
    """
    model = open_fmu(file, cache=cache)
    own = name if name is not None else name_of(file)
    problems: list[Problem] = []
    check_choice(own, Location(shown(file)), problems)
    target = folder / "components" / own
    if target.exists():
        problems.append(Problem("already exists", Location(shown(target)), "give another --name"))
    raise_if_any(problems)
    known = interfaces_of(folder)
    offered = implementing(offer(own, model, FmuSource(target / f"{own}.fmu")), known.values())
    component = offered.component
    has_own = component.interface.name not in known or component.interface != known[component.interface.name]
    if has_own:
        component = replace(component, interface=replace(component.interface, name=numbered(own, known.__contains__)))
    path = target / "component.yaml"
    texts = {path: write_fmu_component(component, f"{own}.fmu")}
    if has_own:
        texts[target / "interfaces.yaml"] = write_interfaces([component.interface])
    write_new(texts, {target / f"{own}.fmu": file})
    told = (*offered.told, *(f"ignored: {problem}" for problem in model.ignored))
    starts: dict[str, list[str]] = {}
    for port, value in offered.starts.items():
        starts.setdefault(array_of(port) or port, []).append(_start(component, port, value))
    shown_starts = (f"{port}: {_together(values)}" for port, values in starts.items())
    return ImportedComponent(component, path, has_own, tuple(shown_starts), offered.left_out, told)


def name_of(file: Path, prefix: str = "fmu") -> str:
    """A component's name from a file's: ``Supplier Radar-2.fmu`` is ``supplier_radar_2``, ``2.fmu`` is ``fmu_2``."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", file.stem)).strip("_").lower()
    return plain if plain and not plain[0].isdigit() else f"{prefix}_{plain}".strip("_")


def _start(component: Component, name: str, value: Value) -> str:
    port = component.interface.port(name)
    unit = port.type.unit if port is not None else DIMENSIONLESS
    return f"{write_value(value, unit, None)} {unit}".rstrip()


def _together(values: list[str]) -> str:
    """Those of an array in a list, or once if they are equal."""
    return values[0] if len(set(values)) == 1 else f"[{', '.join(values)}]"


def interfaces_of(folder: Path) -> dict[str, Interface]:
    """Those of the workspace *folder*, by name."""
    return dict(Workspace(folder).interfaces) if (folder / "components").is_dir() else {}
