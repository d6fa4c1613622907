"""What every rule of evaluation needs: the checked tables and the model that grows."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

from dse.errors import Location
from dse.modelica.algebra.expression import Graph
from dse.modelica.flatten.document import Document, Node
from dse.modelica.flatten.frames import Frame, Request
from dse.modelica.flatten.model import Model
from dse.modelica.flatten.values import Value

Steps = Generator[Request, Value, Value]
"""Evaluation of one node: asks for other nodes' values, returns its own."""


@dataclass(frozen=True, slots=True)
class Context:
    """The tables and the model."""

    document: Document
    model: Model

    @property
    def graph(self) -> Graph:
        """The graph that all values are expressions of."""
        return self.model.graph


@dataclass(frozen=True, slots=True)
class Visit:
    """Evaluation of one *node*, whose *number* is given, in a *frame*."""

    context: Context
    frame: Frame
    number: int
    node: Node

    @property
    def graph(self) -> Graph:
        """The graph that all values are expressions of."""
        return self.context.model.graph

    @property
    def document(self) -> Document:
        """The checked tables."""
        return self.context.document

    @property
    def model(self) -> Model:
        """The model that grows."""
        return self.context.model

    @property
    def where(self) -> Location | None:
        """Where the node stands."""
        return self.context.document.at(self.number)

    def request(self, node: int) -> Request:
        """A wish for the value of another node in the same frame."""
        return Request(self.frame, node)


Rule = Callable[[Visit], Steps]
"""How nodes of one kind are evaluated."""


def requested(frame: Frame, nodes: Sequence[int]) -> Generator[Request, Value, list[Value]]:
    """The values of all *nodes*."""
    values = []
    for node in nodes:
        values.append((yield Request(frame, node)))  # noqa: PERF401 - a comprehension cannot yield
    return values
