"""ZDT1-3 and constr-Ex by the sampler `nsga2` and by pymoo's own NSGA-II: dominated volume at equal budgets.

Run from the top of the repository: ``python benchmarks/bench_evolution.py [SEEDS]``. Both are given the same problems,
populations and numbers of evaluations; the volume is that of all they evaluated, up to the same reference point.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.problems import get_problem

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "exploration"))
from optimized import Array, Runs, brief, drive

from dse.domain.sampler import DesignVariable
from dse.exploration.optimization.front import hypervolume
from dse.exploration.samplers.nsga2 import Nsga2
from dse.units import DIMENSIONLESS

POPULATION = 100
EVALUATIONS = 4000


class ConstrEx(Problem):
    """Deb 2001."""

    def __init__(self) -> None:
        super().__init__(n_var=2, n_obj=2, n_ieq_constr=2, xl=np.array([0.1, 0.0]), xu=np.array([1.0, 5.0]))

    def _evaluate(self, x: Array, out: dict[str, Array], *_: Any, **__: Any) -> None:
        out["F"] = np.column_stack([x[:, 0], (1 + x[:, 1]) / x[:, 0]])
        out["G"] = np.column_stack([6 - x[:, 1] - 9 * x[:, 0], 1 + x[:, 1] - 9 * x[:, 0]])


def ours(problem: Problem, seed: int) -> list[list[float]]:
    """What the sampler finds: objectives that meet the constraints."""

    def run(_: Sequence[str], points: Array) -> Runs:
        out = problem.evaluate(points, return_as_dictionary=True)
        margins = {f"g{i}": -column for i, column in enumerate(out["G"].T if "G" in out else ())}
        return {f"f{i}": column for i, column in enumerate(out["F"].T)}, margins

    ranges = zip(problem.xl.tolist(), problem.xu.tolist(), strict=True)
    variables = tuple(DesignVariable(f"x{i}", low, high, 2, low, DIMENSIONLESS) for i, (low, high) in enumerate(ranges))
    told = drive(
        Nsga2(population=POPULATION, evaluations=EVALUATIONS), brief(variables, "f0", "f1", seed=seed), run
    ).told
    met = [np.all([each.done, *(margins >= 0 for margins in each.margins.values())], axis=0) for each in told]
    values = [np.column_stack([each.metrics["f0"], each.metrics["f1"]]) for each in told]
    return [row for each, kept in zip(values, met, strict=True) for row in each[kept].tolist()]


def theirs(problem: Problem, seed: int) -> list[list[float]]:
    """What pymoo finds as it comes."""
    algorithm = NSGA2(pop_size=POPULATION)
    algorithm.setup(problem, termination=("n_eval", EVALUATIONS), seed=seed)
    found: list[list[float]] = []
    while algorithm.has_next():
        asked = algorithm.ask()
        algorithm.evaluator.eval(problem, asked)
        found += asked.get("F")[asked.get("CV")[:, 0] <= 0].tolist()
        algorithm.tell(infills=asked)
    return found


def main(seeds: int) -> None:
    """Median, least and greatest volume of each."""
    problems = [(name, get_problem(name), (1.1, 1.1)) for name in ("zdt1", "zdt2", "zdt3")]
    for name, problem, reference in [*problems, ("constr-Ex", ConstrEx(), (1.1, 10.0))]:
        for way in (ours, theirs):
            volumes = [hypervolume(way(problem, seed), reference) for seed in range(seeds)]
            spread = f"({min(volumes):.4f} … {max(volumes):.4f})"
            print(f"{name:10} {way.__name__:7} {np.median(volumes):.4f} {spread}", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
