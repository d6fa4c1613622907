"""A point of a study that was not asked for, simulated once; nothing is stored."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from dse.api.studies.exploring import alone
from dse.api.studies.run import Run
from dse.domain.run import Outcome, Run as RunNoun, RunRequest
from dse.domain.study import TESTBENCH, Selection
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.loading import Workspace
from dse.storage import changed_inputs
from dse.testbench import bench_study, one_configuration, with_settings, with_values
from dse.units import parse_unit

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.component import Value
    from dse.domain.definition import DefinedVariable, StudyDefinition

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Tried:
    """The *run*, and what has *changed* in the workspace since the study was made: then it is no run of the study."""

    run: Run
    changed: tuple[str, ...]


def try_point(
    definition: StudyDefinition, configuration: str, point: Mapping[str, float], *, near: str | Path = ""
) -> Tried:
    """Simulate *configuration* of the study at *point*, once, in a process of its own, and keep its waveforms.

    *point* has a value for each design variable that the configuration has, in the unit of the study. The study's files
    are taken from the workspace around *near*, else around the current folder. Raises DseError for what is no point of
    the study, and if its files are not there or cannot be built; a run that fails is a result.
    """
    values = _values(definition, configuration, point)
    free = {name: value for name, value in values.items() if name != TESTBENCH}
    first, *others = (
        _within_ranges(with_values(bench, free), definition, configuration, point)
        for bench in benches_near(definition, Path(near))
    )
    study = replace(bench_study(first, Selection((configuration,))), others=tuple(others))
    made, planned = alone(study, 2, on=int(values.get(TESTBENCH, 0)))
    here = RunNoun(RunRequest(0, configuration, values), Outcome.DONE, {}, ())
    run = Run(made, planned.definition)
    return Tried(run, tuple(changed_inputs(definition, planned.definition, here)))


def benches_near(definition: StudyDefinition, near: Path) -> tuple[TestBench, ...]:
    """The benches of the study as its workspace has them now. DseError for the last place that was looked at."""
    is_bench = not definition.variables
    name = definition.bench.name if is_bench else definition.study

    def found(workspace: Workspace) -> tuple[TestBench, ...]:
        return (workspace.bench(name),) if is_bench else workspace.study(name).benches

    return near_or_here(near, found)


def near_or_here(near: Path, look: Callable[[Workspace], T]) -> T:
    """What *look* finds in the workspace around *near*, else around the current folder; DseError if in neither."""
    with suppress(DseError):
        return look(Workspace.around(near))
    return look(Workspace.around(Path()))


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
    try:
        constants = definition.configuration(configuration).constants
    except KeyError:
        raise fail(f"the study has no configuration '{configuration}'") from None
    variables = {each.name: each for each in definition.variables if not constants or each.name in constants}
    problems = [
        Problem(f"'{name}' is no design variable of configuration {configuration}", None, closest(name, variables))
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
        raise fail(f"'{variable.name}' has certain values only", Location(variable.name), f"{known} {variable.unit}")
    return nearest
