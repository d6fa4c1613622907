"""Distributions of uncertain variables, cut off at the ends of a range: scipy has the mathematics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Correlations = Mapping[tuple[str, str], float]
"""Of uncertain variables, by their names."""

TAIL = 1e-6
"""Probability beyond either end of the range of a distribution that says of no end itself."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """How likely the values of an uncertain variable are: a *kind* with its *numbers* by name (SI)."""

    kind: str
    numbers: Mapping[str, float] = field(default_factory=dict)
    values: tuple[float, ...] = ()
    """What was observed, of an empirical one."""

    @property
    def flaw(self) -> str:
        """Why there is no such distribution; "" if there is one."""
        given = self.numbers
        if self.kind not in _NUMBERS or not _NUMBERS[self.kind] <= given.keys():
            return "it is of no known kind, or lacks a number"
        if given.get("sd", 1.0) <= 0:
            return "its standard deviation must be above 0"
        if self.kind == "lognormal" and given["mean"] <= 0:
            return "the mean of a lognormal distribution must be above 0"
        if min(given.get("alpha", 1.0), given.get("beta", 1.0)) <= 0:
            return "alpha and beta must be above 0"
        if "low" in given and not given["low"] < given["high"]:
            return "low must be below high"
        if "mode" in given and not given["low"] <= given["mode"] <= given["high"]:
            return "the mode must be between low and high"
        if self.kind == "empirical" and len(set(self.values)) < 2:
            return "give two different values or more"
        return ""


_NUMBERS = {
    "normal": {"mean", "sd"},
    "lognormal": {"mean", "sd"},
    "beta": {"alpha", "beta", "low", "high"},
    "triangular": {"mode", "low", "high"},
    "uniform": {"low", "high"},
    "empirical": set(),
}


def quantile(distribution: Distribution, low: float, high: float, share: Array) -> Array:
    """The values below which there is *share* (n,) of what lies in *low* … *high*; SI."""
    import numpy as np

    if distribution.kind == "empirical":
        return np.asarray(np.quantile(np.array(distribution.values), share))
    known = _frozen(distribution)
    first, last = known.cdf(low), known.cdf(high)
    # Shares that are nothing are the end itself: they are beyond what is computed with.
    within = np.where(share < np.finfo(np.float64).eps, 0.0, share)
    return np.asarray(known.ppf(first + within * (last - first)), dtype=np.float64)


def cumulative(distribution: Distribution, low: float, high: float, value: Array) -> Array:
    """The share of what lies in *low* … *high* that is below *value* (n,)."""
    import numpy as np

    if distribution.kind == "empirical":
        sorted_ = np.sort(np.array(distribution.values))
        return np.asarray(np.interp(value, sorted_, np.linspace(0.0, 1.0, len(sorted_))))
    known = _frozen(distribution)
    first, last = known.cdf(low), known.cdf(high)
    return np.asarray((known.cdf(value) - first) / (last - first), dtype=np.float64)


def support(distribution: Distribution) -> tuple[float, float]:
    """The range it has by itself, less what lies beyond `TAIL` of an end that is infinite."""
    if distribution.kind == "empirical":
        return min(distribution.values), max(distribution.values)
    import math

    known = _frozen(distribution)
    low, high = known.support()
    return (
        float(low) if math.isfinite(low) else float(known.ppf(TAIL)),
        float(high) if math.isfinite(high) else float(known.isf(TAIL)),
    )


def median(distribution: Distribution) -> float:
    """The value that half of it is below."""
    import numpy as np

    return float(quantile(distribution, *support(distribution), np.array([0.5]))[0])


def correlation_matrix(names: Sequence[str], correlations: Correlations) -> Array:
    """Of *names*, (n, n): 1 on the diagonal, 0 where none is given."""
    import numpy as np

    matrix = np.eye(len(names))
    for (one, other), value in correlations.items():
        i, j = names.index(one), names.index(other)
        matrix[i, j] = matrix[j, i] = value
    return matrix


def _frozen(distribution: Distribution) -> Any:
    import math

    from scipy import stats

    given = distribution.numbers
    match distribution.kind:
        case "normal":
            return stats.norm(given["mean"], given["sd"])
        case "lognormal":
            # Mean and deviation of the variable itself: Johnson, Kotz, Balakrishnan, Continuous Univariate
            # Distributions 1, 1994, (14.8).
            spread = math.sqrt(math.log1p((given["sd"] / given["mean"]) ** 2))
            return stats.lognorm(spread, scale=given["mean"] / math.sqrt(1 + (given["sd"] / given["mean"]) ** 2))
        case "beta":
            return stats.beta(given["alpha"], given["beta"], given["low"], given["high"] - given["low"])
        case "triangular":
            width = given["high"] - given["low"]
            return stats.triang((given["mode"] - given["low"]) / width, given["low"], width)
        case "uniform":
            return stats.uniform(given["low"], given["high"] - given["low"])
        case other:
            raise ValueError(other)
