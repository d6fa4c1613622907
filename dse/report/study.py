"""A study folder → what the report shows: display units, waveforms against their targets, facts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import Verdict
from dse.domain.run import Waveforms
from dse.report.content import (
    ConfigurationEntry,
    FigureSpec,
    Floats,
    MetricColumn,
    ReportContent,
    RequirementRow,
    Runs,
    SamplerKind,
    Variable,
)
from dse.results.folder import StudyFolder
from dse.results.rows import VERDICTS
from dse.results.table import RunTable
from dse.results.waveforms import read_all_waveforms
from dse.units import Unit, parse_unit

MAX_WAVEFORMS = 4000
"""Runs whose waveforms a page carries at most; more would make it too large to open at ease."""


def read_content(folder: StudyFolder, *, shown_as: str, most: int = MAX_WAVEFORMS) -> ReportContent:
    """Everything the page needs, from *folder* alone. *shown_as* is what the reader types for the folder.

    With more than *most* kept waveforms an evenly spread choice is taken, and the facts say so.
    """
    definition = folder.header.definition
    table = folder.table()
    units = {metric["name"]: parse_unit(metric["unit"]) for metric in definition["metrics"]}
    kept = sorted(number for number, file in folder.kept().items() if file)
    chosen = kept if len(kept) <= most else [kept[i] for i in np.linspace(0, len(kept) - 1, most).astype(int)]
    figures = _figures(folder, table, chosen) if definition["figures"] and chosen else ()
    return ReportContent(
        definition["title"],
        _sampler(definition),
        shown_as,
        Runs(table.numbers, table.configurations, table.done, table.problems),
        tuple(_configuration(entry) for entry in definition["configurations"]),
        tuple(_variable(entry, table) for entry in definition["variables"]),
        tuple(
            MetricColumn(m["name"], m["title"], m["unit"], _shown(table.metric(m["name"]), units[m["name"]]))
            for m in definition["metrics"]
        ),
        tuple(_requirement(entry, table, units[entry["metric"]]) for entry in definition["requirements"]),
        figures,
        tuple(tuple(names) for names in definition["sampler"].get("slices", ())),
        _facts(folder, table, len(kept), len(chosen)),
    )


def _sampler(definition: Mapping[str, Any]) -> SamplerKind:
    sampler = definition["sampler"]
    if sampler["kind"] == "full_factorial":
        return SamplerKind.SLICED if sampler["slices"] else SamplerKind.FULL_FACTORIAL
    return SamplerKind.SCATTERED


def _shown(values: NDArray[np.float64], unit: Unit) -> Floats:
    """SI *values* in *unit*."""
    return (values - float(unit.offset)) / float(unit.factor)


def _bound(value: float | None, unit: Unit) -> float | None:
    return None if value is None else unit.from_si(value)


def _configuration(entry: Mapping[str, Any]) -> ConfigurationEntry:
    properties = {name: f"{total['value']:g} {total['unit']}".rstrip() for name, total in entry["totals"].items()}
    return ConfigurationEntry(entry["id"], entry["choices"], properties)


def _variable(entry: Mapping[str, Any], table: RunTable) -> Variable:
    unit = parse_unit(entry["unit"])
    values = _shown(np.asarray(table.points[entry["name"]], dtype=np.float64), unit)
    low, high, nominal = (unit.from_si(entry[key]) for key in ("low", "high", "nominal"))
    return Variable(entry["name"], entry["title"], entry["unit"], low, high, entry["levels"] or None, nominal, values)


def _requirement(entry: Mapping[str, Any], table: RunTable, unit: Unit) -> RequirementRow:
    skipped = VERDICTS.index(Verdict.NOT_EXERCISED)
    exercised = table.done & (table.verdicts(entry["name"]) != skipped)
    low, high = _bound(entry["at_least"], unit), _bound(entry["at_most"], unit)
    return RequirementRow(entry["name"], entry["title"], entry["metric"], high, low, exercised)


def _figures(folder: StudyFolder, table: RunTable, chosen: list[int]) -> tuple[FigureSpec, ...]:
    waveforms = _waveforms(folder, chosen)
    rows = {number: row for row, number in enumerate(table.numbers.tolist())}
    constants = {entry["id"]: entry["constants"] for entry in folder.header.definition["configurations"]}
    figures = []
    for entry in folder.header.definition["figures"]:
        unit = parse_unit(entry["unit"])
        numbers = [number for number in chosen if entry["current"] in waveforms[number].values]
        if not numbers:
            continue
        current = np.stack([waveforms[number].values[entry["current"]] for number in numbers])
        target = None
        if entry["target"]:
            lines = [
                _target(entry["target"], waveforms[n], table, rows[n], constants[table.configurations[rows[n]]])
                for n in numbers
            ]
            varies = any(line.shape for line in lines)
            length = current.shape[1]
            target = np.stack([np.broadcast_to(line, length) for line in lines]) if varies else np.stack(lines)
            target = _shown(target, unit)
        figures.append(
            FigureSpec(
                entry["name"],
                entry["title"],
                entry["unit"],
                entry["current"],
                entry["target"],
                waveforms[numbers[0]].time,
                np.asarray(numbers, dtype=np.int64),
                _shown(current, unit),
                target,
            )
        )
    return tuple(figures)


def _waveforms(folder: StudyFolder, chosen: list[int]) -> dict[int, Waveforms]:
    wanted, kept = set(chosen), folder.kept()
    files = sorted({kept[number] for number in chosen})
    read = (entry for file in files for entry in read_all_waveforms(folder.waveform_folder / file))
    return {number: waveforms for number, waveforms in read if number in wanted}


def _target(
    name: str, waveforms: Waveforms, table: RunTable, row: int, constants: Mapping[str, float]
) -> NDArray[np.float64]:
    """The target's waveform, or its value in this run as an array without dimensions; NaN if it has none."""
    if name in waveforms.values:
        return waveforms.values[name]
    if name in table.points:
        return np.asarray(table.points[name][row], dtype=np.float64)
    return np.asarray(constants.get(name, np.nan), dtype=np.float64)


def _facts(folder: StudyFolder, table: RunTable, kept: int, chosen: int) -> tuple[tuple[str, str], ...]:
    header, definition = folder.header, folder.header.definition
    simulation, sampler = definition["simulation"], definition["sampler"]
    facts = [
        ("study", definition["study"]),
        ("test bench", definition["bench"]["name"]),
        ("design space", definition["design"]["name"]),
        ("configurations", str(len(definition["configurations"]))),
        ("runs", f"{len(table)} of {header.runs}"),
        ("failed runs", str(int(np.count_nonzero(~table.done)))),
        ("sampler", sampler["kind"].replace("_", " ")),
        ("seed", str(definition["seed"])),
        ("simulation", f"{simulation['stop']:g} s in steps of {simulation['step']:g} s"),
        ("waveforms", f"kept of {kept} runs" + (f", {chosen} of them here" if chosen < kept else "")),
        ("fingerprint", header.fingerprint),
        ("dse", definition["dse"]),
    ]
    facts += [(f"FMU {name}", digest) for name, digest in definition["fmus"].items()]
    return tuple((name, value) for name, value in facts if value)
