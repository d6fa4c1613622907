"""A study ready to be explored: configurations chosen, benches prepared, header written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from dse.domain.bench import TestBench
from dse.domain.component import Value
from dse.domain.definition import StudyDefinition
from dse.domain.design import Configuration
from dse.domain.sampler import Nominal
from dse.domain.study import Keep, Selection, Study
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.loading import Raw, read_setting
from dse.testbench.definition import define
from dse.testbench.error_bars import with_error_bars
from dse.testbench.numerics import Say
from dse.testbench.prepare import prepare_bench
from dse.testbench.prepared import PreparedBench, Setting
from dse.testbench.select import selected


@dataclass(frozen=True, slots=True)
class PreparedStudy:
    """A study with its benches by configuration id, and its definition as it is stored."""

    study: Study
    benches: Mapping[str, PreparedBench]
    definition: StudyDefinition


def prepare_study(
    study: Study,
    *,
    version: int = 2,
    cache: Path | None = None,
    say: Say = lambda _: None,
    sandboxed: bool = False,
) -> PreparedStudy:
    """Choose the configurations, build FMUs, assemble systems. Raises DseError with everything that is wrong.

    *say* and *sandboxed* are for `with_error_bars`.
    """
    configurations = selected(study.bench.design, study.selection, study.where)
    test_parts = {part.name: part.component for part in study.bench.test_components}
    benches = {
        name: with_error_bars(
            prepared, {**prepared.configuration.parts, **test_parts}, cache=cache, say=say, sandboxed=sandboxed
        )
        for name, prepared in prepare_bench(study.bench, configurations, version=version, cache=cache).items()
    }
    require_variables(study, {name: bench.settings for name, bench in benches.items()})
    return PreparedStudy(study, benches, define(study, benches))


def bench_study(bench: TestBench, selection: Selection | None = None) -> Study:
    """The study that runs a bench once on every configuration, waveforms kept."""
    return Study(
        bench.name, bench, (), Nominal(), selection or Selection(), Keep.ALL, title=bench.title, where=bench.where
    )


def with_settings(bench: TestBench, settings: Mapping[str, Raw], configuration: Configuration) -> TestBench:
    """*bench* with other parameter values for one configuration, given as the user writes them. Raises DseError."""
    test_parts = {part.name: part.component for part in bench.test_components}
    components = {path: (component,) for path, component in {**configuration.parts, **test_parts}.items()}
    values: dict[str, Value] = {}
    problems: list[Problem] = []
    for name, raw in settings.items():
        here = Location(f"--set {name}={raw}")
        try:
            values[name] = read_setting(name, raw, components, here, here)
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    return with_values(bench, values)


def with_values(bench: TestBench, values: Mapping[str, Value]) -> TestBench:
    """*bench* with other parameter values, in SI."""
    return replace(bench, parameters={**bench.parameters, **values})


def require_variables(study: Study, settings: Mapping[str, Mapping[str, Setting]]) -> None:
    """Raise DseError unless every design variable can be set in every configuration (*settings* by its id)."""
    problems = []
    for variable in study.variables:
        lacking = [name for name, known in settings.items() if variable.name not in known]
        if lacking:
            what = f"{len(lacking)} of {len(settings)} configurations cannot vary '{variable.name}', as {lacking[0]}"
            hint = "vary a parameter, or an input nothing is connected to, that all chosen configurations have"
            problems.append(Problem(what, variable.where, hint))
    raise_if_any(problems)
