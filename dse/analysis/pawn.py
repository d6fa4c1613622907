"""How much the distribution of a metric changes when a factor is known: also where its variance says little.

PAWN (Pianosi and Wagener 2018), by SALib: the distance between the distribution of all values and that within a part of
the factor's range (Kolmogorov-Smirnov), its median over ten parts. Few runs are apart by chance: as far as they are for
a factor that does nothing, which is made up for comparison.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dse.analysis.data import StudyData, withheld
from dse.analysis.extra import extra

_LEAST = 100
_PARTS = 10
_MADE_UP = 20
_MOST_LACKING = 0.01
_SEED = 0


@dataclass(frozen=True, slots=True)
class Distance:
    """Of a *factor*, 0 … 1; *chance* is what 19 of 20 factors that do nothing stay below."""

    factor: str
    distance: float
    chance: float


def pawn_distances(data: StudyData, metric: str) -> tuple[Distance, ...]:
    """Of every factor that is a number with more than ten values.

    DseError if fewer than 100 runs define *metric*, it never changes, is undefined in more than one run of 100, or runs
    crowd: distances of a crowd would be told as if they were those of the whole space.
    """
    there, values = data.response(metric, _LEAST)
    if len(there) < (1 - _MOST_LACKING) * len(data):
        what = (
            f"it is undefined in {len(data) - len(there)} of {len(data)} runs: without them, indices would be distorted"
        )
        raise withheld(metric, what)
    if there.weights.max() > 2 or np.isnan(there.places).any():
        raise withheld(metric, "runs crowd, or lack a factor: PAWN indices are of runs that fill the whole space")
    columns = [
        k
        for k, factor in enumerate(there.factors)
        if not factor.is_choice and len(np.unique(there.places[:, k])) > _PARTS
    ]
    random = np.random.default_rng(_SEED).random((len(values), _MADE_UP))
    x = np.column_stack([there.places[:, columns], random])
    names = [str(number) for number in range(x.shape[1])]
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    found = np.asarray(extra("SALib.analyze.pawn", "SALib").analyze(problem, x, values, S=_PARTS)["median"])
    chance = float(np.quantile(found[len(columns) :], 0.95))
    return tuple(Distance(there.factors[k].name, float(d), chance) for k, d in zip(columns, found, strict=False))
