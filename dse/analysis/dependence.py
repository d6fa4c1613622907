"""What a metric depends on, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from dse.analysis.data import StudyData, withheld
from dse.analysis.finding import Finding, Topic
from dse.analysis.first_order import LEAST, alias_sentences, courses, few_points, going_together
from dse.analysis.importance import importances, model_first_order_shares
from dse.analysis.phrases import between, difference, listed, parts, percent
from dse.analysis.probability import Interval
from dse.analysis.sensitivity_indices import Effects, IndexEstimates, morris_effects, sobol_indices
from dse.errors import fail

DESIGNED = {"sobol_indices": sobol_indices, "morris": morris_effects}
"""Designs that are made for indices, and what computes them."""

_MOST_NAMED = 4
_HARDLY = 0.03


def metric_label(data: StudyData, name: str) -> str:
    """A metric by its title."""
    return next((entry.title for entry in data.definition.metrics if entry.name == name), "") or name


def shares(data: StudyData, metric: str) -> Iterator[Finding]:
    """What explains how much of its variance by itself. Raises DseError."""
    data = data.evenly(metric, LEAST)
    found = sorted(model_first_order_shares(data, metric), key=lambda share: -round(share.share.value, 9))
    alias_reasons = alias_sentences(data, metric)
    said = [each for each in found if each.share.low > 0]
    if alias_reasons and (not found or (few_points(data.response(metric, 1)[0]) and not said)):
        raise withheld(metric, "; ".join(alias_reasons))
    if not found:
        raise fail(f"{metric}: its runs differ in nothing that could explain it")
    label, named = metric_label(data, metric), said[:_MOST_NAMED]
    named = [each for each in named if each.share.value >= _HARDLY] or named[:1]
    defined = data.response(metric, 2)[0]
    where = "" if len(defined) == len(data) else f" where it is defined ({len(defined)} of {len(data)} runs)"
    ways = {factor: f", {course}" for factor, course in courses(data, metric).items()}
    told = parts([(_called(data, each.factor), each.share, ways.get(each.factor, "")) for each in named])
    most = max(each.share.high for each in found)
    text = f"{label}{where}: {told or f'no factor explains more than {percent(most)} of the variance'}"
    pairs = [pair for pair in going_together(defined) if {*pair} & {each.factor for each in named}]
    left = 1 - math.fsum(each.share.value for each in found)
    if pairs:
        named_pairs = listed([" and ".join(pair) for pair in pairs[:3]], "as well as")
        text += f"; {named_pairs} are not independent in these runs, so their shares overlap"
    elif left >= 0.1 and told and not alias_reasons:
        text += f"; {percent(left)} is interactions or noise"
    text += "".join(f"; {each}" for each in alias_reasons)
    facts = {"shares": [asdict(each) for each in found], "defined": len(defined), "together": pairs}
    yield Finding(Topic.SHARES, metric, text, facts)


def interactions(data: StudyData, metric: str) -> Iterator[Finding]:
    """What matters together with others, by a model. Raises DseError."""
    found = importances(data, metric)
    ranked = sorted(found.factors, key=lambda each: -round(each.share.value, 9))
    named = [each for each in ranked if each.share.low > _HARDLY][:_MOST_NAMED]
    if not named:
        return
    told = parts([(_several(data, each.factors), each.share, "") for each in named])
    for pair in [each for each in found.pairs if each.share.low > _HARDLY][:1]:
        both = listed([_several(data, pair.one), _several(data, pair.other)])
        told += f"; {percent(pair.share.value)} ({between(pair.share)}) depends on both {both}"
    text = f"{metric_label(data, metric)}: {told}; by {found.source}"
    yield Finding(Topic.TOGETHER, metric, text, asdict(found))


def designed_findings(data: StudyData, metric: str) -> Iterator[Finding]:
    """Indices of the design that the study is made by. Raises DseError."""
    found = DESIGNED[data.definition.sampler.kind](data, metric)
    unit = next(entry.unit for entry in data.definition.metrics if entry.name == metric)
    label, factors = metric_label(data, metric), [*found.factors]
    lacking = f", {found.lacking} left out for want of results" if found.lacking else ""
    indices = [each for each in factors if isinstance(each, IndexEstimates)]
    if indices:
        ranked = sorted(indices, key=lambda each: -round(each.total.value, 9))
        named = [each for each in ranked if each.total.high >= _HARDLY][:_MOST_NAMED]
        told = parts([(each.factor, _capped(each.total), f", first-order {_alone(each)}") for each in named])
        text = f"{label}: {told}; Sobol' indices of {found.blocks} blocks{lacking}"
    else:
        effects = [each for each in factors if isinstance(each, Effects)]
        ranked_ = sorted(effects, key=lambda each: -round(each.size.value, 9))[:_MOST_NAMED]
        told = ", ".join(f"{_change(each, unit)} over the range of {each.factor}" for each in ranked_)
        text = f"{label} changes by {told}; {found.blocks} trajectories{lacking}"
    yield Finding(Topic.TOGETHER, metric, text, asdict(found))


def _several(data: StudyData, factors: Sequence[str]) -> str:
    """One factor, or those that depend on each other and have one index."""
    return " with ".join(_called(data, each) for each in factors)


def _called(data: StudyData, factor: str) -> str:
    """What varies a metric may be a condition; it is no choice."""
    return factor + " (condition)" * data.factors[data.factor(factor)].is_condition


def _alone(each: IndexEstimates) -> str:
    return percent(_capped(each.first).value)


def _change(each: Effects, unit: str) -> str:
    half = difference(each.size.high - each.size.value, unit)
    return f"{difference(each.size.value, unit)} (± {half})"


def _capped(share: Interval) -> Interval:
    """A share as it can be: an estimate may lie outside of 0 … 1."""
    return Interval(*(min(max(number, 0.0), 1.0) for number in (share.value, share.low, share.high)))
