"""Reads studies (PET)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import cast

from dse.domain.bench import TestBench
from dse.domain.component import Component, Kind
from dse.domain.sampler import Sampler
from dse.domain.study import DesignVariable, ExecutorChoice, Keep, Selection, Study
from dse.errors import DseError, Location, Problem, closest
from dse.expression.parse import parse_expression
from dse.formats.yaml import Document, Path_
from dse.loading.documents import SelectionSection, StudyFile, VariableSection
from dse.loading.extensions import EXECUTORS, SAMPLERS, Surroundings, read_extension
from dse.loading.fields import read_section
from dse.loading.include import read_document
from dse.loading.places import candidates, settable, split_name
from dse.loading.root import root_of
from dse.loading.values import read_number

FindBench = Callable[[str, Location], TestBench]
"""Returns the test bench of that name, or raises DseError at the location."""

_SEEDS = 2**63


def read_study(path: Path, find_bench: FindBench, inside: Path | None = None) -> Study:
    """One ``*.pet.yaml`` of the workspace *inside*. Raises DseError with every problem in it."""
    document = read_document(path, inside)
    file = read_section(document, StudyFile)
    bench = find_bench(file.testbench, document.place(("testbench",)))
    components = candidates(bench.design, bench.test_components)
    problems: list[Problem] = []
    variables = []
    for name, section in file.design_variables.items():
        try:
            variables.append(_variable(document, name, section, components, bench))
        except DseError as error:
            problems += error.problems
    if not file.design_variables:
        problems.append(
            Problem("no design variable", document.key(("design_variables",)), "use 'dse run' for a bench without any")
        )
    sampler = _sampler(document, file, tuple(variables), inside or root_of(path), problems)
    executor = _executor(document, file, problems)
    selection = _selection(document, file, problems)
    if file.keep_waveforms not in set(Keep):
        where = document.place(("keep_waveforms",))
        problems.append(Problem(f"unknown '{file.keep_waveforms}'", where, closest(file.keep_waveforms, set(Keep))))
    if not 0 <= file.seed < _SEEDS:
        where = document.place(("seed",))
        problems.append(Problem(f"the seed must be 0 … 2^63 - 1, not {file.seed}", where, "seed: 1"))
    if problems or sampler is None:
        raise DseError(*problems)
    return Study(
        file.study,
        bench,
        tuple(variables),
        sampler,
        selection,
        Keep(file.keep_waveforms),
        file.seed,
        file.title,
        document.place(("study",)),
        executor,
    )


def _variable(
    document: Document,
    name: str,
    section: VariableSection,
    components: Mapping[str, tuple[Component, ...]],
    bench: TestBench,
) -> DesignVariable:
    at: Path_ = ("design_variables", name)
    found = settable(name, components, document.key(at))
    component, type_ = found[0]
    if type_.kind is not Kind.REAL:
        raise DseError(Problem(f"'{name}' is {type_}: only real parameters can be varied", document.key(at)))
    place, port = split_name(name, components, document.key(at))
    range_at = document.place((*at, "range"))
    low, high = (read_number(raw, type_.unit, document.place((*at, "range", i))) for i, raw in enumerate(section.range))
    if not low < high:
        raise DseError(
            Problem(
                f"the range of '{name}' is empty: {section.range[0]} … {section.range[1]}", range_at, "low, then high"
            )
        )
    parameter = component.parameter(port)
    for candidate, _ in found:
        limits = candidate.parameter(port)
        if limits and (
            (limits.minimum is not None and low < limits.minimum)
            or (limits.maximum is not None and high > limits.maximum)
        ):
            raise DseError(
                Problem(
                    f"the range of '{name}' leaves what component {candidate.name} allows",
                    range_at,
                    f"stay within min {limits.minimum} and max {limits.maximum} (SI)",
                )
            )
    if section.nominal is not None:
        where = document.place((*at, "nominal"))
        nominal = read_number(section.nominal, type_.unit, where)
        if not low <= nominal <= high:
            what = f"the nominal value of '{name}' is outside its range {section.range[0]} … {section.range[1]}"
            raise DseError(Problem(what, where, "widen the range or change nominal"))
    else:
        given = bench.parameters.get(name, parameter.start if parameter else (low + high) / 2)
        given = next(
            (t.parameters[port] for t in bench.test_components if t.name == place and port in t.parameters), given
        )
        nominal = float(given)
    title = section.title or (parameter.title if parameter else "") or name
    return DesignVariable(name, low, high, section.levels or 0, nominal, type_.unit, title, document.key(at))


def _sampler(
    document: Document, file: StudyFile, variables: tuple[DesignVariable, ...], inside: Path, problems: list[Problem]
) -> Sampler | None:
    """The sampler, or None with what is wrong with it."""
    try:
        section, at = read_extension(document, "sampler", file.sampler, SAMPLERS)
        around = Surroundings(document, at, frozenset(file.design_variables), variables, inside)
        # What else a sampler has to be, its protocol says and the suite over all of them checks.
        return cast(Sampler, section.settled(around))
    except DseError as error:
        problems += error.problems
        return None


def _executor(document: Document, file: StudyFile, problems: list[Problem]) -> ExecutorChoice:
    try:
        section, _ = read_extension(document, "executor", file.executor, EXECUTORS)
        return ExecutorChoice(section.name, section.options())
    except DseError as error:
        problems += error.problems
        return ExecutorChoice()


def _selection(document: Document, file: StudyFile, problems: list[Problem]) -> Selection:
    at: Path_ = ("configurations",)
    try:
        if isinstance(file.configurations, SelectionSection):
            where = document.origin((*at, "where"))
            return Selection(where=parse_expression(file.configurations.where, where))
        if isinstance(file.configurations, list):
            return Selection(ids=tuple(file.configurations))
        if file.configurations == "all":
            return Selection()
        if file.configurations.startswith("where:"):
            raise DseError(
                Problem("a condition is a mapping", document.place(at), "configurations: {where: cost < 9 EUR}")
            )
        return Selection(ids=(file.configurations,))
    except DseError as error:
        problems += error.problems
        return Selection()
