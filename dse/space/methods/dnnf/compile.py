"""A wide space compiled: from decisions and rules to a decision-DNNF that answers by passes over its nodes.

Values that no rule tells apart become one (`trim`), rules become clauses (`cnf`), clauses become fewer (`simplify`),
Booleans get an order of decision (`order`), and a search makes the graph (`exhaust`: an example, the cost).
"""

from __future__ import annotations

from dataclasses import dataclass

from dse.space.flat import FlatSpace
from dse.space.methods.dnnf.cnf import Cnf, encode
from dse.space.methods.dnnf.exhaust import compile_graph
from dse.space.methods.dnnf.graph import DecisionGraph
from dse.space.methods.dnnf.order import arrange
from dse.space.methods.dnnf.simplify import simplify
from dse.space.methods.dnnf.trim import Trimmed, trim

MOST_COMPONENTS = 200_000
"""Components solved before giving up, unless told otherwise."""


@dataclass(frozen=True, slots=True, eq=False)
class Dnnf:
    """The rows of a space as models of a graph.

    Models of *graph* are one to one to rows of *trimmed*.core: *cnf* gives the literals of its variables, *image* what
    became of those in the graph, over Booleans 1 to *booleans* - 1.
    """

    trimmed: Trimmed
    cnf: Cnf
    image: tuple[int, ...]
    booleans: int
    graph: DecisionGraph

    @property
    def flat(self) -> FlatSpace:
        """The space that was compiled."""
        return self.trimmed.flat


def compile_dnnf(flat: FlatSpace, most_nodes: int = MOST_COMPONENTS) -> Dnnf:
    """Hierarchy and rules of a space as a graph.

    Raises UnsupportedError if a rule has no small form in clauses (`Wide` rules, sums of many distinct values) and
    TooWideError beyond *most_nodes* components.
    """
    trimmed = trim(flat)
    cnf = encode(trimmed.core)
    simplified = arrange(simplify(cnf))
    graph = compile_graph(simplified, most_nodes)
    return Dnnf(trimmed, cnf, simplified.image, simplified.booleans, graph)
