"""Configurations proposed to a study: valid ones, as likely as they should be, with what is wished for."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from random import Random

import pytest
from hypothesis import assume, given
from question_spaces import EXAMPLES, Answers, asked
from scipy.stats import chisquare

from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import Compound, DesignSpace, Part
from dse.domain.sampler import Architecture
from dse.errors import DseError
from dse.loading import Workspace
from dse.loading.uvl.reading import read_uvl
from dse.space import OpenedSpace, open_space
from dse.space.methods.listing.recheck import recheck
from dse.space.questions.architectures import SpaceArchitectures

ROOT = Path(__file__).parents[2]
SHARED = ROOT.parent / "shared/data/uvl"


@pytest.fixture(scope="module")
def acc() -> OpenedSpace:
    return open_space(Workspace(ROOT).design("acc_vehicle"))


def test_all_valid_configurations_are_drawn_and_each_as_often_as_any_other(acc: OpenedSpace) -> None:
    architectures = acc.architectures()
    drawn = Counter(each.id for each in architectures.draw(227 * 40, 1))
    assert set(drawn) == {configuration.id for configuration in acc.configurations()}
    assert len(drawn) == architectures.count() == 227
    assert chisquare(list(drawn.values())).pvalue > 1e-6


def test_powertrains_get_equal_shares_however_many_configurations_they_have(acc: OpenedSpace) -> None:
    """And below a hybrid there is no decision that brings others along: its configurations are drawn uniformly."""
    architectures = acc.architectures()
    shares = Counter(each.choices["powertrain"] for each in architectures.stratified(702, 1))
    possible = {configuration.choices["powertrain"] for configuration in acc.configurations()}
    assert set(shares) == possible
    assert max(shares.values()) - min(shares.values()) <= 1
    uniform = Counter(each.choices["powertrain"] for each in architectures.draw(702, 1))
    assert max(uniform.values()) > 2 * min(uniform.values())


@EXAMPLES
@given(asked())
def test_shares_are_equal_at_each_decision_that_brings_others_along(found: Answers) -> None:
    assume(found.valid().any())
    variables = found.engine.flat.variables
    rows = found.rows[found.valid()]
    proposed = SpaceArchitectures(found.space, found.engine).stratified(40, 1)
    drawn = [found.engine.flat.row(each.choices) for each in proposed]
    assert len(drawn) == 40
    assert {tuple(row) for row in drawn} <= {tuple(row) for row in rows.tolist()}
    first = next((v.parent[0] for v in sorted((v for v in variables if v.parent), key=lambda v: v.parent or ())), None)
    if first is not None:
        possible = set(rows[:, first].tolist())
        shares = Counter(int(row[first]) for row in drawn)
        assert set(shares) == possible
        assert max(shares.values()) - min(shares.values()) <= 1


def test_a_seed_always_gives_the_same(acc: OpenedSpace) -> None:
    one, other = acc.architectures(), acc.architectures()
    assert one.draw(20, 3) == other.draw(20, 3)
    assert one.stratified(20, 3) == other.stratified(20, 3)
    wishes = [("sensor", "lidar_905nm"), ("video", None)]
    assert [one.completed(wishes, seed) for seed in range(20)] == [other.completed(wishes, seed) for seed in range(20)]


def test_what_was_given_out_becomes_a_configuration(acc: OpenedSpace) -> None:
    architectures = acc.architectures()
    (given_out,) = architectures.draw(1, 1)
    configuration = architectures.configuration(given_out.id)
    assert configuration.id == given_out.id
    assert dict(configuration.choices) == dict(given_out.choices)
    assert acc.architectures().configuration(given_out.id) == configuration
    with pytest.raises(DseError, match="no valid configuration 'zz'"):
        architectures.configuration("zz")


def test_a_space_without_choices_has_its_one_configuration_to_propose() -> None:
    parts = {"part": Part(Component("part", NO_INTERFACE))}
    space = open_space(DesignSpace("only", Compound("only", parts))).architectures()
    only = Architecture(space.draw(1, 1)[0].id, {})
    assert space.count() == 1
    assert space.alternatives == {}
    assert space.draw(3, 1) == space.stratified(3, 1) == [only] * 3
    assert space.completed([], 1) == space.completed([("nowhere", "x")], 1) == only
    assert space.configuration(only.id).parts == {"part": parts["part"].component}


def test_a_wish_for_what_is_no_alternative_is_not_had(acc: OpenedSpace) -> None:
    architectures = acc.architectures()
    wishes = [("sensor", "radar_from_elsewhere"), ("nowhere", None), ("sensor", "camera_mono")]
    assert architectures.completed(wishes, 1).choices["sensor"] == "camera_mono"


def test_a_space_without_a_valid_configuration_has_nothing_to_propose(acc: OpenedSpace) -> None:
    nothing = acc.part(["powertrain=bev_ideal", "powertrain.machine=pmsm_60kw"]).architectures()
    assert nothing.count() == 0
    for ask in (lambda: nothing.draw(1, 1), lambda: nothing.stratified(1, 1), lambda: nothing.completed([], 1)):
        with pytest.raises(DseError, match="no valid configuration"):
            ask()


PROPOSALS = [("acc_vehicle", 1000), ("routefinding", 200), ("android51", 100)]
MORE = [("acc_vehicle", 5000), ("routefinding", 2500), ("android51", 2500), ("busybox854", 200)]
MANY = [("acc_vehicle", 50_000), ("routefinding", 25_000), ("android51", 25_000)]


@pytest.mark.parametrize(
    ("name", "number"),
    [
        *PROPOSALS,
        *(pytest.param(*more, marks=pytest.mark.thorough) for more in MORE),
        *(pytest.param(*many, marks=pytest.mark.nightly) for many in MANY),
    ],
)
def test_no_proposal_is_invalid(name: str, number: int) -> None:
    """Children of two parents, and parents with one other choice; a parent's own wishes give the parent."""
    if name != "acc_vehicle" and not SHARED.is_dir():
        pytest.skip("the shared feature models are not beside the repository")
    space = Workspace(ROOT).design(name) if name == "acc_vehicle" else read_uvl(SHARED / f"{name}.uvl")
    opened = open_space(space)
    architectures = opened.architectures()
    parents = architectures.draw(60, 1)
    chance = Random(1)  # noqa: S311  # a test needs no secrets
    places = list(architectures.alternatives)
    flat, check = opened.engine.flat, recheck(opened.engine.flat)

    def wishes(parent: Architecture) -> list[tuple[str, str | None]]:
        return [(place, parent.choices.get(place)) for place in places]

    assert [architectures.completed(wishes(parent), 1) for parent in parents] == parents
    for seed in range(number):
        one, other = chance.sample(parents, 2)
        wanted = [*wishes(one), *wishes(other)]
        chance.shuffle(wanted)
        if seed % 2:
            place = chance.choice(places)
            wanted = [(place, chance.choice(architectures.alternatives[place])), *wishes(one)]
        proposed = architectures.completed(wanted, seed)
        assert check.valid(flat.row(proposed.choices)[None, :]).all()
        if not seed % 2:
            # The first wish of all can be had: a parent has it.
            assert wanted[0] in wishes(proposed)
