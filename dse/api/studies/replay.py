"""Simulating a run of a study again."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.lookup import workspace_of
from dse.api.studies.recorded_drives import is_drives
from dse.api.studies.run import Run
from dse.api.studies.trust import benches_near
from dse.errors import DseError, Location, fail

if TYPE_CHECKING:
    from dse.api.studies.exploration import OnChanged, Tell
    from dse.domain.bench import TestBench
    from dse.domain.definition import StudyDefinition


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
    stored: Run,
    *,
    source: str | Path | None = None,
    fmi: int = 2,
    tell: Tell | None = None,
    on_changed: OnChanged | None = None,
) -> Replay:
    """Simulate *stored* again and compare; its study is found in the workspace here, or in the file *source*.

    *on_changed* is called before it is simulated if something has changed since the study was made, with what.
    """
    from dse.api.studies.exploration import again
    from dse.domain.study import TESTBENCH, Selection
    from dse.storage import changed_results
    from dse.testbench import bench_study, with_values

    point = {name: value for name, value in stored.point.items() if name != TESTBENCH}
    first, *others = (with_values(bench, point) for bench in benches_of(stored.definition, source))
    study = replace(bench_study(first, Selection((stored.configuration,))), others=tuple(others))
    made, planned, changed = again(study, stored.definition, stored.noun, fmi, tell=tell, on_changed=on_changed)
    # Alone it has number 0 and its point is the bench's own.
    made = replace(made, request=stored.noun.request)
    return Replay(
        Run(made, replace(planned.definition, variables=stored.definition.variables)),
        stored,
        tuple(changed_results(stored.noun, made)),
        changed,
    )


def benches_of(definition: StudyDefinition, source: str | Path | None) -> tuple[TestBench, ...]:
    """The benches of the study, found by its name in the workspace around the current folder, or in *source*.

    Raises DseError, also if that workspace lies in a study folder and is not trusted.
    """
    if is_drives(definition):
        what = f"'{definition.title}' is a study of drives: who drove is in its recordings"
        raise fail(what, Location(definition.study), "make them again and compare: dse drives DIR --check")
    if not source:
        return benches_near(definition, Path())
    name = str(source)
    workspace = workspace_of(name)
    return workspace.study(name).benches if definition.variables else (workspace.bench(name),)
