"""Rows as paths of a diagram."""

from __future__ import annotations

from dse.space.methods.mdd.diagram import DecisionDiagram


def contains(diagram: DecisionDiagram, row: tuple[int, ...]) -> bool:
    """Whether a row is a path of the diagram."""
    node = -1 if diagram.empty else 0
    for variable, layer in zip(diagram.order, diagram.layers, strict=True):
        node = int(layer[node, row[variable]]) if node >= 0 else -1
    return node >= 0
