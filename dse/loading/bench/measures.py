"""Reads metrics and requirements."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

from pydantic import Field

from dse.domain.bench import ALL_BUT_FEW, Metric, Requirement, Trace, bound_of, margin_of
from dse.domain.expression import Expression, Name
from dse.errors import DseError, Location, Problems, closest, fail, raise_if_any
from dse.expression import descend, parse_expression
from dse.formats import Entry
from dse.loading.names import check_name
from dse.loading.sections import Plain, Section
from dse.loading.values import read_number, read_quantity, read_unit
from dse.units import DIMENSIONLESS, Unit

_OVER = "write it as [10 s, 40 s], or [10 s, end]"


class MetricSection(Section):
    """A metric with a title, display unit or window; plain text is the expression alone."""

    expression: str
    unit: str | None = None
    title: str = ""
    over: list[Plain] | Plain | None = None


class RequirementSection(Section):
    """A bound on a metric."""

    metric: str
    title: str = ""
    at_most: Plain | None = None
    at_least: Plain | None = None
    exercised_when: str | None = None
    met_in: Plain = ALL_BUT_FEW
    on: str | list[str] = Field(default_factory=list)
    text: str = ""
    source: str = ""
    rationale: str = ""
    severity: str = ""


def read_metrics(
    entries: Entry,
    sections: Mapping[str, str | MetricSection],
    stop: float,
    numbered: Callable[[str, Location], str],
    problems: Problems,
) -> tuple[Metric, ...]:
    """The metrics at *entries* of runs until *stop*, in seconds. *numbered* puts numbers for names of elements."""
    metrics = []
    for name, written in sections.items():
        entry = entries[name]
        check_name(name, entry.key, problems)
        if name == "time":
            problems.add("in metrics 'time' is the simulation time", entry.key, "rename the metric")
        with problems:
            if isinstance(written, str):
                metrics.append(Metric(name, parse_expression(numbered(written, entry.where), entry.origin)))
            else:
                unit = read_unit(written.unit or "", entry["unit"].where)
                text = numbered(written.expression, entry["expression"].where)
                expression = parse_expression(text, entry["expression"].origin)
                over = None if written.over is None else _window(entry["over"], written.over, stop)
                metrics.append(Metric(name, expression, unit, written.title, over))
    return tuple(metrics)


def _window(entry: Entry, written: list[Plain] | Plain, stop: float) -> tuple[float, float]:
    """The window of a metric, in seconds, of a run until *stop*. Raises DseError if it is not within the run."""
    if not isinstance(written, list) or len(written) != 2:
        raise fail("'over' needs a start and an end", entry.where, _OVER)
    second = read_unit("s", entry.where)
    ends = (stop if text == "end" else read_number(text, second, entry[at].where) for at, text in enumerate(written))
    start, end = ends
    shown = f"the window [{written[0]}, {written[1]}]"
    if start < 0.0 or end > stop * (1 + 1e-9):
        what = f"{shown} is not within the run, which is from 0 s to {stop:g} s"
        raise fail(what, entry.where, "end it with 'end', or simulate for longer ('stop')")
    if not start < end:
        raise fail(f"{shown} does not end after its start", entry.where, _OVER)
    return start, end


def read_requirements(
    entries: Entry,
    sections: Mapping[str, RequirementSection],
    names: Collection[str],
    metrics: Sequence[Metric],
    problems: Problems,
) -> tuple[tuple[Requirement, ...], tuple[Metric, ...]]:
    """The requirements at *entries* on metrics of these *names*, of which *metrics* could be read.

    A bound that varies from run to run is a metric, and so is the margin to it: these metrics are returned as well.
    """
    known = {metric.name: metric for metric in metrics}
    requirements: list[Requirement] = []
    computed: list[Metric] = []
    for name, section in sections.items():
        with problems:
            requirement, bounds = _requirement(entries[name], section, names)
            if bounds:
                of = known.get(requirement.metric)
                more = _margin(requirement, bounds, of.unit if of else DIMENSIONLESS)
                for metric in more:
                    if metric.name in names:
                        raise fail(f"'{metric.name}' is computed for '{name}'", entries[name].key, "rename the metric")
                computed += more
                requirement = replace(
                    requirement, metric=margin_of(name), at_least=0.0, at_most=None, of=section.metric
                )
            requirements.append(requirement)
    return tuple(requirements), tuple(computed)


def _margin(requirement: Requirement, bounds: Mapping[str, Expression], unit: Unit) -> list[Metric]:
    """The bounds of *requirement* that vary, and the margin to all its bounds, as metrics."""
    title, name, value = requirement.title or requirement.name, requirement.name, requirement.metric
    shown = {"at_most": "most", "at_least": "least"}
    found = [
        Metric(bound_of(name, key), bound, unit, f"At {shown[key]}, for: {title}") for key, bound in bounds.items()
    ]
    parts = [f"{bound_of(name, 'at_most')} - {value}"] if "at_most" in bounds else []
    parts += [f"{value} - {bound_of(name, 'at_least')}"] if "at_least" in bounds else []
    text = parts[0] if len(parts) == 1 else f"min({', '.join(parts)})"
    return [*found, Metric(margin_of(name), parse_expression(text, requirement.where), unit, f"Margin of: {title}")]


def _requirement(
    entry: Entry, section: RequirementSection, metrics: Collection[str]
) -> tuple[Requirement, Mapping[str, Expression]]:
    """A requirement, and its bounds if they vary. Raises DseError."""
    name = entry.name
    problems = Problems()
    check_name(name, entry.key, problems)
    if section.metric not in metrics:
        problems.add(f"unknown metric '{section.metric}'", entry["metric"].where, closest(section.metric, metrics))
    if section.at_most is None and section.at_least is None:
        problems.add(f"requirement '{name}' has no bound", entry.key, "give at_most or at_least")
    bounds: dict[str, float] = {}
    varying: dict[str, Expression] = {}
    unit: Unit | None = None
    for key, raw in (("at_most", section.at_most), ("at_least", section.at_least)):
        if raw is not None and (expression := _varying(raw, entry[key])) is not None:
            varying[key] = expression
        elif raw is not None:
            quantity = read_quantity(raw, entry[key].where)
            if unit is not None and unit.dimension != quantity.unit.dimension:
                problems.add(f"the bounds of '{name}' have different units", entry[key].where)
            bounds[key], unit = float(quantity.si), quantity.unit
    if len(bounds) == 2 and bounds["at_least"] > bounds["at_most"]:
        what = f"the range of '{name}' is empty: at_least {section.at_least} > at_most {section.at_most}"
        problems.add(what, entry["at_least"].where)
    if bounds and varying:
        problems.add(f"one bound of '{name}' varies, the other does not", entry.key, "write two requirements")
    condition = None
    if section.exercised_when is not None:
        condition = parse_expression(section.exercised_when, entry["exercised_when"].origin)
    share = read_number(section.met_in, DIMENSIONLESS, entry["met_in"].where)
    if not 0 < share <= 1:
        problems.add(
            f"met_in must be more than 0 and at most 100 %, not {section.met_in}", entry["met_in"].where, "95 %"
        )
    raise_if_any(problems)
    found = Requirement(
        name,
        section.metric,
        bounds.get("at_most"),
        bounds.get("at_least"),
        unit or DIMENSIONLESS,
        condition,
        section.title,
        entry.key,
        share,
        Trace(section.text, section.source, section.rationale, section.severity),
    )
    return found, varying


def _varying(raw: Plain, entry: Entry) -> Expression | None:
    """The bound *raw* if it is an expression in metrics and constants of the run; None for a quantity."""
    try:
        read_quantity(raw, entry.where)
    except DseError:
        with suppress(DseError):
            found = parse_expression(str(raw), entry.origin)
            if any(isinstance(node, Name) for node in descend(found.root)):
                return found
    return None
