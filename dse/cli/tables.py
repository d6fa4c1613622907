"""Tables of metrics and verdicts for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table

    from dse.domain.definition import StudyDefinition
    from dse.domain.run import Run

_STYLES = {"": "", "pass": "green", "fail": "red", "not exercised": "yellow", "failed to run": "bold red"}


def run_data(run: Run) -> dict[str, Any]:
    """A run as data for `print_json`: metrics in SI, verdicts with their margins; numbers may be NaN or infinite."""
    return {
        "configuration": run.request.configuration,
        "point": dict(run.request.point),
        "outcome": str(run.outcome),
        "problem": run.problem,
        "metrics": dict(run.metrics),
        "requirements": {j.requirement: {"verdict": str(j.verdict), "margin": j.margin} for j in run.judgements},
    }


def metric_table(run: Run, definition: StudyDefinition) -> Table:
    """Every metric in its unit, with its error bar if it was checked, and the requirements if there are any."""
    from rich.table import Table
    from rich.text import Text

    from dse.api.showing.described import metric_rows

    table = Table(box=None, pad_edge=False, header_style="bold")
    headings = {"metric": "left", "value": "right"}
    judged = bool(definition.requirements)
    if judged:
        headings |= {"requirement": "left", "bound": "right", "margin": "right", "verdict": "left"}
    for heading, justify in headings.items():
        table.add_column(heading, justify=justify)  # type: ignore[arg-type]  # one of rich's words
    for row in metric_rows(run, definition):
        verdict = Text(row.verdict, style=_STYLES[row.verdict])
        table.add_row(row.title, row.value, *((row.requirement, row.bound, row.margin, verdict) if judged else ()))
    return table
