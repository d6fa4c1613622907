"""What a study folder holds, as data that can be analysed: every scaling of variables is done here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.analysis.cells import grid_weights
from dse.analysis.data import Factor, Floats, Rows, StudyData
from dse.domain.definition import DefinedVariable, StudyDefinition
from dse.domain.sampler import Placing, Role
from dse.errors import DseError
from dse.exploration import design_variable, unit_of
from dse.loading import SAMPLERS
from dse.storage import RunTable


def study_data(table: RunTable) -> StudyData:
    """All runs of a study that lie in the ranges of its variables; those of an extended study may lie outside.

    Factors are the variables and the places of the design space in which runs differ.
    """
    definition, header = table.header.definition, table.header
    columns = [_scaled(variable, table.points[variable.name]) for variable in definition.variables]
    inside = np.ones(len(table), dtype=np.bool_)
    for _, places in columns:
        inside &= ~((places < -_ROUNDING) | (places > 1.0 + _ROUNDING))
    columns += _chosen(definition, table.configurations)
    all_places = np.array([places for _, places in columns], dtype=np.float64).reshape(len(columns), len(table)).T
    data = StudyData(
        definition,
        tuple(factor for factor, _ in columns),
        np.clip(all_places, 0.0, 1.0),
        table.numbers,
        np.array(table.configurations, dtype=np.str_),
        table.done,
        {entry.name: _finite(table.metric(entry.name)) for entry in definition.metrics if not entry.error_of},
        {name: _finite(table.margins(name)) for name in header.requirements},
        {name: table.verdicts(name) for name in header.requirements},
        _even(table),
        np.ones(len(table)),
        len(table),
        apart=int((~inside).sum()),
    )
    return weighted(data.part(inside), header.slices is not None)


def _even(table: RunTable) -> Rows:
    """Which runs were drawn evenly. Those of an extended study's earlier samplers are if the present one asks for all
    of them again.
    """
    header, sampler = table.header, table.header.definition.sampler
    try:
        placing = SAMPLERS.get(sampler.kind).placed(sampler.options) if header.slices is None else Placing.EVEN
    except DseError:  # a plug-in that is not installed
        placing = Placing.CHOSEN
    if placing is Placing.FIRST and not header.base:
        return np.asarray(table.numbers < header.first)
    since = 0 if header.asked == header.runs else header.base
    return np.asarray((table.numbers >= since) & (placing is Placing.EVEN))


def planes(table: RunTable) -> tuple[StudyData, ...]:
    """The runs of a study, part by part: slices in which some variables are varied and all others held are not mixed.

    One part where there are none.
    """
    data = study_data(table)
    slices = table.header.slices or ()
    if len(slices) < 2:
        return (data,)
    variables = {variable.name: variable for variable in data.definition.variables}
    parts = []
    for names in slices:
        held = [variable for name, variable in variables.items() if name not in names]
        rows = np.ones(len(data), dtype=np.bool_)
        for variable in held:
            _, nominal = _scaled(variable, np.array([variable.nominal]))
            rows &= np.abs(data.places[:, data.factor(variable.name)] - nominal[0]) <= _ROUNDING
        part = replace(data.part(rows), plane=names, apart=data.apart + int((~rows).sum()))
        parts.append(weighted(part, on_grid=True))
    return tuple(parts)


def groups(data: StudyData) -> NDArray[np.intp]:
    """A number for each run, equal where they differ in numbers only: same choices, same factors present, (n,)."""
    choices = [data.places[:, k] for k, factor in enumerate(data.factors) if factor.is_choice]
    absent = np.isnan(data.places).astype(np.float64)
    keys = np.column_stack([np.nan_to_num(np.array(choices).reshape(len(choices), len(data)).T, nan=-1.0), absent])
    if not keys.shape[1]:
        return np.zeros(len(data), dtype=np.intp)
    return np.unique(keys, axis=0, return_inverse=True)[1].reshape(len(data))


def weighted(data: StudyData, on_grid: bool) -> StudyData:
    """With weights, and without the factors that are the same in every run."""
    differs = [len(np.unique(column)) > 1 for column in data.places.T]
    data = replace(
        data,
        factors=tuple(factor for factor, kept in zip(data.factors, differs, strict=True) if kept),
        places=data.places[:, np.array(differs, dtype=np.bool_)],
    )
    weights = grid_weights(data.places, groups(data)) if on_grid else np.ones(len(data))
    return replace(data, weights=weights, different=len(data) if on_grid else _different(data), on_grid=on_grid)


def _different(data: StudyData) -> int:
    """Into how many values the runs are, at most, different in a variable that may have any value."""
    counts = [
        len(np.unique(np.round(np.nan_to_num(column, nan=-1.0), _DIGITS)))
        for factor, column in zip(data.factors, data.places.T, strict=True)
        if factor.variable is not None and not factor.variable.values
    ]
    return max(counts, default=len(data))


def _scaled(defined: DefinedVariable, column: NDArray[Any]) -> tuple[Factor, Floats]:
    """The variable as a factor, and its places: NaN where a run's configuration does not have it."""
    variable = design_variable(defined)
    values = np.asarray(column, dtype=np.float64)
    there = np.isfinite(values)
    places = np.full(len(values), np.nan)
    places[there] = unit_of(values[there, None], (variable,))[:, 0]
    if defined.labels:
        return Factor(defined.name, levels=defined.labels, given=defined.role == Role.CONDITION), places
    return Factor(defined.name, defined.unit, variable), places


def _chosen(definition: StudyDefinition, configurations: tuple[str, ...]) -> list[tuple[Factor, Floats]]:
    """What each run's configuration has at every place of the design space; a place it does not have is a level."""
    choices: Mapping[str, Mapping[str, str]] = {entry.id: entry.choices for entry in definition.configurations}
    found = []
    for place in definition.design.places:
        chosen = np.array([choices[name].get(place, _NOTHING) for name in configurations], dtype=np.str_)
        levels, which = np.unique(chosen, return_inverse=True)
        found.append((Factor(place, levels=tuple(levels.tolist())), (which.reshape(-1) + 0.5) / max(len(levels), 1)))
    return found


def _finite(values: Floats) -> Floats:
    return np.where(np.isfinite(values), values, np.nan)


_NOTHING = "absent"
_ROUNDING = 1e-9
_DIGITS = 9
