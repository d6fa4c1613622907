"""Good rows quickly, without a proof: a beam through a diagram, the most promising partial rows of each layer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dse.space.flat import ABSENT, Ints, Rows
from dse.space.methods.listing.bounds import least
from dse.space.methods.optimum.relaxation import Relaxation

WIDTH = 256
"""Partial rows that are followed."""


def beam(relaxation: Relaxation, factors: Sequence[int], highs: Sequence[int | None], width: int = WIDTH) -> Rows:
    """At most *width* rows of small *factors* times the sums, each sum at most its *highs*; shape (rows, variables).

    A partial row counts what its best completion comes to. There may be better rows, and rows although none is found.
    Of the rules only those in the layers are looked at.
    """
    diagram = relaxation.diagram
    toward = np.array(factors, np.int64)
    bounded = [place for place, high in enumerate(highs) if high is not None]
    limits = np.array([high for high in highs if high is not None], np.int64)[:, None]
    remaining = [part[bounded] for part in relaxation.remaining]
    ahead = least(diagram, [(toward @ weights)[None, :] for weights in relaxation.weights], 1)
    nodes = np.zeros(1, np.int32)
    totals = np.zeros((len(bounded), 1), np.int64)
    scores = np.zeros(1, np.int64)
    trail: list[tuple[Ints, Ints]] = []
    for depth, (layer, weights) in enumerate(zip(diagram.layers, relaxation.weights, strict=True)):
        parents, values = np.nonzero(layer[nodes] >= 0)
        children = layer[nodes[parents], values]
        grown = totals[:, parents] + weights[bounded][:, values]
        keep = np.flatnonzero((grown + remaining[depth + 1][:, children] <= limits).all(axis=0))
        gained = scores[parents[keep]] + (toward @ weights)[values[keep]]
        order = np.argsort(gained + ahead[depth + 1][0, children[keep]], kind="stable")[:width]
        keep = keep[order]
        nodes, totals, scores = children[keep], grown[:, keep], gained[order]
        trail.append((parents[keep], values[keep]))
    columns = np.empty((len(diagram.order), len(nodes)), np.int16)
    places = np.arange(len(nodes))
    for depth in range(len(trail) - 1, -1, -1):
        parents, values = trail[depth]
        column = values[places]
        columns[diagram.order[depth]] = np.where(column == diagram.layers[depth].shape[1] - 1, ABSENT, column)
        places = parents[places]
    return np.ascontiguousarray(columns.T)
