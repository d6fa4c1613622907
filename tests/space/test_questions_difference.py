"""What two design spaces have in common, against brute force."""

from __future__ import annotations

from hypothesis import given
from question_spaces import EXAMPLES, asked, related, without_diagram

from dse.space.methods.engine import Engine
from dse.space.questions.difference import difference, overlay


def valid_choices(found):
    return {frozenset(c.items()) for c, holds in zip(found.choices, found.valid(), strict=True) if holds}


@EXAMPLES
@given(related())
def test_what_is_common_makes_the_same_choices_in_both_spaces(both):
    before, after = both
    found = difference(before.engine, after.engine)
    common = valid_choices(before) & valid_choices(after)
    assert found.before.value == before.valid().sum()
    assert found.after.value == after.valid().sum()
    assert found.common.value == len(common)
    assert difference(after.engine, before.engine).common.value == len(common)
    laid = Engine(overlay(before.engine.flat, after.engine.flat), before.engine)
    for engine in (laid, without_diagram(laid)):
        rows = [row for block in engine.blocks() for row in block]
        assert {frozenset(laid.flat.choices(row).items()) for row in rows} == common


@EXAMPLES
@given(related())
def test_alternatives_that_came_and_went_are_those_of_the_lists(both):
    before, after = both
    found = difference(before.engine, after.engine)
    old, new = ({(v.path, x) for v in one.engine.flat.variables for x in v.values} for one in both)
    assert set(found.removed) == old - new
    assert set(found.added) == new - old
    assert set(found.constraints_removed) <= {c.name for c in before.space.constraints}
    assert set(found.constraints_added) <= {c.name for c in after.space.constraints}


@EXAMPLES
@given(asked())
def test_a_space_does_not_differ_from_itself(found):
    same = difference(found.engine, found.engine)
    assert same.removed == same.added == same.constraints_removed == same.constraints_added == same.changed == ()
    assert same.before == same.after == same.common
