"""Evolution by non-dominated sorting and crowding."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from dse.exploration.optimization.evolution import EvolutionSampler


class Nsga2(EvolutionSampler):
    """NSGA-II (Deb et al. 2002) over configurations and variables together."""

    name: ClassVar[str] = "nsga2"

    def algorithm(self, objectives: int, options: Mapping[str, Any]) -> Any:  # noqa: ARG002  # any number will do
        """pymoo's."""
        from pymoo.algorithms.moo.nsga2 import NSGA2, binary_tournament
        from pymoo.operators.selection.tournament import TournamentSelection

        found = NSGA2(**options)
        found.selection = TournamentSelection(func_comp=binary_tournament)
        return found


SAMPLER = Nsga2
