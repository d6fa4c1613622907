"""Evolution towards reference directions."""

from __future__ import annotations

from collections.abc import Mapping
from math import comb
from typing import Any, ClassVar

from dse.errors import fail
from dse.exploration.optimization.evolution import EvolutionSampler


class Nsga3(EvolutionSampler):
    """NSGA-III (Deb and Jain 2014) over configurations and variables together, for two objectives or more.

    As many reference directions as the population has room for, evenly (Das and Dennis 1998).
    """

    name: ClassVar[str] = "nsga3"

    def algorithm(self, objectives: int, options: Mapping[str, Any]) -> Any:
        """pymoo's."""
        from pymoo.algorithms.moo.nsga3 import NSGA3
        from pymoo.operators.selection.tournament import TournamentSelection

        found = NSGA3(_directions(objectives, options["pop_size"]), **options)
        found.selection = TournamentSelection(func_comp=_compared)
        return found


def _directions(objectives: int, most: int) -> Any:
    """Reference directions, (n, objectives), *most* at most."""
    from pymoo.util.ref_dirs import get_reference_directions

    if objectives < 2:
        raise fail("the sampler 'nsga3' needs two objectives at least", None, "take 'nsga2'")
    if most < objectives:
        raise fail(f"a population of {most} is too small for {objectives} objectives", None, f"population: {4 * most}")
    parts = 1
    while comb(objectives + parts, parts + 1) <= most:
        parts += 1
    return get_reference_directions("das-dennis", objectives, n_partitions=parts)


def _compared(population: Any, pairs: Any, *, random_state: Any, **_: Any) -> Any:
    """Of each pair the one with the smaller violation, else any. pymoo's own leaves equal ones to an unknown seed."""
    import numpy as np

    violation = population.get("CV")[:, 0][pairs]
    sooner = violation[:, 0] <= violation[:, 1]
    equal = violation[:, 0] == violation[:, 1]
    sooner = np.where(equal, random_state.random(len(pairs)) < 1 / 2, sooner)
    return np.where(sooner, pairs[:, 0], pairs[:, 1])[:, None]


SAMPLER = Nsga3
