"""What `run` and `explore` share: telling the terminal how far it is, and what came of it."""

from __future__ import annotations

import re
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

import typer

from dse.cli.arguments import Output
from dse.cli.choice import show_choice
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import (
    console,
    plain,
    plain_table,
    print_json,
    print_line,
    print_table,
    status_line,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dse.api import Explored, ExploreOptions, Plan, Progress, Results, Summary
    from dse.domain.study import Study


class Watched(TypedDict):
    """Who is told how far it is."""

    on_progress: Callable[[Progress], None]
    tell: Callable[[str], None]


_MOST_PROBLEMS, _MOST_NUMBERS = 5, 4
_MOST_LOOKED_AT = 20_000
"""Runs that can be looked at in a second or two."""
_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


@contextmanager
def progress_shown(folder: Path) -> Iterator[Watched]:
    """What exploring into *folder* is to be told to: its steps in words, and then its runs on a progress bar.

    Ctrl-C ends it with what was stored.
    """
    from dse.api import ExplorationInterruptedError, progress_bar

    try:
        with ExitStack() as waiting, progress_bar(console(stderr=True)) as show:
            tell = waiting.enter_context(status_line())

            def advance(progress: Progress) -> None:
                waiting.close()
                show(progress)

            yield {"on_progress": advance, "tell": tell}
    except ExplorationInterruptedError as stop:
        raise KeyboardInterrupt(f"{folder}: {stop}") from None


def explore_and_show(study: Study, folder: Path, options: ExploreOptions, *, gate: bool) -> None:
    """Explore *study* into *folder* with a progress bar, say what came of it, and exit as it deserves."""
    from dse.api import Results, explore_into

    def show_changes(plan: Plan) -> None:
        for line in _plan_lines(plan):
            print_line(line, stderr=True)

    with progress_shown(folder) as watched:
        explored = explore_into(study, folder, options, on_changes=show_changes, **watched)
    results = Results(options.folder(folder), explored)
    summary = results.summary
    _show_outcome(results, summary, explored)
    following = f"dse report {folder}; in sentences: dse findings {folder}"
    if options.shard:
        following = f"dse merge {folder}"
    elif summary.finished <= _MOST_LOOKED_AT:
        show_choice(results.choice(), results.definition, briefly=True)
    if summary.unsettled:
        print_line("to try failed runs again: the same command with --retry-failed")
    print_line(f"next: {following}")
    failed = summary.unsettled or (gate and not summary.is_passed)
    raise typer.Exit(RUNS_FAILED if failed else DONE)


def show_plan(study: Study, folder: Path, options: ExploreOptions, form: Output) -> None:
    """Print what exploring *study* into *folder* would do."""
    from dataclasses import asdict

    from dse.api import plan_into

    with status_line() as tell:
        plan = plan_into(study, folder, options, tell=tell)
    if form is Output.JSON:
        print_json(asdict(plan))
        return
    print_line(f"{folder}: {plan.runs} runs, configurations: {plan.configurations}")
    for line in _plan_lines(plan):
        print_line(line)


def _plan_lines(plan: Plan) -> Iterator[str]:
    simulated = f"{plan.missing}, configurations: {plan.simulated}" if plan.missing else "0"
    if plan.open_ended:
        simulated += "; then the sampler may ask for more"
    told = {
        "changed": ", ".join(plan.changes),
        "stay in the folder": str(plan.there),
        "made before, in the cache": str(plan.known),
        "to be simulated": simulated,
        "again for their waveforms": str(plan.again or ""),
        "that takes": "" if plan.seconds == 0 else "unknown" if plan.seconds is None else _duration(plan.seconds),
    }
    yield from (f"  {what:<27}{how}" for what, how in told.items() if how)


def _duration(seconds: float) -> str:
    from datetime import timedelta

    return "less than a second" if seconds < 1 else f"about {timedelta(seconds=round(seconds))}"


def _show_outcome(results: Results, summary: Summary, explored: Explored) -> None:
    """The counts of verdicts, and the problems of runs."""
    from dse.api import requirement_labels

    screen, folder = console(), results.folder
    what = f"{summary.finished} runs, {explored.new} of them new"
    if explored.taken:
        what += f", {explored.taken} made before and taken from the cache"
    if not explored.new:
        what = f"all {summary.finished} runs were there"
    if explored.again:
        what += f", {explored.again} made again for their waveforms"
    if explored.damaged:
        what += f"; waveforms of {explored.damaged} runs were gone or damaged"
    if explored.extended:
        what += f"; the study was extended, its {explored.before} runs are kept"
    screen.print(f"{folder}: {what}", soft_wrap=True)
    for what in results.definition.ignored[:_MOST_PROBLEMS]:
        screen.print(f"  ignored: {plain(what)}", soft_wrap=True)
    for remark in explored.remarks:
        screen.print(f"  {plain(remark)}", soft_wrap=True)
    if summary.verdicts:
        named = requirement_labels(results.definition)
        verdicts = tuple(next(iter(summary.verdicts.values())))
        shown = plain_table("requirement", *verdicts, right=verdicts)
        for name in summary.verdicts:
            shown.add_row(named[name], *summary.counts(name).values())
        print_table(shown)
    if summary.draws:
        screen.print(plain(summary.draws), soft_wrap=True)
    if summary.checked:
        doubtful = sum(sum(counts.values()) for counts in summary.doubtful.values())
        what = f"{doubtful} verdicts doubtful" if doubtful else "no verdict doubtful"
        screen.print(f"{summary.checked} runs checked with finer numerics: {what}", soft_wrap=True)
    said = outcome_text(summary)
    for line in said[:_MOST_PROBLEMS]:
        screen.print(f"  {plain(line)}", soft_wrap=True)
    if len(said) > _MOST_PROBLEMS:
        screen.print(f"  and {len(said) - _MOST_PROBLEMS} other problems: dse results {folder}", soft_wrap=True)


def outcome_text(summary: Summary) -> list[str]:
    """What runs have to say, those with the same words but for numbers together; and what was tried twice."""
    groups: dict[tuple[str, str], list[int]] = {}
    for number, problem in summary.problems.items():
        kind = "failed: " if number in summary.failures else ""
        groups.setdefault((kind, _NUMBER.sub("", problem)), []).append(number)
    said = [f"{_runs(numbers)} {kind}{summary.problems[numbers[0]]}" for (kind, _), numbers in groups.items()]
    others: dict[tuple[str, str], list[int]] = {}
    for number, cause in summary.causes.items():
        words = _NUMBER.sub("", cause)
        if number not in summary.failures:
            others.setdefault(("came right the second time; the first", words), []).append(number)
        elif words != _NUMBER.sub("", summary.problems.get(number, "")):
            others.setdefault(("failed otherwise the first time", words), []).append(number)
    said += [f"{_runs(numbers)} {kind}: {summary.causes[numbers[0]]}" for (kind, _), numbers in others.items()]
    remarks: dict[str, list[int]] = {}
    for number, remark in summary.remarks.items():
        remarks.setdefault(_NUMBER.sub("", remark), []).append(number)
    return said + [f"{_runs(numbers)} checked: {summary.remarks[numbers[0]]}" for numbers in remarks.values()]


def _runs(numbers: list[int]) -> str:
    if len(numbers) == 1:
        return f"run {numbers[0]}"
    shown = ", ".join(str(number) for number in numbers[:_MOST_NUMBERS])
    more = ", …" if len(numbers) > _MOST_NUMBERS else ""
    return f"{len(numbers)} runs ({shown}{more})"
