"""Reads studies (PET)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, cast

from pydantic import Field

from dse.domain.bench import Derived, Figure, Metric, TestBench
from dse.domain.design import candidates
from dse.domain.expression import Call, Name
from dse.domain.noise import DRAW, HIGHEST_DRAW, MOST_REPLICATES
from dse.domain.run import TESTBENCH
from dse.domain.sampler import DesignVariable, Objective, Role, Sampler
from dse.domain.study import CheckStep, ExecutorChoice, Keep, Replicates, Selection, Study
from dse.errors import DseError, Location, Problems, closest, fail
from dse.expression import descend, parse_expression
from dse.formats import Entry
from dse.loading.bench.candidates import bench_candidates
from dse.loading.bench.uncertainty import UncertainSection, read_correlations, read_uncertain
from dse.loading.bench.variables import Place, VariableSection, read_derived, read_variable, read_weights
from dse.loading.extensions import EXECUTORS, SAMPLERS, Surroundings, read_extension
from dse.loading.include import read_document
from dse.loading.sections import Plain, Section, read_section
from dse.loading.values import read_number
from dse.units import DIMENSIONLESS

FindBench = Callable[[str, Location], TestBench]
"""Returns the test bench of that name, or raises DseError at the location."""

_SEEDS = 2**63


class SelectionSection(Section):
    """Configurations by condition."""

    later: ClassVar[frozenset[str]] = frozenset({"sample"})

    where: str


class ReplicatesSection(Section):
    """How many draws each run is made with, more while a verdict is open."""

    at_least: int = 5
    at_most: int
    confidence: Plain = 0.95


class StudyFile(Section):
    """``*.pet.yaml``."""

    study: str
    title: str = ""
    testbench: str | list[str]
    configurations: str | list[str] | SelectionSection = "all"
    design_variables: dict[str, VariableSection] = Field(default_factory=dict)
    constraints: list[str] = Field(default_factory=list)
    conditions: dict[str, VariableSection] = Field(default_factory=dict)
    uncertain: dict[str, UncertainSection] = Field(default_factory=dict)
    correlations: list[list[str | float | int]] = Field(default_factory=list)
    objectives: list[str] = Field(default_factory=list)
    sampler: str | dict[str, Any] = "full_factorial"
    executor: str | dict[str, Any] = "local"
    keep_waveforms: str = "near_boundary"
    check_step: str = "none"
    bench_weights: list[Plain] | None = None
    seed: int = 0
    replicates: int | ReplicatesSection | None = None


def read_study(path: Path, find_bench: FindBench, inside: Path) -> Study:
    """One ``*.pet.yaml`` of the workspace *inside*. Raises DseError with every problem in it."""
    entry = read_document(path, inside)
    file = read_section(entry, StudyFile)
    problems = Problems()
    constraints = []
    for number, text in enumerate(file.constraints):
        with problems:
            constraints.append(parse_expression(text, entry["constraints"][number].origin))
    executor, selection = ExecutorChoice(), Selection()
    with problems:
        chosen = read_extension(entry["executor"], file.executor, EXECUTORS).section
        executor = ExecutorChoice(chosen.name, chosen.options())
    with problems:
        selection = _selection(entry["configurations"], file)
    for key, word, known in (("keep_waveforms", file.keep_waveforms, Keep), ("check_step", file.check_step, CheckStep)):
        if word not in set(known):
            problems.add(f"unknown '{word}'", entry[key].where, closest(word, set(known)))
    if not 0 <= file.seed < _SEEDS:
        problems.add(f"the seed must be 0 … 2^63 - 1, not {file.seed}", entry["seed"].where, "seed: 1")
    try:
        benches = _benches(entry["testbench"], file.testbench, find_bench)
    except DseError as error:  # what is wrong in this file alone is told all the same
        with problems:
            read_extension(entry["sampler"], file.sampler, SAMPLERS)
        raise DseError(*error.problems, *problems) from None
    variables, derived = _varied(entry, file, benches, problems)
    replicates = None
    with problems:
        replicates = _replicates(entry["replicates"], file.replicates)
    objectives = []
    for number, written in enumerate(file.objectives):
        with problems:
            objectives.append(read_objective(entry["objectives"][number], written, benches))
    correlations: Mapping[tuple[str, str], float] = {}
    with problems:
        correlations = read_correlations(entry["correlations"], file.correlations, variables)
    sampler = None
    with problems:
        found = read_extension(entry["sampler"], file.sampler, SAMPLERS)
        drawn = [variable for variable in variables if variable.role is not Role.CONDITION]
        names = {*file.design_variables, *file.uncertain} - {follower.name for follower in derived}
        around = Surroundings(found.entry, frozenset(names), tuple(drawn), inside)
        # What else a sampler has to be, its protocol says and the suite over all of them checks.
        sampler = cast(Sampler, found.section.settled(around))
        _require_all_cases(sampler, objectives, entry["objectives"].where)
    if file.check_step == CheckStep.NEAR_BOUNDARY and any(each.simulation.check_step for each in benches):
        what, where = "the bench's check_step repeats every run already", entry["check_step"].where
        problems.add(what, where, "leave it out here, or there to have only runs near a boundary repeated")
    if problems or sampler is None:
        raise DseError(*problems)
    if replicates is not None:
        variables.append(draw_variable(entry["replicates"].key))
    first, *others = (replace(each, derived=tuple(derived)) if derived else each for each in benches)
    return Study(
        file.study,
        first,
        tuple(variables),
        sampler,
        selection,
        Keep(file.keep_waveforms),
        file.seed,
        file.title,
        entry["study"].where,
        executor,
        tuple(objectives),
        tuple(constraints),
        correlations,
        CheckStep(file.check_step),
        tuple(others),
        replicates,
    )


def _require_all_cases(sampler: Sampler, objectives: Sequence[Objective], where: Location) -> None:
    """DseError for an expected value that *sampler* could not be told."""
    if not sampler.once and any(each.is_expected for each in objectives):
        what = f"an expected value needs all cases of a design at once: '{sampler.name}' asks for a few"
        raise fail(what, where, "take a sampler that asks once, as full_factorial or sobol")


def _replicates(entry: Entry, given: int | ReplicatesSection | None) -> Replicates | None:
    """Raises DseError."""
    if given is None:
        return None
    if isinstance(given, int):
        found = Replicates(given, given)
    else:
        share = read_number(given.confidence, DIMENSIONLESS, entry["confidence"].where)
        if not 0.5 <= share < 1:
            raise fail("the confidence must be at least 50 % and less than 100 %", entry["confidence"].where, "95 %")
        found = Replicates(given.at_least, given.at_most, share)
    if not 1 <= found.at_least <= found.at_most <= MOST_REPLICATES:
        what = f"there must be 1 … {MOST_REPLICATES:,} replicates"
        what += "" if isinstance(given, int) else ", and at_least no more than at_most"
        raise fail(what, entry.where, "replicates: 20, or {at_least: 5, at_most: 100}")
    return found


def draw_variable(where: Location | None) -> DesignVariable:
    """The draw of all random numbers, as one more variable of a study with replicates."""
    title = "draw of the random numbers"
    return DesignVariable(DRAW, 0.0, HIGHEST_DRAW, 0, 0.0, DIMENSIONLESS, title, where, role=Role.REPLICATE)


def _benches(entry: Entry, named: str | list[str], find_bench: FindBench) -> tuple[TestBench, ...]:
    """The benches a file names. DseError unless one study can be made on all of them."""
    if isinstance(named, str):
        return (find_bench(named, entry.where),)
    if not named or len(set(named)) < len(named):
        raise fail("a bench is listed here twice" if named else "there is no bench", entry.where, "name each once")
    benches, problems = [], Problems()
    for number, name in enumerate(named):
        with problems:
            benches.append(find_bench(name, entry[number].where))
    for number, bench in enumerate(benches[1:] if not problems else (), 1):
        for first in benches[:number]:
            for what in differences(first, bench):
                problems.add(what, entry[number].where, f"let it be as in '{first.name}', or study them apart")
    if problems:
        raise DseError(*problems)
    return tuple(benches)


def _varied(
    entry: Entry, file: StudyFile, benches: Sequence[TestBench], problems: Problems
) -> tuple[list[DesignVariable], list[Derived]]:
    """What the file varies, and what follows from it."""
    bench = benches[0]
    components = bench_candidates(bench.design, bench.test_components)
    variables: list[DesignVariable] = []
    derived: list[Derived] = []
    for section, role in (("design_variables", Role.DESIGN), ("conditions", Role.CONDITION)):
        for name, given in getattr(file, section).items():
            at = entry[section][name]
            with problems:
                place = Place.of(at, components)
                if given.derived is not None:
                    derived.append(read_derived(place, at, given))
                else:
                    variables.append(read_variable(place, at, given, bench, role))
    for name, uncertain in file.uncertain.items():
        with problems:
            at = entry["uncertain"][name]
            variables.append(read_uncertain(Place.of(at, components), at, uncertain))
    sections = ("design_variables", "conditions", "uncertain")
    for number, section in enumerate(sections):
        for other in sections[number + 1 :]:
            for name in getattr(file, section).keys() & getattr(file, other).keys():
                what = f"'{name}' is under '{section}', too"
                problems.add(what, entry[other][name].key, "a parameter is varied for one reason")
    if not (file.design_variables or file.conditions or file.uncertain or isinstance(file.testbench, list)):
        problems.add("no design variable", entry["design_variables"].key, "use 'dse run' for a bench without any")
    weights: list[float] = []
    with problems:
        if file.bench_weights is not None:
            weights = read_weights(entry["bench_weights"], file.bench_weights, len(benches))
    if len(benches) > 1:
        variables.append(replace(bench_variable(benches, entry["testbench"].key), weights=tuple(weights)))
    return variables, derived


def _selection(entry: Entry, file: StudyFile) -> Selection:
    match file.configurations:
        case SelectionSection(where=condition):
            return Selection(where=parse_expression(condition, entry["where"].origin))
        case list(ids):
            return Selection(ids=tuple(ids))
        case "all":
            return Selection()
        case str(name) if name.startswith("where:"):
            raise fail("a condition is a mapping", entry.where, "configurations: {where: cost < 9 EUR}")
        case name:
            return Selection(ids=(name,))


# What a study looks for: metrics and sums of properties to be made small or large.


_WRITTEN = re.compile(r"(minimize|maximize)\s+(.+)", re.DOTALL)


def read_objective(entry: Entry, written: str, benches: Sequence[TestBench]) -> Objective:
    """``minimize`` or ``maximize`` and a metric of all *benches*, ``sum(PROPERTY)`` over the design, or an expression
    in both. Raises DseError."""
    bench = benches[0]
    match = _WRITTEN.fullmatch(written.strip())
    if not match:
        raise fail(f"expected an objective, found '{written}'", entry.where, "minimize METRIC, or minimize sum(cost)")
    maximize = match[1] == "maximize"
    expression = parse_expression(match[2], entry.where)
    each = [{metric.name for metric in bench.metrics} for bench in benches]
    metrics = [metric.name for metric in bench.metrics if all(metric.name in names for names in each)]
    match expression.root:
        case Name(path=name) if name in metrics:
            return Objective(name, maximize)
        case Call("sum", arguments=(Name(path=name),)):
            found = Objective(name, maximize, is_total=True)
        case _:
            found = Objective(match[2].strip(), maximize, is_composite=True)
    stated = candidates(bench.design.root).values()
    known = {name for components in stated for each in components for name in each.properties}
    for name in found.totals:
        if name not in known:
            raise fail(f"no component of the design states '{name}'", entry.where, closest(name, known))
    for node in descend(expression.root):
        if isinstance(node, Name) and node.path not in (*metrics, *found.totals):
            of = next(b.name for b, names in zip(benches, each, strict=True) if node.path not in names)
            raise fail(f"'{node.path}' is not a metric of {of}", entry.where, closest(node.path, metrics))
    return found


# Several benches in one study: what they have to share, and the condition that tells them apart.


def bench_variable(benches: Sequence[TestBench], where: Location | None) -> DesignVariable:
    """The condition that counts *benches* from 0."""
    last, names = len(benches) - 1, tuple(bench.name for bench in benches)
    values = tuple(float(number) for number in range(len(benches)))
    return DesignVariable(
        TESTBENCH,
        0.0,
        float(last),
        len(benches),
        0.0,
        DIMENSIONLESS,
        "test bench",
        where,
        values=values,
        role=Role.CONDITION,
        labels=names,
    )


def differences(one: TestBench, other: TestBench) -> Iterator[str]:
    """In what *other* is not as *one* is, though benches of one study have to be: a run's results are one row."""
    if one.design != other.design:
        yield f"'{other.name}' is a bench of design space '{other.design.name}', '{one.name}' of '{one.design.name}'"
    mine, theirs = ({metric.name: (_unit(metric), metric.unit.symbol) for metric in b.metrics} for b in (one, other))
    for name in sorted({*mine} & {*theirs}):
        if mine[name] != theirs[name]:
            yield f"the metric '{name}' has another unit in '{other.name}': {theirs[name][1]}, not {mine[name][1]}"
    bounds = [
        {r.name: (r.metric, r.at_most, r.at_least, r.met_in) for r in bench.requirements} for bench in (one, other)
    ]
    for name in sorted({*bounds[0]} & {*bounds[1]}):
        if bounds[0][name] != bounds[1][name]:
            yield f"the requirement '{name}' is not the same in '{one.name}' and '{other.name}'"
    drawn = {figure.name: _shown(figure) for figure in one.figures}
    for figure in other.figures:
        if drawn.get(figure.name, _shown(figure)) != _shown(figure):
            yield f"the figure '{figure.name}' shows something else in '{other.name}'"
    if one.simulation.record_every != other.simulation.record_every:
        yield f"'{other.name}' records at other times than '{one.name}' (record_every)"
    if one.simulation.check_step != other.simulation.check_step:
        yield f"one of '{one.name}' and '{other.name}' has check_step, the other has not"


def _unit(metric: Metric) -> object:
    return metric.unit.dimension if metric.unit.symbol else None


def _shown(figure: Figure) -> object:
    return figure.current, figure.target, figure.unit.symbol
