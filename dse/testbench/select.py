"""Which configurations a study or a command means."""

from __future__ import annotations

from dse.domain.design import Configuration, DesignSpace
from dse.domain.study import Selection
from dse.errors import Location, fail
from dse.space.enumerate import configurations, find


def selected(space: DesignSpace, selection: Selection, where: Location | None = None) -> list[Configuration]:
    """The valid configurations the selection names, each once, in its order. Raises DseError if there is none."""
    if selection.ids:
        return list({(c := find(space, name)).id: c for name in selection.ids}.values())
    condition = selection.where
    found = list(configurations(space, condition))
    if not found:
        what = "no configuration meets the condition" if condition else f"'{space.name}' has no valid configuration"
        place = condition.where if condition else where or space.where
        raise fail(what, place, f"list what there is: dse enumerate {space.name}")
    return found


def one_configuration(space: DesignSpace, wanted: str | None) -> Configuration:
    """The valid configuration whose id starts with *wanted*; the first of all if it is None. Raises DseError."""
    if wanted is not None:
        return find(space, wanted)
    first = next(configurations(space), None)
    if first is None:
        raise fail(f"'{space.name}' has no valid configuration", space.where, "relax its constraints")
    return first
