"""What a study of the sampler `rare_failures` came to: the share of the space that fails, and the mildest failure.

Its search is gone through again with the stored runs, which lead to the same asks.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.sampler import Brief
from dse.errors import fail
from dse.exploration.rare_event import Probability
from dse.exploration.samplers.rare_failures import RareFailures
from dse.exploration.variables import design_variable
from dse.storage import RunTable

_JUDGED = [VERDICTS.index(Verdict.PASS), VERDICTS.index(Verdict.FAIL)]


@dataclass(frozen=True, slots=True)
class FailureShare:
    """Of a *configuration* and a *requirement*: how much of the space fails, by the *asked* runs of the search.

    *mildest* is the failing run nearest to the nominal values, -1 if none fails. Of *unknown* runs the requirement has
    no verdict: they count as passed.
    """

    configuration: str
    requirement: str
    share: Probability
    mildest: int
    asked: int
    unknown: int


def failure_shares(table: RunTable) -> Iterator[FailureShare]:
    """Of each configuration; none if *table* is of another sampler. DseError if runs are missing."""
    definition = table.header.definition
    if definition.sampler.kind != RareFailures.name:
        return
    if definition.replicates is not None:
        raise fail("with replicates, the share of the space that fails is not estimated", hint="leave out 'replicates'")
    sampler = RareFailures.model_validate(definition.sampler.options)
    variables = tuple(design_variable(defined) for defined in definition.variables)
    correlations = {(each.one, each.other): each.value for each in definition.correlations}
    names = definition.explored
    brief = Brief(variables, names, definition.seed, table.outcomes([]), correlations=correlations)
    search = sampler.start(brief)
    nominal = np.array([variable.nominal for variable in variables])
    has = {name: table.header.has(name) for name in names}
    places = zip(table.configurations, map(tuple, table.coordinates().tolist()), strict=True)
    numbers = dict(zip(places, table.numbers.tolist(), strict=True))
    asked: dict[str, int] = dict.fromkeys(names, 0)
    while candidates := search.ask():
        wanted = [(name, tuple(np.where(has[name], point, nominal).tolist())) for name, point in candidates]
        if missing := sum(each not in numbers for each in wanted):
            raise fail(f"{missing} runs that the search asked for are missing", hint="finish it with 'dse explore'")
        for name, _ in wanted:
            asked[name] += 1
        search.tell(table.outcomes([numbers[each] for each in wanted]))
    for name in names:
        share, mildest = search.probability(name), search.mildest(name)
        if share is not None:
            point = None if mildest is None else tuple(np.where(has[name], mildest, nominal).tolist())
            judged = np.isin(table.verdicts(search.requirement), _JUDGED)
            unknown = int((~judged & (np.array(table.configurations) == name)).sum())
            run = -1 if point is None else numbers[name, point]
            yield FailureShare(name, search.requirement, share, run, asked[name], unknown)
