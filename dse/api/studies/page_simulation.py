"""The configurations of a study as a report page simulates them: one module, and what its worker has to know."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.api.studies.provenance import benches_near
from dse.api.studies.single_run import Tell, ready
from dse.domain.component import Kind, Parameter
from dse.domain.design import split_path
from dse.domain.noise import DRAW
from dse.domain.run import Outcome, Run, RunRequest
from dse.domain.study import Selection
from dse.errors import Location, fail
from dse.fmu import WebSystem, web_module
from dse.metrics import program_as_data
from dse.report import PageSimulation
from dse.storage import changed_inputs
from dse.testbench import bench_study, singly, wire_bench
from dse.units import parse_unit, short_symbol

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.definition import DefinedVariable, StudyDefinition
    from dse.testbench import PreparedBench, PreparedStudy

MOST_CONFIGURATIONS = 200
"""More would make a page of many megabytes."""


def page_simulation(
    definition: StudyDefinition,
    near: Path,
    workspace: str | Path | None = None,
    *,
    draws: Sequence[float] = (),
    tell: Tell | None = None,
) -> PageSimulation:
    """Every configuration of the study, to be simulated in its page, at these *draws* of noise or without any.

    The study's files are taken from *workspace*, else as `in_workspace` does for the folder *near*. Raises DseError
    naming all that cannot be in a page, and what has changed since the study was made.
    """
    if len(definition.configurations) > MOST_CONFIGURATIONS:
        what = f"a page simulates at most {MOST_CONFIGURATIONS} configurations, this study has"
        raise fail(f"{what} {len(definition.configurations)}", Location(definition.study))
    first, *others = benches_near(definition, near, workspace)
    ids = tuple(each.id for each in definition.configurations)
    planned = ready(replace(bench_study(first, Selection(ids)), others=tuple(others)), tell=tell)
    _require_unchanged(definition, planned)
    benches = [(place, each) for place, name in enumerate(ids) for each in singly(planned.benches[name])]
    known = [bench for _ in ids for bench in planned.study.benches]
    found = [OnBench(place, each, bench) for (place, each), bench in zip(benches, known, strict=True)]
    return simulation_of(definition, found, draws, tell=tell)


@dataclass(frozen=True, slots=True)
class OnBench:
    """The configuration at *place* in a study, *prepared* on its *bench*."""

    place: int
    prepared: PreparedBench
    bench: TestBench


def simulation_of(
    definition: StudyDefinition,
    benches: Sequence[OnBench],
    draws: Sequence[float] = (),
    *,
    also: frozenset[str] = frozenset(),
    tell: Tell | None = None,
) -> PageSimulation:
    """What a page needs for *benches*, which record the columns *also* besides those of metrics and figures.

    Raises DseError naming all that cannot be in a page.
    """
    if tell:
        tell("compiling for the page")
    names = [*dict.fromkeys(each.bench.name for each in benches)]
    gathered = _Gathered(definition, draws or (0.0,), names, also)
    wanted = [
        WebSystem(
            each.prepared.system,
            tuple(each.prepared.recording.variables[at] for at in gathered.columns(each.prepared)),
            tuple(setting.target for setting in each.prepared.settings.values() if setting.target),
            each.prepared.simulation.method,
        )
        for each in benches
    ]
    module = web_module(wanted)
    for each, starts in zip(benches, module.starts, strict=True):
        gathered.add(each, starts)
    return PageSimulation(gathered.document(), module.content)


def _require_unchanged(definition: StudyDefinition, planned: PreparedStudy) -> None:
    point = {variable.name: variable.nominal for variable in definition.variables}
    runs = (Run(RunRequest(0, each.id, point), Outcome.DONE, {}, ()) for each in definition.configurations)
    changed = dict.fromkeys(name for run in runs for name in changed_inputs(definition, planned.definition, run))
    if changed:
        what = f"the workspace has changed since the study was made ({', '.join(changed)})"
        raise fail(what, Location(definition.study), "explore it again, or write the page without --live")


@dataclass(slots=True)
class _Gathered:
    """The document of a page; what several systems share is in it once."""

    definition: StudyDefinition
    draws: Sequence[float]
    benches: list[str]
    also: frozenset[str]
    systems: list[dict[str, Any]] = field(default_factory=list)
    programs: dict[str, Any] = field(default_factory=dict)
    settings: dict[tuple[Any, ...], int] = field(default_factory=dict)

    def columns(self, prepared: PreparedBench) -> list[int]:
        """The places of the columns that are used."""
        shown = {name for figure in self.definition.figures for name in (figure.current, figure.target)}
        wanted = shown.union(prepared.program.signals, self.also)
        return [at for at, name in enumerate(prepared.recording.columns) if name in wanted]

    def add(self, on: OnBench, starts: Mapping[str, float]) -> None:
        """The next system, with the start values that its module takes."""
        prepared, simulation = on.prepared, on.prepared.simulation
        slots = {name: place for place, name in enumerate(starts)}
        components = wire_bench(on.bench, prepared.configuration).parts
        streams = {stream.name for stream in prepared.streams}
        settings = []
        for name, setting in prepared.settings.items():
            if not setting.target or name == DRAW or name in streams or name in prepared.derived:
                continue
            part, own = split_path(name, components) or ("", "")
            parameter = next((p for p in components[part].parameters if p.name == own), None) if part else None
            entry = _setting(name, setting.type.kind, setting.type.items, setting.type.unit.symbol, parameter)
            at = self.settings.setdefault(entry, len(self.settings))
            settings.append([at, slots[setting.target], setting.value])
        program = program_as_data(prepared.program)
        self.systems.append(
            {
                "configuration": on.place,
                "bench": self.benches.index(on.bench.name),
                "steps": simulation.steps,
                "step": simulation.step,
                "stop": simulation.stop,
                "stride": simulation.stride,
                "starts": [*starts.values()],
                "columns": [prepared.recording.columns[at] for at in self.columns(prepared)],
                "settings": settings,
                "constants": {n: prepared.constants[n] for n in self._used(prepared) if n in prepared.constants},
                "derived": [
                    [name, slots[prepared.settings[name].target], self._program(program_as_data(follows.program))]
                    for name, follows in prepared.derived.items()
                ],
                "seeds": [
                    [slots[prepared.settings[s.name].target], [s.seed(draw) for draw in self.draws]]
                    for s in prepared.streams
                ],
                "program": self._program(program),
            }
        )

    def document(self) -> Mapping[str, Any]:
        """All of it as plain data."""
        return {
            "study": self.definition.study,
            "benches": self.benches,
            "draws": len(self.draws),
            "programs": [*self.programs.values()],
            "settings": [dict(zip(_SETTING, entry, strict=True)) for entry in self.settings],
            "variables": [_variable(each) for each in self.definition.variables],
            "requirements": [each.name for each in self.definition.requirements],
            "titles": [each.title or each.name for each in self.definition.requirements],
            # Those of the page, which has error bars beside them.
            "metrics": [
                {"name": each.name, **_scale(each.unit)} for each in self.definition.metrics if not each.error_of
            ],
            "figures": [
                {
                    "name": each.name,
                    "title": each.title or each.name,
                    "unit": short_symbol(each.unit),
                    **_scale(each.unit),
                    "current": each.current,
                    "target": each.target,
                }
                for each in self.definition.figures
            ],
            "systems": self.systems,
        }

    def _used(self, prepared: PreparedBench) -> Iterator[str]:
        """What metrics, derived parameters and targets use that is no waveform."""
        yield from prepared.program.constants
        for follows in prepared.derived.values():
            yield from follows.names
        yield from (figure.target for figure in self.definition.figures if figure.target)

    def _program(self, program: dict[str, Any]) -> int:
        """Its place among the programs; an equal one has the same."""
        key = repr(program)
        self.programs.setdefault(key, program)
        return [*self.programs].index(key)


def _variable(variable: DefinedVariable) -> dict[str, Any]:
    """Its range in its unit."""
    unit = parse_unit(variable.unit)
    low, high = unit.from_si(variable.low), unit.from_si(variable.high)
    names = {"name": variable.name, "title": variable.title or variable.name, "unit": str(unit)}
    return {**names, "low": low, "high": high, **_scale(variable.unit)}


def _scale(unit: str) -> dict[str, float]:
    meaning = parse_unit(unit)
    return {"factor": float(meaning.factor), "offset": float(meaning.offset)}


_SETTING = ("name", "title", "unit", "factor", "offset", "kind", "items", "low", "high", "tunable")


def _setting(name: str, kind: Kind, items: tuple[str, ...], unit: str, parameter: Parameter | None) -> tuple[Any, ...]:
    """As `_SETTING` names it; bounds are SI, None where there is none."""
    meaning = parse_unit(unit)
    bounds = (parameter.minimum, parameter.maximum) if parameter else (None, None)
    low, high = (None if each is None or math.isinf(each) else float(each) for each in bounds)
    title = parameter.title if parameter else ""
    tunable = parameter is None or parameter.tunable
    scale = float(meaning.factor), float(meaning.offset)
    return (name, title or name, str(meaning), *scale, str(kind), items, low, high, tunable)
