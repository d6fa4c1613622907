"""A rating of configurations of a design: the runs that are missing, colours, workbooks and points."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api import ExploreOptions, explore_into
from dse.errors import fail
from dse.rating.cases import Case, CaseStudy, case_studies, not_simulated, tests_of, warned_tests
from dse.rating.protocol import Cell, CellKey, Protocol
from dse.rating.workbook import ASSESSED, Points, Prediction, require_inputs, write_all
from dse.storage import StudyFolder
from dse.units import si_unit

if TYPE_CHECKING:
    from dse.api import Progress
    from dse.domain.design import Configuration, DesignSpace
    from dse.loading import Rating

COST = "cost"
"""The property of components that points are compared with."""


@dataclass(frozen=True, slots=True)
class RatedRun:
    """The run *number* in the study folder *folder*: the *value* of its KPI in the protocol's unit, NaN if undefined,
    or the *problem* for which it has none."""

    folder: Path
    number: int
    value: float
    problem: str = ""


@dataclass(frozen=True)
class RatedConfiguration:
    """One configuration with the *runs* of its cases, its *prediction*, and the points of its *workbook*."""

    configuration: Configuration
    runs: Mapping[Case, RatedRun]
    prediction: Prediction
    workbook: Path
    filled: Points

    @property
    def id(self) -> str:
        """The configuration's id."""
        return self.configuration.id

    @property
    def choices_text(self) -> str:
        """The choices in one line."""
        return ", ".join(f"{place} {choice}" for place, choice in self.configuration.choices.items() if choice)

    @cached_property
    def cost(self) -> float | None:
        """The sum of costs in SI, None if no component states one."""
        stated = any(COST in part.properties for part in self.configuration.parts.values())
        return self.configuration.total(COST) if stated else None

    @property
    def cost_text(self) -> str:
        """The cost with its unit, "–" if none is stated."""
        stated = (part.properties[COST].unit for part in self.configuration.parts.values() if COST in part.properties)
        return "–" if self.cost is None else f"{self.cost:.2f} {si_unit(next(stated).dimension)}".rstrip()

    @property
    def failed(self) -> tuple[RatedRun, ...]:
        """The runs without a value: their cells have no colour and no points."""
        return tuple(run for run in self.runs.values() if run.problem)


@dataclass(frozen=True, slots=True)
class RatedDesign:
    """Configurations of *design* rated; *missing* names the tests of the *protocol* that were not simulated."""

    rating: Rating
    design: DesignSpace
    protocol: Protocol
    cells: tuple[Cell, ...]
    rated: tuple[RatedConfiguration, ...]
    missing: tuple[str, ...]
    simulated: int
    """How many runs were made now; the others were there."""

    @property
    def best_first(self) -> list[RatedConfiguration]:
        """The configurations, most points first, of as many the cheapest."""
        return sorted(self.rated, key=lambda each: (-each.filled.points, each.cost or 0.0, each.id))

    @property
    def differing(self) -> list[str]:
        """The places at which not all configurations have the same choice, in the order of the design."""
        places = dict.fromkeys(path for each in self.rated for path in each.configuration.choices)
        return [p for p in places if len({each.configuration.choices.get(p, "") for each in self.rated}) > 1]

    @property
    def partly(self) -> dict[str, tuple[int, int]]:
        """Tests of which some cells alone have a run: how many, of how many."""
        there: dict[str, list[bool]] = {}
        for cell in self.cells:
            there.setdefault(cell.test, []).append((cell.key, "") in self.rated[0].runs)
        return {test: (sum(found), len(found)) for test, found in there.items() if any(found) and not all(found)}

    @property
    def gaps(self) -> str:
        """What was not simulated and has no points, in words; "" if all was."""
        parts = [f"{test} ({there} of {of} cells simulated)" for test, (there, of) in self.partly.items()]
        return ", ".join([*self.missing, *parts])

    @property
    def not_assessed(self) -> str:
        """What the protocol asks for besides the matrices, and neither a simulation nor the rating tells, in words."""
        left = (name.lower() for name in ASSESSED if name not in self.rating.inputs)
        return f"{', '.join(['General requirements', *left])} and documents are not assessed"

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders of the studies."""
        return tuple(dict.fromkeys(run.folder for run in self.rated[0].runs.values()))

    @property
    def layers_left(self) -> str:
        """The robustness layers that were simulated for no scenario, in words; "" if all were."""
        there = {name.split(": ")[0] for _, name in self.rated[0].runs}
        left = {layer for layer, _ in self.protocol.layers} - there
        return ", ".join(sorted({layer.rstrip("*") for layer in left}))

    @property
    def undeclared(self) -> str:
        """The inputs that the package asks for and the rating does not declare, in words; "" if there is none."""
        return ", ".join(self.rated[0].filled.undeclared)

    def cheapest(self, at_least: float) -> RatedConfiguration | None:
        """The configuration of the least cost with that many points, None if there is none."""
        enough = [each for each in self.rated if each.filled.points >= at_least and each.cost is not None]
        return min(enough, key=lambda each: (each.cost, -each.filled.points, each.id), default=None)

    def differences(self, one: RatedConfiguration, other: RatedConfiguration) -> Iterator[tuple[Cell, str, str]]:
        """The cells whose colours differ, with both colours; "" is none."""
        mine, theirs = one.prediction.colours, other.prediction.colours
        for cell in self.cells:
            if mine.get(cell.key) != theirs.get(cell.key):
                yield cell, mine.get(cell.key, ""), theirs.get(cell.key, "")

    def effects(self) -> list[tuple[str, str, int, float]]:
        """What each choice is worth: place, alternative ("" for none), number of rated configurations that have it, and
        their mean points less those of all. Largest range of a place first; only places where they differ."""
        mean = sum(each.filled.points for each in self.rated) / len(self.rated)
        found: list[list[tuple[str, str, int, float]]] = []
        for path in self.differing:
            by_choice: dict[str, list[float]] = {}
            for each in self.rated:
                by_choice.setdefault(each.configuration.choices.get(path, ""), []).append(each.filled.points)
            rows = [(path, name, len(of), sum(of) / len(of) - mean) for name, of in by_choice.items()]
            found.append(sorted(rows, key=lambda row: (-row[3], row[1])))
        return [row for rows in sorted(found, key=lambda rows: rows[-1][3] - rows[0][3]) for row in rows]


def rate(
    rating: Rating,
    design: DesignSpace,
    configurations: Sequence[Configuration],
    folder: Path,
    options: ExploreOptions | None = None,
    *,
    layers: bool = False,
    on_progress: Callable[[Progress], None] | None = None,
    tell: Callable[[str], None] | None = None,
) -> RatedDesign:
    """Rate *configurations* of *design*: studies in *folder*, one for each test bench, get the runs they lack.

    With *layers*, the robustness layers are simulated, too. Workbooks are written into *folder* as well:
    ``RATING-ID.xlsx``.

    Raises DseError with every problem of the rating, and if the protocol's package is not installed;
    ExplorationInterruptedError as `explore_into` does.
    """
    if not configurations:
        raise fail(f"no configuration of '{design.name}' was chosen")
    protocol = Protocol(rating.protocol.text, rating.protocol.where)
    require_inputs(protocol, rating.inputs)
    if not layers:
        rating = replace(rating, tests=tuple(replace(test, variations=()) for test in rating.tests))
    warned = warned_tests(rating, protocol)
    cells = protocol.cells(warned)
    studies = case_studies(rating, protocol, cells, design, configurations)
    runs: dict[str, dict[Case, RatedRun]] = {each.id: {} for each in configurations}
    simulated = 0
    for study in studies:
        place = folder / study.study.name
        explored = explore_into(study.study, place, options or ExploreOptions(), on_progress=on_progress, tell=tell)
        simulated += explored.simulated
        _read(study, place, runs)
    inputs = {name: given.text for name, given in rating.inputs.items()}
    predictions = {
        folder / f"{rating.name}-{each.id}.xlsx": predict(protocol, cells, runs[each.id], inputs)
        for each in configurations
    }
    workers = (options.workers if options else 0) or os.cpu_count() or 1
    found: list[RatedConfiguration] = []
    for each, path, filled in zip(
        configurations, predictions, write_all(protocol, predictions, warned, workers), strict=True
    ):
        found.append(RatedConfiguration(each, runs[each.id], predictions[path], path, filled))
        if tell:
            tell(f"calculating points: {len(found)} of {len(configurations)}")
    missing = not_simulated(tests_of(rating, protocol, design), protocol)
    return RatedDesign(rating, design, protocol, cells, tuple(found), missing, simulated)


def _read(each: CaseStudy, folder: Path, runs: dict[str, dict[Case, RatedRun]]) -> None:
    """Add the runs of a study to *runs* by configuration."""
    with StudyFolder.open(folder) as store:
        table = store.table()
    metrics = {reading.metric: table.metric(reading.metric) for reading in each.readings.values()}
    places = {
        (request.configuration, tuple(request.point.values())): row for row, request in enumerate(table.requests())
    }
    for name, found in runs.items():
        for case, point in each.points.items():
            row, reading = places[name, point], each.readings[case]
            value, number = float(metrics[reading.metric][row]), int(table.numbers[row])
            problem = "" if table.done[row] else table.problems[row] or "failed to run"
            found[case] = RatedRun(folder, number, reading.unit.from_si(value), problem)


def predict(
    protocol: Protocol, cells: Sequence[Cell], runs: Mapping[Case, RatedRun], inputs: Mapping[str, str]
) -> Prediction:
    """The colours of all cells that have a run, and the layers whose criteria all their cells meet."""
    colours: dict[CellKey, str] = {}
    judged: dict[tuple[str, str], list[tuple[str, bool]]] = {}
    for cell in cells:
        run = runs.get((cell.key, ""))
        if run is None or run.problem or cell.key in colours:
            continue
        colours[cell.key] = protocol.colour(cell, run.value, inputs)
        if protocol.weight(colours[cell.key]) == 0.0:
            continue  # a red cell is not verified, with or without a layer
        scenario = protocol.scenario(cell.test)
        for name, (layer, condition) in protocol.variations(scenario).items() if not cell.extended else ():
            other = runs.get((cell.key, name))
            if other is None and (not condition or (cell.key, layer) in runs):
                continue  # a layer that is one for all conditions has none for each, and the other way round
            met = (
                other is not None
                and not other.problem
                and protocol.is_met(
                    layer, condition, cell.test, colours[cell.key], protocol.colour(cell, other.value, inputs)
                )
            )
            judged.setdefault((layer, scenario), []).append((cell.test, met))
    parts: dict[str, set[str]] = {}
    for test in protocol.tests:
        parts.setdefault(protocol.scenario(test), set()).add(test)
    claimed = {
        (layer, scenario)
        for (layer, scenario), found in judged.items()
        if all(met for _, met in found) and {test for test, _ in found} == parts[scenario]
    }
    values = {case: run.value for case, run in runs.items() if not run.problem}
    return Prediction(colours, values, frozenset(claimed), inputs)
