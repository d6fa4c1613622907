"""Continuous and initial equations: residuals, one by one or as families over a domain."""

from __future__ import annotations

from collections.abc import Iterator

from dse.errors import Location, fail
from dse.modelica.flat_model import Check, Equation
from dse.modelica.flatten.document import Record, fields, points, shape, single
from dse.modelica.flatten.evaluation.context import Frame
from dse.modelica.flatten.evaluation.evaluation import Evaluation
from dse.modelica.flatten.model import Declared


def continuous(evaluation: Evaluation) -> tuple[list[Equation], list[Check]]:
    """The equations that hold at all times, and the asserts of functions in them."""
    frame = Frame(makes_events=True)
    records = evaluation.document.lists["continuous_equation_operations"]
    return [item for record in records for item in _equations(evaluation, record, frame)], frame.asserts


def initial(evaluation: Evaluation) -> list[Equation]:
    """The equations that hold at the start only. Comparisons are taken as they are: nothing is held yet."""
    frame = Frame(makes_events=False)
    document, declared = evaluation.document, evaluation.model.declared
    found = []
    for record in document.lists["initialization_equation_operations"]:
        found += list(_equations(evaluation, record, frame))
    for record in document.lists["initial_parameter_values"]:
        where = document.where(record.get("provenance"))
        fields(record, "target value", "an initial value", where)
        item = declared[record["target"]]
        found += _solved_for(evaluation, item, record["value"], frame, f"an initial value of '{item.name}'", where)
    for item, record in zip(declared, document.lists["variables"], strict=True):
        node = record["attributes"]["binding"]
        if item.role == "parameter" and node is not None and (record["attributes"]["fixed"] or [True])[0] is False:
            found += _solved_for(evaluation, item, node, frame, f"a binding of '{item.name}'", item.where)
    if frame.asserts:
        raise fail("an assert in a function that an initial equation calls is not supported", frame.asserts[0].where)
    return found


def _solved_for(
    evaluation: Evaluation, item: Declared, node: int, frame: Frame, what: str, where: Location | None
) -> Iterator[Equation]:
    for name, value in evaluation.scalars(item, node, _fresh(frame), f"{what} of another size", where):
        yield Equation(evaluation.graph.variable(name) - value, where)


def _equations(evaluation: Evaluation, record: Record, frame: Frame) -> Iterator[Equation]:
    document = evaluation.document
    kind, data = single(record, "an equation")
    where = document.where(data.get("provenance"))
    if kind == "residual":
        fields(data, "residual", "an equation", where)
        for element in evaluation.elements(data["residual"], _fresh(frame)).elements:
            yield Equation(element, where)
        return
    if kind != "structured":
        raise fail(f"an equation of kind '{kind}' is not supported", where)
    fields(data, "domain scalar_view bodies", "a family of equations", where)
    view, detail = single(data["scalar_view"], "a family of equations", where)
    domain = data["domain"]
    sizes = shape(document, domain)
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


def _fresh(frame: Frame) -> Frame:
    """The same frame that knows nothing yet, so that what one equation found does not stay in memory for all."""
    return Frame(frame.makes_events, frame.asserts)
