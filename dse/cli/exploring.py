"""What `run`, `explore`, `simulate` and `replay` share: exploring with a progress bar, and one run on its own."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from dse.cli.app import DONE, INTERRUPTED, RUNS_FAILED, console, plain

if TYPE_CHECKING:
    from dse.domain.definition import StudyDefinition
    from dse.domain.run import Run
    from dse.domain.study import Study
    from dse.results.table import RunTable
    from dse.testbench.plan import Plan

_MOST_PROBLEMS = 5


def explore_into(
    study: Study, folder: Path, *, workers: int, threads: int, version: int, fuse: bool, fresh: bool, gate: bool
) -> None:
    """Explore *study* into *folder* with a progress bar, say what came of it, and exit as it deserves."""
    from dse.cli.progress import progress_bar
    from dse.exploration.executors.local import Local
    from dse.exploration.explore import ExplorationInterruptedError, explore
    from dse.results.folder import StudyFolder

    planned = ready(study, version=version, fuse=fuse)
    if fresh:
        StudyFolder.discard(folder)
    with StudyFolder.resume(folder, planned.definition) as store:
        before = len(store.finished())
        try:
            with progress_bar() as show:
                summary = explore(
                    study,
                    planned.prepared,
                    store,
                    executor=Local(workers=workers, threads=threads),
                    on_progress=show,
                )
        except ExplorationInterruptedError as stop:
            console(stderr=True).print(f"{folder}: {stop}", soft_wrap=True)
            raise typer.Exit(INTERRUPTED) from None
        table = store.table()
    _say(folder, table, before, summary.simulated)
    raise typer.Exit(exit_code(table, gate=gate))


def run_alone(study: Study, *, version: int, fuse: bool = False) -> tuple[Run, StudyDefinition]:
    """The single run of *study*, made in a process of its own, with waveforms; and the study's definition."""
    from dse.exploration.executors.local import Local
    from dse.exploration.explore import explore
    from dse.results.folder import StudyFolder

    planned = ready(study, version=version, fuse=fuse)
    with (
        tempfile.TemporaryDirectory(prefix="dse-") as scratch,
        StudyFolder.create(Path(scratch) / "run", planned.definition) as store,
    ):
        explore(study, planned.prepared, store, executor=Local(workers=1))
        run = store.run(0)
    return run, planned.definition


def ready(study: Study, *, version: int, fuse: bool) -> Plan:
    """*study* with all that has to be built for it, the terminal told what is going on. Raises DseError."""
    from dse.testbench.fuse import fused_plan
    from dse.testbench.plan import plan

    with console(stderr=True).status("building FMUs, assembling configurations") as status:
        planned = plan(study, version=version)
        if not fuse:
            return planned
        status.update("fusing configurations")
        return fused_plan(planned, tell=lambda made, all_: status.update(f"fusing configurations: {made} of {all_}"))


def exit_code(table: RunTable, *, gate: bool) -> int:
    """3 if a run failed to run, or with *gate* if a requirement failed; else 0."""
    counts = verdict_counts(table)
    failed = bool((~table.done).any()) or (gate and any(count["fail"] for count in counts.values()))
    return RUNS_FAILED if failed else DONE


def verdict_counts(table: RunTable) -> dict[str, dict[str, int]]:
    """How often each verdict was given, by requirement."""
    from dse.results.rows import VERDICTS

    return {
        name: {str(verdict): int((table.verdicts(name) == code).sum()) for code, verdict in enumerate(VERDICTS)}
        for name in table.header.requirements
    }


def _say(folder: Path, table: RunTable, before: int, simulated: int) -> None:
    from rich.table import Table

    screen = console()
    made = len(table) - before
    again = max(0, simulated - made)
    what = f"{len(table)} runs, {made} of them new" if made else f"all {len(table)} runs were there"
    if again:
        what += f", {again} made again for their waveforms"
    screen.print(f"{folder}: {what}", soft_wrap=True)
    titles = {requirement.name: requirement.title for requirement in table.header.definition.requirements}
    counts = verdict_counts(table)
    if counts:
        shown = Table(box=None, pad_edge=False, header_style="bold")
        shown.add_column("requirement")
        for verdict in next(iter(counts.values())):
            shown.add_column(verdict, justify="right")
        for name, count in counts.items():
            label = name if titles[name] == name else f"{name} {titles[name]}"
            shown.add_row(label, *(str(number) for number in count.values()))
        screen.print(shown)
    said: dict[str, str] = {}
    for number, done, problem in zip(table.numbers.tolist(), table.done.tolist(), table.problems, strict=True):
        if problem:
            said.setdefault(problem, f"  run {number} {'' if done else 'failed: '}{plain(problem)}")
    for line in list(said.values())[:_MOST_PROBLEMS]:
        screen.print(line, soft_wrap=True)
    if len(said) > _MOST_PROBLEMS:
        screen.print(f"  and {len(said) - _MOST_PROBLEMS} other problems: dse results {folder}", soft_wrap=True)
    screen.print(f"next: dse report {folder}", soft_wrap=True)
