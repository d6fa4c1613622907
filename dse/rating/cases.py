"""The runs that a rating needs of a design: a study for each test bench, and which run each cell is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, cast

from dse.domain.bench import TestBench
from dse.domain.sampler import Nominal, Point, Sampler
from dse.domain.study import Keep, Selection, Study
from dse.errors import DseError, Problems, closest, fail
from dse.loading import SAMPLERS, Change, RatedTest, Rating, case_variable, parse_condition
from dse.rating.conditions import is_met
from dse.rating.protocol import Cell, CellKey, Protocol
from dse.testbench import check_bench
from dse.units import Unit, describe, parse_unit

if TYPE_CHECKING:
    from dse.domain.design import Configuration, DesignSpace
    from dse.loading import Place

Case = tuple[CellKey, str]
"""A run: of a cell, with the variation of a robustness layer or "" for none."""


@dataclass(frozen=True, slots=True)
class Reading:
    """How the KPI of a case is read from the runs of a study: the *metric*, and the *unit* that the protocol has."""

    metric: str
    unit: Unit


@dataclass(frozen=True, slots=True)
class CaseStudy:
    """The runs of a rating on one bench. *points* has the case's point, *readings* how its KPI is read."""

    study: Study
    points: Mapping[Case, Point]
    readings: Mapping[Case, Reading]


@dataclass(slots=True)
class _Group:
    bench: TestBench
    tests: list[RatedTest] = field(default_factory=list)
    cases: dict[Case, tuple[RatedTest, Cell, Mapping[str, Change]]] = field(default_factory=dict)


def case_studies(
    rating: Rating,
    protocol: Protocol,
    cells: Sequence[Cell],
    design: DesignSpace,
    configurations: Sequence[Configuration],
) -> tuple[CaseStudy, ...]:
    """The studies that make all runs of *rating* for *configurations* of *design*. Raises DseError with every problem
    that only the *protocol* shows."""
    tests = tests_of(rating, protocol, design)
    problems = Problems()
    groups: dict[tuple[str, tuple[tuple[str, str], ...]], _Group] = {}
    own: dict[CellKey, Cell] = {}
    for cell in cells:
        own.setdefault(cell.key, cell)
    rules = {id(test): test.condition and parse_condition(test.condition, protocol.attributes) for test in tests}
    units: dict[str, Mapping[str, Unit]] = {}
    for test in tests:
        with problems:
            _require_kpis(test, protocol)
            if test.bench.name not in units:
                units[test.bench.name] = check_bench(test.bench, configurations[0]).program.units
            _require_units(test, protocol, units[test.bench.name])
        attributes = {name for cell in cells if cell.test == test.test.text for name in cell.attributes}
        for parameter in test.cells:
            if parameter.attribute.text not in attributes:
                what = f"the cells of {test.test.text} have no attribute '{parameter.attribute.text}'"
                problems.add(what, parameter.attribute.where, closest(parameter.attribute.text, attributes))
    if problems:
        raise DseError(*dict.fromkeys(problems))
    taken: dict[CellKey, RatedTest] = {}
    for key, cell in own.items():
        for test in (test for test in tests if test.test.text == cell.test):
            rule = rules[id(test)]
            with problems:
                named = {protocol.attributes[name]: text for name, text in cell.attributes.items()}
                if rule and not is_met(rule, named):
                    continue
                _require_value(test, cell, taken)
                group = groups.setdefault(_group_of(test), _Group(test.bench))
                group.tests += [test] if not any(test is each for each in group.tests) else []
                group.cases[key, ""] = test, cell, {}
                wanted = () if cell.extended else protocol.variations(protocol.scenario(cell.test))
                for each in test.variations:
                    if each.name in wanted:
                        group.cases[key, each.name] = test, cell, each.changes
    used = {id(test) for group in groups.values() for test in group.tests}
    for test in tests:
        if test.condition and id(test) not in used and not problems:
            problems.add(
                f"no cell of {test.test.text} meets this condition", test.condition.where, "compare attributes"
            )
    found: list[CaseStudy] = []
    selection = Selection.of(configurations)
    for group in groups.values():
        with problems:
            number = sum(each.study.bench.name == group.bench.name for each in found) + 1
            name = group.bench.name if number == 1 else f"{group.bench.name}_{number}"
            found.append(_study(name, rating, group, selection, protocol))
    if problems:
        raise DseError(*dict.fromkeys(problems))
    return tuple(found)


def tests_of(rating: Rating, protocol: Protocol, design: DesignSpace) -> tuple[RatedTest, ...]:
    """The tests of *rating* on benches of *design*. Raises DseError if there is none, or one is not the protocol's."""
    problems = Problems()
    for test in rating.tests:
        if test.test.text not in protocol.tests:
            what, hint = f"{protocol.name} has no test '{test.test.text}'", closest(test.test.text, protocol.tests)
            problems.add(what, test.test.where, hint)
    layers = {layer for layer, _ in protocol.layers}
    for layer, condition in rating.layers:
        if layer.text not in layers:
            what = f"{protocol.name} has no robustness layer '{layer.text}'"
            problems.add(what, layer.where, closest(layer.text, layers))
        elif condition and condition.text not in (known := protocol.conditions(layer.text)):
            what = f"the layer '{layer.text}' of {protocol.name} has no condition '{condition.text}'"
            problems.add(what, condition.where, closest(condition.text, known))
    if problems:
        raise DseError(*problems)
    found = tuple(test for test in rating.tests if test.bench.design.name == design.name)
    if not found:
        designs = ", ".join(sorted({test.bench.design.name for test in rating.tests}))
        what = f"no test of '{rating.name}' is on a test bench of '{design.name}'"
        raise fail(what, rating.where, f"it rates {designs}" if designs else "name tests")
    return found


def _group_of(test: RatedTest) -> tuple[str, tuple[tuple[str, str], ...]]:
    """What tests have in common that one study can make the runs of."""
    return test.bench.name, tuple((each.name, each.expression.text) for each in test.derived)


def _require_value(test: RatedTest, cell: Cell, taken: dict[CellKey, RatedTest]) -> None:
    if cell.kpi not in test.values:
        what = f"'{cell.kpi}' is missing in the values of {cell.test}"
        raise fail(what, next(iter(test.values.values())).where, f"add '{cell.kpi}: METRIC'")
    other = taken.setdefault(cell.key, test)
    if other is not test:
        what = (
            f"a cell of {cell.test} ({described(cell)}) is simulated on '{other.bench.name}' and on '{test.bench.name}'"
        )
        raise fail(what, test.condition.where if test.condition else test.test.where, "separate them by 'where'")


def _require_kpis(test: RatedTest, protocol: Protocol) -> None:
    """DseError unless each value is a KPI of the protocol; one that judges other tests only is not read."""
    for kpi, metric in test.values.items():
        if kpi not in protocol.known_kpis:
            raise fail(f"{protocol.name} has no KPI '{kpi}'", metric.where, closest(kpi, protocol.known_kpis))


def _require_units(test: RatedTest, protocol: Protocol, units: Mapping[str, Unit]) -> None:
    for kpi, metric in test.values.items():
        wanted, unit = parse_unit(protocol.unit(kpi)), units[metric.text]
        if wanted.dimension != unit.dimension:
            found, right = describe(unit.dimension), describe(wanted.dimension)
            raise fail(
                f"'{kpi}' is {right}, the metric '{metric.text}' is {found}", metric.where, "name another metric"
            )


def described(cell: Cell) -> str:
    """The attributes of *cell* in a few words."""
    return ", ".join(f"{name} {text}" for name, text in cell.attributes.items())


def _study(name: str, rating: Rating, group: _Group, selection: Selection, protocol: Protocol) -> CaseStudy:
    """One study of all cases of *group*; a parameter that some of its tests leave alone has the bench's value there."""
    places: dict[str, Place] = {name: place for test in group.tests for name, place in test.places.items()}
    used = {
        name
        for test, _, changes in group.cases.values()
        for name in (*(each.place.name for each in test.cells), *test.fixed, *changes)
    }
    names = sorted(used)
    for follower in group.tests[0].derived:
        if follower.name in used:
            raise fail(f"'{follower.name}' follows from others, and is set as well", follower.where, "remove one")
    points: dict[Case, Point] = {}
    readings: dict[Case, Reading] = {}
    for case, (test, cell, changes) in group.cases.items():
        values = {each.place.name: each.value(cell.attributes[each.attribute.text]) for each in test.cells}
        values |= test.fixed
        values |= {name: _default(places[name], group.bench, test) for name in names if name not in values}
        values |= {name: change.of(places[name], values[name]) for name, change in changes.items()}
        points[case] = tuple(values[name] for name in names)
        readings[case] = Reading(test.values[cell.kpi].text, parse_unit(protocol.unit(cell.kpi)))
    variables = tuple(
        case_variable(places[name], {point[number] for point in points.values()}) for number, name in enumerate(names)
    )
    rows, table = tuple(dict.fromkeys(points.values())), SAMPLERS.get("csv")
    study = Study(
        name,
        replace(group.bench, derived=group.tests[0].derived),
        variables,
        cast(Sampler, table.model_validate({"file": "cells", "rows": rows})) if variables else Nominal(),
        selection,
        Keep.ALL if len(selection.ids) == 1 else Keep.NEAR_BOUNDARY,
        title=f"{rating.title or rating.name}: {group.bench.title or group.bench.name}",
        where=rating.where,
    )
    return CaseStudy(study, points, readings)


def _default(place: Place, bench: TestBench, test: RatedTest) -> float:
    """The value that *bench* has for a parameter which *test* leaves alone. Raises DseError if it has none."""
    value = place.given(bench)
    if value is None:
        what = f"'{place.name}' has no value on '{bench.name}'"
        raise fail(what, test.test.where, "give one under 'parameters'")
    return value


def warned_tests(rating: Rating, protocol: Protocol) -> frozenset[str]:
    """The tests of *rating* for which a warning is declared where the function can be chosen: its KPI has a metric."""
    others = {
        test.test.text: protocol.kpis(test.test.text)[1:] for test in rating.tests if test.test.text in protocol.tests
    }
    return frozenset(
        test.test.text for test in rating.tests if set(others.get(test.test.text, ())) & test.values.keys()
    )


def not_simulated(tests: Iterable[RatedTest], protocol: Protocol) -> tuple[str, ...]:
    """The tests of *protocol* that none of *tests* is."""
    simulated = {test.test.text for test in tests}
    return tuple(test for test in protocol.tests if test not in simulated)
