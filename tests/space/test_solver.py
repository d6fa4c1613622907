"""The solver beside the diagram and brute force: the same optima, where either can; and it is chosen by itself."""

from __future__ import annotations

import random
import sys
from functools import partial
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_spaces import design_spaces

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.flat import Clause, FlatSpace, Fold, Gather, Ints, Linear, Rule, Table, Variable, Wide
from dse.space.lowering import flatten
from dse.space.methods import clausal, engine as engines
from dse.space.methods.dnnf.trim import UnsupportedError
from dse.space.methods.engine import Engine
from dse.space.methods.listing.blocks import first
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.optimum.optimizer import Optimizer, best, sums
from dse.space.methods.optimum.pareto import pareto
from dse.space.methods.solver import answers, model
from dse.space.methods.solver.answers import SolverOptimizer
from dse.space.methods.solver.model import Budget, SolverModel, SolverProgress, UnprovenError
from dse.space.questions.nearest import nearest
from dse.space.questions.optimum import read_aims
from dse.space.space import open_space
from dse.units import parse_quantity

ANY = Interface("any", ())


@settings(max_examples=40, deadline=None)
@given(space=design_spaces(), numbers=st.data())
def test_the_solver_agrees_with_the_diagram_on_spaces_of_every_construct(
    space: DesignSpace, numbers: st.DataObject
) -> None:
    flat = flatten(space)
    entry = st.integers(-5, 9)
    weights = {
        number: np.array([*numbers.draw(st.lists(entry, min_size=len(v.values), max_size=len(v.values))), 0], np.int64)
        for number, v in enumerate(flat.variables)
    }
    diagram = compile_diagram(flat)
    expected = best(diagram, weights, 3)
    found = answers.least(flat, weights, 3)
    assert tuple(sums(weights, found).tolist()) == expected.values
    assert (answers.first(flat) is None) is (first(diagram) is None)


def middling() -> tuple[FlatSpace, list[dict[int, Ints]]]:
    """24 places of 6, of which every third exists under a choice of the one before; neighbours fit, two sums."""
    draw = random.Random(7)  # noqa: S311  # reproducible, not secret
    names = tuple("abcdef")
    variables = tuple(Variable(f"p{n}", names, (n - 1, 2) if n % 3 == 2 else None) for n in range(24))
    weigh = [{n: np.array([*draw.choices(range(1, 30), k=6), 0], np.int64) for n in range(24)} for _ in range(3)]
    rules: list[Rule] = [Linear(weigh[0], None, 200), Linear(weigh[1], 260, None)]
    for n in range(23):
        allowed = np.array([[draw.random() < 0.7 for _ in range(7)] for _ in range(7)])
        allowed[-1] = allowed[:, -1] = True
        rules.append(Table((n, n + 1), allowed))
    masks = [np.array([draw.random() < 0.3 for _ in range(6)] + [False]) for _ in range(12)]
    rules += [Clause(tuple((n, masks[(n + m) % 12]) for n in range(m, m + 8))) for m in range(0, 16, 4)]
    return FlatSpace("middling", variables, (), tuple(rules)), weigh


@pytest.mark.thorough
def test_the_solver_agrees_with_the_diagram_on_a_space_of_ten_to_the_fourteen() -> None:
    flat, weigh = middling()
    diagram = compile_diagram(flat)
    for weights in weigh:
        assert tuple(sums(weights, answers.least(flat, weights, 2)).tolist()) == best(diagram, weights, 2).values
    both = [pareto(partial(make, known), weigh[:2]) for make, known in ((Optimizer, diagram), (SolverOptimizer, flat))]
    assert both[0].values == both[1].values


class Extreme:
    """The first fold, if it is anything, is at least as large as the second; sums and products fail as one."""

    def __init__(self, bounded: bool) -> None:
        self.bounded = bounded

    def bounds(self, low, high):
        may_hold = np.asarray(high[0]) >= np.asarray(low[1])
        vague = np.ones(len(low[0]), np.bool_)
        return (may_hold, vague) if self.bounded else (vague, vague)

    def holds(self, folds):
        return folds[0] >= folds[1]


NOTHING = np.iinfo(np.int64).max


@pytest.mark.sampled(4)
@pytest.mark.parametrize("gathers", list(product(Gather, Gather)))
@pytest.mark.parametrize("bounded", [True, False])
def test_rules_over_every_kind_of_fold_are_cut_off_exactly(gathers: tuple[Gather, Gather], bounded: bool) -> None:
    for seed in range(6):
        insist_on_exact_cuts(random.Random(f"{gathers}{seed}"), gathers, bounded)  # noqa: S311  # reproducible, not secret


def insist_on_exact_cuts(draw: random.Random, gathers: tuple[Gather, Gather], bounded: bool) -> None:
    folds = []
    for gather in gathers:
        some = [1, 2, 3, -1] if gather is Gather.SUM else [1, 2, 3, *[NOTHING] * 3]
        values = {n: np.array([*draw.choices(some, k=2), 0 if gather is Gather.SUM else NOTHING]) for n in range(4)}
        folds.append(Fold(gather, values, draw.choice([0, 1] if gather in (Gather.SUM,) else [1, NOTHING])))
    variables = tuple(Variable(f"p{n}", ("a", "b"), (0, 1) if n == 3 else None) for n in range(4))
    flat = FlatSpace("wide", variables, (), (Wide(tuple(folds), Extreme(bounded)),))
    solver = SolverModel(flat)
    listed, _ = solver.rows(1_000)
    found = set()
    while (row := solver.least()) is not None:
        solver.add_other(row)
        found.add(tuple(row.tolist()))
    # `rows` keeps what the rules themselves allow, and cuts nothing off.
    assert found == {tuple(row) for row in listed.tolist()}


def allocation(functions: int, ecus: int) -> DesignSpace:
    """Functions on ECUs of limited capacity, some apart; ECUs cost by what runs there."""
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    places, rules = {}, {}
    for f in range(functions):
        load = draw.randint(5, 30)
        options = []
        for e in range(ecus):
            stated = {f"load{e}": f"{load} W", "cost": f"{draw.randint(1, 20)} EUR", "mass": f"{draw.randint(1, 9)} kg"}
            quantities = {name: parse_quantity(text) for name, text in stated.items()}
            options.append(Part(Component(f"f{f}_on{e}", ANY, properties=quantities)))
        places[f"f{f}"] = Alternative(tuple(options))
    for e in range(ecus):
        rules[f"capacity{e}"] = f"sum(load{e}) <= {18 * functions // ecus + 8} W"
    for number in range(2 * functions):
        one, other = draw.sample(range(functions), 2)
        on = (f"(f{one} is f{one}_on{e} and f{other} is f{other}_on{e})" for e in range(ecus))
        rules[f"apart{number}"] = f"not ({' or '.join(on)})"
    return DesignSpace(
        "allocation",
        Compound("allocation", places),
        tuple(Constraint(name, parse_expression(text)) for name, text in rules.items()),
    )


@pytest.fixture
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """No diagram but one of a handful of nodes, and no graph, so that small spaces are answered as large ones are."""

    def unsupported(*_: object) -> None:
        raise UnsupportedError

    monkeypatch.setattr(engines, "DIAGRAM", 10)
    monkeypatch.setattr(clausal, "compile_dnnf", unsupported)
    monkeypatch.setattr(clausal, "least", unsupported)


def test_where_the_diagram_is_too_large_the_solver_gives_the_same_answers(narrow: None) -> None:
    space = allocation(6, 3)
    opened = open_space(space)
    assert opened.engine.diagram is None
    assert opened.engine.is_solved
    diagram = compile_diagram(flatten(space))
    (cost,), (mass,) = (read_aims([f"sum({name})"], []) for name in ("cost", "mass"))
    told: list[str] = []
    ranked = opened.best(cost, 4, told.append)
    objective = [
        {
            n: np.array([int(o.component.properties[name].si) for o in place.options] + [0])
            for n, place in enumerate(space.root.parts.values())
        }
        for name in ("cost", "mass")
    ]
    assert tuple(int(entry.values[0]) for entry in ranked) == best(diagram, objective[0], 4).values
    assert told[-1].startswith(f"found {ranked[-1].values[0]} EUR, none is below ")
    front = pareto(partial(Optimizer, diagram), objective).values
    assert tuple(tuple(map(int, entry.values)) for entry in opened.pareto([cost, mass])) == front
    (ratio,) = read_aims(["sum(cost) / sum(mass)"], [])
    every, _ = SolverModel(flatten(space)).rows(10_000)
    quotients = sums(objective[0], every) / sums(objective[1], every)
    assert float(opened.best(ratio, 1)[0].values[0]) == pytest.approx(quotients.min(), abs=1e-12)
    given = dict(opened.engine.flat.choices(every[0])) | {"f0": "f0_on1", "f1": "f1_on1", "f2": "f2_on1"}
    kept = (every == opened.engine.flat.row(given)).sum(axis=1).max()
    assert len(nearest(opened.engine, given).changes) == 6 - kept


def test_a_conflict_of_a_space_without_a_diagram_is_minimal(narrow: None) -> None:
    space = allocation(6, 3)
    cheap = Constraint("cheap", parse_expression("sum(cost) <= 8 EUR"))
    opened = open_space(DesignSpace("allocation", space.root, (*space.constraints, cheap)))
    blamed = [constraint.name for constraint in opened.conflict()]
    assert "cheap" in blamed
    numbers = [n for n, constraint in enumerate(opened.engine.flat.constraints) if constraint.name in blamed]
    flat = opened.engine.flat
    assert first(compile_diagram(flat.only(numbers))) is None
    for number in numbers:
        assert first(compile_diagram(flat.only([other for other in numbers if other != number]))) is not None


def test_a_search_that_is_late_is_left_to_the_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    flat, weigh = middling()
    expected = best(compile_diagram(flat), weigh[2], 2).values
    monkeypatch.setattr(engines, "LATE", 1)
    asked: list[FlatSpace] = []
    least = answers.least
    monkeypatch.setattr(answers, "least", lambda *given: asked.append(given[0]) or least(*given))
    assert tuple(sums(weigh[2], Engine(flat).least(weigh[2], 2)).tolist()) == expected
    assert asked == [flat]


def test_a_spent_budget_says_how_far_the_solver_came() -> None:
    space = allocation(24, 6)
    flat = flatten(space)
    weights = {n: np.array([*range(7, 13), 0], np.int64) for n in range(24)}
    with pytest.raises(UnprovenError) as spent:
        SolverModel(flat).least(weights, Budget(time=0.002))
    assert spent.value.progress is not None
    assert spent.value.progress.bound >= 0
    with pytest.raises(UnprovenError):
        SolverModel(flat.having(*(Linear(weights, 200 + n, None) for n in range(3)))).rows(10**6, Budget(time=0.002))


def test_the_best_that_cannot_be_proven_is_refused_with_what_is_known(
    monkeypatch: pytest.MonkeyPatch, narrow: None
) -> None:
    opened = open_space(allocation(6, 3))
    (cost,) = read_aims([], ["sum(cost)"])

    def spent(*_: object) -> None:
        # To each sum of weights belongs a constant of 28 EUR: what the cheapest ECU of each function costs at least.
        raise UnprovenError(SolverProgress(-80, -100))

    monkeypatch.setattr(answers, "least", spent)
    what = r"the best of 'allocation' under 'sum\(cost\)' cannot be proven: found 108 EUR, none is above 128 EUR"
    with pytest.raises(DseError, match=rf"{what} \(gap 18\.5 %\)"):
        opened.best(cost, 1)


def test_numbers_that_the_solver_cannot_hold_are_refused_by_the_name_of_their_constraint() -> None:
    rule = Constraint("heavy", parse_expression("sum(mass) <= 5 kg"))
    weights = {0: np.array([1 << 60, 0, 0], np.int64)}
    flat = FlatSpace("big", (Variable("p", ("a", "b")),), (rule,), (Linear(weights, None, 5, 0),))
    with pytest.raises(DseError, match="the numbers of constraint 'heavy' have too many digits"):
        answers.first(flat)


def test_without_the_package_a_question_names_it(monkeypatch: pytest.MonkeyPatch, narrow: None) -> None:
    monkeypatch.setitem(sys.modules, "ortools.sat.python", None)
    monkeypatch.setattr(model, "is_installed", lambda: False)
    model.cp_sat.cache_clear()
    try:
        with pytest.raises(DseError, match=r"(?s)the package ortools, which is not installed.*dse-workbench\[solver\]"):
            open_space(allocation(6, 3)).engine.first()
    finally:
        model.cp_sat.cache_clear()


def test_a_space_without_any_decision_has_one_row_or_none() -> None:
    nothing = FlatSpace("nothing", (), (), ())
    row = answers.first(nothing)
    assert row is not None
    assert row.shape == (0,)
    assert answers.first(nothing.having(Table((), np.array(False)))) is None
    assert answers.first(nothing.having(Linear({}, 1, None))) is None


def test_samplers_draw_and_complete_in_a_space_that_only_the_solver_opens(narrow: None) -> None:
    space = allocation(6, 3)
    flat = flatten(space)
    every = {tuple(row) for row in SolverModel(flat).rows(10_000)[0].tolist()}
    architectures = open_space(space).architectures()
    drawn = architectures.draw(30, 1)
    assert {tuple(flat.row(each.choices).tolist()) for each in drawn} <= every
    assert architectures.configuration(drawn[0].id).choices == drawn[0].choices
    # What is wanted at most, by brute force: in the order of the preferences, each if it can be had.
    wanted = [(f"f{n}", f"f{n}_on2") for n in range(6)]
    found = tuple(flat.row(architectures.completed(wanted, 1).choices).tolist())
    assert found in every
    assert [value == 2 for value in found] == max([value == 2 for value in row] for row in every)
