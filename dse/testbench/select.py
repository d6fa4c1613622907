"""Which configurations a study or a command means."""

from __future__ import annotations

from dse.domain.design import Configuration, DesignSpace
from dse.domain.study import Selection
from dse.errors import Location, fail
from dse.space import open_space


def selected(space: DesignSpace, selection: Selection, where: Location | None = None) -> list[Configuration]:
    """The valid configurations the selection names, each once, in its order. Raises DseError if there is none."""
    if selection.ids:
        opened = open_space(space)
        return list({(c := opened.configuration(name)).id: c for name in selection.ids}.values())
    condition = selection.where
    found = list(open_space(space, where=condition).configurations())
    if not found:
        what = "no configuration meets the condition" if condition else f"'{space.name}' has no valid configuration"
        place = condition.where if condition else where or space.where
        raise fail(what, place, f"list what there is: dse enumerate {space.name}")
    return found


def one_configuration(space: DesignSpace, wanted: str | None) -> Configuration:
    """The valid configuration whose id starts with *wanted*; the first of all if it is None. Raises DseError."""
    if wanted is not None:
        return open_space(space).configuration(wanted)
    first = next(open_space(space).configurations(), None)
    if first is None:
        raise fail(f"'{space.name}' has no valid configuration", space.where, "relax its constraints")
    return first
