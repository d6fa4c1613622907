"""What every rule of evaluation needs: the checked tables and the model that grows."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from dse.errors import Location
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.flat_model import Check
from dse.modelica.flatten.document import Document, Node
from dse.modelica.flatten.model import Model
from dse.modelica.flatten.values import Value


@dataclass(slots=True)
class Frame:
    """Evaluation of one equation, one call or one turn of a loop.

    *makes_events*: comparisons of continuous quantities are to be held between events. *path*: the condition under
    which this part is evaluated at all, absent if always. *definitions*: for a call, the value each of its assignments
    gave, by number, and *latest* the number of each variable's last one; shared by all frames of the call. *asserts*
    collects what inlined functions demand of wherever the call is made.
    """

    makes_events: bool
    asserts: list[Check] = field(default_factory=list)
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
        return replace(self, binders={**self.binders, domain: point}, known={}, calls={})

    def quiet(self) -> Frame:
        """The same without events."""
        return replace(self, makes_events=False, known={}, calls={}) if self.makes_events else self

    def under(self, condition: Expression) -> Frame:
        """The same where *condition* holds."""
        path = condition if self.path is None else condition.graph.make("and", self.path, condition)
        return replace(self, path=path, known={}, calls={})

    def call(self, function: int, arguments: tuple[Value, ...]) -> Frame:
        """A call of *function* made from here. Functions never make events."""
        return Frame(False, self.asserts, function, self.depth + 1, arguments, path=self.path)

    def demand(self, condition: Expression, message: str, where: Location | None, is_warning: bool = False) -> None:
        """Assert *condition* where this part is evaluated."""
        if self.path is not None:
            condition = implies(self.path, condition)
        if not condition.is_constant or condition.value == 0:
            self.asserts.append(Check(condition, message, is_warning, where=where))


def implies(guard: Expression, condition: Expression) -> Expression:
    """``not guard or condition``."""
    return guard.graph.make("or", guard.graph.make("not", guard), condition)


class Request(NamedTuple):
    """A wish for the value of expression *node* in *frame*."""

    frame: Frame
    node: int


Steps = Generator[Request, Value, Value]
"""Evaluation of one node: asks for other nodes' values, returns its own."""


@dataclass(frozen=True, slots=True)
class Visit:
    """Evaluation of one *node*, whose *number* is given, in a *frame*."""

    document: Document
    model: Model
    frame: Frame
    number: int
    node: Node

    @property
    def graph(self) -> Graph:
        """The graph that all values are expressions of."""
        return self.model.graph

    @property
    def where(self) -> Location | None:
        """Where the node stands."""
        return self.document.at(self.number)

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
