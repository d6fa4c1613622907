"""Samplers that search: each learns, and finds what its own library finds; the whole gate is nightly."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from command_line import run_dse
from optimized import Array, Runs, brief, drive, variables

from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import Alternative, Compound, DesignSpace, Part
from dse.exploration.optimization.designs import Design
from dse.exploration.optimization.offspring import Breeding
from dse.exploration.optimization.optimizing_sampler import OptimizingSampler
from dse.exploration.samplers.local import Local
from dse.exploration.samplers.mixed_gp import MixedGp
from dse.exploration.samplers.nsga2 import Nsga2
from dse.exploration.samplers.tpe import Tpe
from dse.space import open_space
from dse.testing.searchers import PROBLEMS, Problem, SearcherSuite, lay_out

BY_NAME = {problem.name: problem for problem in PROBLEMS}


def within(problem: Problem, evaluations: int, search: Callable[[Callable[..., Any]], None]) -> float:
    """The least value of so many that *search* asks for, of choices and places as `Problem.value` does."""
    values: list[float] = []

    def evaluate(*given: Any) -> tuple[float, float]:
        value, margin = problem.value(*given)
        values.append(value if margin >= 0 else math.inf)
        return value, margin

    search(evaluate)
    return min(values[:evaluations])


def optuna_tpe(problem: Problem, seed: int, evaluations: int) -> float:
    """Optuna's sampler with its own options, asked by Optuna."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))

    def search(evaluate: Callable[..., Any]) -> None:
        def objective(trial: optuna.Trial) -> float:
            value, margin = evaluate(trial.suggest_categorical, lambda name: trial.suggest_float(name, 0.0, 1.0))
            trial.set_constraint("R", -margin)
            return float(value)

        study.optimize(objective, evaluations)

    return within(problem, evaluations, search)


def decoded(problem: Problem, x: Array) -> tuple[Callable[..., str], Callable[[str], float]]:
    """Choices and places of a point of the unit cube; a choice takes an equal part of its side."""
    at = dict(zip([*problem.places, *problem.variables], x.tolist(), strict=True))
    return lambda name, options: options[min(int(at[name] * len(options)), len(options) - 1)], at.__getitem__


def pymoo_nsga2(problem: Problem, seed: int, evaluations: int) -> float:
    """pymoo's, as it is, over the unit cube; with as many designs in a generation as ours begins with."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import ElementwiseProblem
    from pymoo.optimize import minimize

    def search(evaluate: Callable[..., Any]) -> None:
        class Cube(ElementwiseProblem):  # type: ignore[misc]
            def __init__(self) -> None:
                count = len(problem.places) + len(problem.variables)
                super().__init__(n_var=count, n_obj=1, n_ieq_constr=1, xl=0.0, xu=1.0)

            def _evaluate(self, x: Array, out: dict[str, Any], *_: Any, **__: Any) -> None:
                out["F"], margin = evaluate(*decoded(problem, x))
                out["G"] = -margin

        minimize(Cube(), NSGA2(pop_size=16), ("n_eval", evaluations), seed=seed)

    return within(problem, evaluations, search)


def scipy_simplex(problem: Problem, seed: int, evaluations: int) -> float:
    """scipy's Nelder-Mead from the best of eight points, then from the next one; choices stay as they were drawn."""
    from scipy.optimize import minimize

    fixed, count = len(problem.places), len(problem.variables)
    drawn = np.random.default_rng(seed).random((8, fixed + count))

    def search(evaluate: Callable[..., Any]) -> None:
        left = evaluations

        def worth(x: Array, choices: Array) -> float:
            nonlocal left
            left -= 1
            value, margin = evaluate(*decoded(problem, np.concatenate([choices, x])))
            return float(value) if margin >= 0 else 1e9 * (1 - margin)

        known = [worth(x[fixed:], x[:fixed]) for x in drawn]
        for place in np.argsort(known):
            if left > 0:
                start, choices = drawn[place, fixed:], drawn[place, :fixed]
                steps = np.diag(np.where(start > 0.9, -0.1, 0.1))
                options = {"initial_simplex": np.vstack([start, start + steps]), "maxfev": left, "xatol": 1e-3}
                minimize(
                    worth, start, (choices,), "Nelder-Mead", bounds=[(0, 1)] * count, options={**options, "fatol": 1e9}
                )

    return within(problem, evaluations, search)


LEAST = {
    "branin": [0.542773, 0.151667],
    "hartmann6": [0.20169, 0.150011, 0.476874, 0.275332, 0.311652, 0.6573],
    "ackley5": [0.5] * 5,
    "gomez": [0.55465, 0.1883],
    "toy": [0.798, 0.0],
    "tree": [0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.5, 0.5, 0.5],
}


@pytest.mark.parametrize("name", LEAST)
def test_the_least_value_of_a_problem_is_where_it_is_known_to_be(name: str) -> None:
    problem = BY_NAME[name]
    if name == "toy":
        curve = [(value(problem, [(k + 0.5) / 10, x]), k, x) for k in range(10) for x in np.linspace(0, 1, 2001)]
        assert min(curve)[0] == pytest.approx(problem.least, abs=2e-5)
        return
    assert value(problem, LEAST[name]) == pytest.approx(problem.least, abs=2e-4)


def value(problem: Problem, x: list[float]) -> float:
    found, margin = problem.value(*decoded(problem, np.array(x)))
    assert margin >= -2e-3
    return found


def hartmann(_: object, points: Array) -> Runs:
    return {"f": np.array([value(BY_NAME["hartmann6"], x) for x in points.tolist()])}, {}


@pytest.mark.parametrize(
    "sampler",
    [
        Tpe(evaluations=40),
        Nsga2(evaluations=96),
        Local(evaluations=60),
        pytest.param(MixedGp(evaluations=60), marks=pytest.mark.thorough),
    ],
    ids=lambda sampler: sampler.name,
)
def test_it_learns_from_what_it_is_told(sampler: OptimizingSampler) -> None:
    """Half of its last designs are better than nine tenths of its first ones."""
    given = replace(brief(variables(6), "f", seed=0), configurations=("only",))
    found = drive(sampler, given, hartmann).column("f")
    assert np.median(found[-10:]) < np.quantile(found[:10], 0.1)


def test_tpe_asks_for_what_optuna_asks_for_that_is_told_the_same() -> None:
    """Design by design, so that all of them are learnt from: Optuna's own study goes on from our first ones."""
    import optuna

    driven = drive(Tpe(evaluations=40, batch=1), brief(variables(6), "f", seed=3), hartmann)
    units = [list(point) for _, point in driven.candidates]
    names = [str(number) for number in range(6)]
    ranges = dict.fromkeys(names, optuna.distributions.FloatDistribution(0.0, 1.0))
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=3, n_startup_trials=1))
    for unit in units[:10]:
        first = optuna.trial.create_trial(
            params=dict(zip(names, unit, strict=True)),
            distributions=ranges,
            value=hartmann(None, np.array([unit]))[0]["f"][0],
        )
        study.add_trial(first)
    for unit in units[10:]:
        trial = study.ask(ranges)
        asked = [trial.params[name] for name in names]
        assert unit == pytest.approx(asked, abs=1e-6)
        study.tell(trial, hartmann(None, np.array([asked]))[0]["f"][0])


@pytest.mark.parametrize(("kind", "numbers"), [(Tpe, (20, 70)), (Nsga2, (80, 450))])
def test_without_a_number_as_many_are_asked_for_together_as_are_few_among_those_known(
    kind: type[OptimizingSampler], numbers: tuple[int, int]
) -> None:
    """A longer study begins as a shorter one."""

    def run(_: object, points: Array) -> Runs:
        return {"f": points.sum(axis=1)}, {}

    short, long = (drive(kind(evaluations=number), brief(variables(2), "f"), run) for number in numbers)
    sizes = [len(ask) for ask in long.asks]
    assert long.candidates[: numbers[0]] == short.candidates
    assert sizes[:5] == ([10, 1, 1, 1, 1] if kind is Tpe else [16] * 5)
    assert sizes[-2] == (2 if kind is Tpe else 17)
    assert kind(evaluations=60).options().keys() >= {"evaluations", "draws"}
    assert None not in kind(evaluations=60).options().values()


def test_children_inherit_the_choice_at_the_only_place_of_a_design() -> None:
    parts = tuple(Part(Component(name, NO_INTERFACE)) for name in "abcde")
    space = open_space(DesignSpace("one", Compound("one", {"place": Alternative(parts)}))).architectures()
    parent = Design(space.completed([("place", "c")], 1), (0.5,))
    random = np.random.default_rng(1)
    children = [child for _ in range(50) for child in Breeding(space, 1).children(parent, parent, random)]
    kept = sum(child.architecture == parent.architecture for child in children)
    assert 30 <= kept <= 70


@pytest.mark.thorough
@pytest.mark.parametrize(
    "sampler",
    [
        "nsga2: {evaluations: 20}",
        "tpe: {evaluations: 20}",
        "mixed_gp: {evaluations: 12, first: 8}",
        "local: {evaluations: 20}",
        "stratified: {configurations: 1, samples: 8}",
        "combinations: {samples: 8}",
    ],
)
def test_a_design_without_choices_is_searched_from_the_command_line(sampler: str, tmp_path: Path) -> None:
    lay_out(BY_NAME["branin"], tmp_path)
    (tmp_path / "testbenches/s.pet.yaml").write_text(
        "study: s\ntestbench: bench\nconfigurations: all\nobjectives: [minimize f]\n"
        f"design_variables: {{fn.x0: {{range: [0, 1]}}, fn.x1: {{range: [0, 1]}}}}\nsampler: {{{sampler}}}\n"
    )
    done = run_dse(tmp_path, "explore", "s", "--workers", "1", cache=tmp_path / "cache")
    assert done.returncode == 0, done.stderr


@pytest.mark.nightly
class TestTpe(SearcherSuite):
    sampler = Tpe
    library = staticmethod(optuna_tpe)
    bands: ClassVar[Mapping[str, float]] = {"hartmann6": 1.1}


@pytest.mark.nightly
class TestNsga2(SearcherSuite):
    sampler = Nsga2
    evaluations = 400
    bands: ClassVar[Mapping[str, float]] = {"gomez": 4.0}
    library = staticmethod(pymoo_nsga2)


@pytest.mark.nightly
class TestLocal(SearcherSuite):
    sampler = Local
    # Two starts share the runs that scipy's one start has; on islands ten starts decide more than the simplex does.
    bands: ClassVar[Mapping[str, float]] = {"ackley5": 2.5, "gomez": 1.5}
    unfit: ClassVar[Mapping[str, str]] = {"gomez": "what is allowed are islands, and a simplex stays on its own"}
    library = staticmethod(scipy_simplex)


@pytest.mark.nightly
class TestMixedGp(SearcherSuite):
    """Its processes are ours: there is no library to compare with."""

    sampler = MixedGp
