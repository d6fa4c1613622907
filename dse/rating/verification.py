"""A test procedure carried out: the runs that are missing, and the verdict in each case."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.analysis import case_label
from dse.api import ExploreOptions, explore_into
from dse.domain.bench import VERDICTS, Requirement, Verdict, bound_of
from dse.domain.sampler import Role
from dse.domain.study import Keep, Selection
from dse.errors import fail
from dse.storage import StudyFolder

if TYPE_CHECKING:
    from dse.api import Progress
    from dse.domain.design import Configuration, DesignSpace
    from dse.domain.study import Study
    from dse.loading import Procedure
    from dse.storage import RunTable

CHECK = "An engineering check by simulation, no conformity"
"""What the result is."""

_RANKS = (Verdict.FAILED_TO_RUN, Verdict.FAIL, Verdict.NOT_EXERCISED, Verdict.PASS)


@dataclass(frozen=True, slots=True)
class CaseVerdict:
    """The *verdict* on a *requirement* in a *case* of a *test*, the run *number* in the study folder *folder*.

    *value*, the bounds *at_least* and *at_most* and the *margin* are in SI, NaN where undefined or absent. They are
    shown in *unit*. *problem* says why a run failed.
    """

    configuration: str
    test: str
    case: str
    requirement: str
    title: str
    verdict: Verdict
    value: float
    at_least: float
    at_most: float
    margin: float
    unit: str
    folder: Path
    number: int
    problem: str = ""

    @property
    def share(self) -> float:
        """The margin in parts of the bound or the value, whichever is larger: the less, the worse. NaN if undefined."""
        bound = self.at_most if math.isnan(self.at_least) else self.at_least
        size = max(abs(bound), abs(self.value))
        return self.margin / size if size > 0 else self.margin


@dataclass(frozen=True, slots=True)
class Verification:
    """The *verdicts* of a *procedure* on configurations of *design*, the worst first.

    *left_out* names the tests on benches of other design spaces. So many runs were *simulated* now.
    """

    procedure: Procedure
    design: DesignSpace
    verdicts: tuple[CaseVerdict, ...]
    left_out: tuple[str, ...]
    simulated: int

    def count(self, verdict: Verdict, configuration: str | None = None, test: str | None = None) -> int:
        """How many verdicts are *verdict*; of a *configuration*, of a *test*."""
        return sum(
            each.verdict == verdict and configuration in (None, each.configuration) and test in (None, each.test)
            for each in self.verdicts
        )


def designs_of(procedure: Procedure) -> tuple[DesignSpace, ...]:
    """The design spaces whose benches *procedure* uses."""
    return tuple({test.bench.design.name: test.bench.design for test in procedure.tests}.values())


def verify(
    procedure: Procedure,
    design: DesignSpace,
    configurations: Sequence[Configuration],
    folder: Path,
    options: ExploreOptions | None = None,
    *,
    on_progress: Callable[[Progress], None] | None = None,
    tell: Callable[[str], None] | None = None,
) -> Verification:
    """Carry out *procedure* for *configurations* of *design*: studies in *folder*, one a test, get the runs they lack.

    Raises DseError; ExplorationInterruptedError as `explore_into` does.
    """
    if not configurations:
        raise fail(f"no configuration of '{design.name}' was chosen")
    mine = [test for test in procedure.tests if test.bench.design.name == design.name]
    if not mine:
        known = ", ".join(each.name for each in designs_of(procedure))
        raise fail(
            f"no test of '{procedure.name}' is on a bench of '{design.name}'", procedure.where, f"it has {known}"
        )
    selection = Selection.of(configurations)
    keep = Keep.ALL if len(configurations) == 1 else Keep.NEAR_BOUNDARY
    found: list[CaseVerdict] = []
    simulated = 0
    for test in mine:
        study = replace(test, selection=selection, keep=keep)
        place = folder / test.name
        explored = explore_into(study, place, options or ExploreOptions(), on_progress=on_progress, tell=tell)
        simulated += explored.simulated
        with StudyFolder.open(place) as store:
            found += _verdicts(study, place, store.table())
    left_out = tuple(test.name for test in procedure.tests if test not in mine)
    return Verification(procedure, design, worst_first(found), left_out, simulated)


def worst_first(verdicts: Sequence[CaseVerdict]) -> tuple[CaseVerdict, ...]:
    """Runs that failed, then verdicts fail, not exercised and pass; of each the least share first, undefined ones
    before all."""

    def badness(each: CaseVerdict) -> tuple[int, float, int]:
        share = each.share
        return _RANKS.index(each.verdict), -math.inf if math.isnan(share) else share, each.number

    return tuple(sorted(verdicts, key=badness))


def _verdicts(study: Study, folder: Path, table: RunTable) -> Iterator[CaseVerdict]:
    definition = table.header.definition
    conditions = [variable.name for variable in definition.variables if variable.role == Role.CONDITION]
    units = {metric.name: metric.unit for metric in definition.metrics}
    for row, request in enumerate(table.requests()):
        values = [float(request.point[name]) for name in conditions if name in request.point]
        case = case_label(definition, values) or "the bench as it is"
        for requirement in study.bench.requirements:
            measured = requirement.of or requirement.metric
            done = bool(table.done[row])
            yield CaseVerdict(
                request.configuration,
                study.name,
                case,
                requirement.name,
                requirement.title or requirement.name,
                Verdict.FAILED_TO_RUN if not done else VERDICTS[table.verdicts(requirement.name)[row]],
                float(table.metric(measured)[row]),
                _bound(table, row, requirement, "at_least", requirement.at_least),
                _bound(table, row, requirement, "at_most", requirement.at_most),
                float(table.margins(requirement.name)[row]),
                units[measured],
                folder,
                request.number,
                "" if done else table.problems[row] or "failed to run",
            )


def _bound(table: RunTable, row: int, requirement: Requirement, key: str, given: float | None) -> float:
    """The bound *key* in this run, SI: *given*, or the metric that computes it; NaN if there is none."""
    if not requirement.of:
        return math.nan if given is None else given
    name = bound_of(requirement.name, key)
    return float(table.metric(name)[row]) if name in table.header.metrics else math.nan
