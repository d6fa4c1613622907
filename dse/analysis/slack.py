"""Margins as shares, so that those of several requirements can be compared; the page has the same (`margins.ts`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dse.analysis.data import MET, Codes, Floats
from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import DefinedRequirement
from dse.storage import RunTable
from dse.units import parse_unit

FAILING = VERDICTS.index(Verdict.FAIL)


def slack(
    requirements: Sequence[DefinedRequirement],
    margins: Mapping[str, Floats],
    verdicts: Mapping[str, Codes],
    metrics: Mapping[str, Floats],
) -> Floats:
    """The least margin of each run as a share of its scale, (n,); all in SI, by name.

    Infinite where a run exercises no requirement, -inf where it fails one whose metric is undefined.
    """
    least = np.full(max((len(each) for each in verdicts.values()), default=0), np.inf)
    for entry in requirements:
        codes = verdicts[entry.name]
        share = margins[entry.name] / scale_of(entry, metrics[entry.metric])
        share = np.where(np.isnan(share), -np.inf, share)
        least = np.where(np.isin(codes, [MET, FAILING]), np.minimum(least, share), least)
    return least


def slack_of_runs(table: RunTable) -> Floats:
    """`slack` of the runs of a study."""
    entries = table.header.definition.requirements
    if not entries:
        return np.full(len(table), np.inf)
    margins = {entry.name: table.margins(entry.name) for entry in entries}
    verdicts = {entry.name: table.verdicts(entry.name) for entry in entries}
    return slack(entries, margins, verdicts, {entry.metric: table.metric(entry.metric) for entry in entries})


def scale_of(requirement: DefinedRequirement, values: Floats) -> float:
    """What a share of margin is a share of, SI: the bound; of a band, half its width; of a bound at 0, the metric's
    median size."""
    unit, scale = parse_unit(requirement.unit), _size_of_bound(requirement)
    factor = abs(float(unit.factor))
    if scale > 0:
        return scale
    sizes = np.sort(np.abs((values - float(unit.offset)) / float(unit.factor)))
    sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
    return float(sizes[len(sizes) // 2]) * factor if len(sizes) else factor


def _size_of_bound(requirement: DefinedRequirement) -> float:
    low, high = requirement.at_least, requirement.at_most
    if low is not None and high is not None:
        return (high - low) / 2
    unit = parse_unit(requirement.unit)
    return float(abs(unit.from_si(high if high is not None else low or 0.0)) * abs(float(unit.factor)))
