"""Reads studies (PET)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, cast

from pydantic import Field

from dse.domain.bench import TestBench
from dse.domain.component import Kind
from dse.domain.sampler import DesignVariable, Sampler
from dse.domain.study import CheckStep, ExecutorChoice, Keep, Selection, Study
from dse.errors import DseError, Location, Problems, closest, fail
from dse.expression import parse_expression
from dse.formats import Entry
from dse.loading.bench.candidates import Candidates, bench_candidates, settable, split_name
from dse.loading.extensions import EXECUTORS, SAMPLERS, Surroundings, read_extension
from dse.loading.include import read_document
from dse.loading.sections import Plain, Section, read_section
from dse.loading.values import read_number

FindBench = Callable[[str, Location], TestBench]
"""Returns the test bench of that name, or raises DseError at the location."""

_SEEDS = 2**63


class VariableSection(Section):
    """One design variable."""

    range: list[Plain] = Field(min_length=2, max_length=2)
    levels: int | None = None
    nominal: Plain | None = None
    title: str = ""


class SelectionSection(Section):
    """Configurations by condition."""

    later: ClassVar[frozenset[str]] = frozenset({"sample"})

    where: str


class StudyFile(Section):
    """``*.pet.yaml``."""

    later: ClassVar[frozenset[str]] = frozenset({"objectives", "uncertain"})

    study: str
    title: str = ""
    testbench: str
    configurations: str | list[str] | SelectionSection = "all"
    design_variables: dict[str, VariableSection]
    sampler: str | dict[str, Any] = "full_factorial"
    executor: str | dict[str, Any] = "local"
    keep_waveforms: str = "near_boundary"
    check_step: str = "none"
    seed: int = 0


def read_study(path: Path, find_bench: FindBench, inside: Path) -> Study:
    """One ``*.pet.yaml`` of the workspace *inside*. Raises DseError with every problem in it."""
    entry = read_document(path, inside)
    file = read_section(entry, StudyFile)
    bench = find_bench(file.testbench, entry["testbench"].where)
    components = bench_candidates(bench.design, bench.test_components)
    problems = Problems()
    variables = []
    for name, section in file.design_variables.items():
        with problems:
            variables.append(_variable(entry["design_variables"][name], section, components, bench))
    if not file.design_variables:
        problems.add("no design variable", entry["design_variables"].key, "use 'dse run' for a bench without any")
    sampler, executor, selection = None, ExecutorChoice(), Selection()
    with problems:
        found = read_extension(entry["sampler"], file.sampler, SAMPLERS)
        around = Surroundings(found.entry, frozenset(file.design_variables), tuple(variables), inside)
        # What else a sampler has to be, its protocol says and the suite over all of them checks.
        sampler = cast(Sampler, found.section.settled(around))
    with problems:
        chosen = read_extension(entry["executor"], file.executor, EXECUTORS).section
        executor = ExecutorChoice(chosen.name, chosen.options())
    with problems:
        selection = _selection(entry["configurations"], file)
    for key, word, known in (("keep_waveforms", file.keep_waveforms, Keep), ("check_step", file.check_step, CheckStep)):
        if word not in set(known):
            problems.add(f"unknown '{word}'", entry[key].where, closest(word, set(known)))
    if file.check_step == CheckStep.NEAR_BOUNDARY and bench.simulation.check_step:
        what, where = "the bench's check_step repeats every run already", entry["check_step"].where
        problems.add(what, where, "leave it out here, or there to have only runs near a boundary repeated")
    if not 0 <= file.seed < _SEEDS:
        problems.add(f"the seed must be 0 … 2^63 - 1, not {file.seed}", entry["seed"].where, "seed: 1")
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
        entry["study"].where,
        executor,
        CheckStep(file.check_step),
    )


def _variable(entry: Entry, section: VariableSection, components: Candidates, bench: TestBench) -> DesignVariable:
    name, key = entry.name, entry.key
    found = settable(name, components, key)
    component, type_ = found[0]
    if type_.kind is not Kind.REAL:
        raise fail(f"'{name}' is {type_}: only real parameters can be varied", key)
    place, port = split_name(name, components, key)
    written = entry["range"]
    low, high = (read_number(raw, type_.unit, written[i].where) for i, raw in enumerate(section.range))
    shown = f"{section.range[0]} … {section.range[1]}"
    if not low < high:
        raise fail(f"the range of '{name}' is empty: {shown}", written.where, "low, then high")
    for candidate, _ in found:
        limits = candidate.parameter(port)
        if limits and (
            (limits.minimum is not None and low < limits.minimum)
            or (limits.maximum is not None and high > limits.maximum)
        ):
            what = f"the range of '{name}' leaves what component {candidate.name} allows"
            raise fail(what, written.where, f"stay within min {limits.minimum} and max {limits.maximum} (SI)")
    parameter = component.parameter(port)
    if section.nominal is not None:
        nominal = read_number(section.nominal, type_.unit, entry["nominal"].where)
        if not low <= nominal <= high:
            what = f"the nominal value of '{name}' is outside its range {shown}"
            raise fail(what, entry["nominal"].where, "widen the range or change nominal")
    else:
        given = bench.parameters.get(name, parameter.start if parameter else (low + high) / 2)
        for part in bench.test_components:
            given = part.parameters.get(port, given) if part.name == place else given
        nominal = float(given)
    title = section.title or (parameter.title if parameter else "") or name
    return DesignVariable(name, low, high, section.levels or 0, nominal, type_.unit, title, key)


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
