"""Whether a diagram has any valid row."""

from __future__ import annotations

from dse.space.methods.listing.blocks import MOST_ROUNDS, cannot_be
from dse.space.methods.listing.walk import Rounds
from dse.space.methods.mdd.diagram import Diagram
from dse.space.methods.optimum.optimizer import Optimizer


def is_empty(diagram: Diagram, most_rounds: int | None = MOST_ROUNDS) -> bool:
    """Whether no row is valid; proven by a bound where that suffices, else by the complete search.

    A row that shows the opposite is looked for by a beam before that. Raises TooMuchError after *most_rounds*, None
    for no limit.
    """
    if cannot_be(diagram):
        return True
    return Optimizer(diagram, []).is_vain(None if most_rounds is None else Rounds(most_rounds))
