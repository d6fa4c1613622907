"""What a study's definition says, in words and units for showing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from dse.api.presentation.quantities import checked_quantity, difference, quantity, units_called
from dse.storage import Scale, scales_of
from dse.units import parse_unit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dse.analysis import Ranking
    from dse.domain.definition import DefinedRequirement, StudyDefinition
    from dse.domain.run import Run
    from dse.storage import Certainty


@dataclass(frozen=True, slots=True)
class MetricRow:
    """A metric, with a requirement on it if there is one, as texts. A metric's further requirements have rows without
    *title* and *value*."""

    title: str
    value: str
    requirement: str = ""
    bound: str = ""
    margin: str = ""
    verdict: str = ""
    certainty: str = ""

    @property
    def judged(self) -> str:
        """The verdict, and that it is doubtful if it is."""
        return f"{self.verdict}, {self.certainty}" if self.certainty == "doubtful" else self.verdict


@dataclass(frozen=True, slots=True)
class Check:
    """What finer numerics can change of a run: *errors* are the error bars of its metrics, and how certain its verdicts
    are by requirement. Both are empty if nobody has looked."""

    errors: Mapping[str, float] = field(default_factory=dict)
    certainties: Mapping[str, Certainty] = field(default_factory=dict)


def check_by_bars(run: Run, definition: StudyDefinition) -> Check:
    """What the error bars among the metrics of *run* tell, if there are any."""
    import numpy as np

    from dse.domain.bench import VERDICTS
    from dse.domain.run import ERROR_BAR
    from dse.storage import CERTAINTIES, certainties_by_bars

    bars = [metric.error_of for metric in definition.metrics if metric.error_of and run.metrics]
    errors = {name: run.metrics[f"{name}{ERROR_BAR}"] for name in bars}
    metrics = {requirement.name: requirement.metric for requirement in definition.requirements}
    judged = run.judgements if errors else ()
    codes = certainties_by_bars(
        np.array([VERDICTS.index(entry.verdict) for entry in judged], dtype=np.uint8),
        np.array([entry.margin for entry in judged], dtype=np.float64),
        np.array([errors[metrics[entry.requirement]] for entry in judged], dtype=np.float64),
    )
    certainties = (CERTAINTIES[code] for code in codes.tolist())
    return Check(errors, dict(zip((entry.requirement for entry in judged), certainties, strict=True)))


def metric_rows(run: Run, definition: StudyDefinition, check: Check) -> Iterator[MetricRow]:
    """Every metric in its unit, with its error bar if it was checked, and the requirements on it."""
    for metric in definition.metrics:
        if metric.error_of:
            continue
        name = metric.name
        value = checked_quantity(run.metrics.get(name, math.nan), check.errors.get(name), metric.unit)
        requirements = [entry for entry in definition.requirements if entry.metric == name]
        if not requirements:
            yield MetricRow(metric.title, value)
        for number, requirement in enumerate(requirements):
            title, shown = ("", "") if number else (metric.title, value)
            judged = *_judged(run, requirement), str(check.certainties.get(requirement.name, ""))
            yield MetricRow(title, shown, requirement.name, _bound(requirement), *judged)


def requirement_labels(definition: StudyDefinition) -> Mapping[str, str]:
    """The requirements by name, each with its title if it has another."""
    named = {entry.name: entry.title for entry in definition.requirements}
    return {name: name if name == words else f"{name} {words}" for name, words in named.items()}


def _bound(requirement: DefinedRequirement) -> str:
    bounds = ((requirement.at_most, "≤"), (requirement.at_least, "≥"))
    return ", ".join(f"{sign} {quantity(bound, requirement.unit)}" for bound, sign in bounds if bound is not None)


def _judged(run: Run, requirement: DefinedRequirement) -> tuple[str, str]:
    judgement = next(entry for entry in run.judgements if entry.requirement == requirement.name)
    return difference(judgement.margin, requirement.unit), str(judgement.verdict)


# The best designs of a study as plain data.


def ranking_as_data(ranking: Ranking, definition: StudyDefinition, units: str = "shown") -> dict[str, Any]:
    """*ranking* as plain data, in these *units*: ``units`` has them by variable, objective, requirement and metric."""
    from dse.analysis import unit_of_objective

    scales = dict(scales_of(definition, units_called(units)))
    metrics = {entry.name: entry.metric for entry in definition.requirements}
    names = [f"sum({each.name})" if each.is_total else each.name for each in ranking.objectives]
    for name, objective in zip(names, ranking.objectives, strict=True):
        if objective.is_composite:  # computed, and shown, in SI
            unit = parse_unit(unit_of_objective(definition, objective))
            scales[name] = Scale(str(unit), unit)
    data = asdict(ranking)
    for design in (*data["best"], *data["better"]):
        design["point"] = {name: scales[name].number(value) for name, value in design["point"].items()}
        design["values"] = [scales[name].of(value) for name, value in zip(names, design["values"], strict=True)]
        design["margins"] = {name: scales[f"{name}.margin"].of(value) for name, value in design["margins"].items()}
        for missed in design["missed"]:
            if missed["worst"] is not None:
                missed["worst"] = scales[metrics[missed["requirement"]]].of(missed["worst"])
    return {**data, "units": _symbols(scales)}


def _symbols(scales: Mapping[str, Scale]) -> dict[str, str]:
    return {name: scale.symbol for name, scale in scales.items() if scale.symbol}
