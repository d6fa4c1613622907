"""Real and made-up feature models through the whole chain: file, decisions and rules, decision-DNNF."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from feature_models import feature_model

from dse.loading.uvl.reading import read_uvl
from dse.space.flat import ABSENT, Clause, FlatSpace, Rows, Table
from dse.space.lowering import flatten
from dse.space.methods.dnnf.compile import Dnnf, compile_dnnf
from dse.space.methods.dnnf.queries import count, occurrences
from dse.space.methods.dnnf.rows import rows, sample
from dse.space.methods.solver.answers import conflict, first

SHARED = Path(__file__).parents[3] / "shared/data/uvl"
MODELS = ("android51", "automotive01", "busybox854", "routefinding")

needs_shared = pytest.mark.skipif(not SHARED.is_dir(), reason="the shared feature models are not beside the repository")


@cache
def compiled(path: Path) -> Dnnf:
    return compile_dnnf(flatten(read_uvl(path)))


@pytest.fixture(scope="module")
def made_up(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("models") / "made_up.uvl"
    path.write_text(feature_model(2_000, 2_000, seed=5), encoding="utf-8")
    return path


def meets_all(flat: FlatSpace, found: Rows) -> bool:
    for number, variable in enumerate(flat.variables):
        exists = np.ones(len(found), bool)
        if variable.parent is not None:
            exists = found[:, variable.parent[0]] == variable.parent[1]
        if not np.array_equal(found[:, number] != ABSENT, exists):
            return False
    for rule in flat.rules:
        match rule:
            case Clause():
                held = np.any([mask[found[:, number]] for number, mask in rule.literals], axis=0)
            case Table():
                held = rule.allowed[tuple(found[:, number] for number in rule.scope)]
            case _:
                raise TypeError(rule)
        if not held.all():
            return False
    return True


@pytest.mark.sampled(2)
@needs_shared
@pytest.mark.parametrize("name", MODELS)
def test_a_shared_model_has_the_count_other_counters_agree_on(name: str) -> None:
    known = json.loads((SHARED / "counts.json").read_text(encoding="utf-8"))
    assert count(compiled(SHARED / f"{name}.uvl")) == int(known[name]["count"])


@pytest.mark.sampled(2)
@needs_shared
@pytest.mark.parametrize("name", MODELS)
def test_rows_of_a_shared_model_meet_its_rules_and_differ(name: str) -> None:
    dnnf = compiled(SHARED / f"{name}.uvl")
    drawn, listed = sample(dnnf, 300, seed=1), next(rows(dnnf))
    row = first(dnnf.flat)
    assert row is not None
    assert meets_all(dnnf.flat, np.concatenate([drawn, listed, row[None]]))
    assert len(np.unique(listed, axis=0)) == len(listed)


@needs_shared
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.sampled(3)
def test_samples_of_a_shared_model_have_each_value_as_often_as_counted(name: str) -> None:
    dnnf = compiled(SHARED / f"{name}.uvl")
    total, drawn = count(dnnf), sample(dnnf, 2_000, seed=2)
    for number, amounts in enumerate(occurrences(dnnf)):
        assert sum(amounts) == total
        for value, amount in enumerate(amounts[:-1]):
            share = amount / total
            spread = (share * (1 - share) / len(drawn)) ** 0.5
            # Six standard deviations, and two rows where next to none are expected.
            assert abs((drawn[:, number] == value).mean() - share) <= 6 * spread + 2 / len(drawn)


@needs_shared
def test_a_dead_feature_is_blamed_on_the_one_constraint_that_kills_it() -> None:
    # PIE stands below STATIC, and the file says !STATIC | !PIE.
    dnnf = compiled(SHARED / "busybox854.uvl")
    flat = dnnf.flat
    number = next(at for at, variable in enumerate(flat.variables) if variable.path == "STATIC.PIE")
    assert occurrences(dnnf)[number][0] == 0
    wish = len(flat.constraints)
    blamed = conflict(flat.having(Table((number,), np.array([True, False, False]), wish)))
    assert blamed is not None
    assert [flat.constraints[owner].because for owner in blamed if owner != wish] == ["!STATIC | !PIE"]
    assert conflict(flat) is None


@pytest.mark.thorough
def test_a_made_up_model_has_no_dead_value_and_its_rows_meet_its_rules(made_up: Path) -> None:
    dnnf = compiled(made_up)
    total = count(dnnf)
    assert total > 10**20
    amounts = occurrences(dnnf)
    for variable, found in zip(dnnf.flat.variables, amounts, strict=True):
        assert sum(found) == total
        assert all(amount or name is None for name, amount in zip(variable.values, found[:-1], strict=True))
    assert meets_all(dnnf.flat, np.concatenate([sample(dnnf, 200, seed=3), next(rows(dnnf))]))


@pytest.mark.thorough
def test_a_made_up_model_is_compiled_the_same_twice(made_up: Path) -> None:
    flat = compiled(made_up).flat
    one, other = compile_dnnf(flat), compile_dnnf(flat)
    assert one.graph.nodes == other.graph.nodes
    assert np.array_equal(sample(one, 20, 1), sample(other, 20, 1))
