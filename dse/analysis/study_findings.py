"""What was learnt from a study, in sentences that say no more than its runs do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from functools import partial

from dse.analysis.boxes import best_boxes
from dse.analysis.conditions import share_met, worst_case, worst_designs
from dse.analysis.data import ALL, StudyData
from dse.analysis.dependence import DESIGNED, designed_findings, interactions, metric_label, shares
from dse.analysis.failures import failure_findings
from dse.analysis.finding import Account, Finding, Topic
from dse.analysis.phrases import at_all, between, condition, likely, listed, percent, point, requirement_label, value
from dse.analysis.probability import Basis, Met
from dse.analysis.robust import robust_centre
from dse.analysis.study_reader import planes
from dse.storage import RunTable


def essentials(table: RunTable, parts: Sequence[StudyData] = ()) -> tuple[Finding, ...]:
    """What the runs say about the requirements and what these depend on; and what they do not say, and why.

    *parts* are the `planes` of the table, if they are there already.
    """
    return failure_findings(table) or _stated(parts or planes(table), _of_requirements)


def findings(table: RunTable, notice: Callable[[str], None] = lambda _: None) -> tuple[Finding, ...]:
    """All that is known how to be said: also of other metrics, and of what matters together with others.

    *notice* is called with what is computed next.
    """
    return failure_findings(table) or _stated(planes(table), _of_everything, notice)


def _stated(
    parts: Sequence[StudyData], part: _Part, notice: Callable[[str], None] = lambda _: None
) -> tuple[Finding, ...]:
    found: list[Finding] = []
    for data in parts:
        account = Account(notice)
        if len(data):
            part(account, data)
        told = [*_runs(data), *account.findings, *account.withheld()]
        order = {topic: number for number, topic in enumerate(Topic)}
        found += [replace(each, plane=data.plane) for each in sorted(told, key=lambda each: order[each.topic])]
    return tuple(found)


def _of_requirements(account: Account, data: StudyData) -> None:
    names = _requirements(data)
    for name in names:
        label = requirement_label(data, name)
        account.add("how often it is met", name, label, partial(_met, data.about(name), name))
        for factor in data.factors:
            if factor.is_condition:
                account.add("the worst case", name, label, partial(_worst, data.about(name), factor.name, name))
    for name in names[-1:] if len(names) > 1 else names:
        label = requirement_label(data, name)
        account.add("a box", name, label, partial(_boxes, data.about(name), name))
        account.add("a robust centre", name, label, partial(_centre, data.about(name), name))
    for metric in dict.fromkeys(entry.metric for entry in data.definition.requirements):
        _dependence(account, data, metric)


def _of_everything(account: Account, data: StudyData) -> None:
    _of_requirements(account, data)
    behind = {entry.metric for entry in data.definition.requirements}
    for name in _requirements(data)[:-1]:
        if (data.met(name) == data.met()).all():
            continue
        account.add("a box", name, requirement_label(data, name), partial(_boxes, data.about(name), name))
    for metric in data.metrics:
        if metric not in behind:
            _dependence(account, data, metric)
    if len(data.factors) > 1:
        told = {each.about for each in account.findings if each.topic is Topic.TOGETHER}
        for metric in (name for name in data.judged_metrics if name not in told):
            label = metric_label(data, metric)
            account.add("what matters together", metric, label, partial(interactions, data, metric))


def _requirements(data: StudyData) -> list[str]:
    """Those of the study, then all together if they are several."""
    return [*data.verdicts, ALL] if len(data.verdicts) > 1 else [*data.verdicts]


def _dependence(account: Account, data: StudyData, metric: str) -> None:
    label = metric_label(data, metric)
    if data.definition.sampler.kind in DESIGNED:
        account.add("designed indices", metric, label, partial(designed_findings, data, metric))
    if not any(each.about == metric and each.topic is Topic.TOGETHER for each in account.findings):
        account.add("what explains the variance", metric, label, partial(shares, data, metric))


def _runs(data: StudyData) -> Iterator[Finding]:
    failed = int((~data.done).sum())
    facts = {"runs": len(data), "failed": failed, "apart": data.apart, "factors": [f.name for f in data.factors]}
    if not len(data):
        yield Finding(Topic.RUNS, "", "there are no runs in the ranges of the study", facts)
    elif failed:
        what = f"{failed} of {len(data)} runs failed to run: they meet nothing and have no metrics"
        yield Finding(Topic.RUNS, "", what, facts)
    if data.apart and not data.plane:
        what = f"{data.apart} runs are outside the present ranges and are left out"
        yield Finding(Topic.RUNS, "", what, facts)


def _met(data: StudyData, name: str) -> Iterable[Finding]:
    met = share_met(data, name)
    return [Finding(Topic.MET, name, f"{requirement_label(data, name)}: {_how_often(met, data)}", asdict(met))]


def _how_often(met: Met, data: StudyData) -> str:
    rows, incomplete = "runs", 0
    is_elsewhere = any(each.on for each in data.definition.requirements if each.name == met.requirement)
    at = at_all(met.conditions) + " of its benches" * (is_elsewhere and met.conditions > 1)
    if met.conditions and met.basis is not Basis.MODEL:
        designs = worst_designs(data.evenly(met.requirement, 1))
        rows, incomplete = designs.rows, designs.incomplete
    others = [f"{met.not_exercised} do not exercise it"] if met.not_exercised else []
    others += [f"{met.failed_to_run} failed to run"] if met.failed_to_run else []
    others += [f"{incomplete} were not run at all of them"] if incomplete else []
    rest = f"; {listed(others)}" if others else ""
    exercised = " where it is exercised" if met.not_exercised else ""
    # All there are, or those that were chosen: no sample of anything.
    is_sample = any(factor.variable for factor in data.factors)
    if is_sample and met.failed and met.met:
        crowded = round(met.counts_as) < _CROWDED * met.judged
        counted = f"{met.met} of {met.judged} {rows}" if met.conditions else f"{met.judged} {rows}"
        by = {
            Basis.RUNS: f"estimated from {counted}",
            Basis.EVEN_RUNS: f"estimated from {counted} that were drawn evenly",
            Basis.MODEL: f"by a model of the verdicts through {met.judged} runs",
        }[met.basis]
        by += f", an effective sample of {met.counts_as:.0f}" if crowded and met.basis is not Basis.MODEL else ""
        return f"met{at} in {likely(met.share)} of the space{exercised} ({by}){rest}"
    bound = f"at least {percent(met.share.low)}" if met.met else f"at most {percent(met.share.high)}"
    space = f" ({bound} of the space{exercised})" if is_sample else ""
    which = f"{rows}{' that exercise it' if met.not_exercised else ''}"
    return f"met{at} in {met.met} of {met.judged} {which}{space}{rest}"


def _worst(data: StudyData, over: str, name: str) -> Iterable[Finding]:
    factor = data.factors[data.factor(over)]
    found = worst_case(data, over, name)
    text = f"{requirement_label(data, name)}: worst at {over} = {value(factor, found.worst.place)}"
    if found.worst.met:
        text += f", met there in {likely(found.worst.met.share)}"
    if silent := [value(factor, each.place) for each in found.conditions if each.met is None]:
        text += f"; at {listed(silent)} no run shows whether it is met"
    if found.complete:
        text += f"; {found.passing} of {found.complete} designs meet it at all conditions"
    if found.best >= 0:
        text += f", the one with the largest least margin has it in run {found.best}"
    if found.incomplete and found.complete:
        text += f"; {found.incomplete} designs were not run at all conditions"
    return [Finding(Topic.CONDITIONS, name, text, asdict(found))]


def _boxes(data: StudyData, name: str) -> Iterator[Finding]:
    data = worst_designs(data)
    label, start = requirement_label(data, name), f"met{at_all(data.conditions)} if"
    found = best_boxes(data, name)
    if not found:
        text = f"{label}: no limits were found within which it is met more often than elsewhere, but by chance"
        yield Finding(Topic.BOX, name, text, {"limits": []})
    for box in found:
        held_out = f"in {percent(box.density.value)} of {box.checked} held-out {data.rows} ({between(box.density)})"
        text = f"{label}: {start} {condition(box.limits)}: {held_out}; {percent(box.coverage)} of all that meet it"
        facts = {"condition": condition(box.limits), "density": asdict(box.density), "coverage": box.coverage}
        yield Finding(Topic.BOX, name, text, facts | {"checked": box.checked, "luck": box.luck})
        start = "else if"


def _centre(data: StudyData, name: str) -> Iterable[Finding]:
    data = worst_designs(data)
    found = robust_centre(data, name)
    end = f"the nearest that does not is run {found.limit}" if found.limit >= 0 else "a range ends there"
    text = (
        f"{requirement_label(data, name)}: most may change around run {found.number} ({point(data, found.number)}): "
        f"where every number changes by up to {percent(found.margin)} of its range at once, "
        f"{percent(found.share.value)} of {found.around} held-out {data.rows} meet it ({between(found.share)}); {end}"
    )
    return [Finding(Topic.CENTRE, name, text, asdict(found))]


_CROWDED = 0.9

_Part = Callable[[Account, StudyData], None]
