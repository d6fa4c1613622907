"""Reads studies (PET)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from dse.domain.bench import TestBench
from dse.domain.component import Component, Kind
from dse.domain.study import (
    DesignVariable,
    FullFactorial,
    Keep,
    LatinHypercube,
    Sampler,
    Selection,
    Study,
)
from dse.errors import DseError, Location, Problem, closest, raise_if_any
from dse.loading.documents import SelectionSection, StudyFile, VariableSection
from dse.loading.expression import parse_expression
from dse.loading.fields import read_section
from dse.loading.include import read_document
from dse.loading.places import candidates, settable, split_name
from dse.loading.values import read_number
from dse.loading.yaml import Document, Path_

FindBench = Callable[[str, Location], TestBench]
"""Returns the test bench of that name, or raises DseError at the location."""

_SAMPLERS = ("full_factorial", "latin_hypercube")
_MAX_RUNS = 5_000_000
_SEEDS = 2**63


def read_study(path: Path, find_bench: FindBench, inside: Path | None = None) -> Study:
    """One ``*.pet.yaml`` of the workspace *inside*. Raises DseError with every problem in it."""
    document = read_document(path, inside)
    file = read_section(document, StudyFile)
    bench = find_bench(file.testbench, document.place(("testbench",)))
    components = candidates(bench.design, bench.test_components)
    problems: list[Problem] = []
    sampler = _sampler(document, file, problems)
    variables = []
    for name, section in file.design_variables.items():
        try:
            needs_levels = isinstance(sampler, FullFactorial)
            variables.append(_variable(document, name, section, components, bench, needs_levels))
        except DseError as error:
            problems += error.problems
    if not file.design_variables:
        problems.append(
            Problem("no design variable", document.key(("design_variables",)), "use 'dse run' for a bench without any")
        )
    selection = _selection(document, file, problems)
    if file.keep_waveforms not in set(Keep):
        where = document.place(("keep_waveforms",))
        problems.append(Problem(f"unknown '{file.keep_waveforms}'", where, closest(file.keep_waveforms, set(Keep))))
    if not 0 <= file.seed < _SEEDS:
        where = document.place(("seed",))
        problems.append(Problem(f"the seed must be 0 … 2^63 - 1, not {file.seed}", where, "seed: 1"))
    raise_if_any(problems)
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
    )


def _variable(
    document: Document,
    name: str,
    section: VariableSection,
    components: Mapping[str, tuple[Component, ...]],
    bench: TestBench,
    needs_levels: bool,
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
    levels = section.levels or 0
    if needs_levels and levels < 2:
        raise DseError(Problem(f"'{name}' needs at least 2 levels", document.key(at), "levels: 25"))
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
    return DesignVariable(name, low, high, levels, nominal, type_.unit, title, document.key(at))


def _sampler(document: Document, file: StudyFile, problems: list[Problem]) -> Sampler:
    where = document.place(("sampler",))
    if isinstance(file.sampler, str):
        if file.sampler == "full_factorial":
            return _factorial(document, file, (), problems)
        if file.sampler == "latin_hypercube":
            problems.append(
                Problem(
                    "'latin_hypercube' needs a number of samples", where, "sampler: {latin_hypercube: {samples: 500}}"
                )
            )
        else:
            problems.append(Problem(f"unknown sampler '{file.sampler}'", where, closest(file.sampler, _SAMPLERS)))
        return FullFactorial()
    factorial, hypercube = file.sampler.full_factorial, file.sampler.latin_hypercube
    if (factorial is None) == (hypercube is None):
        problems.append(Problem("give exactly one sampler", where, closest("", _SAMPLERS)))
        return FullFactorial()
    if hypercube is not None:
        if not 1 <= hypercube.samples <= _MAX_RUNS:
            at = document.place(("sampler", "latin_hypercube", "samples"))
            problems.append(Problem(f"samples must be 1 … {_MAX_RUNS}, not {hypercube.samples}", at))
        return LatinHypercube(hypercube.samples)
    slices = tuple(tuple(entry) for entry in factorial.slices) if factorial else ()
    return _factorial(document, file, slices, problems)


def _factorial(
    document: Document, file: StudyFile, slices: tuple[tuple[str, ...], ...], problems: list[Problem]
) -> FullFactorial:
    names = set(file.design_variables)
    for i, entry in enumerate(slices):
        if not entry:
            where = document.place(("sampler", "full_factorial", "slices", i))
            problems.append(Problem("a slice names no design variable", where, "remove it or name one"))
        for j, name in enumerate(entry):
            where = document.place(("sampler", "full_factorial", "slices", i, j))
            if name in entry[:j]:
                problems.append(Problem(f"'{name}' stands twice in a slice", where, "remove one"))
            if name not in names:
                problems.append(Problem(f"'{name}' is not a design variable", where, closest(name, names)))
    runs = 0
    for entry in slices or (tuple(names),):
        product = 1
        for name in entry:
            product *= max(1, (file.design_variables[name].levels or 1) if name in names else 1)
        runs += product
    if runs > _MAX_RUNS:
        problems.append(
            Problem(f"{runs} runs for each configuration", document.key(("sampler",)), "use fewer levels or slices")
        )
    return FullFactorial(slices)


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
