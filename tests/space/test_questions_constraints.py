"""What constraints do, by the table, by conflicts and by explanations, against brute force."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from question_spaces import EXAMPLES, asked, without_diagram

from dse.errors import DseError
from dse.space.methods.engine import Engine
from dse.space.questions.conflict import conflict, minimal_conflict
from dse.space.questions.explain import broken_by
from dse.space.questions.impact import funnel, impact
from dse.space.questions.occurrence import occurrences


@EXAMPLES
@given(asked())
def test_the_table_counts_what_is_left_removed_and_freed(found):
    for number, entry in enumerate(impact(found.engine)):
        others = np.delete(found.holds, number, axis=1).all(axis=1)
        assert entry.constraint is found.space.constraints[number]
        assert entry.after.value == found.holds[:, : number + 1].all(axis=1).sum()
        assert entry.removes.value == (~found.holds[:, number]).sum()
        assert entry.frees.value == (others & ~found.holds[:, number]).sum()
        assert entry.is_redundant == (entry.frees.value == 0)
        assert entry.after.exact
        assert entry.removes.exact
        assert entry.frees.exact


@EXAMPLES
@given(asked())
def test_the_funnel_is_what_the_table_leaves(found):
    assert funnel(found.engine) == tuple(entry.after for entry in impact(found.engine))
    with pytest.raises(DseError, match="one after the other"):
        funnel(without_diagram(found.engine))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Engine, "is_empty", lambda _: pytest.fail("what is counted needs no proof"))
        assert all(tally.exact for tally in funnel(found.engine))


@EXAMPLES
@given(asked())
def test_the_table_is_the_same_without_a_diagram(found):
    assert impact(without_diagram(found.engine)) == impact(found.engine)


@EXAMPLES
@given(asked(most_constraints=8))
def test_a_conflict_is_empty_while_each_proper_subset_of_it_is_not(found):
    for engine in (found.engine, without_diagram(found.engine)):
        if found.valid().any():
            with pytest.raises(DseError, match="has valid configurations"):
                conflict(engine)
            continue
        blamed = [found.space.constraints.index(constraint) for constraint in conflict(engine)]
        assert blamed == sorted(blamed)
        assert not found.holds[:, blamed].all(axis=1).any()
        for fewer in combinations(blamed, len(blamed) - 1):
            assert found.holds[:, list(fewer)].all(axis=1).any()


@EXAMPLES
@given(st.lists(st.sets(st.integers(0, 9), min_size=1, max_size=4), min_size=1, max_size=6))
def test_a_minimal_conflict_is_one_of_the_smallest_sets_that_conflict(conflicts):
    def consistent(items):
        return not any(one <= set(items) for one in conflicts)

    found = set(minimal_conflict(range(10), consistent))
    assert found in conflicts
    assert not any(one < found for one in conflicts)


@EXAMPLES
@given(asked(), st.integers(0, 1_000_000))
def test_an_explanation_names_exactly_the_constraints_that_are_broken(found, place):
    row = place % len(found.rows)
    broken = [entry.constraint for entry in broken_by(found.space, found.choices[row])]
    assert broken == [c for c, holds in zip(found.space.constraints, found.holds[row], strict=True) if not holds]


@EXAMPLES
@given(asked())
def test_dead_alternatives_and_forced_choices_are_those_of_the_list(found):
    valid = [chosen for chosen, is_valid in zip(found.choices, found.valid(), strict=True) if is_valid]
    if not valid:
        return
    paths = {variable.path for variable in found.engine.flat.variables}
    for engine in (found.engine, without_diagram(found.engine)):
        entries = occurrences(engine)
        assert {entry.path for entry in entries} == paths
        assert len({(entry.path, entry.choice) for entry in entries}) == len(entries)
        for entry in entries:
            if entry.choice is None:
                continue
            times = sum(chosen.get(entry.path) == entry.choice for chosen in valid)
            assert entry.dead == (times == 0)
            assert entry.forced == (times == len(valid))
            assert entry.share == pytest.approx(times / len(valid))
