"""Which configurations a command is about: those of -c, --where or --best."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from dse.errors import fail

if TYPE_CHECKING:
    from dse.domain.design import Configuration
    from dse.space import OpenedSpace

_MOST = 1000
"""Configurations that are simulated at once."""


def chosen_configurations(
    part: OpenedSpace, ids: Sequence[str], where: str | None, best: int | None
) -> list[Configuration]:
    """Those of *ids*, or all of *part* if it was opened with the condition *where*, or the *best* of the least cost;
    without any, the first valid one. Raises DseError, and BadParameter if several are given."""
    if (len(ids) > 0) + (where is not None) + (best is not None) > 1:
        raise typer.BadParameter("one of -c, --where and --best", param_hint="--best")
    if ids:
        return list({found.id: found for found in map(part.configuration, ids)}.values())
    if best is not None:
        from dse.space import read_aims

        cheapest = part.best(read_aims(["sum(cost)"], [])[0], best)
        return [found for each in cheapest if (found := part.of_choices(each.choices))]
    chosen = list(part.configurations(_MOST + 1 if where else 1))
    if len(chosen) > _MOST:
        raise fail(f"more than {_MOST:,} configurations meet the condition", hint="narrow --where, or take --best N")
    if not chosen:
        raise part.nothing()
    return chosen
