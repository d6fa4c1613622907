"""Assignment to elements of an array inside a function."""

from __future__ import annotations

from collections.abc import Sequence

from dse.errors import Location
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.flatten.builtins import known_index
from dse.modelica.flatten.frames import Assertion, Frame
from dse.modelica.flatten.values import Array, MismatchError, places, position


def updated(
    graph: Graph,
    base: Array,
    subscripts: Sequence[Sequence[Expression] | Expression],
    value: Array,
    frame: Frame,
    where: Location | None,
) -> Array:
    """*base* with ``base[subscripts] := value``. An index only known at run time gives a choice for every element.

    Such an index outside the array fails the run, by an assertion of *frame*. Raises MismatchError for other sizes.
    """
    rest: list[Sequence[Expression] | Expression] = list(subscripts)
    rest += [[graph.constant(float(k)) for k in range(1, size + 1)] for size in base.shape[len(rest) :]]
    lists = [[item] if isinstance(item, Expression) else list(item) for item in rest]
    if tuple(len(items) for item, items in zip(rest, lists, strict=True) if not isinstance(item, Expression)) != (
        value.shape
    ):
        raise MismatchError("an assignment to array elements of another size")
    elements = list(base.elements)
    for element, place in zip(value.elements, places([len(items) for items in lists]), strict=True):
        index = [items[k - 1] for k, items in zip(place, lists, strict=True)]
        known = [known_index(item, size) for item, size in zip(index, base.shape, strict=True)]
        unknown = [(item, size) for item, size, found in zip(index, base.shape, known, strict=True) if found is None]
        for item, size in unknown:
            inside = graph.make("and", graph.make("greater_equal", item, graph.of(1.0)), _at_most(item, size))
            _demand(frame, inside, where)
        for target in places([1 if found else size for found, size in zip(known, base.shape, strict=True)]):
            exact = [found or at for found, at in zip(known, target, strict=True)]
            spot = position(base.shape, exact)
            condition = graph.constant(1.0)
            for item, at, found in zip(index, exact, known, strict=True):
                if found is None:
                    condition = graph.make("and", condition, graph.make("equal", item, graph.of(float(at))))
            elements[spot] = graph.make("if", condition, element, elements[spot])
    return Array(tuple(elements), base.shape)


def _at_most(item: Expression, size: int) -> Expression:
    return item.graph.make("less_equal", item, item.graph.of(float(size)))


def _demand(frame: Frame, condition: Expression, where: Location | None) -> None:
    graph = condition.graph
    whole = condition if frame.path is None else graph.make("or", graph.make("not", frame.path), condition)
    frame.asserts.append(Assertion(whole, "an index outside its array", False, where))
