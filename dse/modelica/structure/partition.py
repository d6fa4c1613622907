"""Which blocks are computed in every evaluation of the derivatives, and which only when somebody looks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from dse.modelica.algebra.expression import Symbol
from dse.modelica.solved import Block
from dse.modelica.structure.arrange import Stage


def partitioned(stages: Sequence[Stage], wanted: Iterable[Symbol]) -> tuple[list[Block], list[Block]]:
    """Blocks of *stages* that *wanted* needs, and the others; both in their order."""
    needed = set(wanted)
    is_hot = [False] * len(stages)
    for place in reversed(range(len(stages))):
        if needed.intersection(stages[place].gives):
            is_hot[place] = True
            needed.update(stages[place].needs)
    hot = [stage.block for stage, is_wanted in zip(stages, is_hot, strict=True) if is_wanted]
    return hot, [stage.block for stage, is_wanted in zip(stages, is_hot, strict=True) if not is_wanted]
