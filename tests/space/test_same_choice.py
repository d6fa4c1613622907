"""``same_choice`` is true where one name is chosen at all its places, or all are absent: absent is no same choice.

Every method that answers about a design space is asked about small random ones with optional places and places
inside architectures; the truth is that of the same rule written without ``same_choice``, by brute force.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings, strategies as st
from question_spaces import SMALL, Answers, answers, listed, without_diagram
from random_spaces import agreement, bare_space, holding, spelled_out

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.loading.uvl.reading import read_uvl_text
from dse.loading.uvl.tokens import Source
from dse.loading.uvl.writing import to_uvl
from dse.space.flat import ABSENT
from dse.space.lowering import flatten
from dse.space.methods.dnnf.compile import compile_dnnf
from dse.space.methods.dnnf.queries import count
from dse.space.methods.dnnf.trim import UnsupportedError
from dse.space.methods.engine import Engine
from dse.space.methods.grid.exact import exact_count
from dse.space.questions.conflict import conflict
from dse.space.questions.explain import broken_by
from dse.space.questions.nearest import nearest
from dse.space.questions.occurrence import occurrences
from dse.space.questions.optimum import Aim, best_configurations
from dse.space.questions.picking import Picking
from dse.space.restriction.refine import refine
from dse.space.space import open_space
from dse.units import parse_quantity

MASS = Aim(parse_expression("sum(mass)"), largest=True)


@st.composite
def comparing(draw: st.DrawFn) -> Answers:
    """A space whose constraints compare places, one of them perhaps a sum."""
    bare = bare_space(draw, SMALL)
    texts = [agreement(draw, bare) for _ in range(draw(st.integers(1, 3)))]
    if draw(st.booleans()):
        texts.append(f"sum(mass) <= {draw(st.integers(0, 12))} kg")
    constraints = tuple(Constraint(f"c{number}", parse_expression(text)) for number, text in enumerate(texts))
    return answers(replace(bare, constraints=constraints))


@pytest.mark.parametrize(
    "examples",
    [2, pytest.param(200, marks=pytest.mark.thorough), pytest.param(1000, marks=pytest.mark.nightly)],
)
def test_every_method_takes_an_absent_place_for_another_choice(examples):
    # Shrinking would take longer than reading what is found, which is small.
    quiet = settings(
        deadline=None, max_examples=examples, suppress_health_check=list(HealthCheck), phases=[Phase.generate]
    )
    quiet(given(comparing(), st.data())(every_method))()


PART = {
    name: Part(Component(name, Interface("any", ()), properties={"mass": parse_quantity("1 kg")})) for name in "abc"
}
PLACES = {"one": ["a", "b"], "two": ["a", "c", None], "three": ["a", "b", "c", None]}
SAME = {
    "same_choice(one, two)": lambda one, two, three: one == two,
    "not same_choice(two, one)": lambda one, two, three: one != two,
    "same_choice(two, three)": lambda one, two, three: two == three,
    "same_choice(three, two) xor true": lambda one, two, three: two != three,
    "same_choice(one, two, three)": lambda one, two, three: one == two == three,
    "same_choice(two, three, two) iff false": lambda one, two, three: two != three,
    "sum(mass) >= 3 kg implies not same_choice(two, one)": lambda one, two, three: one != two or None in (two, three),
    "if one is a then not same_choice(two, three) else true": lambda one, two, three: one != "a" or two != three,
    "at_least(2, same_choice(one, two), same_choice(two, three), one is b)": lambda one, two, three: (
        (one == two) + (two == three) + (one == "b") >= 2
    ),
}


@pytest.mark.parametrize("text", SAME)
def test_an_absent_place_has_the_choice_of_an_absent_one_only(text):
    """Counted by hand over all 24 ways to choose, and by every method."""
    tree = {
        place: Optional(either) if None in names else either
        for place, names in PLACES.items()
        for either in [Alternative(tuple(PART[name] for name in names if name))]
    }
    rules = (Constraint("c", parse_expression(text)),)
    found = answers(DesignSpace("pair", Compound("pair", tree), rules))
    wanted = [
        {place: name for place, name in zip(PLACES, names, strict=True) if name}
        for names in product(*PLACES.values())
        if SAME[text](*names)
    ]
    counted(found, len(wanted))
    valid = [dict(choices) for choices, holds in zip(found.choices, found.valid(), strict=True) if holds]
    assert sorted(map(sorted, map(dict.items, valid))) == sorted(map(sorted, map(dict.items, wanted)))
    chosen_in(replace(found, space=replace(found.space, constraints=())), text)


def test_a_broken_rule_is_explained_by_what_stands_at_its_places():
    space = DesignSpace("pair", Compound("pair", {"one": PART["a"], "two": Optional(PART["a"])}), ())
    space = replace(space, constraints=(Constraint("c", parse_expression("same_choice(one, two)")),))
    (broken,) = broken_by(space, {})
    assert [(seen.what, seen.value) for seen in broken.seen] == [("one", "a"), ("two", "absent")]
    assert not broken_by(space, {"two": "a"})


def every_method(found, data):
    valid = [dict(choices) for choices, holds in zip(found.choices, found.valid(), strict=True) if holds]
    counted(found, len(valid))
    chosen_in(found, agreement(data.draw, found.space))
    place = data.draw(st.integers(0, len(found.choices) - 1))
    broken = [entry.constraint for entry in broken_by(found.space, found.choices[place])]
    assert broken == [c for c, holds in zip(found.space.constraints, found.holds[place], strict=True) if not holds]
    if not valid:
        blamed = [found.space.constraints.index(constraint) for constraint in conflict(found.engine)]
        assert not found.holds[:, blamed].all(axis=1).any()
        return
    for engine in (found.engine, without_diagram(found.engine)):
        drawn = engine.sample(4, 1)
        assert all(dict(engine.flat.choices(row)) in valid for row in drawn)
        for entry in occurrences(engine):
            times = sum(choices.get(entry.path) == entry.choice for choices in valid)
            if entry.choice is not None:
                assert (entry.dead, entry.forced) == (times == 0, times == len(valid))
    near = dict(nearest(found.engine, found.choices[place]).choices)
    lost = ((found.rows != found.rows[place]) & (found.rows[place] != ABSENT)).sum(axis=1)
    assert near in valid
    assert lost[found.choices.index(near)] == lost[found.valid()].min()
    (best,) = best_configurations(found.space, found.engine, MASS, 1)
    assert dict(best.choices) in valid
    stepped(found, valid)
    if found.engine.flat.variables:
        narrowed(found, data)


def counted(found, number):
    """By diagrams, grids and DNNF, with rules as tables and clauses and as they were written, and by UVL."""
    assert len(list(listed(found.engine))) == found.engine.exactly() == number
    assert len(list(listed(without_diagram(found.engine)))) == number
    if number and not found.engine.flat.wides():
        assert exact_count(found.engine.diagram, most_work=1e9) == number
    wide = flatten(found.space, 0)
    assert Engine(wide).exactly() == number
    assert (
        np.logical_and.reduce(
            [np.ones(len(found.rows), bool), *(holding(rule, found.rows) for rule in wide.rules)]
        ).sum()
        == number
    )
    try:
        assert count(compile_dnnf(found.engine.flat)) == number
    except UnsupportedError:
        assert found.engine.flat.wides()
    assert Engine.of(read_uvl_text(Source("model.uvl", to_uvl(found.space)))).exactly() == number


def chosen_in(found, selection):
    """A selection keeps the same as its spelled-out form."""
    kept = [
        open_space(found.space, where=parse_expression(text)).engine.exactly()
        for text in (selection, spelled_out(selection, found.space))
    ]
    assert kept[0] == kept[1]


def stepped(found, valid):
    """What can be picked on the page of choices."""
    picking = Picking(found.engine)
    for number in picking.open:
        variable = picking.variables[number]
        if variable.parent is None:
            for option in picking.options(number):
                assert option.tally.value == sum(choices.get(variable.path) == option.name for choices in valid)


def narrowed(found, data):
    """Without one of the alternatives."""
    path = data.draw(st.sampled_from([variable.path for variable in found.engine.flat.variables]))
    there = [number for number, variable in enumerate(found.engine.flat.variables) if variable.path == path]
    names = {number: np.array([*found.engine.flat.variables[number].values, path], object) for number in there}
    gone = data.draw(st.sampled_from(sorted({*np.concatenate(list(names.values()))} - {path}, key=str)))
    subset = {path: [name for name in np.concatenate(list(names.values())) if name not in (path, gone)]}
    fits = ~np.any([names[number][found.rows[:, number]] == gone for number in there], axis=0)
    left = [choices for choices, kept in zip(found.choices, fits & found.valid(), strict=True) if kept]
    try:
        refined = refine(found.space, subset)
    except DseError:
        assert not left
        return
    assert sorted(sorted(one.choices.items()) for one in open_space(refined).configurations()) == sorted(
        sorted(choices.items()) for choices in left
    )
