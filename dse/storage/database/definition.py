"""The definition of a study as JSON: written with a format version, and read back as a noun or refused by name."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from dse.domain.definition import Json, StudyDefinition, to_json
from dse.units import UnitError, parse_unit

FORMAT = 2
"""Version of the stored definition. Format 1 had its samplers' options beside their kind and no *explored*."""


def definition_to_json(definition: StudyDefinition) -> dict[str, Json]:
    """*definition* as plain data."""
    return {"format": FORMAT, **to_json(definition)}


def definition_from_json(data: Json) -> StudyDefinition:
    """The definition that *data* holds, of this format or an earlier one. ValueError says what is wrong with it."""
    if not isinstance(data, Mapping):
        raise ValueError("definition is no object")  # noqa: TRY004  # what a file holds is wrong, not its caller
    version = data.get("format", 1)
    if version not in (1, FORMAT) or version is True:
        raise ValueError(f"definition.format is {json.dumps(version)[:40]}")
    if version == 1:
        data = _from_first(data)
    definition: StudyDefinition = _read(data, StudyDefinition, "definition")
    flaws = [*_flaws(definition)]
    if flaws:
        raise ValueError(flaws[0])
    return definition


def fingerprint(definition: StudyDefinition) -> str:
    """SHA-256 of the definition in canonical JSON: studies with equal fingerprints ask for the same runs and results.

    Which waveforms are kept does not matter: they can be added to a study later. Nor does what was ignored.
    """
    left_out = {"keep_waveforms", "ignored"}
    if definition.space:  # its configurations come as they are asked for
        left_out |= {"configurations", "fmus"}
    decisive = {key: value for key, value in definition_to_json(definition).items() if key not in left_out}
    text = json.dumps(decisive, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def read_noun(data: Json, shape: Any, at: str) -> Any:
    """The noun of type *shape* that *data* holds. ValueError names the place, from *at*, where it does not."""
    return _read(data, shape, at)


def unit_flaws(definition: StudyDefinition) -> Iterator[str]:
    """Units that cannot be read, as showing the study needs them."""
    for section in ("variables", "metrics", "requirements", "figures"):
        for entry in getattr(definition, section):
            try:
                parse_unit(entry.unit)
            except UnitError as error:
                yield f"definition.{section}: {error}"


def _flaws(definition: StudyDefinition) -> Iterator[str]:
    for section in ("variables", "metrics", "requirements", "configurations"):
        key = "id" if section == "configurations" else "name"
        names = Counter(getattr(entry, key) for entry in getattr(definition, section))
        yield from (f"definition.{section} lists '{name}' twice" for name, count in names.items() if count > 1)
    metrics = {metric.name for metric in definition.metrics}
    for requirement in definition.requirements:
        if requirement.metric not in metrics:
            yield f"requirement '{requirement.name}' is on '{requirement.metric}', which is no metric"
    for name in {*definition.explored} - {configuration.id for configuration in definition.configurations}:
        yield f"definition.explored names '{name}', which is no configuration"
    try:
        json.dumps(definition_to_json(definition), ensure_ascii=False, allow_nan=False).encode()
    except (ValueError, RecursionError) as error:
        yield f"definition: {error}"


def _from_first(data: Mapping[str, Any]) -> dict[str, Any]:
    """Format 1 as format 2. What is not shaped as format 1 was is left to be refused."""
    later = dict(data)
    if isinstance(sampler := data.get("sampler"), Mapping):
        options = {key: value for key, value in sampler.items() if key != "kind"}
        later["sampler"] = {"kind": sampler.get("kind"), "options": options, "slices": options.get("slices")}
    if isinstance(configurations := data.get("configurations"), list):
        later["configurations"] = [_start_by_name(entry) for entry in configurations]
        later["explored"] = [entry.get("id") for entry in configurations if isinstance(entry, Mapping)]
    return later


def _start_by_name(configuration: Json) -> Json:
    """Format 1 had start values in pairs."""
    if not isinstance(configuration, Mapping) or not isinstance(configuration.get("start"), Mapping):
        return configuration
    return {**configuration, "start": {name: dict(pairs) for name, pairs in configuration["start"].items()}}


def _read(value: Json, shape: Any, at: str) -> Any:
    """*value* as a *shape*: a frozen noun, or what its fields are annotated with. ValueError names the place."""
    if shape is Any:
        return value
    origin, arguments = get_origin(shape), get_args(shape)
    if origin in (Union, UnionType):
        if value is None and NoneType in arguments:
            return None
        return _read(value, next(argument for argument in arguments if argument is not NoneType), at)
    if origin is tuple:
        if not isinstance(value, list):
            raise ValueError(f"{at} is no list")
        return tuple(_read(entry, arguments[0], f"{at}[{number}]") for number, entry in enumerate(value))
    if origin is Mapping or is_dataclass(shape):
        if not isinstance(value, Mapping):
            raise ValueError(f"{at} is no object")
        if origin is Mapping:
            return {key: _read(entry, arguments[1], f"{at}.{key}") for key, entry in value.items()}
        return _read_noun(value, shape, at)
    fits = isinstance(value, (int, float) if shape is float else shape) and isinstance(value, bool) == (shape is bool)
    if not fits:
        raise ValueError(f"{at} is {json.dumps(value)[:40]}")
    return value


def _read_noun(value: Mapping[str, Json], shape: Any, at: str) -> Any:
    hints = get_type_hints(shape)
    found = {}
    for entry in fields(shape):
        if entry.name in value:
            found[entry.name] = _read(value[entry.name], hints[entry.name], f"{at}.{entry.name}")
        elif entry.default is MISSING and entry.default_factory is MISSING:
            raise ValueError(f"{at} has no '{entry.name}'")
    return shape(**found)
