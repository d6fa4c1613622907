"""The next study, written from what was learnt from one."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.api.lookup import workspace_of
from dse.errors import fail
from dse.storage import StudyFolder, over_draws

if TYPE_CHECKING:
    from dse.analysis import Narrowing
    from dse.domain.study import Study
    from dse.storage import RunTable

_SAMPLES = 160


class Towards(StrEnum):
    """What the next study looks at more closely."""

    AROUND = "around"
    FRONT = "front"
    BOX = "box"
    BAND = "band"


def refine(folder: Path, name: str, towards: Towards, *, run: int = 0, share: float = 0.25, number: int = 5) -> str:
    """The file of a study called *name* that looks closer at what the study in *folder* found; its own is read.

    At a *share* of each range around *run*; at what holds the front of its objectives, or the *number* best under one;
    at the best box in which all requirements are met; or at the band where a verdict is in doubt, by the sampler
    'boundary'. Raises DseError if there is no such thing, or the study's file is not in the workspace here.
    """
    with StudyFolder.open(folder) as stored:
        definition = stored.require_definition()
        narrowing = _narrowing(over_draws(stored.table()), towards, run, share, number)
    if not definition.variables:
        raise fail("the study has no variables to narrow", hint="write a study (*.pet.yaml) of its bench")
    if towards is not Towards.BAND and narrowing.is_whole(definition):
        what = f"--{towards} is everywhere in the study's ranges and configurations: the next study would be the same"
        raise fail(what, hint="more samples in the same study show more")
    study = workspace_of(definition.study).study(definition.study)
    return _written(study, name, narrowing, _sampler(study, towards, narrowing))


def _narrowing(table: RunTable, towards: Towards, run: int, share: float, number: int) -> Narrowing:
    from dse.analysis import (
        around,
        around_designs,
        best_boxes,
        objectives_of,
        of_band,
        of_box,
        ranked,
        study_data,
        worst_designs,
    )

    definition = table.header.definition
    match towards:
        case Towards.AROUND:
            return around(table, run, share)
        case Towards.FRONT:
            objectives = objectives_of(definition, (), ())
            if not objectives:
                raise fail("the study has no objective", hint="give it objectives, or narrow it to its box: --box")
            return around_designs(table, ranked(table, objectives, number).best)
        case Towards.BOX:
            found = best_boxes(worst_designs(study_data(table)))
            if not found:
                raise fail("no box was found in which requirements are met more often than elsewhere, but by chance")
            return of_box(definition, found[0])
    return of_band(table)


def _sampler(study: Study, towards: Towards, narrowing: Narrowing) -> Mapping[str, Any] | None:
    """Another one than the study's where that cannot go on there."""
    if towards is Towards.BAND:
        return {"boundary": {"samples": _SAMPLES}}
    lists = study.sampler.proposes and bool(narrowing.ids)
    points = study.sampler.name == "csv" or not study.once
    return {"latin_hypercube": {"samples": _SAMPLES}} if lists or points else None


def _written(study: Study, name: str, narrowing: Narrowing, sampler: Mapping[str, Any] | None) -> str:
    from dse.loading import read_document, write_narrowed

    where = study.where
    if where is None:
        raise fail(f"the study '{study.name}' has no file", hint="call this where its workspace is")
    root = workspace_of(study.name).root
    data = read_document(root / where.file if not Path(where.file).is_absolute() else Path(where.file), root).data
    condition = study.selection.where
    rules = [f"({condition.text})"] if condition else []
    rules += [_rule(place, levels) for place, levels in narrowing.where.items()]
    configurations = list(narrowing.ids) or (" and ".join(rules) if narrowing.where else None)
    return write_narrowed(data, name, study.variables, narrowing.ranges, configurations, sampler)


def _rule(place: str, levels: tuple[str, ...]) -> str:
    there = [level for level in levels if level != "absent"]
    parts = [f"{place} in [{', '.join(there)}]"] if there else []
    parts += [f"{place} is absent"] if "absent" in levels else []
    return f"({' or '.join(parts)})" if len(parts) > 1 else parts[0]
