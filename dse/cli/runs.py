"""One run on the terminal, and its figures as a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import plain_table, print_json, print_line, print_some, print_table

if TYPE_CHECKING:
    from rich.table import Table

    from dse.api import Run

_STYLES = {"": "", "pass": "green", "fail": "red", "not exercised": "yellow", "failed to run": "bold red"}


def exit_code(run: Run, *, gate: bool) -> int:
    """Whether the run succeeded; with *gate* also, whether it meets its requirements for certain."""
    unmet = "fail" in run.verdicts.values() or "doubtful" in run.check.certainties.values()
    return RUNS_FAILED if not run.is_done or (gate and unmet) else DONE


def present_run(run: Run, output: str, plot: Path | None, units: str) -> None:
    """Print the run for a person, or as ``json`` in *units*, and draw its figures if a file for them is given."""
    ignored = run.definition.ignored
    if output == "json":
        print_json(_data(run, units) | ({"ignored": list(ignored)} if ignored else {}))
    else:
        print_some("ignored", ignored)
        _show(run)
    if plot is not None and not run.has_waveforms:
        print_line(f"{plot}: not drawn, the run has no waveforms", stderr=True)
    elif plot is not None:
        from dse.report import draw_run

        draw_run(run.noun, run.definition, plot)
        print_line(f"figures: {plot}")


def write_run(run: Run, target: Path) -> None:
    """Write the waveforms that the bench records, if the run has come to some."""
    if not run.has_waveforms or not len(run.waveforms):
        why = "the bench records nothing" if run.has_waveforms else "the run has no waveforms"
        print_line(f"{target}: not written, {why}", stderr=True)
        return
    run.waveforms.write(target, {"bench": run.definition.bench.name, "configuration": run.configuration})
    print_line(f"{target}: {len(run.waveforms)} waveforms of {len(run.waveforms.time)} points", stderr=True)


def metric_table(run: Run) -> Table:
    """Every metric in its unit, with its error bar if it was checked, and the requirements if there are any."""
    from rich.text import Text

    from dse.api import metric_rows

    judged = bool(run.definition.requirements)
    more = ("requirement", "bound", "margin", "verdict") if judged else ()
    table = plain_table("metric", "value", *more, right=("value", "bound", "margin"))
    for row in metric_rows(run.noun, run.definition, run.check):
        verdict = Text(row.judged, style=_STYLES[row.verdict])
        table.add_row(row.title, row.value, *((row.requirement, row.bound, row.margin, verdict) if judged else ()))
    return table


def _show(run: Run) -> None:
    """The configuration, the point, and every metric with its verdicts."""
    chosen = ", ".join(f"{place} {choice}" for place, choice in run.choices.items())
    print_line(run.definition.title, style="bold")
    print_line(f"configuration {run.configuration}{f': {chosen}' if chosen else ''}")
    if run.problem and not run.is_done:
        print_line(f"failed to run: {run.problem}", style="bold red")
    elif run.problem:
        print_line(run.problem, style="yellow")
    print_table(metric_table(run))


def _data(run: Run, units: str) -> dict[str, Any]:
    """The run as plain data, and if it was checked, whether its verdicts are certain."""
    data = run.as_data(units)
    for name, word in run.check.certainties.items():
        data["requirements"][name] |= {"certainty": str(word)} if word else {}
    return {key: value for key, value in data.items() if key != "run"}
