"""What the constraints of a space leave of it, one after the other, and alternatives that occur nowhere."""

from __future__ import annotations

from dse.errors import fail
from dse.space.methods.engine import Engine
from dse.space.methods.tally import Tally
from dse.space.questions.impact import counted

MOST_CONSTRAINTS = 40
"""Each takes about a tenth of a second."""


def funnel(engine: Engine, seed: int = 0) -> tuple[Tally, ...]:
    """How many are valid once each constraint and those before it apply, in the order of the file.

    Raises DseError for a space without a diagram, in which each count takes a second, or too many constraints.
    """
    flat = engine.flat
    if engine.diagram is None or len(flat.constraints) > MOST_CONSTRAINTS:
        what = f"'{flat.name}' is too large to look at {len(flat.constraints):,} constraints one after the other"
        raise fail(what, None, f"dse space constraints {flat.name}")
    return tuple(counted(engine.only(range(number + 1)), seed) for number in range(len(flat.constraints)))
