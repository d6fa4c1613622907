"""Part of a group of variables: values go with their variables, and the work grows with the number of variables."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dse.cosim.binding.calls import AccessorType
from dse.cosim.tables import groups
from dse.cosim.tables.groups import parts_of
from dse.cosim.wiring.wiring import VariableGroup
from dse.domain.fmu import Variable
from dse.domain.system import Conversion


def _group(shapes: list[tuple[int, ...]], *, transformed: bool = False) -> VariableGroup:
    variables = [Variable(f"v{n}", n, "Float64", "input", kind=None, shape=shape) for n, shape in enumerate(shapes)]
    positions = tuple(range(100, 100 + sum(variable.size for variable in variables)))
    transforms = tuple(Conversion(float(position)) for position in positions) if transformed else ()
    return VariableGroup(AccessorType.FLOAT64, tuple(variables), positions, transforms=transforms)


@given(
    st.lists(st.tuples(st.sampled_from([(), (2,), (2, 3)]), st.booleans()), max_size=12), st.booleans(), st.booleans()
)
def test_values_go_with_their_variables(
    drawn: list[tuple[tuple[int, ...], bool]], neighbours: bool, transformed: bool
) -> None:
    group = _group([shape for shape, _ in drawn], transformed=transformed)
    wanted = [f"v{n}" for n, (_, is_wanted) in enumerate(drawn) if is_wanted]
    parts = parts_of(group, wanted, neighbours=neighbours)
    assert [variable.name for part in parts for variable in part.variables] == wanted
    at = {v.name: 100 + sum(other.size for other in group.variables[:n]) for n, v in enumerate(group.variables)}
    for part in parts:
        expected = [at[variable.name] + n for variable in part.variables for n in range(variable.size)]
        assert list(part.positions) == expected
        assert part.transforms == (tuple(Conversion(float(each)) for each in expected) if transformed else ())
        assert not neighbours or all(b == a + 1 for a, b in pairwise(part.positions))
    if neighbours:
        assert all(a.positions[-1] + 1 < b.positions[0] for a, b in pairwise(parts))
    else:
        assert len(parts) <= 1


class _Listed(list[str]):
    """Names that must not be looked through for each variable."""

    def __contains__(self, _name: object) -> bool:
        raise AssertionError


def test_each_part_is_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Any] = []
    monkeypatch.setattr(groups, "replace", lambda *which, **what: made.append(which) or replace(*which, **what))
    group = _group([()] * 500)
    (part,) = parts_of(group, _Listed(f"v{n}" for n in range(500)), neighbours=False)
    assert part == group
    assert len(made) == 1
