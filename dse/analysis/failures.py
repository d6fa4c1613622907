"""The share of the space that fails, of studies that looked for failures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from dse.analysis.finding import Finding, Topic
from dse.analysis.paired import value_label
from dse.errors import DseError
from dse.exploration import FailureShare, failure_shares
from dse.storage import RunTable
from dse.units import shown


def failure_findings(table: RunTable) -> tuple[Finding, ...]:
    """What the search came to, by configuration; () if *table* is of another sampler than `rare_failures`."""
    definition = table.header.definition
    titles = {each.name: each.title or each.name for each in definition.requirements}
    try:
        found = tuple(failure_shares(table))
    except DseError as error:
        reason = error.problems[0].what
        return (Finding(Topic.WITHHELD, "", f"share that fails: {reason}", {"reason": reason}),)
    return tuple(
        Finding(
            Topic.FAILURES,
            each.requirement,
            f"{each.requirement} ({titles[each.requirement]})"
            + (f", {each.configuration}" if len(found) > 1 else "")
            + f": {'; '.join(_sentence(table, each))}",
            asdict(each),
        )
        for each in found
    )


def _sentence(table: RunTable, found: FailureShare) -> Iterator[str]:
    share = found.share
    if not share.failing:
        yield f"none of {found.asked:,} runs fails; at most {_percent(share.high)} of the space do (95 % confidence)"
    else:
        interval = f"{_percent(share.low).removesuffix(' %')} … {_percent(share.high)}"
        yield (
            f"fails in {_percent(share.value)} of the space ({interval}; importance sampling, {share.failing:,} of the "
            f"last {share.runs:,} runs fail; {found.asked:,} runs)"
        )
    if found.mildest >= 0:
        row = int((table.numbers == found.mildest).argmax())
        point = {name: float(column[row]) for name, column in table.points.items()}
        told = [value_label(variable, point[variable.name]) for variable in table.header.definition.variables]
        yield f"mildest failure: run {found.mildest} ({', '.join(told)})"
    if found.unknown:
        yield f"{found.unknown:,} runs have no verdict and count as passed"


def _percent(share: float) -> str:
    return f"{shown(100 * share, 2)} %"
