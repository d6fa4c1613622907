"""The hierarchical Goldstein problem, with one objective and with two: our samplers beside those of SBArchOpt.

``python benchmarks/bench_optimise.py [--seeds 10] [--peers FOLDER] [--models]``, from the top of the repository; the
peers come into the folder by ``pip install --target FOLDER sb-arch-opt numba``. All are given the same numbers of
evaluations; with --models so few that models pay. What is chosen in the design space (benchmarks/goldstein) decides
which variables there are. Shown are medians: the least objective that meets the constraint, or the dominated volume.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, DesignVariable, Objective, Outcomes, Sampler
from dse.exploration.optimization.front import hypervolume
from dse.exploration.samplers.mixed_gp import MixedGp
from dse.exploration.samplers.nsga2 import Nsga2
from dse.exploration.samplers.tpe import Tpe
from dse.loading import Workspace
from dse.space import open_space
from dse.units import DIMENSIONLESS

Array = NDArray[np.float64]

PLACES = ("first", "second", "plan.a", "plan.b", "wave")
REFERENCE = (60.0, 90.0)
POPULATION = 50
MANY, FEW, FIRST = 1000, 80, 30


class Goldstein:
    """Pelamatti et al. 2020, section 5.2 and appendix B; the second objective is that of SBArchOpt."""

    def __init__(self, objectives: int) -> None:
        self.objectives = objectives
        space = open_space(Workspace(Path(__file__).parent / "goldstein").design("goldstein"))
        self.space = space.architectures()
        self.parts = {one.id: one.parts for one in space.configurations()}
        self.numbers = {
            name: {place: {key: float(q.si) for key, q in part.properties.items()} for place, part in parts.items()}
            for name, parts in self.parts.items()
        }

    def has(self, name: str) -> list[bool]:
        """Which variables a configuration has, in the order of `PLACES`."""
        return [place in self.parts[name] and bool(self.parts[name][place].parameters) for place in PLACES]

    def __call__(self, name: str, x: Array) -> tuple[float, float, float]:
        """Two objectives to be small, and a constraint that is met at 0 and below."""
        numbers = self.numbers[name]
        a, b, third, fourth = (numbers[place] for place in ("plan.a", "plan.b", "third", "fourth"))
        plan = ("a" not in a) + 2 * ("b" not in b)
        first, second = [(a, b), ({"factor": 0.5}, b), (a, {"factor": 0.7}), (third, fourth)][plan]
        radius = 20 + first["factor"] * second["factor"]

        def value(at: Array) -> float:
            wave = 5 * np.cos(2 * np.pi * at[4] / 100) - 2 if "wave" in numbers else 0.0
            listed = a.get("a", at[2]), b.get("b", at[3])
            return float(surface(at[0], at[1], *listed, third["power"], fourth["power"]) + wave)

        other = value(x + 30) + (plan + 4 * ("wave" in numbers)) / 7 * 5
        return value(x), other, float(radius**2 - (x[0] - 50) ** 2 - (x[1] - 50) ** 2)


def surface(x: float, y: float, a: float, b: float, p: float, q: float) -> float:
    """Goldstein's function as Pelamatti et al. have it."""
    linear = 53.3108 + 0.184901 * x + 0.0870775 * y - 0.106959 * a + 0.00242482 * b
    powers = -5.02914e-6 * x**3 + 7.72522e-8 * x**p + 7.98772e-6 * a**q + 1.32851e-6 * b**3
    pairs = -0.00146393 * x * y - 0.00301588 * x * a - 0.00272291 * x * b
    pairs += 0.0017004 * y * a + 0.0038428 * y * b - 0.000198969 * a * b
    triples = 1.86025e-5 * x * y * a - 1.88719e-6 * x * y * b + 2.50923e-5 * x * a * b - 5.62199e-5 * y * a * b
    return linear + powers + pairs + triples


def ours(problem: Goldstein, sampler: Sampler, seed: int) -> Array:
    """All that was evaluated: objectives and constraint, (n, m + 1)."""
    variables = tuple(DesignVariable(f"{place}.x", 0.0, 100.0, 2, 50.0, DIMENSIONLESS) for place in PLACES)
    nothing: Mapping[str, Array] = {variable.name: np.zeros(0) for variable in variables}
    none = Outcomes((), nothing, np.zeros(0, bool), {}, {}, {})
    objectives = tuple(Objective(f"f{i}") for i in range(problem.objectives))
    search = sampler.start(Brief(variables, (), seed, none, problem.space, objectives))
    rows: list[Array] = []
    while asked := search.ask():
        points = np.array([np.where(problem.has(name), point, 50.0) for name, point in asked])
        found = np.array([problem(name, point) for (name, _), point in zip(asked, points, strict=True)])
        rows.append(found)
        search.tell(
            Outcomes(
                tuple(name for name, _ in asked),
                {variable.name: points[:, i] for i, variable in enumerate(variables)},
                np.ones(len(asked), dtype=bool),
                {f"f{i}": found[:, i] for i in range(problem.objectives)},
                {"g": -found[:, 2]},
                {"g": tuple(Verdict.PASS if g <= 0 else Verdict.FAIL for g in found[:, 2].tolist())},
            )
        )
    return np.concatenate(rows)[:, [*range(problem.objectives), 2]]


def theirs(objectives: int, algorithm: Callable[[Any], Any], evaluations: int, seed: int) -> Array:
    """The same of an algorithm of SBArchOpt."""
    from sb_arch_opt.problems.hierarchical import HierarchicalGoldstein, MOHierarchicalGoldstein

    problem = (MOHierarchicalGoldstein if objectives == 2 else HierarchicalGoldstein)()
    search = algorithm(problem)
    search.setup(problem, seed=seed, termination=("n_eval", evaluations), verbose=False)
    rows: list[Array] = []
    while search.has_next() and sum(map(len, rows)) < evaluations:
        asked = search.ask()
        if asked is None or not len(asked):
            break
        search.evaluator.eval(problem, asked)
        rows.append(np.column_stack([asked.get("F"), asked.get("G")]))
        search.tell(infills=asked)
    return np.concatenate(rows)[:evaluations]


def score(rows: Array) -> float:
    """The least objective, or the volume up to `REFERENCE`, of rows that meet the constraint."""
    met = rows[rows[:, -1] <= 0, :-1]
    if rows.shape[1] == 2:
        return float(met.min()) if len(met) else np.inf
    return hypervolume(met.tolist(), REFERENCE)


def main() -> None:
    """A line for each sampler."""
    options = argparse.ArgumentParser()
    options.add_argument("--seeds", type=int, default=10)
    options.add_argument("--peers", type=Path)
    options.add_argument("--models", action="store_true")
    options.add_argument("--only", nargs="*", default=[], help="names of samplers")
    given = options.parse_args()
    warnings.filterwarnings("ignore")
    for objectives in (1, 2):
        problem = Goldstein(objectives)
        word = "least objective" if objectives == 1 else f"volume up to {REFERENCE}"
        for name, (evaluations, run) in contestants(problem, given).items():
            if given.only and name not in given.only:
                continue
            print(
                f"{objectives} objective{'s'[: objectives - 1]}, {evaluations} evaluations, {name}: ",
                end="",
                flush=True,
            )
            start = time.perf_counter()
            found = [score(run(seed)) for seed in range(given.seeds)]
            seconds = (time.perf_counter() - start) / given.seeds
            ends = f"{min(found):.2f} … {max(found):.2f}"
            print(f"{word} {median(found):.3f} ({ends}), {seconds:.1f} s each", flush=True)


def contestants(problem: Goldstein, given: argparse.Namespace) -> dict[str, tuple[int, Callable[[int], Array]]]:
    """Whom to compare: evaluations, and what came of a seed."""
    number = problem.objectives
    many: dict[str, Sampler] = {
        "nsga2": Nsga2(population=POPULATION, evaluations=MANY),
        "tpe": Tpe(first=POPULATION, evaluations=MANY),
    }
    few: dict[str, Sampler] = {
        "mixed_gp": MixedGp(first=FIRST, batch=1, evaluations=FEW),
        "tpe": Tpe(first=FIRST, batch=1, evaluations=FEW),
    }
    chosen = few if given.models else many
    evaluations = FEW if given.models else MANY
    found: dict[str, tuple[int, Callable[[int], Array]]] = {
        name: (evaluations, lambda seed, sampler=sampler: ours(problem, sampler, seed))
        for name, sampler in chosen.items()
    }
    if given.peers is None:
        print("SBArchOpt is left out: pip install --target FOLDER sb-arch-opt numba, then --peers FOLDER")
        return found
    sys.path.append(str(given.peers))
    from sb_arch_opt.algo.pymoo_interface import get_nsga2

    found["sbarchopt_nsga2"] = (
        evaluations,
        lambda seed: theirs(number, lambda _: get_nsga2(FIRST if given.models else POPULATION), evaluations, seed),
    )
    if given.models:
        from sb_arch_opt.algo.arch_sbo import get_arch_sbo_gp

        found["sbarchopt_gp"] = (
            evaluations,
            lambda seed: theirs(number, lambda p: get_arch_sbo_gp(p, init_size=FIRST), evaluations, seed),
        )
    return found


if __name__ == "__main__":
    main()
