"""What every rule of evaluation needs: the checked tables and the model that grows."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from dse.errors import Location
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.flatten.document import Document, Node
from dse.modelica.flatten.evaluation.values import Value
from dse.modelica.flatten.model import Model


@dataclass(frozen=True, slots=True)
class Assertion:
    """An assert met while a function was inlined: *condition* must hold wherever the call is made."""

    condition: Expression
    message: str
    is_warning: bool
    where: Location | None


@dataclass(slots=True)
class Frame:
    """Evaluation of one equation, one call or one turn of a loop.

    *makes_events*: comparisons of continuous quantities are to be held between events. *path*: the condition under
    which this part is evaluated at all, absent if always. *definitions*: for a call, the value each of its assignments
    gave, by number, and *latest* the number of each variable's last one; shared by all frames of the call. *asserts*
    collects what inlined functions demand.
    """

    makes_events: bool
    asserts: list[Assertion]
    function: int = -1
    depth: int = 0
    arguments: tuple[Value, ...] = ()
    definitions: dict[int, Value] = field(default_factory=dict)
    latest: dict[int, int] = field(default_factory=dict)
    binders: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    path: Expression | None = None
    known: dict[int, Value] = field(default_factory=dict)
    calls: dict[int, tuple[Value, ...]] = field(default_factory=dict)

    def turn(self, domain: int, point: tuple[int, ...]) -> Frame:
        """The same with loop counters of *domain* at *point*."""
        return self._changed(binders={**self.binders, domain: point})

    def quiet(self) -> Frame:
        """The same without events."""
        return self._changed(makes_events=False) if self.makes_events else self

    def under(self, condition: Expression) -> Frame:
        """The same where *condition* holds."""
        path = condition if self.path is None else condition.graph.make("and", self.path, condition)
        return self._changed(path=path)

    def call(self, function: int, arguments: tuple[Value, ...]) -> Frame:
        """A call of *function* made from here. Functions never make events."""
        return Frame(False, self.asserts, function, self.depth + 1, arguments, path=self.path)

    def _changed(
        self,
        makes_events: bool | None = None,
        binders: Mapping[int, tuple[int, ...]] | None = None,
        path: Expression | None = None,
    ) -> Frame:
        return Frame(
            self.makes_events if makes_events is None else makes_events,
            self.asserts,
            self.function,
            self.depth,
            self.arguments,
            self.definitions,
            self.latest,
            self.binders if binders is None else binders,
            self.path if path is None else path,
        )


class Request(NamedTuple):
    """A wish for the value of expression *node* in *frame*."""

    frame: Frame
    node: int


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
