"""Rows of a compiled space: drawn at random, each equally likely, or listed in the order of the graph."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from dse.space.dnnf.compile import Dnnf
from dse.space.dnnf.descend import descend
from dse.space.dnnf.lots import Chance, Rank
from dse.space.dnnf.weigh import weigh
from dse.space.flat import Bools, Rows
from dse.space.sampling.uniform import generator

_FIRST_BLOCK = 64
_BLOCK = 4096


def sample(dnnf: Dnnf, number: int, seed: int, wanted: Mapping[int, Bools] | None = None) -> Rows:
    """Rows drawn independently, each of all (wanted) rows equally likely; shape (number, variables).

    The first rows are those of a smaller sample. Exact whatever the number of rows: choices are made in whole numbers.
    Shape (0, variables) if there is no row.
    """
    blocks = [np.zeros((0, len(dnnf.flat.variables)), np.int16)]
    missing = number
    for block in drawn(dnnf, seed, wanted) if number else ():
        blocks.append(block[:missing])
        missing -= len(blocks[-1])
        if not missing:
            break
    return np.concatenate(blocks)


def drawn(dnnf: Dnnf, seed: int, wanted: Mapping[int, Bools] | None = None) -> Iterator[Rows]:
    """Blocks of such rows without end, shape (at most 4096, variables); no block if there is no row."""
    weighed = weigh(dnnf, wanted)
    random = generator(seed)
    size = _FIRST_BLOCK
    while weighed.total:
        # Always whole blocks, so that the stream of random numbers does not depend on what is asked for.
        yield descend(weighed, Chance(np.arange(size, dtype=np.intp), random))
        size = min(2 * size, _BLOCK)


def rows(dnnf: Dnnf, start: int = 0, wanted: Mapping[int, Bools] | None = None) -> Iterator[Rows]:
    """Every (wanted) row from number *start* on, in blocks of shape (at most 4096, variables), made when asked for.

    The order is that of the graph: the same for the same space, of no further meaning.
    """
    weighed = weigh(dnnf, wanted)
    size = _FIRST_BLOCK
    while start < weighed.total:
        number = min(size, weighed.total - start)
        offsets = np.arange(number, dtype=np.int64)
        yield descend(weighed, Rank(offsets.astype(np.intp), start, offsets))
        start += number
        size = min(2 * size, _BLOCK)


def first(dnnf: Dnnf, wanted: Mapping[int, Bools] | None = None) -> Rows | None:
    """Row number 0, shape (variables,), or None if there is none."""
    block = next(rows(dnnf, 0, wanted), None)
    return None if block is None else block[0]
