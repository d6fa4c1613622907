"""Which configurations a study or a command means."""

from __future__ import annotations

from collections.abc import Iterator

from dse.domain.design import Configuration, DesignSpace
from dse.domain.study import Selection
from dse.errors import Location, fail


def selected(space: DesignSpace, selection: Selection, where: Location | None = None) -> list[Configuration]:
    """The valid configurations the selection names, in the order of the design space. Raises DseError."""
    from dse.space.enumerate import configurations
    from dse.space.evaluate import holds

    if selection.ids:
        return [one(space, wanted, where) for wanted in selection.ids]
    condition = selection.where
    found = [c for c in configurations(space) if condition is None or holds(condition, space, c)]
    if not found:
        what = "no configuration meets the condition" if condition else f"design space {space.name} has no configuration"
        raise fail(what, condition.where if condition else where, f"'dse enumerate {space.name}' lists what there is")
    return found


def one(space: DesignSpace, wanted: str | None, where: Location | None = None) -> Configuration:
    """The configuration whose id starts with *wanted*; the first of all if *wanted* is None. Raises DseError."""
    from dse.space.enumerate import configurations

    matches = _matching(configurations(space), wanted)
    first = next(matches, None)
    if first is None:
        raise fail(
            f"no valid configuration '{wanted}' in design space {space.name}" if wanted else f"{space.name} is empty",
            where,
            f"'dse enumerate {space.name}' lists the ids",
        )
    if wanted and first.id != wanted:
        second = next(matches, None)
        if second is not None:
            raise fail(f"'{wanted}' is not unique: {first.id}, {second.id}, …", where, "give more of the id")
    return first


def _matching(found: Iterator[Configuration], wanted: str | None) -> Iterator[Configuration]:
    return (c for c in found if wanted is None or c.id.startswith(wanted))
