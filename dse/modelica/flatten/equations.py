"""Continuous and initial equations: residuals, one by one or as families over a domain."""

from __future__ import annotations

from collections.abc import Iterator

from dse.errors import Location, fail
from dse.modelica.flat_model import Equation
from dse.modelica.flatten.document import Record, fields, single
from dse.modelica.flatten.domains import points, ranges
from dse.modelica.flatten.evaluation.context import Assertion, Frame
from dse.modelica.flatten.evaluation.evaluation import Evaluation


def continuous(evaluation: Evaluation) -> tuple[list[Equation], list[Assertion]]:
    """The equations that hold at all times, and the asserts of functions in them."""
    frame, asserts = evaluation.frame(makes_events=True)
    document = evaluation.document
    records = document.lists["continuous_equation_operations"]
    return [item for record in records for item in _equations(evaluation, record, frame)], asserts


def initial(evaluation: Evaluation) -> list[Equation]:
    """The equations that hold at the start only. Comparisons are taken as they are: nothing is held yet."""
    frame, asserts = evaluation.frame(makes_events=False)
    document = evaluation.document
    found = []
    for record in document.lists["initialization_equation_operations"]:
        found += list(_equations(evaluation, record, frame))
    for record in document.lists["initial_parameter_values"]:
        where = document.where(record.get("provenance"))
        fields(record, "target value", "an initial value", where)
        item = evaluation.model.declared[record["target"]]
        value = evaluation.elements(record["value"], _fresh(frame))
        if value.shape != item.shape:
            raise fail(f"an initial value of '{item.name}' of another size", where)
        for name, element in zip(item.names, value.elements, strict=True):
            found.append(Equation(evaluation.graph.variable(name) - element, where))
    for item, record in zip(evaluation.model.declared, document.lists["variables"], strict=True):
        node = record["attributes"]["binding"]
        if item.role == "parameter" and node is not None and (record["attributes"]["fixed"] or [True])[0] is False:
            value = evaluation.elements(node, _fresh(frame))
            if value.shape != item.shape:
                raise fail(f"a binding of '{item.name}' of another size", item.where)
            for name, element in zip(item.names, value.elements, strict=True):
                found.append(Equation(evaluation.graph.variable(name) - element, item.where))
    if asserts:
        raise fail("an assert in a function that an initial equation calls is not supported", asserts[0].where)
    return found


def _equations(evaluation: Evaluation, record: Record, frame: Frame) -> Iterator[Equation]:
    document = evaluation.document
    kind, data = single(record, "an equation")
    where = document.where(data.get("provenance"))
    if kind == "residual":
        fields(data, "residual", "an equation", where)
        yield from _residuals(evaluation, data["residual"], _fresh(frame), where)
        return
    if kind != "structured":
        raise fail(f"an equation of kind '{kind}' is not supported", where)
    fields(data, "domain scalar_view bodies", "a family of equations", where)
    view, detail = single(data["scalar_view"], "a family of equations", where)
    domain = data["domain"]
    sizes = tuple(len(counter) for counter in ranges(document, domain))
    for body in data["bodies"]:
        place = document.at(body) or where
        if view == "RowMajorProjection":
            bound = 0
        elif view == "BinderSubstitution":
            bound = len(sizes)
        elif view == "BinderPrefixProjection":
            fields(detail, "binder_count", "a family of equations", where)
            bound = detail["binder_count"]
        else:
            raise fail(f"a family of equations of kind '{view}' is not supported", where)
        seen: set[tuple[int, ...]] = set()
        for point in points(document, domain):
            if point[:bound] in seen:
                continue
            seen.add(point[:bound])
            turn = frame.turn(domain, point[:bound])
            value = evaluation.elements(body, turn)
            if value.shape != sizes[bound:]:
                raise document.refused(f"a family of equations of size {list(value.shape)}", body)
            for element in value.elements:
                yield Equation(element, place)


def _residuals(evaluation: Evaluation, node: int, frame: Frame, where: Location | None) -> Iterator[Equation]:
    for element in evaluation.elements(node, frame).elements:
        yield Equation(element, where)


def _fresh(frame: Frame) -> Frame:
    """The same frame that knows nothing yet, so that what one equation found does not stay in memory for all."""
    return Frame(frame.makes_events, frame.asserts)
