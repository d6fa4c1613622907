"""A table said in clauses: the forbidden cells covered by boxes that are as large as they can be."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from dse.space.flat import ABSENT, Bools, FlatSpace, Table

Box = tuple[tuple[int, Bools], ...]
"""Cells by variable and mask, shape (values + 1,)."""

_Links = tuple[tuple[tuple[int, int, bool], ...] | None, ...]
"""By axis: the axes it hangs below, by which value, and whether directly; None for a root."""


def boxes(flat: FlatSpace, table: Table) -> list[Box]:
    """Boxes that hold every forbidden cell a row can reach, and no allowed one that a row can reach.

    Greedy: a box grows from the first cell not yet covered, axis by axis, as far as cells are forbidden or out of
    reach. An axis a box does not restrict is left out of it; a box without axes forbids everything.
    """
    axis_of = {number: axis for axis, number in enumerate(table.scope)}
    links: list[tuple[tuple[int, int, bool], ...] | None] = []
    for number in table.scope:
        above = flat.variables[number].parent
        found: list[tuple[int, int, bool]] = []
        is_root, direct = above is None, True
        while above is not None:
            if above[0] in axis_of:
                found.append((axis_of[above[0]], above[1], direct))
            above, direct = flat.variables[above[0]].parent, False
        links.append(None if is_root else tuple(found))
    allowed = np.ascontiguousarray(table.allowed)
    return [
        tuple((table.scope[axis], mask) for axis, mask in box)
        for box in _cover(allowed.shape, allowed.tobytes(), tuple(links))
    ]


@lru_cache(maxsize=1024)  # thousands of rules have the same few tables
def _cover(shape: tuple[int, ...], cells: bytes, links: _Links) -> tuple[Box, ...]:
    """Boxes by axis instead of variable."""
    allowed = np.frombuffer(cells, np.bool_).reshape(shape)
    reachable = _reachable(shape, links)
    free_to_take = ~(allowed & reachable)
    to_cover = ~allowed & reachable
    found: list[Box] = []
    while to_cover.any():
        cell = np.unravel_index(int(np.argmax(to_cover)), shape)
        masks = [np.arange(size) == at for size, at in zip(shape, cell, strict=True)]
        for axis, size in enumerate(shape):
            others = [np.flatnonzero(mask) for mask in masks]
            others[axis] = np.arange(size)
            block = np.moveaxis(free_to_take[np.ix_(*others)], axis, 0)
            masks[axis] = block.reshape(size, -1).all(axis=1)
        to_cover[np.ix_(*(np.flatnonzero(mask) for mask in masks))] = False
        found.append(tuple((axis, mask) for axis, mask in enumerate(masks) if not mask.all()))
    return tuple(found)


def _reachable(shape: tuple[int, ...], links: _Links) -> Bools:
    """The cells that the hierarchy alone lets a row take."""
    reachable = np.ones(shape, bool)
    for axis, above in enumerate(links):
        if above is None:
            np.moveaxis(reachable, axis, 0)[ABSENT] = False
            continue
        for other, value, direct in above:
            both = np.moveaxis(reachable, (axis, other), (0, 1))
            # No child without what it hangs below; and the parent's value not without the child.
            beside = [each for each in range(shape[other]) if each != value % shape[other]]
            both[np.ix_(range(len(both) - 1), beside)] = False
            if direct:
                both[ABSENT, value] = False
    return reachable
