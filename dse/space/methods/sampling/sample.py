"""Rows drawn at random, each valid row equally likely: walks through the tilted diagram, and rejection.

A walk takes every branch with a probability that is a whole number out of 2^63, so the probability of a row is known
exactly, whatever rounding went into the tables. A valid row is kept with a probability inversely proportional to it.
Two valid rows thus differ in probability only by what rounding the product of the factors, one for each variable,
leaves: less than (variables + 4) * 2^-51 relative, 2^-40 for two thousand variables. What decides has 63 bits, which
adds 2^-63 over the probability of being kept. The generator, PCG64, is taken to be random.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import ABSENT, Bools, Floats, Ints, Linear, Rows, Wide
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.mdd.diagram import DecisionDiagram
from dse.space.methods.mdd.folds import fold_rows, judged
from dse.space.methods.sampling.tilt import Tilt, TooRareError, branches, tilt
from dse.space.methods.sampling.uniform import DRAWN_BITS, BranchTable, bits, draw, generator, tabulate

MOST_DRAWS = 20_000_000
"""Rows drawn before `sample` gives up."""

MOST_DRAWN_CELLS = 400_000_000
"""Decisions of rows drawn before that, too; some twenty seconds."""

_BLOCK = 1 << 15
_WORDS = 1 << 22
_LIKELY = 20
"""Draws for each wanted row that are not too many, however deep the diagram."""
_FACTORS = 15
"""Factors of at least 2^-63 whose product double precision holds."""


@dataclass(frozen=True, slots=True, eq=False)
class Walks:
    """Random walks through a diagram: for each layer a table and the node below each of its entries.

    A row that meets the rules has at least the probability exp(*log_floor*). *linears* and *wides* are the rules
    that a walk may break.
    """

    diagram: DecisionDiagram
    tables: tuple[BranchTable, ...]
    below: tuple[NDArray[np.int32], ...]
    log_floor: float
    linears: tuple[Linear, ...]
    wides: tuple[Wide, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Walked:
    """Rows, and the probability of each: mantissa * 2^exponent. *acceptance*: bits that decide what is kept."""

    rows: Rows
    mantissa: Floats
    exponent: Ints
    acceptance: NDArray[np.uint64]


def sample(diagram: DecisionDiagram, number: int, seed: int, most_draws: int = MOST_DRAWS) -> Rows:
    """*number* independent rows, each drawn uniformly among all that meet all rules; shape (number, variables).

    The same seed gives the same rows, and the first rows of a larger sample. Raises EmptyError if it is proven that
    there is no such row, TooRareError if *most_draws* walks find too few, or fewer walks of a deep diagram.
    """
    walks = tilted_walks(diagram, tilt(diagram))
    random = generator(seed)
    found: list[Rows] = []
    missing, drawn = number, 0
    block = min(_BLOCK, rows_at_once(diagram))
    most_draws = min(most_draws, max(MOST_DRAWN_CELLS // (len(walks.tables) + 1), _LIKELY * number))
    while missing > 0:
        if drawn >= most_draws:
            raise TooRareError
        walked = walk(walks, random, block)
        drawn += len(walked.rows)
        rows = walked.rows[kept(walks, walked)][:missing]
        found.append(rows)
        missing -= len(rows)
    rows = np.concatenate(found) if found else np.zeros((0, len(diagram.flat.variables)), np.int16)
    return recheck(diagram.flat).insist(rows)


def rows_at_once(diagram: DecisionDiagram) -> int:
    """How many rows may be drawn at a time, for the memory that the random bits take to stay small."""
    return max(1, _WORDS // (len(diagram.layers) + 1))


def tilted_walks(diagram: DecisionDiagram, tilted: Tilt) -> Walks:
    """The walks that take every row with a probability proportional to its weight under the tilt."""
    tables: list[BranchTable] = []
    below: list[NDArray[np.int32]] = []
    for layer, energy, masses in zip(diagram.layers, tilted.energies, tilted.masses[1:], strict=True):
        shares, _ = branches(layer, energy, masses)
        table = tabulate(np.where(layer >= 0, np.maximum(shares, 2.0**-1000), 0.0))
        tables.append(table)
        below.append(np.take_along_axis(layer, table.values.astype(np.int64), axis=1).ravel())
    wides = () if diagram.expanded else diagram.flat.wides()
    return Walks(diagram, tuple(tables), tuple(below), -tilted.log_bound - tilted.rounding, tilted.linears, wides)


def walk(walks: Walks, random: np.random.Generator, number: int) -> Walked:
    """The next *number* walks; in how many blocks they are asked for changes nothing."""
    diagram = walks.diagram
    depth = len(walks.tables)
    drawn = np.ascontiguousarray(bits(random, (number, depth + 1)).T)
    columns = np.full((depth, number), ABSENT, np.int16)
    node = np.zeros(number, np.int32)
    mantissa = np.ones(number)
    exponent = np.zeros(number, np.int64)
    for place, (table, below) in enumerate(zip(walks.tables, walks.below, strict=True)):
        branch = draw(table, node, drawn[place])
        variable = diagram.order[place]
        value = table.values.ravel()[branch]
        columns[variable] = np.where(value < len(diagram.flat.variables[variable].values), value, ABSENT)
        mantissa *= table.chances.ravel()[branch]
        if place % _FACTORS == _FACTORS - 1 or place == depth - 1:
            mantissa, power = np.frexp(mantissa)
            exponent += power
        node = below[branch]
    return Walked(np.ascontiguousarray(columns.T), mantissa, exponent, drawn[depth])


def kept(walks: Walks, walked: Walked) -> NDArray[np.intp]:
    """Which rows to keep, for all valid rows to be equally likely: those that meet the rules and are accepted."""
    floor = floor_share(walks, walked)
    accepted = walked.acceptance.astype(np.float64) < np.ldexp(floor, DRAWN_BITS)
    places = np.flatnonzero(accepted)
    places = places[meets(walks, walked.rows[places])]
    if (floor[places] > 1).any():
        raise RuntimeError("internal error: a valid row is less likely than the tilt promised")
    return places


def floor_share(walks: Walks, walked: Walked) -> Floats:
    """The least probability of a valid row over the probability of each row; at most 1 for valid rows."""
    whole = round(walks.log_floor / log(2))
    floor = exp(walks.log_floor - whole * log(2))
    return np.ldexp(floor / walked.mantissa, np.clip(whole - walked.exponent, -2000, 2000).astype(np.int32))


def meets(walks: Walks, rows: Rows) -> Bools:
    """Which walked rows meet the rules that are not in the layers, exactly; shape (rows,)."""
    left = np.arange(len(rows))
    for linear in walks.linears:
        total = np.zeros(len(left), np.int64)
        for variable, weights in linear.weights.items():
            total += weights[rows[left, variable]]
        low, high = linear.low, linear.high
        left = left[(low is None or total >= low) & (high is None or total <= high)]
    for wide in walks.wides:
        left = left[judged(wide, [fold_rows(fold, rows[left]) for fold in wide.folds])]
    answer = np.zeros(len(rows), np.bool_)
    answer[left] = True
    return answer
