"""A point of a study that was not asked for, simulated once; nothing is stored."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.studies.provenance import benches_near
from dse.api.studies.run import Run
from dse.api.studies.single_run import OnChanged, again
from dse.domain.run import TESTBENCH, Outcome, Run as RunNoun, RunRequest
from dse.domain.study import Selection
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.testbench import bench_study, one_configuration, with_settings, with_values
from dse.units import parse_unit, short_symbol

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.component import Value
    from dse.domain.definition import DefinedVariable, StudyDefinition


@dataclass(frozen=True, slots=True)
class WhatIfRun:
    """The *run*, and what has *changed* in the workspace since the study was made: then it is no run of the study."""

    run: Run
    changed: tuple[str, ...]


def what_if_run(
    definition: StudyDefinition,
    configuration: str,
    point: Mapping[str, float],
    *,
    near: str | Path = "",
    workspace: str | Path | None = None,
    on_changed: OnChanged | None = None,
) -> WhatIfRun:
    """Simulate *configuration* of the study at *point*, once, in a process of its own, and keep its waveforms.

    *point* has a value for each design variable that the configuration has, in the unit of the study. The study's files
    are taken from *workspace*, else as `in_workspace` does for the folder *near*. *on_changed* is called before it is
    simulated if something has changed since the study was made, with what. Raises DseError for what is no point of
    the study, and if its files are not there, not trusted, or cannot be built; a failed run is a result, too.
    """
    values = _values(definition, configuration, point)
    free = {name: value for name, value in values.items() if name != TESTBENCH}
    first, *others = (
        _within_ranges(with_values(bench, free), definition, configuration, point)
        for bench in benches_near(definition, Path(near), workspace)
    )
    study = replace(bench_study(first, Selection((configuration,))), others=tuple(others))
    here = RunNoun(RunRequest(0, configuration, values), Outcome.DONE, {}, ())
    made, planned, changed = again(study, definition, here, 2, on_changed=on_changed)
    return WhatIfRun(Run(made, planned.definition), changed)


def _within_ranges(
    bench: TestBench, definition: StudyDefinition, configuration: str, point: Mapping[str, float]
) -> TestBench:
    """*bench*, if the components take the values of *point* that may be any. DseError with all that they do not."""
    chosen = one_configuration(bench.design, configuration)
    free = {each.name: each.unit for each in definition.variables if each.name in point and not each.values}
    try:
        return with_settings(bench, {name: f"{point[name]!r} {unit}".rstrip() for name, unit in free.items()}, chosen)
    except DseError as error:
        raise DseError(*(replace(each, where=_place(each.where)) for each in error.problems)) from None


def _place(where: Location | None) -> Location:
    return Location(str(where or "").removeprefix("--set "))


def _values(definition: StudyDefinition, configuration: str, point: Mapping[str, float]) -> dict[str, Value]:
    """*point* in SI, each value of its variable's kind. DseError with all problems."""
    tells = any(each.constants for each in definition.configurations)
    try:
        constants = definition.configuration(configuration).constants
    except KeyError:
        raise fail(f"the study has no configuration '{configuration}'") from None
    variables = {each.name: each for each in definition.variables if not tells or each.name in constants}
    problems = [
        Problem(f"'{name}' is not a design variable of configuration {configuration}", None, closest(name, variables))
        for name in point
        if name not in variables
    ]
    problems += [Problem(f"there is no value for '{name}'", Location(name)) for name in variables if name not in point]
    raise_if_any(problems)
    return {name: _value(variable, point[name]) for name, variable in variables.items()}


def _value(variable: DefinedVariable, given: float) -> Value:
    """*given* in SI; of a variable with certain values the one it is, but for rounding."""
    value = parse_unit(variable.unit).to_si(given)
    if not variable.values:
        return value
    nearest = min(variable.values, key=lambda each: abs(each - value))
    if not math.isclose(nearest, value, rel_tol=1e-9, abs_tol=1e-12):
        unit = parse_unit(variable.unit)
        known = ", ".join(variable.label(each) or f"{unit.from_si(each):g}" for each in variable.values)
        raise fail(
            f"'{variable.name}' has certain values only",
            Location(variable.name),
            f"{known} {short_symbol(variable.unit)}",
        )
    return nearest
