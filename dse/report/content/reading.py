"""A study folder → what the report shows: display units, waveforms against their targets, facts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.analysis import noisy, severity_levels
from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import (
    DefinedConfiguration,
    DefinedMetric,
    DefinedRequirement,
    DefinedVariable,
    StudyDefinition,
)
from dse.domain.run import TESTBENCH, Outcome, Run, Waveforms
from dse.domain.sampler import Grid, Scale as Scaling
from dse.errors import DseError, Location, Problem
from dse.report.content.architecture import parts_and_links
from dse.report.content.data import (
    ConfigurationEntry,
    FigureSpec,
    Floats,
    MetricColumn,
    Property,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Retried,
    Runs,
    SamplerKind,
)
from dse.report.content.draws import draws_of
from dse.report.content.objectives import composites_of, objectives_of
from dse.report.content.scenes import scenes_of
from dse.storage import (
    CERTAINTIES,
    Certainty,
    RunTable,
    Scale,
    StudyFolder,
    StudyHeader,
    UnreadableError,
    damaged_study,
    draws_sentence,
    over_draws,
    read_chosen_waveforms,
)
from dse.units import Unit, parse_unit

MAX_WAVEFORMS = 4000
"""Runs whose waveforms a page carries at most; more would make it too large to open at ease."""


def read_content(path: Path, most: int = MAX_WAVEFORMS) -> ReportContent:
    """Everything the page needs, from the study folder *path* alone.

    With more than *most* kept waveforms an evenly spread choice is taken; waveforms whose file is gone or damaged are
    left out. The facts say so. DseError if the folder is damaged otherwise.
    """
    with StudyFolder.snapshot(path) as folder:
        return _read(folder, most)


def content_of_run(run: Run, definition: StudyDefinition) -> ReportContent:
    """One run on its own, with its waveforms, as the figures need it."""
    entry = definition.configuration(run.request.configuration)
    waveforms = {run.request.number: run.waveforms} if run.waveforms else {}
    numbers = np.asarray([run.request.number], dtype=np.int64)
    done = np.asarray([run.outcome is Outcome.DONE])
    points = {name: np.asarray([value]) for name, value in run.request.point.items()}
    constants = {entry.id: entry.constants}
    rows = _Rows(numbers, (run.request.configuration,), points, constants, _bench_labels(definition))
    return ReportContent(
        definition.title,
        SamplerKind.FULL_FACTORIAL,
        "",
        Runs(numbers, (run.request.configuration,), done, (run.problem,)),
        (_configuration(entry, definition),),
        figures=_figures(definition, rows, waveforms),
    )


def _read(folder: StudyFolder, most: int) -> ReportContent:
    folder.require_definition()
    table = folder.table()
    lost = folder.lost()
    files = folder.kept()
    kept = sorted(number for number, file in files.items() if file and number not in lost)
    chosen = kept if len(kept) <= most else [kept[i] for i in np.linspace(0, len(kept) - 1, most).astype(int)]
    strangers = set(kept) - set(table.numbers.tolist())
    single, table = table, over_draws(table)
    chosen = [number for number in chosen if number in set(table.numbers.tolist())]
    if strangers:
        raise damaged_study(folder.path, f"waveforms were kept of run {min(strangers)}, which is not there")
    waveforms = _waveforms(folder, files, chosen) if folder.header.definition.figures else None
    missing = len(lost) + (len(chosen) - len(waveforms) if waveforms is not None else 0)
    told = _waveform_facts(len(kept), len(chosen), missing)
    try:
        content = _content(folder, table, waveforms or {}, told)
        return replace(content, missing=_missing(folder.path, missing), draws=draws_of(single, table))
    except ValueError as error:
        raise damaged_study(folder.path, str(error)) from error


def _content(folder: StudyFolder, table: RunTable, waveforms: Mapping[int, Waveforms], told: str) -> ReportContent:
    """ValueError if the parts of the study do not fit each other."""
    definition = table.header.definition
    units = {metric.name: parse_unit(metric.unit) for metric in definition.metrics}
    constants = {entry.id: entry.constants for entry in definition.configurations}
    rows = _Rows(table.numbers, table.configurations, table.points, constants, _bench_labels(definition))
    figures = _figures(definition, rows, waveforms)
    are_noisy = frozenset(noisy(definition))
    checked = np.isin(table.numbers, table.checks.numbers) if len(table.checks) else None
    return ReportContent(
        definition.title,
        _layout(table.header.slices),
        folder.path.as_posix(),
        Runs(table.numbers, table.configurations, table.done, table.problems, checked),
        tuple(
            replace(_configuration(entry, definition), noisy=entry.id in are_noisy)
            for entry in definition.configurations
        ),
        tuple(map(_variable, definition.variables, table.coordinates().T, lacking(table.header))),
        tuple(_metric(m, table) for m in definition.metrics if not m.error_of),
        tuple(
            _requirement(entry, level, table, units[entry.metric])
            for entry, level in zip(definition.requirements, severity_levels(definition), strict=True)
        ),
        figures,
        table.header.slices or (),
        _facts(folder, table, told),
        objectives=objectives_of(definition),
        composites=composites_of(definition, table),
        notes=folder.notes(),
        retried=tuple(Retried(cause, tuple(runs)) for cause, runs in folder.retried().items()),
        scenes=scenes_of(definition),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """What targets of figures are looked up in: points by run, constants by configuration."""

    numbers: NDArray[np.int64]
    configurations: tuple[str, ...]
    points: Mapping[str, NDArray[Any]]
    constants: Mapping[str, Mapping[str, float]]
    benches: tuple[str, ...] = ()

    def value(self, name: str, number: int) -> float:
        """Value (SI) of the parameter *name* in run *number*; NaN if it has none."""
        row = int(np.searchsorted(self.numbers, number))
        if name in self.points:
            return float(self.points[name][row])
        constants = self.constants[self.configurations[row]]
        bench = self.benches[int(self.points[TESTBENCH][row])] if self.benches and TESTBENCH in self.points else ""
        return constants.get(f"{bench}/{name}", constants.get(name, float("nan")))


def _bench_labels(definition: StudyDefinition) -> tuple[str, ...]:
    """The names of several benches, in their order; that of the first does not matter."""
    found = (variable.labels for variable in definition.variables if variable.name == TESTBENCH)
    return next(found, ("", *definition.other_simulations) if definition.other_simulations else ())


def _layout(slices: Grid | None) -> SamplerKind:
    if slices is None:
        return SamplerKind.SCATTERED
    return SamplerKind.SLICED if slices else SamplerKind.FULL_FACTORIAL


def _metric(entry: DefinedMetric, table: RunTable) -> MetricColumn:
    unit = parse_unit(entry.unit)
    error = Scale(entry.unit, unit, is_difference=True).of(table.errors(entry.name)) if table.has_checks else None
    return MetricColumn(entry.name, entry.title, str(unit), _shown(table.metric(entry.name), unit), error)


def _shown(values: NDArray[np.float64], unit: Unit) -> Floats:
    """SI *values* in *unit*."""
    return np.asarray(Scale(unit.symbol, unit).of(values))


def _bound(value: float | None, unit: Unit) -> float | None:
    # Converted like the values it is compared with, so that a value on its bound stays there.
    return None if value is None else float(_shown(np.asarray(value), unit))


def _configuration(entry: DefinedConfiguration, definition: StudyDefinition) -> ConfigurationEntry:
    choices = {place: entry.choices[place] for place in definition.design.places if place in entry.choices}
    properties = {name: Property(total.value, total.unit) for name, total in entry.totals.items()}
    parts, links = parts_and_links(entry)
    return ConfigurationEntry(entry.id, choices, properties, parts, links, allocations=entry.allocations)


def lacking(header: StudyHeader) -> list[tuple[int, ...]]:
    """For each variable the places of the configurations that do not have it."""
    has = np.array([header.has(name) for name in header.configurations], dtype=np.bool_)
    by_variable = has.reshape(len(header.configurations), len(header.variables)).T
    return [tuple(np.flatnonzero(~column).tolist()) for column in by_variable]


def _variable(entry: DefinedVariable, coordinates: Floats, lack: tuple[int, ...]) -> ReportVariable:
    # As tables have them: what was written as 0.36 km/h is that again.
    unit = parse_unit(entry.unit)
    scale = Scale(str(unit), unit)
    found, where = np.unique(coordinates, return_inverse=True)
    values = np.array([scale.number(value) for value in found.tolist()], dtype=np.float64)[where]
    # The bench's own value, which the nominal one may be, need not lie in the range.
    nominal = min(max(entry.nominal, entry.low), entry.high)
    low, high, nominal = (scale.number(value) for value in (entry.low, entry.high, nominal))
    levels = entry.levels or None
    labels = tuple(entry.label(float(value)) for value in range(int(entry.high) + 1)) if entry.labels else ()
    apart = tuple(scale.number(value) for value in sorted(entry.values)) if _are_apart(entry) else ()
    is_log = entry.scale == Scaling.LOG
    return ReportVariable(
        entry.name, entry.title, str(unit), low, high, levels, nominal, values, lack, labels, entry.role, apart, is_log
    )


_FEW, _WIDE = 4, 3.0
"""Fewer values than that, and neighbours that differ by a larger factor, are apart."""


def _are_apart(entry: DefinedVariable) -> bool:
    """Whether a figure must not interpolate between the values that were listed for a variable."""
    values = sorted(entry.values)
    wide = any(0 < low < high / _WIDE for low, high in pairwise(values))
    return bool(entry.labels) or (bool(values) and (len(values) < _FEW or wide))


def _requirement(entry: DefinedRequirement, level: int, table: RunTable, unit: Unit) -> RequirementRow:
    nothing = [VERDICTS.index(verdict) for verdict in (Verdict.NOT_EXERCISED, Verdict.NOT_APPLICABLE)]
    exercised = table.done & ~np.isin(table.verdicts(entry.name), nothing)
    low, high = _bound(entry.at_least, unit), _bound(entry.at_most, unit)
    unsettled = None
    if len(table.checks):
        doubtful = replace(table, rates=None).certainties(entry.name) == CERTAINTIES.index(Certainty.DOUBTFUL)
        told = np.abs(table.margins(entry.name)) <= table.errors(entry.metric)
        unsettled = doubtful & ~(told & exercised)
    draws = _draws(table, table.header.requirements.index(entry.name))
    applies = table.verdicts(entry.name) != VERDICTS.index(Verdict.NOT_APPLICABLE) if entry.on else None
    given = entry.name, entry.title, entry.metric, high, low
    origin = {
        "text": entry.text,
        "source": entry.source,
        "rationale": entry.rationale,
        "severity": entry.severity,
        "benches": ", ".join(entry.on),
        "counts when": entry.exercised_when or "",
    }
    said = tuple((name, text) for name, text in origin.items() if text)
    return RequirementRow(*given, exercised, unsettled, draws, entry.met_in, applies, level, said)


def _draws(table: RunTable, column: int) -> Floats | None:
    """How many draws met a requirement, of how many, and between which rates that leaves it, (4, n)."""
    rates = table.rates
    if rates is None:
        return None
    return np.array([rates.met[:, column], rates.judged[:, column], *rates.interval(column)], dtype=np.float64)


def _figures(definition: StudyDefinition, rows: _Rows, waveforms: Mapping[int, Waveforms]) -> tuple[FigureSpec, ...]:
    figures = []
    for entry in definition.figures:
        unit = parse_unit(entry.unit)
        numbers = [number for number, recorded in waveforms.items() if entry.current in recorded.values]
        if not numbers:
            continue
        # Runs that ended early, or of a shorter bench, have no values at the end.
        time = max((waveforms[number].time for number in numbers), key=len)
        current = np.stack([_padded(waveforms[number].values[entry.current], len(time)) for number in numbers])
        target = None
        if entry.target:
            target = _shown(_target(entry.target, numbers, rows, waveforms, len(time)), unit)
        figures.append(
            FigureSpec(
                entry.name,
                entry.title,
                str(unit),
                entry.current,
                entry.target,
                time,
                np.asarray(numbers, dtype=np.int64),
                _shown(current, unit),
                target,
            )
        )
    return tuple(figures)


def _target(
    name: str, numbers: list[int], rows: _Rows, waveforms: Mapping[int, Waveforms], length: int
) -> NDArray[np.float64]:
    """The target of each run: one value each (n,) if it is a parameter everywhere, else waveforms (n, *length*)."""
    if not any(name in waveforms[number].values for number in numbers):
        return np.asarray([rows.value(name, number) for number in numbers])
    found = ((number, waveforms[number].values.get(name)) for number in numbers)
    return np.stack([np.full(length, rows.value(name, n)) if v is None else _padded(v, length) for n, v in found])


def _padded(values: Floats, length: int) -> Floats:
    """*values* with NaN behind them."""
    if len(values) == length:
        return values
    return np.pad(values, (0, length - len(values)), constant_values=np.nan)


def _waveforms(folder: StudyFolder, kept: Mapping[int, str], chosen: list[int]) -> dict[int, Waveforms]:
    """The waveforms of the runs *chosen* that can be read, as far as figures show them."""
    figures = folder.header.definition.figures
    names = {name for entry in figures for name in (entry.current, entry.target) if name}
    numbers = frozenset(chosen)
    found: dict[int, Waveforms] = {}
    for file in sorted({kept[number] for number in chosen}):
        try:
            found.update(read_chosen_waveforms(folder.waveform_folder / file, numbers, names))
        except UnreadableError:
            raise
        except DseError:  # the others can be shown all the same
            continue
    return dict(sorted(found.items()))


_AGAIN = "the same explore command makes them again"


def _missing(study: Path, runs: int) -> tuple[Problem, ...]:
    what = f"waveforms of {runs} run{'s' * (runs > 1)} are gone or damaged, and left out"
    return (Problem(what, Location(str(study)), _AGAIN),) if runs else ()


def _waveform_facts(kept: int, chosen: int, missing: int) -> str:
    text = f"kept of {kept} runs" + (f", {chosen} of them here" if chosen < kept else "")
    return text + (f"; files of {missing} runs are gone or damaged: {_AGAIN}" if missing else "")


def _checked(table: RunTable) -> str:
    if not table.has_checks:
        return ""
    checked = len(table.checks) or int(np.count_nonzero(table.done))
    doubtful = CERTAINTIES.index(Certainty.DOUBTFUL)
    count = sum(int((table.certainties(name) == doubtful).sum()) for name in table.header.requirements)
    return f"{checked}, with {count} doubtful verdicts"


def _facts(folder: StudyFolder, table: RunTable, waveforms: str) -> tuple[tuple[str, str], ...]:
    header, definition = folder.header, folder.header.definition
    simulation = definition.simulation
    extended = f", {header.earlier} of them before it was extended" if header.era else ""
    facts = [
        ("study", definition.study),
        ("test bench", definition.bench.name),
        ("design space", definition.design.name),
        ("configurations", str(len(definition.configurations))),
        ("runs", f"{folder.count()} of {header.runs}{extended}"),
        ("failed runs", str(int(np.count_nonzero(~table.done)))),
        ("checked runs", _checked(table)),
        ("sampler", definition.sampler.kind.replace("_", " ")),
        ("seed", str(definition.seed)),
        ("noise", draws_sentence(folder.header.definition, len(table))),
        ("simulation", f"{simulation.stop:g} s in steps of {simulation.step:g} s"),
        ("waveforms", waveforms),
        ("fingerprint", header.fingerprint),
        ("dse", definition.dse),
    ]
    facts += [(f"FMU {name}", digest) for name, digest in definition.fmus.items()]
    facts += [("ignored", told) for told in definition.ignored]
    return tuple((name, value) for name, value in facts if value)
