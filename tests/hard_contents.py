"""Contents of reports that are hard to show, with all that a report may have: conditions, choices, costs, waveforms."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from known_functions import even, study, variable
from report_pages import content_of

from dse.report.content.data import FigureSpec, Floats, Property, ReportContent
from dse.storage import RunTable

SCRIPT = '</script><img src=x onerror="window.pwned=1"><b>'
LONG = "\u202eRTL \u2067" + "W" * 10_000
UNEXERCISED = 0.25
"""Of the grip, below which no requirement is exercised."""


def driven(count: int = 96, *, variables: int = 2, title: Callable[[str], str] = str, **facts: object) -> RunTable:
    """Designs with two sensors, at two speeds and three grips; y is to be at most 0.9, z at most 0.4."""
    points = np.concatenate([even(count, variables, 0), np.zeros((count, 2))], axis=1)
    points[:, -2], points[:, -1] = np.arange(count) % 2, (np.arange(count) // 2 % 3) / 2
    names = [f"x{number + 1}" for number in range(variables)]
    inputs = (
        *(variable(name, title=title(f"gain {name}")) for name in names),
        variable("speed", title=title("lead speed"), role="condition", values=(0.0, 1.0)),
        variable("grip", title=title("friction"), role="condition", values=(0.0, 0.5, 1.0)),
    )
    values = {"y": points[:, 0] + points[:, -2] - 0.6 * points[:, -1], "z": points[:, 0] * points[:, 1]}
    choices = [{title("sensor"): title(("radar", "lidar")[i // 6 % 2])} for i in range(count)]
    asked = {"y": 0.9, "z": 0.4}
    exercised = points[:, -1] > UNEXERCISED
    return study(points, values, asked, variables=inputs, choices=choices, exercised=exercised, **facts)  # type: ignore[arg-type]  # any facts of a study


def furnished(table: RunTable, title: str = "made up", problem: str = "it broke") -> ReportContent:
    """With costs of configurations and a figure of waveforms."""
    content = content_of(table, title, problem)
    kept = np.flatnonzero(content.runs.done)
    time = np.linspace(0.0, 1.0, 5)
    lines = np.ones((len(kept), 1)) * time
    return dataclasses.replace(
        content,
        configurations=tuple(
            dataclasses.replace(one, properties={"cost": Property(100.0 * (1 + place), "EUR")})
            for place, one in enumerate(content.configurations)
        ),
        figures=(FigureSpec("gap", title, "m", title, None, time, kept, lines, None),) if len(kept) else (),
    )


def renamed(name: str) -> ReportContent:
    table = driven(title=lambda _: name, done=np.arange(96) % 9 > 0)
    content = furnished(table, name, name)
    return dataclasses.replace(
        content,
        variables=tuple(dataclasses.replace(one, unit_symbol=name) for one in content.variables),
        metrics=tuple(dataclasses.replace(one, title=name, unit_symbol=name) for one in content.metrics),
        requirements=tuple(dataclasses.replace(one, title=name) for one in content.requirements),
    )


def wild() -> ReportContent:
    content = furnished(driven())

    def spoilt(values: Floats, start: int) -> Floats:
        values = values.copy()
        values[start : start + 32] = np.repeat([np.nan, np.inf, -np.inf, 1e300], 8)
        return values

    metrics = tuple(dataclasses.replace(m, values=spoilt(m.values, 16 * i)) for i, m in enumerate(content.metrics))
    return dataclasses.replace(content, metrics=metrics)


def crowded() -> ReportContent:
    content = furnished(driven(240, variables=28))
    first = content.requirements[0]
    several = tuple(dataclasses.replace(first, name=f"R{k}", title=f"level {k}", at_most=0.3 * k) for k in range(1, 6))
    assert content.insight is not None
    asked = dataclasses.replace(content.insight.asked, exercised=("",) * 5)
    return dataclasses.replace(
        content, requirements=several, insight=dataclasses.replace(content.insight, asked=asked, chances=(), told=())
    )


CONTENTS: dict[str, Callable[[], ReportContent]] = {
    "usual": lambda: furnished(driven()),
    "names that are scripts": lambda: renamed(SCRIPT),
    "names of ten thousand letters": lambda: renamed(LONG),
    "no numbers": wild,
    "no run": lambda: furnished(driven(0)),
    "one run": lambda: furnished(driven(1)),
    "all failed": lambda: furnished(driven(done=np.zeros(96, dtype=bool))),
    "thirty variables": crowded,
}
