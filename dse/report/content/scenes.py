"""Which runs of a study can be seen in three dimensions, and of which there are replays beside the report."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from dse.domain.definition import DefinedConfiguration, StudyDefinition
from dse.report.content.data import ReportContent, Scenes

_LANE = {"position", "gap"}


def scenes_of(definition: StudyDefinition) -> Scenes | None:
    """What can be seen of the runs; None if nothing that is stored says where a car is."""
    if not any(map(_has_a_car, definition.configurations)):
        return None
    return Scenes(definition.study)


def with_replays(content: ReportContent, made: Collection[int]) -> ReportContent:
    """*content* of a report that has the replays of *made* beside it; those runs are scenes, whatever else is known."""
    if not made:
        return content
    known = content.scenes or Scenes(dict(content.facts).get("study", ""))
    return replace(content, scenes=replace(known, made=tuple(sorted(made))))


def _has_a_car(configuration: DefinedConfiguration) -> bool:
    """Whether a part has a heading, or tells its way along a lane and how far another one is ahead.

    Stored are the outputs that are connected or recorded: enough to know all that drive by themselves.
    """
    told = {*(wire.split(" -> ")[0] for wire in configuration.wires), *configuration.columns}
    ports = {tuple(name.split(".", 1)) for name in told if "." in name}
    lanes = ({port for part, port in ports if part == each} for each in {part for part, _ in ports})
    return any(port.endswith("motion.heading") for _, port in ports) or any(each >= _LANE for each in lanes)
