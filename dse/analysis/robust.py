"""The tested point around which most can change before something tested does not pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dse.analysis.data import ALL, StudyData, withheld
from dse.analysis.once import once
from dse.analysis.reading import groups

_DIGITS = 9
_LEAST_AROUND = 3


@dataclass(frozen=True, slots=True)
class Centre:
    """Run *number* passes, and so does every run of which no number differs by *margin* of its range or more.

    *around* is how many other runs those are. *limit* is the nearest run that does not pass; -1 if that is farther than
    the end of a range.
    """

    number: int
    margin: float
    around: int
    limit: int


@once
def robust_centre(data: StudyData, requirement: str = ALL) -> Centre:
    """The passing run with the largest margin: the distance, in the factor that differs most and as a part of its
    range, to the nearest run with the same choices that does not pass, or to the end of a range.

    Of designs at the worst of their conditions (`worst_designs`) it is a design. Not exercised and failed runs do not
    pass. DseError if no run passes, none has a number to change, or fewer than
    three runs lie around the best: what was not tested is no margin.
    """
    from scipy.spatial import cKDTree

    met = data.met(requirement)
    if not met.any():
        raise withheld(requirement, f"no {data.rows[:-1]} meets it: there is no robust centre")
    decided = [not factor.is_choice and factor.is_decided for factor in data.factors]
    best: Centre | None = None
    kinds = groups(data)
    for kind in np.unique(kinds[met]).tolist():
        rows = np.flatnonzero(kinds == kind)
        points = data.places[rows][:, np.array(decided, dtype=np.bool_)]
        points = points[:, ~np.isnan(points).any(axis=0)]
        points = points[:, np.ptp(points, axis=0) > 0]
        if not points.shape[1]:
            continue
        inside, others = met[rows], np.flatnonzero(~met[rows])
        margins = np.minimum(points[inside], 1 - points[inside]).min(axis=1)
        limits = np.full(len(margins), -1)
        if len(others):
            away, which = cKDTree(points[others]).query(points[inside], p=np.inf)
            limits = np.where(away < margins, data.numbers[rows[others[which]]], -1)
            margins = np.minimum(away, margins)
        first = int(np.argmax(np.round(margins, _DIGITS)))
        margin = float(margins[first])
        if best is None or round(margin, _DIGITS) > round(best.margin, _DIGITS):
            near = np.abs(points - points[np.flatnonzero(inside)[first]]).max(axis=1) < margin
            best = Centre(
                int(data.numbers[rows[inside]][first]), margin, max(int(near.sum()) - 1, 0), int(limits[first])
            )
    if best is None:
        raise withheld(
            requirement, f"no number differs between {data.rows} with the same choices: there is no robust centre"
        )
    if best.margin <= 0:
        raise withheld(requirement, "no run that meets it does so at another condition, or right beside it, too")
    if best.around < _LEAST_AROUND:
        raise withheld(
            requirement, f"around the best point there are {best.around} other {data.rows}: too few for a margin"
        )
    return best
