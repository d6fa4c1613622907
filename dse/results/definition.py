"""Whether the stored definition of a study is shaped as the definition of a study must be."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from dse.units import UnitError, parse_unit

_NUMBER = (int, float)
_OPTIONAL_NUMBER = (int, float, type(None))
_OPTIONAL_TEXT = (str, type(None))

_LEAST = {
    "variables": [{"name": str}],
    "metrics": [{"name": str}],
    "requirements": [{"name": str}],
    "configurations": [{"id": str}],
}
"""What the tables are laid out by. A dict names entries that must be there, a list holds any number of its entry."""

_NUMBERS, _TEXTS = {"*": _NUMBER}, {"*": str}
"""Objects with any keys."""

_WHOLE = {
    "study": str,
    "title": str,
    "dse": str,
    "bench": {"name": str},
    "design": {"name": str, "places": [str]},
    "variables": [
        {
            "name": str,
            "title": str,
            "unit": str,
            "low": _NUMBER,
            "high": _NUMBER,
            "levels": int,
            "nominal": _NUMBER,
        }
    ],
    "sampler": {"kind": str},
    "seed": _NUMBER,
    "metrics": [{"name": str, "title": str, "unit": str, "expression": str}],
    "requirements": [
        {
            "name": str,
            "title": str,
            "metric": str,
            "unit": str,
            "at_most": _OPTIONAL_NUMBER,
            "at_least": _OPTIONAL_NUMBER,
            "exercised_when": _OPTIONAL_TEXT,
        }
    ],
    "figures": [{"name": str, "title": str, "unit": str, "current": str, "target": _OPTIONAL_TEXT}],
    "simulation": {"stop": _NUMBER, "step": _NUMBER, "record_every": _NUMBER},
    "configurations": [
        {
            "id": str,
            "choices": _TEXTS,
            "components": _TEXTS,
            "totals": {"*": {"value": _NUMBER, "unit": str}},
            "constants": _NUMBERS,
            "wires": [str],
        }
    ],
    "fmus": _TEXTS,
}


def least_flaws(definition: object) -> list[str]:
    """What is wrong with *definition* for the tables: sections, names, and values that JSON or UTF-8 cannot carry."""
    flaws = list(_shape_flaws(definition, _LEAST, "definition"))
    if flaws or not isinstance(definition, Mapping):
        return flaws
    for section in _LEAST:
        key = "id" if section == "configurations" else "name"
        names = Counter(entry[key] for entry in definition[section])
        flaws += [f"definition.{section} lists '{name}' twice" for name, count in names.items() if count > 1]
    try:
        json.dumps(definition, ensure_ascii=False, allow_nan=False).encode()
    except (ValueError, RecursionError) as error:
        flaws.append(f"definition: {error}")
    return flaws


def whole_flaws(definition: Mapping[str, Any]) -> list[str]:
    """What is wrong with *definition* for showing the study or simulating it again; [] if nothing."""
    flaws = list(_shape_flaws(definition, _WHOLE, "definition"))
    return flaws or [*_sampler_flaws(definition["sampler"]), *_reference_flaws(definition), *_unit_flaws(definition)]


def _shape_flaws(value: object, shape: Any, at: str) -> Iterator[str]:
    if isinstance(shape, dict):
        if not isinstance(value, Mapping):
            yield f"{at} is no object"
            return
        for key in value if "*" in shape else shape:
            if key in value:
                yield from _shape_flaws(value[key], shape.get("*", shape.get(key)), f"{at}.{key}")
            else:
                yield f"{at} has no '{key}'"
    elif isinstance(shape, list):
        if not isinstance(value, Sequence) or isinstance(value, str):
            yield f"{at} is no list"
            return
        for number, entry in enumerate(value):
            yield from _shape_flaws(entry, shape[0], f"{at}[{number}]")
    elif not isinstance(value, shape) or (isinstance(value, bool) and shape is not bool):
        yield f"{at} is {json.dumps(value)[:40]}"


def _sampler_flaws(sampler: Mapping[str, Any]) -> Iterator[str]:
    match sampler["kind"]:
        case "full_factorial":
            yield from _shape_flaws(sampler, {"slices": [[str]]}, "definition.sampler")
        case "latin_hypercube":
            yield from _shape_flaws(sampler, {"samples": _NUMBER}, "definition.sampler")
        case kind:
            yield f"definition.sampler.kind is '{kind}'"


def _reference_flaws(definition: Mapping[str, Any]) -> Iterator[str]:
    metrics = {entry["name"] for entry in definition["metrics"]}
    for entry in definition["requirements"]:
        if entry["metric"] not in metrics:
            yield f"requirement '{entry['name']}' is on '{entry['metric']}', which is no metric"


def _unit_flaws(definition: Mapping[str, Any]) -> Iterator[str]:
    for section in ("variables", "metrics", "requirements", "figures"):
        for entry in definition[section]:
            try:
                parse_unit(entry["unit"])
            except UnitError as error:
                yield f"definition.{section}: {error}"
