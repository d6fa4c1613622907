"""Code from Simulink's coder becomes a component of a workspace."""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from dse.domain.component import Component, Kind
from dse.domain.fmu import FmuModel, Variable
from dse.errors import Location, Problem, fail, raise_if_any
from dse.formats import shown, write_flow, write_text
from dse.interchange.importing.component import interfaces_of, name_of
from dse.interchange.importing.files import write_new
from dse.interchange.importing.fmu_component import implementing, offer
from dse.interchange.names import numbered
from dse.kinds import SimulinkSource
from dse.loading import check_choice, write_component, write_interfaces
from dse.simulink import CodedModel, Number, Port, block_of, read_model, systems, try_model

_KINDS = {
    Number.REAL: Kind.REAL,
    Number.INTEGER: Kind.INTEGER,
    Number.BOOLEAN: Kind.BOOLEAN,
    Number.ENUMERATION: Kind.ENUMERATION,
}


@dataclass(frozen=True, slots=True)
class ImportedCode:
    """A component that was written to *path* for *model*.

    *left_out* are parameters it does without, each with the reason; *told* says what is as it may not be expected.
    """

    component: Component
    path: Path
    has_own_interface: bool
    model: CodedModel
    left_out: tuple[str, ...]
    told: tuple[str, ...]


def import_code(
    folder: Path,
    workspace: Path,
    name: str | None = None,
    *,
    model: str = "",
    step: float | None = None,
    steps: Mapping[str, float] = MappingProxyType({}),
    sources: tuple[Path, ...] = (),
    cache: Path | None = None,
) -> ImportedCode:
    """Write the component of the *model* whose code is in *folder*; the code stays where it is, and may change there.

    Its parameters begin with what the code has. It implements that interface of the workspace whose ports it has by
    name and kind, else one of its own; numbers of the code are taken as SI. *step* (s) is for code that tells none,
    *steps* for its functions by name, if it has one for each rate; *sources* are files and folders of C that it needs
    besides.
    Raises DseError: no code that can be read, compiled and run for a while, a component that is there already. Nothing
    is written then.
    """
    read = read_model(folder, model, step=step, rates=steps, sources=sources)
    own = name if name is not None else name_of(Path(read.folder.model))
    problems: list[Problem] = []
    check_choice(own, Location(shown(folder)), problems)
    target = workspace / "components" / own
    if target.exists():
        problems.append(Problem("already exists", Location(shown(target)), "give another --name"))
    raise_if_any(problems)
    tried = try_model(read, cache=cache)
    if tried.error:
        raise fail(f"the model reports '{tried.error}'", Location(shown(folder)))
    variables = tuple(_variables(read, tried.parameters))
    infinite = [
        f"{port.name}: it begins as {value}, and keeps that"
        for port, value in zip(read.interface.parameters, tried.parameters, strict=True)
        if not math.isfinite(value)
    ]
    source = SimulinkSource(folder, model, sources, step, tuple(steps.items()))
    offered = offer(own, _as_read(read, variables), source)
    known = interfaces_of(workspace)
    fitting = implementing(offered, known.values(), has_units=False)
    component = fitting.component
    has_own = component.interface.name not in known or component.interface != known[component.interface.name]
    if has_own:
        component = replace(component, interface=replace(component.interface, name=numbered(own, known.__contains__)))
    path = target / "component.yaml"
    texts = {path: _component_yaml(component, path, folder, source)}
    if has_own:
        texts[target / "interfaces.yaml"] = write_interfaces([component.interface])
    write_new(texts, {})
    left_out = (*infinite, *fitting.left_out)
    return ImportedCode(component, path, has_own, read, left_out, (*read.interface.warnings, *fitting.told))


def _variables(model: CodedModel, defaults: tuple[float, ...]) -> Iterator[Variable]:
    made, known = model.interface, systems(model.folder.texts[model.folder.header])
    groups = (("input", made.inputs), ("output", made.outputs), ("parameter", made.parameters))
    names = [port.name for _, ports in groups for port in ports]
    twice = {name for name, count in Counter(names).items() if count > 1}
    starts = dict(zip((port.expression for port in made.parameters), defaults, strict=True))
    for causality, ports in groups:
        for port in ports:
            start = starts.get(port.expression) if causality == "parameter" else None
            if start is None or math.isfinite(start):
                yield _variable(port, causality, start, known, is_twice=port.name in twice)


def _variable(port: Port, causality: str, start: float | None, known: dict[str, str], *, is_twice: bool) -> Variable:
    scalar = port.scalar
    return Variable(
        _label(port.place if is_twice else port.name),
        0,
        {Number.REAL: "Real", Number.BOOLEAN: "Boolean"}.get(scalar.number, "Integer"),
        causality,
        _KINDS[scalar.number],
        start=() if start is None else (_text(start, scalar.number),),
        variability="tunable" if causality == "parameter" else "",
        items={item.removeprefix(f"{scalar.name}_"): value for item, value in scalar.items},
        description=_title(port, known) if causality == "parameter" else "",
    )


def _title(port: Port, known: dict[str, str]) -> str:
    """Its block; with its own name before it, if the model has it as a variable, as which its users know it."""
    variable, block = re.search(r"Variable:\s*(\w+)", port.block), block_of(port.block, known)
    return f"{variable[1]} ({block})" if variable and block else block


def _label(name: str) -> str:
    """Indices of C as a component counts them: ``gap[0][1]`` is ``gap[1,2]``."""

    def together(found: re.Match[str]) -> str:
        return f"[{','.join(str(int(index) + 1) for index in re.findall(r'[0-9]+', found[0]))}]"

    return re.sub(r"(?:\[\d+\])+", together, name)


def _text(value: float, number: Number) -> str:
    if number is Number.BOOLEAN:
        return "true" if value else "false"
    return repr(value) if number is Number.REAL else str(int(value))


def _as_read(model: CodedModel, variables: tuple[Variable, ...]) -> FmuModel:
    """The code as an FMU that is described in the same words."""
    folder, by_name = model.folder, {variable.name: variable for variable in variables}
    return FmuModel(folder.path, folder.path, folder.path, 2, folder.model, "", by_name, title="")


def _component_yaml(component: Component, path: Path, folder: Path, source: SimulinkSource) -> str:
    """Its text, with lines to edit where the code does not tell what its numbers mean."""

    def near(place: Path) -> str:
        return write_text(Path(os.path.relpath(place.absolute(), path.parent.absolute())).as_posix())

    entries = {"kind": "simulink", "folder": near(folder)}
    entries |= {"sources": f"[{', '.join(map(near, source.sources))}]"} if source.sources else {}
    entries |= {"model": write_text(source.model)} if source.model else {}
    entries |= {"step": f"{source.step!r} s"} if source.step is not None else {}
    each = ", ".join(f"{name}: {step!r} s" for name, step in source.steps)
    entries |= {"steps": f"{{{each}}}"} if each else {}
    real = next((port for port in component.interface.ports if port.type.kind is Kind.REAL), None)
    head = ""
    if real is not None:
        head = (
            "# The code has no units: its numbers are SI, unless the source sets others, as in\n"
            f"#   in_code: {{{real.name}: {{unit: {str(real.type.unit) or 'm/s'}, min: 0, max: 100}}}}\n"
        )
    return head + write_component(component, write_flow(entries))
