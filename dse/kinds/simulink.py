"""``source: {kind: simulink}``: C or C++ that Simulink's coder wrote, as it wrote it (`dse docs simulink`)."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.component import Causality, Component, Source, Type
from dse.domain.labels import c_member, is_part
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.kinds._coded import STRUCT, Code, coded_files
from dse.kinds._generated import build_generated
from dse.kinds._meaning import Meaning, NumberSection, code_of, read_meaning
from dse.loading import ComponentKind, Plain, SourcePlace, SourceSection

if TYPE_CHECKING:
    from dse.simulink import CodedModel, Port


class SimulinkSection(SourceSection):
    """The keys of ``source``."""

    folder: str | None = None
    model: str = ""
    sources: list[str] = []
    step: Plain | None = None
    steps: dict[str, Plain] = {}
    outputs_at: str = "end"
    unused: list[str] = []
    in_code: dict[str, NumberSection] = {}


@dataclass(frozen=True, slots=True)
class SimulinkSource(Source):
    """*folder* is what the coder wrote of *model*, if there are several; *step* in s where the code does not tell.

    *steps* are those of its functions, by name, where it has one for each rate.
    *sources* are more files and folders of C that it needs. *is_raw*: outputs are as the code leaves them, also at the
    last minor step of its solver. Inputs that are *unused* keep what the model begins with. *meanings* are of ports
    and parameters, or arrays of them, by the component's names.
    """

    kind = "simulink"
    label = "Simulink's coder"

    folder: Path
    model: str = ""
    sources: tuple[Path, ...] = ()
    step: float | None = None
    steps: tuple[tuple[str, float], ...] = ()
    is_raw: bool = False
    unused: tuple[str, ...] = ()
    meanings: tuple[tuple[str, Meaning], ...] = ()
    where: Location | None = field(default=None, compare=False)

    @property
    def sample_time(self) -> float | None:
        """The *step*, if it is given, else what the code tells; None where it cannot be read, as its build will say."""
        return self.step or _step_of(self.folder, self.model, self.sources, self.steps, _stamps(self.folder))


@lru_cache(maxsize=64)
def _step_of(
    folder: Path,
    model: str,
    sources: tuple[Path, ...],
    steps: tuple[tuple[str, float], ...],
    _stamps: tuple[object, ...],
) -> float | None:
    """In s. Benches ask for it in every configuration, and a large model takes a second to read."""
    from dse.simulink import read_model

    try:
        return read_model(folder, model, rates=dict(steps), sources=sources).timing.step
    except DseError:
        return None


def _stamps(folder: Path) -> tuple[object, ...]:
    """Other ones when the code may be another."""
    if not folder.is_dir():
        return ()
    with os.scandir(folder) as entries:
        return tuple(sorted((each.name, (told := each.stat()).st_mtime_ns, told.st_size) for each in entries))


class SimulinkKind(ComponentKind[SimulinkSection, SimulinkSource]):
    """Compiled into a library of its own, of which every run loads a copy."""

    section = SimulinkSection

    def read(self, section: SimulinkSection, place: SourcePlace) -> SimulinkSource:
        """A folder of the workspace. Raises DseError."""
        if section.folder is None:
            raise place.missing("folder", "folder: acc_ert_rtw")
        step = None if section.step is None else place.number(section.step, "s", "step")
        if step is not None and step <= 0:
            raise fail(f"the step must be positive, not {section.step}", place.at("step"))
        steps = {name: place.number(each, "s", "steps", name) for name, each in section.steps.items()}
        raise_if_any(
            [
                Problem(f"the step of '{name}' must be positive, not {section.steps[name]}", place.at("steps", name))
                for name, each in steps.items()
                if each <= 0
            ]
        )
        if section.outputs_at not in ("end", "raw"):
            raise fail(f"'{section.outputs_at}' is neither 'end' nor 'raw'", place.at("outputs_at"))
        return SimulinkSource(
            place.path(section.folder, "folder"),
            section.model,
            tuple(place.path(name, "sources", n) for n, name in enumerate(section.sources)),
            step,
            tuple(steps.items()),
            section.outputs_at == "raw",
            tuple(section.unused),
            tuple((name, read_meaning(name, each, place)) for name, each in section.in_code.items()),
            place.entry.key,
        )

    def check(self, component: Component, source: SimulinkSource) -> tuple[Problem, ...]:
        """Read the code and see that every port is there. Raises DseError; its warnings are told.

        That nothing is here to read it by is told, and nothing else.
        """
        if find_spec("clang") is None:
            what = f"component '{component.name}' is not looked into: libclang is not installed"
            return (Problem(what, component.where, 'pip install "dse-workbench[simulink]"'),)
        model, codes = _chosen(component, source)
        rounded = (
            f"'{name}' is a whole number in the code: without a scale it is rounded to whole units"
            for name, code in codes.items()
            if code.is_rounded
        )
        return tuple(Problem(what, component.where) for what in (*model.interface.warnings, *rounded))

    def build(self, component: Component, source: SimulinkSource, *, version: int, cache: Path | None) -> Path:
        """The FMU. Raises DseError: the code cannot be read or compiled, or lacks a port."""
        from dse.simulink import build_library

        if sys.platform == "win32":
            raise fail("components of the kind simulink are built on Linux and macOS only", component.where)
        model, codes = _chosen(component, source)
        files = coded_files(component, codes, build_library(model, cache=cache))
        return build_generated(component, files, STRUCT, model.timing.step, version=version, cache=cache, is_coded=True)


def _chosen(component: Component, source: SimulinkSource) -> tuple[CodedModel, dict[str, Code]]:
    """The model with the component's ports and parameters in its order, and their numbers. Raises DseError."""
    from dse.simulink import Chosen, read_model

    model = read_model(source.folder, source.model, step=source.step, rates=dict(source.steps), sources=source.sources)
    made = model.interface
    problems: list[Problem] = []
    found: dict[str, Port] = {}
    codes: dict[str, Code] = {}
    groups = (by_name(made.inputs), by_name(made.outputs), by_name(made.parameters))
    for name, type_, known, what in _wanted(component, *groups):
        label = c_member(component.variable(name))
        port = known.get(label)
        if port is None:
            names = list(dict.fromkeys(each.name for each in known.values()))
            # Looking for a name that is close takes its time.
            close = closest(label, names) if len(problems) < _MOST_HINTS else ""
            hint = close or f"it has {', '.join(names[:8]) or 'none'}"
            problems.append(Problem(f"the code has no {what} '{label}' for '{name}'", component.where, hint))
            continue
        found[name] = port
        try:
            codes[name] = code_of(
                name, type_, port.scalar, _of(name, source), component.where, is_given=what != "output"
            )
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    raise_if_any(_loose(component, source, made.inputs, found))
    ports = component.interface.ports
    chosen = Chosen(
        tuple(found[each.name] for each in ports if each.causality is Causality.INPUT),
        tuple(found[each.name] for each in ports if each.causality is Causality.OUTPUT),
        tuple(found[each.name] for each in component.parameters),
    )
    return model.with_ports(chosen, is_raw=source.is_raw), codes


_Known = Mapping[str, "Port"]


def _wanted(
    component: Component, inputs: _Known, outputs: _Known, parameters: _Known
) -> Iterator[tuple[str, Type, _Known, str]]:
    for port in component.interface.ports:
        is_input = port.causality is Causality.INPUT
        yield port.name, port.type, inputs if is_input else outputs, "input" if is_input else "output"
    for parameter in component.parameters:
        yield parameter.name, parameter.type, parameters, "parameter"


def _loose(
    component: Component, source: SimulinkSource, inputs: list[Port], found: Mapping[str, Port]
) -> Iterator[Problem]:
    """Inputs that nobody gives, and names in the source that are of nothing."""
    own = [*(each.name for each in component.interface.ports), *(each.name for each in component.parameters)]
    for name, meaning in source.meanings:
        if not any(is_part(each, name) for each in own):
            yield Problem(f"there is neither port nor parameter '{name}'", meaning.where, closest(name, own))
    names = [each.name for each in inputs]
    for name in source.unused:
        if not any(is_part(each, name) for each in names):
            yield Problem(f"the code has no input '{name}'", source.where, closest(name, names))
    taken = {port.expression for port in found.values()}
    left = [each.name for each in inputs if each.expression not in taken]
    left = [each for each in left if not any(is_part(each, name) for name in source.unused)]
    if left:
        what = f"nothing provides the code's {'inputs' if len(left) > 1 else 'input'} {', '.join(left[:8])}"
        yield Problem(what, component.where, f"map a port to it, or declare it unused: unused: [{left[0]}]")


def by_name(ports: Iterable[Port]) -> dict[str, Port]:
    """*ports* by their names, and by these with what holds them in the code; the first has a name that several have."""
    found: dict[str, Port] = {}
    for each in ports:
        for name in (each.name, each.place):
            found.setdefault(name, each)
    return found


_MOST_HINTS = 5


def _of(name: str, source: SimulinkSource) -> Meaning | None:
    return next((each for whole, each in source.meanings if is_part(name, whole)), None)


KIND = SimulinkKind()
