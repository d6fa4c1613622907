"""Writes the next study: a study's file with narrower ranges and fewer configurations."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from dse.domain.sampler import DesignVariable
from dse.errors import fail
from dse.formats import write_file, write_text
from dse.units import Unit


def write_narrowed(
    data: Mapping[str, Any],
    name: str,
    variables: Sequence[DesignVariable],
    ranges: Mapping[str, tuple[float, float]],
    configurations: Sequence[str] | str | None,
    sampler: Mapping[str, Any] | None,
) -> str:
    """The study file whose content is *data* as one called *name*.

    Of its *variables* those in *ranges* (SI) are narrowed. *configurations* are ids, or a condition; None for those of
    the file. *sampler* takes the place of the file's. Raises DseError if a variable is left without a value.
    """
    entries = {key: dict(value) for key, value in data["design_variables"].items()} if ranges else {}
    for variable in variables:
        if variable.name in ranges and variable.name in entries:
            entries[variable.name] = _narrowed(entries[variable.name], variable, *ranges[variable.name])
    changed = {**data, "study": name, **({"design_variables": entries} if entries else {})}
    if configurations is not None:
        is_condition = isinstance(configurations, str)
        changed["configurations"] = {"where": configurations} if is_condition else list(configurations)
    if sampler is not None:
        changed["sampler"] = dict(sampler)
    order = ["study", "title", "testbench", "configurations"]
    ordered = {key: changed[key] for key in [*order, *changed] if key in changed}
    return write_file({key: _written(value) for key, value in ordered.items()})


def _narrowed(entry: dict[str, Any], variable: DesignVariable, low: float, high: float) -> dict[str, Any]:
    kept = {key: value for key, value in entry.items() if key not in ("range", "values", "nominal")}
    if variable.low <= variable.nominal <= variable.high and low <= variable.nominal <= high and "nominal" in entry:
        kept["nominal"] = entry["nominal"]
    if not variable.values:
        return {"range": [_shown(value, variable.unit) for value in (low, high)], **kept}
    values = [value for value in variable.values if low <= value <= high]
    if not values:
        raise fail(f"'{variable.name}' has no value left between {low:g} and {high:g}", variable.where)
    kept.pop("levels", None)
    return {"values": [_shown(value, variable.unit) for value in values], **kept}


def _shown(value: float, unit: Unit) -> str:
    near = unit.from_si(value)
    text = f"{near:.6g}"
    return f"{text} {unit}".rstrip() if unit.symbol else text


def _written(value: Any) -> Any:
    """What `write_file` takes: what stands in a mapping one entry a line, each in one line."""
    if isinstance(value, Mapping):
        return {key: _flow(entry) for key, entry in value.items()}
    return _flow(value)


def _flow(value: Any) -> str:
    match value:
        case bool():
            return str(value).lower()
        case int() | float():
            return repr(value)
        case str():
            return write_text(value) if not _reads_as_number(value) else value
        case list():
            return f"[{', '.join(map(_flow, value))}]"
        case Mapping():
            return f"{{{', '.join(f'{write_text(str(key))}: {_flow(entry)}' for key, entry in value.items())}}}"
    return json.dumps(value)


def _reads_as_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
