"""The exponential tilt of a diagram: weights under which the rows that meet the sum rules are no longer rare.

Every row gets the weight exp(-sum over cuts of multiplier * (sum - bound)). A row that meets the rules weighs at
least one, so the weights of all rows together bound the number of valid rows from above; the multipliers that make
this bound least are those of the maximum-entropy distribution whose mean sums keep the bounds (Chernoff bound and
conjugate family: Siegmund, Importance sampling in the Monte Carlo study of sequential tests, 1976).

Example: ten coins, at most two heads: 56 of 1,024 rows, so 5 % of plain draws are valid.

    the multiplier ln 4 makes the mean number of heads 2: a coin shows heads with probability 1 / 5
    68 % of the draws are then valid, and the bound is (1 + 1 / 4)^10 * 4^2 = 149 instead of 1,024
    for uniform rows, each valid one is kept in inverse proportion to its weight: 56 / 149 = 38 % of all draws

Cost: at most 80 steps of a few passes over the diagram each; then a draw is a walk. 10,000 uniform rows of 54
decisions take 0.7 s (docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Floats, Ints, Linear
from dse.space.methods.listing.bounds import cuts_of, stacked
from dse.space.methods.mdd.diagram import DecisionDiagram, extremes

_ITERATIONS = 80
_HALVINGS = 30
_CLOSE = 1e-6
"""A decrease of the logarithm of the bound that is not worth another step."""
_FAINT = -2000
"""Binary exponent under which a share of a node is nothing in double precision."""


class EmptyError(Exception):
    """Proven: no row meets the rules."""


class TooRareError(Exception):
    """Too few of the rows drawn met the rules to say anything; whether there are any is not known."""


@dataclass(frozen=True, slots=True, eq=False)
class Masses:
    """Weight of all completions of the nodes of one layer: mantissa * 2^exponent, shapes (nodes,)."""

    mantissa: Floats
    exponent: Ints


@dataclass(frozen=True, slots=True, eq=False)
class Tilt:
    """The best tilt of a diagram.

    *linears* are the sum rules that some path breaks, without the sides that none breaks; *multipliers* >= 0 one for
    each side. *energies* are logarithms of weights per layer, shape (values + 1,); *masses*
    those of the nodes per layer, the terminal's included. The number of valid rows is at most exp(*log_bound*), and
    *rounding* bounds the relative error of that and of the weight of any row.
    """

    linears: tuple[Linear, ...]
    multipliers: Floats
    energies: tuple[Floats, ...]
    masses: tuple[Masses, ...]
    log_bound: float
    rounding: float


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """What the bound depends on: *weights* of the cuts per layer, shape (values + 1, cuts); *bounds*, shape (cuts,)."""

    diagram: DecisionDiagram
    weights: tuple[Floats, ...]
    bounds: Floats


def tilt(diagram: DecisionDiagram) -> Tilt:
    """The tilt that makes the bound on the number of valid rows least; Wide rules are not seen.

    Raises EmptyError if the diagram is empty, if a sum cannot reach its bounds on any path (in whole numbers), or if
    the bound falls below one row by more than its rounding error, which is known: it is a sum of positive products.
    """
    if diagram.empty:
        raise EmptyError
    linears = _breakable(diagram)
    cuts = tuple(cuts_of(linears))
    weights = tuple(part.T.astype(np.float64) for part in stacked(diagram, [cut.weights for cut in cuts]))
    problem = _Problem(diagram, weights, np.array([float(cut.high) for cut in cuts]))
    multipliers = _solved(problem)
    energies = tuple(_energies(problem, multipliers))
    masses = tuple(node_masses(diagram, energies))
    log_bound = log_mass(masses[0]) + float(multipliers @ problem.bounds)
    return Tilt(linears, multipliers, energies, masses, log_bound, _rounding(problem, multipliers))


def node_masses(diagram: DecisionDiagram, energies: Sequence[Floats]) -> list[Masses]:
    """The weight of all completions of each node, per layer, the terminal's included; never overflows."""
    masses = [Masses(np.full(1, 0.5), np.ones(1, np.int64))]
    for layer, energy in zip(reversed(diagram.layers), reversed(energies), strict=True):
        shares, power = branches(layer, energy, masses[-1])
        mantissa, exponent = np.frexp(shares.sum(axis=1))
        masses.append(Masses(mantissa, power + exponent))
    return masses[::-1]


def branches(layer: NDArray[np.int32], energy: Floats, below: Masses) -> tuple[Floats, Ints]:
    """What each branch of a layer's nodes weighs, shape (nodes, values + 1), in units of 2^power, shape (nodes,)."""
    whole = np.rint(energy / log(2))
    factor = np.exp(energy - whole * log(2))
    # The child -1 finds the nothing at the end.
    exponent = np.append(below.exponent, np.iinfo(np.int64).min // 2)[layer] + whole.astype(np.int64)
    power = exponent.max(axis=1)
    faded = np.maximum(exponent - power[:, None], _FAINT).astype(np.int32)
    return np.ldexp(np.append(below.mantissa, 0.0)[layer] * factor, faded), power


def log_mass(masses: Masses) -> float:
    """Natural logarithm of the weight of node 0."""
    return log(float(masses.mantissa[0])) + int(masses.exponent[0]) * log(2)


def _breakable(diagram: DecisionDiagram) -> tuple[Linear, ...]:
    """The sum rules that are not in the layers and that some path breaks, without the sides that none breaks."""
    found: list[Linear] = []
    for linear in () if diagram.expanded else diagram.flat.linears():
        low, high = (int(reached[0][0]) for reached in extremes(diagram, linear.weights))
        if (linear.low is not None and high < linear.low) or (linear.high is not None and low > linear.high):
            raise EmptyError
        below = linear.low if linear.low is not None and low < linear.low else None
        above = linear.high if linear.high is not None and high > linear.high else None
        if below is not None or above is not None:
            found.append(replace(linear, low=below, high=above))
    return tuple(found)


def _solved(problem: _Problem) -> Floats:
    """Multipliers at which the bound is least, by projected Newton steps that are halved until they descend."""
    multipliers = np.zeros(len(problem.bounds))
    if not len(multipliers):
        return multipliers
    reach = _reach(problem)
    spread = np.ones_like(multipliers)
    value = _log_bound(problem, multipliers)
    for iteration in range(_ITERATIONS):
        if value + _rounding(problem, multipliers) < 0:
            raise EmptyError
        mean, covariance = _moments(problem, multipliers)
        if iteration == 0:
            spread = np.sqrt(np.maximum(np.diag(covariance), (1e-9 * reach) ** 2))
        excess = (mean - problem.bounds) / spread
        if not ((multipliers > 0) | (excess > 0)).any():
            break
        step = _step(multipliers * spread, excess, covariance / np.outer(spread, spread)) / spread
        for _ in range(_HALVINGS):
            moved = np.maximum(multipliers + step, 0.0)
            value_there = _log_bound(problem, moved)
            if value_there < value:
                break
            step = step / 2
        else:
            break
        gained, value, multipliers = value - value_there, value_there, moved
        if gained < _CLOSE:
            break
    if value + _rounding(problem, multipliers) < 0:
        raise EmptyError
    return multipliers


def _step(multipliers: Floats, excess: Floats, covariance: Floats) -> Floats:
    """Newton's step for the multipliers that are positive or want to be; all in units of the sums' spread."""
    free = np.flatnonzero((multipliers > 0) | (excess > 0))
    step = np.zeros_like(multipliers)
    curved = covariance[np.ix_(free, free)]
    # Sums that depend on one another make the covariance singular; far out it vanishes altogether.
    curved = curved + np.diag(1e-6 * np.diag(curved) + 1e-12)
    longest = 10.0 + 2.0 * float(np.abs(multipliers).max())
    step[free] = np.clip(np.linalg.solve(curved, excess[free]), -longest, longest)
    return step


def _log_bound(problem: _Problem, multipliers: Floats) -> float:
    masses = node_masses(problem.diagram, _energies(problem, multipliers))
    return log_mass(masses[0]) + float(multipliers @ problem.bounds)


def _rounding(problem: _Problem, multipliers: Floats) -> float:
    """A bound on the relative error of sums of products of the layers' weights, with room to spare."""
    additions = sum(len(weights) + 8 for weights in problem.weights)
    return 2.0**-48 * (additions + float(multipliers @ _reach(problem)))


def _reach(problem: _Problem) -> Floats:
    """The greatest magnitude of the cuts' sums and bounds, shape (cuts,)."""
    reach = np.abs(problem.bounds)
    for weights in problem.weights:
        reach = reach + np.abs(weights).max(axis=0)
    return reach


def _energies(problem: _Problem, multipliers: Floats) -> list[Floats]:
    return [-(weights @ multipliers) for weights in problem.weights]


def _moments(problem: _Problem, multipliers: Floats) -> tuple[Floats, Floats]:
    """Mean, shape (cuts,), and covariance of the cuts' sums over all rows, each with its weight.

    The covariance adds up over the layers: decision after decision, the expected sum is a martingale.
    """
    energies = _energies(problem, multipliers)
    layers = problem.diagram.layers
    below = Masses(np.full(1, 0.5), np.ones(1, np.int64))
    mean = np.zeros((1, len(multipliers)))
    chances: list[Floats] = []
    surprises: list[Floats] = []
    for layer, weights, energy in zip(reversed(layers), reversed(problem.weights), reversed(energies), strict=True):
        shares, power = branches(layer, energy, below)
        total = shares.sum(axis=1)
        mantissa, exponent = np.frexp(total)
        below = Masses(mantissa, power + exponent)
        chance = shares / total[:, None]
        through = mean[layer] + weights
        mean = np.einsum("nv,nvc->nc", chance, through)
        chances.append(chance)
        surprises.append(through - mean[:, None, :])
    covariance = np.zeros((len(multipliers), len(multipliers)))
    reached = np.ones(1)
    for layer, chance, surprise in zip(layers, reversed(chances), reversed(surprises), strict=True):
        flow = reached[:, None] * chance
        flat = surprise.reshape(-1, len(multipliers))
        covariance += (flat * flow.reshape(-1, 1)).T @ flat
        reached = np.bincount(layer.ravel() + 1, flow.ravel())[1:].astype(np.float64)
    return mean[0], covariance
