"""Which way of completing rows fits a space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from dse.space.flat import Rows
from dse.space.methods.completing.graph import GraphCompletion
from dse.space.methods.completing.layers import LayeredCompletion
from dse.space.methods.completing.narrowing import DiagramCompletion, NarrowedCompletion
from dse.space.methods.completing.wishes import Wish
from dse.space.methods.engine import Engine


class Completion(Protocol):
    """Completes rows of a space."""

    def row(self, wishes: Sequence[Wish], random: np.random.Generator) -> Rows:
        """A row that grants *wishes* in their order, uniform among those that do; shape (variables,)."""


def completion(engine: Engine) -> Completion:
    """By the diagram of all rules, else the graph of all rules, else by narrowing. Raises DseError if there is no row.

    A pass over a diagram of ten thousand nodes takes half a millisecond, one over a graph of so many some 20 ms; to
    narrow and search takes from 10 ms up to seconds, where the sums that no diagram holds stand in the way.
    """
    if engine.is_empty():
        raise engine.nothing()
    if engine.expanded is not None:
        return LayeredCompletion(engine.expanded)
    if engine.diagram is None and engine.entangled.graph is not None:
        return GraphCompletion.of(engine.entangled.graph)
    return NarrowedCompletion(engine) if engine.diagram is None else DiagramCompletion(engine, engine.diagram)
