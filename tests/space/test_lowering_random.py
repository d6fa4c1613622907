"""The flat rules of a random design space hold exactly where the constraint's outcome is not false."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from random_spaces import design_spaces, folded, holding, rows_of

from dse.domain.design import Constraint, DesignSpace
from dse.errors import DseError
from dse.space.flat import FlatSpace
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places
from dse.space.lowering import clauses, flatten, formulas, selecting

EXAMPLES = settings(deadline=None, max_examples=60, suppress_health_check=list(HealthCheck))


def outcomes(flat: FlatSpace, space: DesignSpace, constraint: Constraint, rows: np.ndarray) -> list[bool | None]:
    """Per row whether the constraint is not false; None where a value does not exist."""
    rule = compile_in(constraint.rule, Places(space))
    found: list[bool | None] = []
    for row in rows:
        try:
            found.append(rule.outcome(flat.choices(row)) is not False)
        except DseError:
            found.append(None)
    return found


def check(space: DesignSpace, most_cells: int) -> FlatSpace | None:
    try:
        flat = flatten(space, most_cells)
    except DseError:
        # Only what fails whatever is chosen fails at once.
        bare = flatten(DesignSpace(space.name, space.root))
        rows = rows_of(bare)
        assert any(None in set(outcomes(bare, space, constraint, rows)) for constraint in space.constraints)
        return None
    rows = rows_of(flat)
    for number, constraint in enumerate(space.constraints):
        wanted = outcomes(flat, space, constraint, rows)
        defined = np.array([outcome is not None for outcome in wanted], bool)
        holds = np.ones(int(defined.sum()), bool)
        for rule in flat.rules:
            if rule.owner == number:
                holds &= holding(rule, rows[defined])
        expected = np.array([outcome for outcome in wanted if outcome is not None], bool)
        assert (holds == expected).all(), (constraint.rule.text, rows[defined][holds != expected][0], flat.rules)
    return flat


@EXAMPLES
@given(design_spaces(), st.sampled_from([4096, 8, 0]))
def test_flat_rules_hold_where_no_outcome_is_false(space, most_cells):
    check(space, most_cells)


@EXAMPLES
@given(design_spaces(), st.sampled_from([1, 4]))
def test_what_is_too_large_to_rewrite_is_judged_as_it_was_written(space, most_parts):
    with patch.object(formulas, "MOST_PARTS", most_parts), patch.object(clauses, "MOST_CLAUSES", 1):
        check(space, 0)


@EXAMPLES
@given(design_spaces(most_constraints=1), st.sampled_from([4096, 0]))
def test_a_selection_holds_where_the_outcome_is_true(space, most_cells):
    flat = flatten(DesignSpace(space.name, space.root))
    rows = rows_of(flat)
    for constraint in space.constraints:
        rule = compile_in(constraint.rule, Places(space))
        try:
            expected = [rule.outcome(flat.choices(row)) is True for row in rows]
        except DseError:
            continue
        holds = np.ones(len(rows), bool)
        for own in selecting(space, constraint.rule, most_cells):
            holds &= holding(own, rows)
        assert holds.tolist() == expected


@EXAMPLES
@given(design_spaces(), st.data())
def test_the_bounds_of_a_wide_rule_are_never_wrong(space, data):
    with patch.object(formulas, "MOST_PARTS", data.draw(st.sampled_from([1, 20_000]))):
        try:
            flat = flatten(space, 0)
        except DseError:
            assume(False)
            raise
    rows = rows_of(flat)
    for rule in flat.wides():
        folds = [np.array(folded(fold, rows), np.int64) for fold in rule.folds]
        group = np.array(data.draw(st.lists(st.integers(0, len(rows) - 1), min_size=1, max_size=6)))
        low = [np.append(fold[group], fold[group].min()) for fold in folds]
        high = [np.append(fold[group], fold[group].max()) for fold in folds]
        may_hold, may_fail = rule.judge.bounds(low, high)
        for place, row in enumerate(group):
            try:
                holds = rule.judge.holds([int(fold[row]) for fold in folds])
            except DseError:
                # Whoever prunes here would never learn that a value does not exist.
                assert may_hold[[place, -1]].all()
                continue
            assert (may_hold if holds else may_fail)[[place, -1]].all(), space.constraints[rule.owner].rule.text
