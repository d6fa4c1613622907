"""The definition of a study as JSON: written with a format version, and read back as a noun or refused by name."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

from dse.domain.definition import Json, StudyDefinition, to_json
from dse.domain.distribution import Distribution
from dse.domain.sampler import Role, Scale
from dse.json_data import read_json, read_noun
from dse.units import UnitError, parse_unit

FORMAT = 2
"""Version of the stored definition. Format 1 had its samplers' options beside their kind and no *explored*."""


def definition_to_json(definition: StudyDefinition) -> dict[str, Json]:
    """*definition* as plain data; without *units* if it has none, as definitions of earlier versions are."""
    data = to_json(definition)
    return {"format": FORMAT, **{key: value for key, value in data.items() if key != "units" or value}}


@lru_cache(maxsize=2)
def read_definition(text: str) -> tuple[Json, StudyDefinition]:
    """What *text* holds, as plain data and as a definition; ValueError if it is none. Neither may be changed."""
    data = read_json(text)
    return data, definition_from_json(data)


def definition_from_json(data: Json) -> StudyDefinition:
    """The definition that *data* holds, of this format or an earlier one. ValueError says what is wrong with it."""
    if not isinstance(data, Mapping):
        raise ValueError("definition is not an object")  # noqa: TRY004  # what a file holds is wrong, not its caller
    version = data.get("format", 1)
    if version not in (1, FORMAT) or version is True:
        raise ValueError(f"definition.format is {json.dumps(version)[:40]}")
    if version == 1:
        data = _from_first(data)
    definition: StudyDefinition = read_noun(data, StudyDefinition, "definition")
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
    for variable in definition.variables:
        if variable.scale not in {*Scale} or variable.role not in {*Role}:
            yield f"variable '{variable.name}' has an unknown scale or role"
        given = variable.distribution
        if given and (flaw := Distribution(given.kind, given.numbers, given.values).flaw):
            yield f"the distribution of '{variable.name}': {flaw}"
    metrics = {metric.name for metric in definition.metrics}
    for requirement in definition.requirements:
        if requirement.metric not in metrics:
            yield f"requirement '{requirement.name}' is on '{requirement.metric}', which is not a metric"
    totals = {name for configuration in definition.configurations for name in configuration.totals}
    for objective in definition.objectives:
        # Where a sampler proposes configurations, there are none yet when the study begins.
        if objective.is_composite or (objective.is_total and not definition.configurations):
            continue
        if objective.name not in (totals if objective.is_total else metrics):
            yield f"objective '{objective.name}' is neither a metric nor a total"
    for name in {*definition.explored} - {configuration.id for configuration in definition.configurations}:
        yield f"definition.explored names '{name}', which is not a configuration"
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
