"""The order in which elements stand in a system."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from dse.domain.system import Wire


def along_the_flow(names: Sequence[str], wires: Iterable[Wire]) -> list[str]:
    """*names* along the flow of signals; loops are cut where the given order says."""
    import networkx as nx

    graph = nx.DiGraph()
    graph.add_nodes_from(names)
    graph.add_edges_from((wire.source, wire.target) for wire in wires)
    rank = {name: number for number, name in enumerate(names)}
    condensed = nx.condensation(graph)
    members = {node: sorted(data["members"], key=rank.__getitem__) for node, data in condensed.nodes(data=True)}
    order = nx.lexicographical_topological_sort(condensed, key=lambda node: rank[members[node][0]])
    return [name for node in order for name in members[node]]
