"""Expression nodes to values: the front-end's table on one side, the scalar graph on the other.

Evaluation keeps its own stack, so that neither a sum of ten thousand terms nor nested calls meet Python's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar, cast

from dse.errors import Location, fail
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.flatten.document import Document
from dse.modelica.flatten.evaluation import aggregates, operations
from dse.modelica.flatten.evaluation.context import Frame, Request, Steps, Visit
from dse.modelica.flatten.model import Declared, Model
from dse.modelica.flatten.values import Array, MismatchError, Value, array, only

_MOST_STEPS = 3_000_000
"""Steps of one evaluation, so that a loop of a billion turns is refused and does not run for ever."""
T = TypeVar("T")
_RULES = {**operations.RULES, **aggregates.RULES}


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Evaluates nodes of *document*; what it needs of events it notes in *model*."""

    document: Document
    model: Model

    @property
    def graph(self) -> Graph:
        """The graph that all values are expressions of."""
        return self.model.graph

    def value(self, node: int, frame: Frame) -> Value:
        """The value of expression *node* in *frame*. Raises DseError with the place of what is not supported."""
        stack: list[tuple[Steps, Frame, int]] = []
        request: Request | None = Request(frame, node)
        value: Value | None = None
        steps = 0
        while request is not None or stack:
            if request is not None:
                known = request.frame.known.get(request.node)
                if known is None:
                    steps += 1
                    if steps > _MOST_STEPS:
                        raise self.document.refused("an expression that takes so many steps to unroll", node)
                    stack.append((self._steps(request), *request))
                value, request = known, None
                continue
            top, inside, number = stack[-1]
            try:
                request = top.send(value) if value is not None else next(top)
                value = None
            except StopIteration as end:
                stack.pop()
                value = inside.known[number] = end.value
            except MismatchError as problem:
                raise self.document.refused(str(problem), number) from None
        return cast("Value", value)

    def expression(self, node: int, frame: Frame) -> Expression:
        """The scalar value of *node*."""
        return self._as(only, node, frame)

    def elements(self, node: int, frame: Frame) -> Array:
        """The value of *node*, a number or an array of numbers."""
        return self._as(array, node, frame)

    def _as(self, form: Callable[[Value], T], node: int, frame: Frame) -> T:
        try:
            return form(self.value(node, frame))
        except MismatchError as problem:
            raise self.document.refused(str(problem), node) from None

    def scalars(
        self, item: Declared, node: int, frame: Frame, misfit: str, where: Location | None
    ) -> Iterator[tuple[str, Expression]]:
        """Name and value of each scalar of *item* by *node*. Raises DseError, which says *misfit*, for another size."""
        value = self.elements(node, frame)
        if value.shape != item.shape:
            raise fail(misfit, where)
        return zip(item.names, value.elements, strict=True)

    def _steps(self, request: Request) -> Steps:
        frame, number = request
        node = self.document.nodes.get(number)
        rule = _RULES.get(node.kind) if node else None
        if node is None or rule is None:
            kind = node.kind if node else f"number {number}"
            raise self.document.refused(f"an expression of kind '{kind}' here", number)
        return rule(Visit(self.document, self.model, frame, number, node))
