"""Tables of metrics and verdicts for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.table import Table

    from dse.domain.run import Run

_STYLES = {"pass": "green", "fail": "red", "not exercised": "yellow", "failed to run": "bold red"}


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


def metric_table(run: Run, definition: Mapping[str, Any]) -> Table:
    """Every metric in its unit, with its error bar if it was checked, and the requirements on it."""
    from rich.table import Table

    from dse.domain.run import ERROR_BAR

    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading, justify in (("metric", "left"), ("value", "right"), ("requirement", "left"), ("bound", "right")):
        table.add_column(heading, justify=justify)  # type: ignore[arg-type]  # one of rich's words
    table.add_column("margin", justify="right")
    table.add_column("verdict")
    for metric in definition["metrics"]:
        if "error_of" in metric:
            continue
        rows = [r for r in definition["requirements"] if r["metric"] == metric["name"]] or [None]
        value = quantity(run.metrics.get(metric["name"], float("nan")), metric["unit"])
        bar = run.metrics.get(metric["name"] + ERROR_BAR)
        if bar is not None:
            value += f" ± {difference(bar, metric['unit'], digits=2)}"
        for number, requirement in enumerate(rows):
            head = (metric["title"], value) if number == 0 else ("", "")
            table.add_row(*head, *_judgement(run, requirement))
    return table


def quantity(value: float, unit: str) -> str:
    """An SI number in *unit* as a person reads it; a dash where it is undefined."""
    from dse.units import parse_unit

    if math.isnan(value):
        return "–"
    return f"{parse_unit(unit).from_si(value) if abs(value) != float('inf') else value:.4g} {unit}".rstrip()


def difference(value: float, unit: str, *, digits: int = 4) -> str:
    """A difference of SI numbers in *unit*: as `quantity`, but 20 degC are 20 K apart from 0 degC, not 293 K."""
    from dse.units import parse_unit

    if math.isnan(value):
        return "–"
    return f"{value / float(parse_unit(unit).factor):.{digits}g} {unit}".rstrip()


def _judgement(run: Run, requirement: Mapping[str, Any] | None) -> tuple[Any, ...]:
    from rich.text import Text

    if requirement is None:
        return ("", "", "", "")
    judgement = next(j for j in run.judgements if j.requirement == requirement["name"])
    unit = requirement["unit"]
    bounds = [
        f"{sign} {quantity(requirement[key], unit)}"
        for key, sign in (("at_most", "≤"), ("at_least", "≥"))
        if requirement[key] is not None
    ]
    verdict = str(judgement.verdict)
    return (
        requirement["name"],
        ", ".join(bounds),
        difference(judgement.margin, unit),
        Text(verdict, style=_STYLES[verdict]),
    )
