"""Findings as sentences, and the boxes and robust centres among them with their ranges."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dse.analysis import (
    Box as FoundBox,
    Centre as FoundCentre,
    Finding,
    StudyData,
    Topic,
    best_boxes,
    robust_centre,
    worst_designs,
)
from dse.errors import DseError
from dse.report.content.insight import Centre, InsightBox, InsightFinding, Range
from dse.report.insight.naming import Naming
from dse.units import parse_unit


def insight_findings(findings: Sequence[Finding], naming: Naming) -> tuple[InsightFinding, ...]:
    """Every finding, with titles for names."""
    return tuple(
        InsightFinding(naming.plane(each.plane), str(each.topic), naming.spoken(each.text)) for each in findings
    )


def boxes_of(data: StudyData, findings: Sequence[Finding], naming: Naming) -> tuple[InsightBox, ...]:
    """The boxes of all requirements together, as they are told in *findings*; none where they are withheld."""
    try:
        data = worst_designs(data)
        found = best_boxes(data, whole_of(data))
    except DseError:
        return ()
    mine = [each for each in findings if each.plane == data.plane and each.about == whole_of(data)]
    texts = [naming.spoken(each.text) for each in mine if each.topic is Topic.BOX]
    return tuple(_box(each, data, naming, text) for each, text in zip(found, texts, strict=False))


def centres_of(data: StudyData, naming: Naming) -> tuple[Centre, ...]:
    """The robust centre of all requirements together; none where it is withheld."""
    try:
        data = worst_designs(data)
        found = robust_centre(data, whole_of(data))
    except DseError:
        return ()
    return (_centre(found, data, naming),)


def whole_of(data: StudyData) -> str:
    """What all requirements together are called."""
    return next(iter(data.verdicts)) if len(data.verdicts) == 1 else "all requirements"


def _box(box: FoundBox, data: StudyData, naming: Naming, text: str) -> InsightBox:
    choices = [f"{limit.factor.name} is {' or '.join(limit.levels)}" for limit in box.limits if limit.factor.is_choice]
    density = box.density
    return InsightBox(
        naming.plane(data.plane),
        text,
        (density.value, density.low, density.high),
        box.coverage,
        box.checked,
        tuple(
            _range(data, naming, limit.factor.name, limit.low, limit.high)
            for limit in box.limits
            if not limit.factor.is_choice
        ),
        ", ".join(choices),
    )


def _centre(centre: FoundCentre, data: StudyData, naming: Naming) -> Centre:
    (row,) = np.flatnonzero(data.numbers == centre.number)
    ranges = [
        _range(data, naming, factor.name, place - centre.margin, place + centre.margin)
        for factor, place in zip(data.factors, data.places[row].tolist(), strict=True)
        if not factor.is_choice and factor.is_decided and not math.isnan(place)
    ]
    share = (centre.share.value, centre.share.low, centre.share.high)
    plane = naming.plane(data.plane)
    return Centre(plane, centre.number, centre.margin, centre.around, centre.limit, share, tuple(ranges))


def _range(data: StudyData, naming: Naming, name: str, low: float, high: float) -> Range:
    """Between two places; where one is NaN, the range's own end."""
    factor = data.factors[data.factor(name)]
    unit = parse_unit(factor.unit)
    first, last = (0.0 if math.isnan(low) else max(low, 0.0)), (1.0 if math.isnan(high) else min(high, 1.0))
    ends = [factor.value(first), factor.value(last)]
    if factor.variable is not None and (values := factor.variable.values):
        inside = [v for i, v in enumerate(values) if first <= (i + 0.5) / len(values) <= last]
        ends = [min(inside), max(inside)] if inside else ends
    return Range(naming.variables[name], *map(unit.from_si, ends))
