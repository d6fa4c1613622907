"""Simulating a run of a study again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.naming import workspace_of
from dse.api.run import Run
from dse.errors import DseError, Location, fail

if TYPE_CHECKING:
    from dse.api.results import Results
    from dse.domain.definition import StudyDefinition
    from dse.domain.study import Study
    from dse.testbench.study import PreparedStudy


@dataclass(frozen=True, slots=True)
class Replay:
    """*run* was simulated from what the workspace has now, with the number and point it is *stored* with.

    *different* are the results that are not the same bit for bit, *changed* the inputs that changed since.
    """

    run: Run
    stored: Run
    different: tuple[str, ...]
    changed: tuple[str, ...]

    @property
    def is_same(self) -> bool:
        """Whether the same came of the same."""
        return not (self.different or self.changed)

    def problem(self, where: str) -> DseError | None:
        """What is wrong, of a study that is called *where*; None if nothing is."""
        number, causes = self.run.number, ", ".join(self.changed)
        if self.different:
            why = f"changed since: {causes}" if causes else "dse or this machine have changed since"
            what = f"run {number} did not give the same again: {', '.join(self.different)}"
            return fail(what, Location(where), f"{why}; explore again")
        if self.changed:
            what = f"run {number} gave the same, but not from the same: {causes} changed since"
            hint = "explore again, or replay with the --fmi the study was explored with"
            return fail(what, Location(where), hint)
        return None


def replay(
    results: Results,
    number: int,
    *,
    source: str | Path | None = None,
    version: int = 2,
    prepare: Callable[[Study, int], PreparedStudy] | None = None,
) -> Replay:
    """Simulate run *number* again and compare; its study is found in the workspace here, or in the file *source*.

    *prepare* makes a study ready, for an FMI version, in place of `exploring.ready`.
    """
    from dse.api.exploring import alone, ready
    from dse.storage.difference import changes, differences

    stored = results.run(number)
    study = _single(_study(results.definition, source), stored)
    planned = prepare(study, version) if prepare else ready(study, version=version)
    # Alone it has number 0 and its point is the bench's own.
    again = replace(alone(planned), request=stored.noun.request)
    return Replay(
        Run(again, planned.definition),
        stored,
        tuple(differences(stored.noun, again)),
        tuple(changes(results.definition, planned.definition, stored.noun)),
    )


def _study(definition: StudyDefinition, source: str | Path | None) -> Study:
    """The study the folder came from, found by its name in the workspace around the current folder, or in *source*."""
    from dse.testbench.study import bench_study

    is_bench = not definition.variables
    name = str(source) if source else definition.bench.name if is_bench else definition.study
    workspace = workspace_of(name)
    return bench_study(workspace.bench(name)) if is_bench else workspace.study(name)


def _single(study: Study, stored: Run) -> Study:
    from dse.domain.study import Selection
    from dse.testbench.study import bench_study, with_values

    return bench_study(with_values(study.bench, stored.point), Selection((stored.configuration,)))
