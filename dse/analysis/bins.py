"""The values of a factor in bins: its own levels where there are few, else parts with as many runs each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import Factor, Floats, Rows


def binned(places: Floats, factor: Factor, most: int) -> tuple[Rows, NDArray[np.intp]]:
    """Which of n *places* have a value, (n,), and the bin of each of those, numbered from 0; no bin is empty.

    Not more than *most* bins, but as many as a choice has levels. Equal values are in one bin.
    """
    rows = ~np.isnan(places)
    x = places[rows]
    values, which = np.unique(x, return_inverse=True)
    if len(values) <= most or factor.is_choice:
        return rows, which.reshape(-1)
    cuts = np.quantile(x, np.arange(1, most) / most)
    return rows, np.unique(np.searchsorted(cuts, x, side="right"), return_inverse=True)[1].reshape(-1)
