"""The tested point around which most can change before something tested does not pass.

It is found by half of the runs and judged by the others: of many points some are among passes by luck. Between the runs
of the half a model of the verdicts says where something would fail: the widest gap between failing runs would be luck,
too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dse.analysis.data import ALL, Rows, StudyData, withheld
from dse.analysis.measure import chances_at
from dse.analysis.memoize import memoized
from dse.analysis.probability import Interval, wilson
from dse.analysis.radial import drawn
from dse.analysis.study_reader import groups

_DIGITS = 9
_LEAST_RUNS = 20
_LEAST_AROUND = 5
_LEAST_SHARE = 0.9
_LIKELY = 0.8
"""Where it is less probable than that, a point between the runs counts as one that does not pass."""
_BETWEEN, _MOST, _MOST_KINDS = 2**11, 200, 8


@dataclass(frozen=True, slots=True)
class Centre:
    """Run *number* passes, and around it, where no number differs by more than *margin* of its range, others do.

    Of those that it was not found by, *around* are there, and this *share* of what is there passes. *limit* is the
    nearest run that does not pass; -1 if the end of a range is nearer.
    """

    number: int
    margin: float
    around: int
    limit: int
    share: Interval


@memoized
def robust_centre(data: StudyData, requirement: str = ALL) -> Centre:
    """The passing run with the largest margin: the distance, in the factor that differs most and as a part of its
    range, to the nearest point with the same choices that does not pass or would hardly, or to the end of a range.

    Of designs at the worst of their conditions (`worst_designs`) it is a design. Not exercised and failed runs do not
    pass. Of the combinations of choices the eight with the most passes are looked at. DseError if no run passes or none
    has a number to change; or if fewer than five of the other half of the runs are around it, or less than nine of ten
    of these pass.
    """
    data = data.evenly(requirement, _LEAST_RUNS)
    met, half, kinds = data.met(requirement), data.half(), groups(data)
    if not met.any():
        raise withheld(requirement, f"no {data.rows[:-1]} meets it: there is no robust centre")
    best: Centre | None = None
    found, counts = np.unique(kinds[met & half], return_counts=True)
    for kind in found[np.argsort(-counts, kind="stable")][:_MOST_KINDS].tolist():
        there = data.part(kinds == kind)
        varied = [not f.is_choice and np.ptp(x) > 0 for f, x in zip(there.factors, there.places.T, strict=True)]
        decided = np.array([f.is_decided for f, is_varied in zip(there.factors, varied, strict=True) if is_varied])
        if not decided.any():
            continue
        there = replace(there, places=there.places[:, varied])
        mine, passes, points = half[kinds == kind], there.met(requirement), there.places[:, decided]
        row, margin = _widest(there.part(mine), requirement, decided)
        row = int(np.flatnonzero(mine)[row])
        away = np.abs(points - points[row]).max(axis=1)
        around = ~mine & (away <= margin)
        if best is None or round(margin, _DIGITS) > round(best.margin, _DIGITS):
            share = wilson(int((passes & around).sum()), int(around.sum())) if around.any() else Interval(0.0, 0.0, 1.0)
            end = min(points[row].min(), (1 - points[row]).min())
            limit = -1 if margin >= end or passes.all() else int(there.numbers[~passes][np.argmin(away[~passes])])
            best = Centre(int(there.numbers[row]), margin, int(around.sum()), limit, share)
    if best is None:
        why = f"no number differs between {data.rows} with the same choices: there is no robust centre"
    elif best.margin <= 0:
        why = "no run that meets it does so at another condition, or right beside it, too"
    elif best.around < _LEAST_AROUND:
        which = f"held-out {data.rows[:-1] if best.around == 1 else data.rows}"
        why = f"around the best point there are {best.around} {which}, and {_LEAST_AROUND} are needed"
    elif best.share.value < _LEAST_SHARE:
        why = f"around the best point only {best.share.value:.0%} of {best.around} held-out {data.rows} meet it"
    else:
        return best
    raise withheld(requirement, why)


def _widest(data: StudyData, requirement: str, decided: Rows) -> tuple[int, float]:
    """The row with the largest margin, and the margin, in the columns of the places that are *decided*."""
    from scipy.spatial import cKDTree

    rows = drawn(np.arange(len(data)), _MOST)
    met = data.met(requirement)
    between = np.random.default_rng(0).random((_BETWEEN, len(decided)))
    fails = chances_at(data.part(rows), requirement, data.places[rows], between)[0] < _LIKELY
    points = data.places[:, decided]
    others = np.concatenate([points[~met], between[fails][:, decided]])
    inside = np.flatnonzero(met)
    margins = np.minimum(points[inside], 1 - points[inside]).min(axis=1)
    if len(others):
        margins = np.minimum(cKDTree(others).query(points[inside], p=np.inf)[0], margins)
    first = int(np.argmax(np.round(margins, _DIGITS)))
    return int(inside[first]), float(margins[first])
