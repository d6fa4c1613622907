"""Tables of metrics and verdicts for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table

    from dse.domain.definition import DefinedRequirement, StudyDefinition
    from dse.domain.run import Run

_MOST_DIGITS = 10  # of a value with an error bar; a bar below them is rounding
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


def metric_table(run: Run, definition: StudyDefinition) -> Table:
    """Every metric in its unit, with its error bar if it was checked, and the requirements if there are any."""
    from rich.table import Table

    from dse.domain.run import ERROR_BAR

    table = Table(box=None, pad_edge=False, header_style="bold")
    headings = {"metric": "left", "value": "right"}
    if definition.requirements:
        headings |= {"requirement": "left", "bound": "right", "margin": "right", "verdict": "left"}
    for heading, justify in headings.items():
        table.add_column(heading, justify=justify)  # type: ignore[arg-type]  # one of rich's words
    for metric in definition.metrics:
        if metric.error_of:
            continue
        rows: list[DefinedRequirement | None] = [r for r in definition.requirements if r.metric == metric.name]
        value = checked_quantity(
            run.metrics.get(metric.name, float("nan")), run.metrics.get(metric.name + ERROR_BAR), metric.unit
        )
        for number, requirement in enumerate(rows or [None]):
            head = (metric.title, value) if number == 0 else ("", "")
            table.add_row(*head, *(_judgement(run, requirement) if definition.requirements else ()))
    return table


def quantity(value: float, unit: str) -> str:
    """An SI number in *unit* as a person reads it; a dash where it is undefined."""
    from dse.units import parse_unit

    return f"{parse_unit(unit).from_si(value):.4g} {unit}".rstrip() if not math.isnan(value) else "–"


def checked_quantity(value: float, bar: float | None, unit: str) -> str:
    """As `quantity`, with an error bar of two digits if there is one, and the value to the bar's last digit."""
    from dse.units import parse_unit

    if bar is None or not math.isfinite(value):
        return quantity(value, unit)
    shown, size = parse_unit(unit).from_si(value), bar / float(parse_unit(unit).factor)
    if math.isnan(bar):
        return f"{shown:.4g} ± ? {unit}".rstrip()
    if not 0.0 < size < math.inf:
        return f"{shown:.4g} ± {'∞' if size else 0} {unit}".rstrip()
    decimals = 1 - math.floor(math.log10(size))
    digits = decimals + math.floor(math.log10(max(abs(shown), size))) + 1
    if decimals < 0 or digits > _MOST_DIGITS:
        return f"{shown:.{_MOST_DIGITS}g} ± {size:.2g} {unit}".rstrip()
    return f"{shown:.{decimals}f} ± {size:.{decimals}f} {unit}".rstrip()


def difference(value: float, unit: str) -> str:
    """A difference of SI numbers in *unit*: as `quantity`, but 20 degC are 20 K apart from 0 degC, not 293 K."""
    from dse.units import parse_unit

    if math.isnan(value):
        return "–"
    return f"{value / float(parse_unit(unit).factor):.4g} {unit}".rstrip()


def _judgement(run: Run, requirement: DefinedRequirement | None) -> tuple[Any, ...]:
    from rich.text import Text

    if requirement is None:
        return ("", "", "", "")
    judgement = next(j for j in run.judgements if j.requirement == requirement.name)
    unit = requirement.unit
    bounds = [
        f"{sign} {quantity(bound, unit)}"
        for bound, sign in ((requirement.at_most, "≤"), (requirement.at_least, "≥"))
        if bound is not None
    ]
    verdict = str(judgement.verdict)
    return (
        requirement.name,
        ", ".join(bounds),
        difference(judgement.margin, unit),
        Text(verdict, style=_STYLES[verdict]),
    )
