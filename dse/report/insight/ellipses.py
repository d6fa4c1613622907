"""The largest ellipse around a point in what is allowed of a plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dse.report.content.data import Floats

_TURNS = 36
_STRETCHES = np.geomspace(1, 8, 25)
_CORNERS = 72
_FINER = 4


def largest_ellipse(centre: Floats, field: Floats, least: float) -> Floats:
    """The outline, (72, 2), of the largest ellipse around *centre* in the unit square where *field* is *least* or more.

    The field, (n, n) with x last, is on even places, and bilinear between. Of all ellipses around the centre, those
    of 36 directions and 25 shapes up to 1 : 64 are tried; (0, 2) if the field is less at the centre already.
    """
    fine = _finer(field) >= least
    edge = ~fine & _beside(fine)
    last = len(fine) - 1
    near = np.round(centre * last).astype(int)
    if not fine[near[1], near[0]]:
        return np.empty((0, 2))
    rows, columns = np.nonzero(edge)
    away = np.stack([columns, rows], axis=1) / last - centre
    room = np.minimum(centre, 1 - centre)
    best, found = 0.0, np.empty((0, 2))
    around = np.linspace(0, 2 * np.pi, _CORNERS, endpoint=False)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    for turn in np.arange(_TURNS) * np.pi / _TURNS:
        along = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        turned = (away @ along.T) ** 2
        for stretch in _STRETCHES:
            axes = np.array([stretch, 1 / stretch])
            reach = np.sqrt((along.T**2) @ axes**2)
            squared = min(float((room / reach).min()) ** 2, float((turned @ axes**-2.0).min(initial=np.inf)))
            if squared > best * (1 + 1e-9):
                best = squared
                found = centre + np.sqrt(squared) * (circle * axes) @ along
    return found


def _finer(field: Floats) -> Floats:
    """With three places more between two of them."""
    places = np.arange((len(field) - 1) * _FINER + 1) / _FINER
    below = np.minimum(places.astype(int), len(field) - 2)
    part = places - below
    rows = field[below] * (1 - part)[:, None] + field[below + 1] * part[:, None]
    return np.asarray(rows[:, below] * (1 - part) + rows[:, below + 1] * part, dtype=np.float64)


def _beside(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Where one of the four neighbours has the flag."""
    padded = np.pad(flags, 1)
    return np.asarray(padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:])
