"""Reads test procedures: the cases in which a design is tested, and the bounds in each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, cast

from pydantic import Field

from dse.domain.bench import Derived, TestBench
from dse.domain.component import Value
from dse.domain.sampler import DesignVariable, Nominal, Role, Sampler
from dse.domain.study import Study
from dse.errors import DseError, Location, Problems, fail
from dse.formats import Entry
from dse.loading.bench.bench import read_settings
from dse.loading.bench.candidates import bench_candidates
from dse.loading.bench.measures import MetricSection, RequirementSection, read_metrics, read_requirements
from dse.loading.bench.study import FindBench
from dse.loading.bench.variables import Place, VariableSection, read_derived, read_variable
from dse.loading.extensions import SAMPLERS
from dse.loading.include import read_document
from dse.loading.names import check_name
from dse.loading.sections import Section, read_section
from dse.loading.values import Elements, Raw


class ProcedureTestSection(Section):
    """Cases on one bench, and what is required in them."""

    hints: ClassVar[Mapping[str, str]] = {"requirements": "NAME: {metric: METRIC, at_most: BOUND}"}

    testbench: str
    title: str = ""
    conditions: dict[str, VariableSection] = Field(default_factory=dict)
    parameters: dict[str, Raw | Elements] = Field(default_factory=dict)
    metrics: dict[str, str | MetricSection] = Field(default_factory=dict)
    requirements: dict[str, RequirementSection] = Field(min_length=1)


class ProcedureFile(Section):
    """``*.procedure.yaml``."""

    procedure: str
    title: str = ""
    source: str = ""
    tests: dict[str, ProcedureTestSection] = Field(min_length=1)


@dataclass(frozen=True, slots=True)
class Procedure:
    """A procedure of *tests*, each a study: every combination of its conditions is a case, and its requirements are
    those of the procedure, not of the bench. *source* tells where its figures are from."""

    name: str
    title: str
    source: str
    tests: tuple[Study, ...]
    where: Location


def read_procedure(path: Path, find_bench: FindBench, inside: Path) -> Procedure:
    """One ``*.procedure.yaml`` of the workspace *inside*. Raises DseError with every problem in it."""
    entry = read_document(path, inside)
    file = read_section(entry, ProcedureFile)
    problems = Problems()
    tests = []
    for name, section in file.tests.items():
        check_name(name, entry["tests"][name].key, problems)
        with problems:
            tests.append(_read_test(entry["tests"][name], section, find_bench))
    if problems:
        raise DseError(*problems)
    return Procedure(file.procedure, file.title, file.source, tuple(tests), entry["procedure"].where)


def _read_test(entry: Entry, section: ProcedureTestSection, find_bench: FindBench) -> Study:
    bench = find_bench(section.testbench, entry["testbench"].where)
    components = bench_candidates(bench.design, bench.test_components)
    problems = Problems()
    settings: dict[str, Value] = {}
    for name, raw in section.parameters.items():
        with problems:
            settings |= read_settings(name, raw, components, entry["parameters"][name])
    bench = _with_settings(bench, settings)
    variables: list[DesignVariable] = []
    derived: list[Derived] = []
    for name, given in section.conditions.items():
        at = entry["conditions"][name]
        with problems:
            place = Place.of(at, components)
            if name in settings:
                raise fail(f"'{name}' is under 'parameters', too", at.key, "remove one")
            if given.derived is not None:
                derived.append(read_derived(place, at, given))
            else:
                variables.append(read_variable(place, at, given, bench, Role.CONDITION))
    theirs = {metric.name for metric in bench.metrics}
    for name in section.metrics.keys() & theirs:
        problems.add(f"'{name}' is a metric of {bench.name}", entry["metrics"][name].key, "rename it")
    own = read_metrics(entry["metrics"], section.metrics, bench.simulation.stop, lambda text, _: text, problems)
    metrics = (*bench.metrics, *own)
    names = theirs | section.metrics.keys()
    required, bounds = read_requirements(entry["requirements"], section.requirements, names, metrics, problems)
    if problems:
        raise DseError(*problems)
    bench = replace(bench, metrics=(*metrics, *bounds), requirements=required, derived=tuple(derived))
    title = section.title or bench.title
    every = cast(Sampler, SAMPLERS.get("full_factorial").model_validate({}))
    return Study(entry.name, bench, tuple(variables), every if variables else Nominal(), title=title, where=entry.key)


def _with_settings(bench: TestBench, settings: Mapping[str, Value]) -> TestBench:
    """*bench* with other values, by ``part.parameter``."""
    names = {part.name for part in bench.test_components}
    own = {name: value for name, value in settings.items() if name.split(".")[0] not in names}
    parts = []
    for part in bench.test_components:
        start = f"{part.name}."
        mine = {name.removeprefix(start): value for name, value in settings.items() if name.startswith(start)}
        parts.append(replace(part, parameters={**part.parameters, **mine}))
    return replace(bench, parameters={**bench.parameters, **own}, test_components=tuple(parts))
