"""Rows of a compiled space: drawn at random, each equally likely, or listed in the order of the graph."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from dse.space.flat import Rows
from dse.space.methods.dnnf.compile import Dnnf
from dse.space.methods.dnnf.descend import descend
from dse.space.methods.dnnf.graph import DecisionGraph, GraphBranch
from dse.space.methods.dnnf.selection import RandomSelection, RankSelection
from dse.space.methods.dnnf.weigh import weigh
from dse.space.methods.sampling.uniform import generator

_FIRST_BLOCK = 64
_BLOCK = 4096


def sample(dnnf: Dnnf, number: int, seed: int) -> Rows:
    """Rows drawn independently, each of all rows equally likely; shape (number, variables).

    The first rows are those of a smaller sample. Exact whatever the number of rows: choices are made in whole numbers.
    Shape (0, variables) if there is no row.
    """
    blocks = [np.zeros((0, len(dnnf.flat.variables)), np.int16)]
    missing = number
    for block in drawn(dnnf, seed) if number else ():
        blocks.append(block[:missing])
        missing -= len(blocks[-1])
        if not missing:
            break
    return np.concatenate(blocks)


def drawn(dnnf: Dnnf, seed: int) -> Iterator[Rows]:
    """Blocks of such rows without end, shape (at most 4096, variables); no block if there is no row."""
    weighed = weigh(dnnf)
    random = generator(seed)
    size = _FIRST_BLOCK
    while weighed.total:
        # Always whole blocks, so that the stream of random numbers does not depend on what is asked for.
        yield descend(weighed, RandomSelection(np.arange(size, dtype=np.intp), random))
        size = min(2 * size, _BLOCK)


def rows(dnnf: Dnnf) -> Iterator[Rows]:
    """Every row in blocks of shape (at most 4096, variables), made when asked for.

    The order is that of the graph: the same for the same space, of no further meaning.
    """
    weighed = weigh(dnnf)
    start, size = 0, _FIRST_BLOCK
    while start < weighed.total:
        ranks = np.arange(start, min(start + size, weighed.total), dtype=np.int64)
        yield descend(weighed, RankSelection(np.arange(len(ranks), dtype=np.intp), ranks))
        start += len(ranks)
        size = min(2 * size, _BLOCK)


def rows_of_model(dnnf: Dnnf, literals: Iterable[int]) -> Iterator[Rows]:
    """Those rows for which all of *literals* hold, which settle every Boolean of the graph."""
    return rows(replace(dnnf, graph=DecisionGraph((), GraphBranch(tuple(literals), (), ()))))
