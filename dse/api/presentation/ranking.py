"""The best designs of a study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from dse.api.presentation.quantities import units_called
from dse.storage import Scale, scales_of
from dse.units import parse_unit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dse.analysis import Ranking
    from dse.domain.definition import StudyDefinition


def ranking_as_data(ranking: Ranking, definition: StudyDefinition, units: str = "shown") -> dict[str, Any]:
    """*ranking* as plain data, in these *units*: ``units`` has them by variable, objective, requirement and metric."""
    from dse.analysis import unit_of_objective

    scales = dict(scales_of(definition, units_called(units)))
    metrics = {entry.name: entry.metric for entry in definition.requirements}
    names = [f"sum({each.name})" if each.is_total else each.name for each in ranking.objectives]
    for name, objective in zip(names, ranking.objectives, strict=True):
        if objective.is_composite:  # computed, and shown, in SI
            symbol = unit_of_objective(definition, objective)
            scales[name] = Scale(symbol, parse_unit(symbol))
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
