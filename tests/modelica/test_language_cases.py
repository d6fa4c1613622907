"""Every language case, built for both FMI versions and run in every way, against its independent solution."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping

import pytest
from fmpy.validation import validate_fmu
from language_case import CASES as FOLDER, Case
from modelica_components import Built
from slaves import numbers, run_cs, run_master, run_me
from solutions_of_classes import CASES as OF_CLASSES
from solutions_of_dynamics import CASES as OF_DYNAMICS
from solutions_of_events import CASES as OF_EVENTS
from solutions_of_expressions import CASES as OF_EXPRESSIONS
from solutions_of_mechanisms import CASES as OF_MECHANISMS

from dse.domain.fmu import FmuModel

ALL = [*OF_EXPRESSIONS, *OF_CLASSES, *OF_DYNAMICS, *OF_EVENTS, *OF_MECHANISMS]
TIGHT = 1e-9


EVERY_DAY = {case.model for case in ALL[::4]}
PARAMETERS = [
    pytest.param(
        case,
        version,
        id=f"{case.model}-fmi{version}",
        marks=[] if version == 2 and case.model in EVERY_DAY else pytest.mark.thorough,
    )
    for case in ALL
    for version in (2, 3)
]


def test_every_model_of_the_folder_has_a_solution() -> None:
    assert sorted(case.model for case in ALL) == sorted(file.stem for file in FOLDER.glob("*.mo"))


def test_every_model_says_which_situation_it_is() -> None:
    assert all(case.file.read_text(encoding="utf-8").startswith("// ") for case in ALL)


def deviation(got: Mapping[str, float], wanted: Mapping[str, float]) -> float:
    """Largest difference: absolute up to 1, relative beyond; infinite if a value is no number."""
    errors = [abs(got[name] - want) / max(1.0, abs(want)) for name, want in wanted.items()]
    return math.inf if any(map(math.isnan, errors)) else max(errors)


def check(case: Case, rows: list[tuple[float, dict[str, float]]], variant: Mapping[str, float], bound: float) -> None:
    compared = 0
    for time, got in rows:
        if not case.is_compared(time):
            continue
        wanted = case.expected(time, variant)
        wrong = {name: (got[name], want) for name, want in wanted.items() if deviation(got, {name: want}) > bound}
        assert not wrong, f"{case.model} at {time:g} s with {dict(variant)}: (got, wanted) = {wrong}"
        compared += 1
    assert compared >= min(3, len(rows))


def timed(case: Case, rows: list[dict[str, float]], step: float) -> list[tuple[float, dict[str, float]]]:
    return [(k * step, row) for k, row in enumerate(rows)]


def names_of(case: Case) -> list[str]:
    return list(case.expected(0.0))


def steps_of(case: Case, step: float) -> int:
    return int(case.stop / step + 1e-6)


@pytest.mark.parametrize(("case", "version"), PARAMETERS)
def test_however_it_is_run_a_model_follows_its_solution(case: Case, version: int, built: Built) -> None:
    """One build for all. What does not depend on the version of FMI is looked at in one of them."""
    model = built(case.file, version)
    follows_by_co_simulation(case, model)
    if case.exchanged:
        follows_by_model_exchange(case, model)
    is_the_same_to_master_and_fmpy(case, model)
    assert validate_fmu(str(model.archive)) == []
    if version == 2:
        follows_with_structural_parameters(case, model, built)
        follows_with_other_steps_and_tolerances(case, model)
        if case.residuals:
            satisfies_its_equations(case, model)


def follows_by_co_simulation(case: Case, model: FmuModel) -> None:
    for variant in ({}, *case.variants):
        if not_settable(model, variant):
            continue
        rows = run_cs(model, names_of(case), steps_of(case, case.step), case.step, variant, case.moved, TIGHT)
        check(case, timed(case, rows, case.step), variant, case.error)


def follows_with_structural_parameters(case: Case, model: FmuModel, built: Built) -> None:
    for variant in case.variants:
        if not not_settable(model, variant):
            continue
        other = built(case.file, 2, variant)
        rows = run_cs(other, names_of(case), steps_of(case, case.step), case.step, {}, case.moved, TIGHT)
        check(case, timed(case, rows, case.step), variant, case.error)


def follows_with_other_steps_and_tolerances(case: Case, model: FmuModel) -> None:
    factors = (1 / 7,) if case.moved else (1 / 7, 3.1)
    for factor in factors:
        step = case.step * factor
        rows = run_cs(model, names_of(case), steps_of(case, step), step, {}, case.moved, TIGHT)
        check(case, timed(case, rows, step), {}, case.error)
    rows = run_cs(model, names_of(case), steps_of(case, case.step), case.step, {}, case.moved, 1e-5)
    check(case, timed(case, rows, case.step), {}, max(1e4 * case.error, 1e-12))


def follows_by_model_exchange(case: Case, model: FmuModel) -> None:
    rows = run_me(model, names_of(case), steps_of(case, case.step), case.step, {}, case.inputs, 1e-8)
    jumps = {t for signal in case.inputs.values() for t in signal.times}
    quiet = [(t, row) for t, row in rows if all(abs(t - jump) > 1e-6 for jump in jumps if jump > 0)]
    check(case, quiet, {}, max(1000 * case.error, 1e-9))


def is_the_same_to_master_and_fmpy(case: Case, model: FmuModel) -> None:
    outputs = [name for name in names_of(case) if model.variables[name].causality == "output"]
    steps = min(steps_of(case, case.step), 12)
    own = run_master(model, outputs, steps, case.step, {})
    theirs = run_cs(model, outputs, steps, case.step, {}, {}, None)
    assert [bits(row) for row in own] == [bits(row) for row in theirs]


def satisfies_its_equations(case: Case, model: FmuModel) -> None:
    steps = steps_of(case, case.step)
    for row in run_cs(model, numbers(model), steps, case.step, {}, case.moved, TIGHT):
        assert max(map(abs, case.residuals(row))) < case.error


def not_settable(model: FmuModel, variant: Mapping[str, float]) -> bool:
    """Whether *variant* names a parameter that has its value built in."""
    return any(
        name not in model.variables or model.variables[name].causality not in ("parameter", "input") for name in variant
    )


def bits(row: Mapping[str, float]) -> dict[str, bytes]:
    return {name: struct.pack("<d", value) for name, value in row.items()}
