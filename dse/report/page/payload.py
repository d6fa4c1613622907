"""ReportContent as the page reads it: a JSON document, and two blocks of numbers beside it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.definition import to_json
from dse.report.charts.chart import Axis, Chart, Drawn, Limits, Points, Rule, limits, values_of
from dse.report.content.data import Draws, FigureSpec, ReportContent, SamplerKind
from dse.report.content.insight import Insight
from dse.report.figure import ShownFigure
from dse.report.interpolation.radial import MOST_CENTRES, radial_fields
from dse.report.page.designs import designs_of
from dse.report.page.encoding import Block, quantise, second_differences
from dse.report.page.provenance import notes_of

Json = dict[str, object]


@dataclass(frozen=True, slots=True)
class Payload:
    """*document* is JSON that is safe inside a script element; *columns* and *waveforms* are base64."""

    document: str
    columns: str
    waveforms: str


def payload_of(content: ReportContent, shown: Sequence[ShownFigure] = ()) -> Payload:
    """Everything the page needs, with the figures *shown*; the same content gives the same bytes."""
    columns, waveforms = Block(), Block()
    document = _document(content)
    _add_runs(content, columns)
    document |= designs_of(content, columns)
    figures = [_add_figure(figure, index, columns, waveforms) for index, figure in enumerate(content.figures)]
    document["figures"] = figures
    document["facts"] = [*([k, v] for k, v in content.facts), *_storage_facts(content, figures)]
    if content.sampler is SamplerKind.SCATTERED and len(content.variables) >= 2:
        document["radial"] = [_add_radial(content, index, columns) for index in range(len(content.configurations))]
    document["charted"] = [_charted(figure, f"chart.{index}", columns) for index, figure in enumerate(shown)]
    if content.insight is not None:
        document["insight"] = insight_json(content.insight, columns)
        document["missing"] = [problem.what for problem in content.missing]
    document |= notes_of(content)
    if content.scenes is not None:
        document["scenes"] = {"study": content.scenes.study, "made": content.scenes.made}
    document["drawn"] = _add_draws(content, content.draws, columns) if content.draws else None
    document["columns"] = columns.directory
    document["waveforms"] = waveforms.directory
    return Payload(script_json(document), columns.text(), waveforms.text())


def _document(content: ReportContent) -> Json:
    metrics = [metric.name for metric in content.metrics]
    variables = [variable.name for variable in content.variables]
    return {
        "title": content.title,
        "sampler": str(content.sampler),
        "runs": len(content.runs),
        "mostCentres": MOST_CENTRES,
        "variables": [
            {
                "name": v.name,
                "title": v.title or v.name,
                "unit": v.unit_symbol,
                "low": v.low,
                "high": v.high,
                "nominal": v.nominal,
                "levels": v.levels or 0,
                "lack": v.lack,
                "labels": v.labels,
                "apart": () if v.labels else v.apart,
                "log": v.log,
                "role": str(v.role),
            }
            for v in content.variables
        ],
        "metrics": [
            {"name": m.name, "title": m.title or m.name, "unit": m.unit_symbol, "checked": m.error is not None}
            for m in content.metrics
        ],
        "requirements": [
            {
                "name": r.name,
                "title": r.title or r.name,
                "metric": metrics.index(r.metric),
                "atMost": r.at_most,
                "atLeast": r.at_least,
                "metIn": r.met_in,
                "level": r.level,
                "origin": r.origin,
            }
            for r in content.requirements
        ],
        "configurations": [
            {"id": c.id, "choices": list(c.choices.items()), "noisy": c.noisy, "allocations": to_json(c.allocations)}
            for c in content.configurations
        ],
        # One variable by itself spans no plane.
        "slices": [[variables.index(name) for name in names] for names in content.slices if len(names) > 1],
        "problems": [[row, text] for row, text in enumerate(content.runs.problems) if text],
    }


def _add_runs(content: ReportContent, block: Block) -> None:
    place = {entry.id: index for index, entry in enumerate(content.configurations)}
    block.add("number", "i4", content.runs.numbers)
    block.add("configuration", "i4", np.array([place[name] for name in content.runs.configurations], dtype=np.int32))
    block.add("done", "u1", content.runs.done)
    if content.runs.checked is not None:
        block.add("checked", "u1", content.runs.checked)
    for index, variable in enumerate(content.variables):
        block.add(f"variable.{index}", "f8", variable.values)
    for index, metric in enumerate(content.metrics):
        block.add(f"metric.{index}", "f8", metric.values)
        if metric.error is not None:
            block.add(f"error.{index}", "f8", metric.error)
    for index, requirement in enumerate(content.requirements):
        block.add(f"exercised.{index}", "u1", requirement.exercised)
        if requirement.unsettled is not None:
            block.add(f"unsettled.{index}", "u1", requirement.unsettled)
        if requirement.applies is not None:
            block.add(f"applies.{index}", "u1", requirement.applies)
        if requirement.draws is not None:
            block.add(f"draws.{index}", "f4", requirement.draws)


def _add_draws(content: ReportContent, draws: Draws, block: Block) -> list[int]:
    """The metrics that there are values of, by place."""
    metrics = [metric.name for metric in content.metrics]
    block.add("drawn.row", "i4", draws.rows)
    block.add("drawn.draw", "i4", draws.draws)
    for index, flags in enumerate(draws.judged):
        block.add(f"drawn.judged.{index}", "u1", flags)
    for name, values in zip(draws.metrics, draws.values, strict=True):
        block.add(f"drawn.value.{metrics.index(name)}", "f8", values)
    return [metrics.index(name) for name in draws.metrics]


def _add_figure(figure: FigureSpec, index: int, columns: Block, waveforms: Block) -> Json:
    columns.add(f"figure.{index}.time", "f8", figure.time)
    columns.add(f"figure.{index}.kept", "i4", figure.kept)
    error = _add_waveforms(f"figure.{index}.current", figure.current, columns, waveforms)
    shape = "none"
    if figure.target is not None and figure.target.ndim == 1:
        shape = "constant"
        columns.add(f"figure.{index}.target", "f8", figure.target)
    elif figure.target is not None:
        shape = "waveform"
        error = max(error, _add_waveforms(f"figure.{index}.target", figure.target, columns, waveforms))
    return {
        "name": figure.name,
        "title": figure.title or figure.name,
        "unit": figure.unit_symbol,
        "current": figure.current_label,
        "target": figure.target_label or "target",
        "shape": shape,
        "error": error,
    }


def _add_waveforms(name: str, values: NDArray[np.floating], columns: Block, waveforms: Block) -> float:
    quantised = quantise(values)
    columns.add(f"{name}.low", "f8", quantised.low)
    columns.add(f"{name}.high", "f8", quantised.high)
    waveforms.add(name, "u2", second_differences(quantised.codes))
    return quantised.error


def _charted(figure: ShownFigure, place: str, block: Block) -> Json:
    return {
        "title": figure.title,
        "problem": figure.problem.what if figure.problem else "",
        "charts": [_add_chart(chart, f"{place}.{index}", block) for index, chart in enumerate(figure.charts)],
    }


def _add_chart(chart: Chart, place: str, block: Block) -> Json:
    x_limits, y_limits = limits(chart)
    return {
        "name": chart.name,
        "title": chart.title,
        "note": chart.note,
        "x": _axis(chart.x, x_limits),
        "y": _axis(chart.y, y_limits),
        "drawn": [_add_drawn(drawn, f"{place}.{index}", block) for index, drawn in enumerate(chart.drawn)],
    }


def _axis(axis: Axis, ends: Limits) -> Json:
    low, high = ends
    names = list(axis.names)
    return {"title": axis.label, "unit": axis.unit, "log": bool(axis.log), "low": low, "high": high, "names": names}


def _add_drawn(drawn: Drawn, place: str, block: Block) -> Json:
    entry: Json = {"kind": type(drawn).__name__.lower(), "label": drawn.label}
    if isinstance(drawn, Rule):
        return {**entry, "axis": drawn.axis, "value": drawn.value}
    for name, _, values in values_of(drawn):
        block.add(f"{place}.{name}", "f8", values)
    if isinstance(drawn, Points):
        block.add(f"{place}.runs", "i4", drawn.runs)
        entry["verdict"] = None if drawn.verdict is None else int(drawn.verdict)
    return entry


def _add_radial(content: ReportContent, index: int, block: Block) -> bool:
    fields = radial_fields(content, content.configurations[index].id)
    if fields is None:
        return False
    block.add(f"radial.{index}.centres", "i4", fields.centres)
    block.add(f"radial.{index}.weights", "f4", fields.weights)
    block.add(f"radial.{index}.middle", "f8", fields.middle)
    block.add(f"radial.{index}.spread", "f8", fields.spread)
    return True


def _storage_facts(content: ReportContent, figures: list[Json]) -> list[list[str]]:
    return [
        [
            f"waveform '{figure.title or figure.name}' in this page",
            f"{len(figure.kept)} of {len(content.runs)} runs, 16-bit steps, "
            f"largest error {entry['error']:.1g} {figure.unit_symbol}".rstrip(),
        ]
        for figure, entry in zip(content.figures, figures, strict=True)
    ]


def script_json(document: Mapping[str, object]) -> str:
    """*document* as JSON that is safe inside a script element."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False, ensure_ascii=True)
    # Inside a script element only "</script" and "<!--" end or bend the text; without < neither can be spelt.
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


# An insight as the page reads it: its fields as they are called, arrays beside it in the block of numbers.


_KINDS = {"float32": "f4", "uint8": "u1"}


def insight_json(insight: Insight, block: Block) -> Any:
    """Plain data; an array is ``{"array": its name in *block*}``. Numbers have six digits, what is none is null."""
    return _plain(insight, "insight", block)


def _plain(value: Any, place: str, block: Block) -> Any:
    if is_dataclass(value):
        return {each.name: _plain(getattr(value, each.name), f"{place}.{each.name}", block) for each in fields(value)}
    if isinstance(value, tuple | list):
        return [_plain(each, f"{place}.{index}", block) for index, each in enumerate(value)]
    if isinstance(value, np.ndarray):
        block.add(place, _KINDS[value.dtype.name], value)
        return {"array": place}
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    if isinstance(value, Mapping):
        raise TypeError(f"{place} is a mapping, which has no order that the page could rely on")
    return str(value) if isinstance(value, str) else value
