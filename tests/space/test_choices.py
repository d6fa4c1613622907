"""Choices as a user types them."""

from __future__ import annotations

import pytest
from random_spaces import ANY

from dse.domain.component import Component
from dse.domain.design import Alternative, Compound, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.space.methods.engine import Engine
from dse.space.restriction.choices import choosing, completed, kept_choices, read_choices


def part(name):
    return Part(Component(name, ANY))


def two_drives():
    """Either architecture has a place ``drive.gear``, which may be left out in one of them."""
    fast = Compound("fast", {"gear": Alternative((part("g1"), part("g2")))}, interface=ANY)
    slow = Compound("slow", {"gear": Optional(part("g2"))}, interface=ANY)
    return DesignSpace("car", Compound("car", {"drive": Alternative((fast, slow)), "roof": Optional(part("glass"))}))


@pytest.mark.parametrize(
    ("texts", "count"),
    [
        (["drive=fast"], 4),
        (["drive.gear=g2"], 4),
        (["drive.gear=absent"], 2),
        (["drive.gear=g1", "roof=absent"], 1),
        (["drive=slow", "drive.gear=g1"], 0),
    ],
)
def test_a_choice_means_the_place_wherever_it_comes_from(texts, count):
    space = two_drives()
    engine = Engine.of(space)
    assert engine.having(*choosing(engine.flat, read_choices(space, texts))).count().value == count


def test_all_problems_are_told_at_once():
    with pytest.raises(DseError) as told:
        read_choices(two_drives(), ["drive", "drive=fats", "rof=glass", "roof=glass", "roof=absent"])
    assert [problem.hint for problem in told.value.problems] == [
        "write place=choice, as sensor=radar",
        "did you mean 'fast'?",
        "did you mean 'roof'?",
        "give it once",
    ]


def test_choices_are_complete_when_no_decision_is_open():
    space = two_drives()
    assert completed(space, {"drive": "slow", "roof": "absent"}) is None
    assert completed(space, {"drive": "slow", "drive.gear": "absent", "roof": "glass"}) == {
        "drive": "slow",
        "roof": "glass",
    }
    bare = DesignSpace("bare", Compound("bare", {"roof": Optional(part("glass"))}))
    assert completed(bare, {"roof": "absent"}) == {}


def test_what_is_kept_is_what_all_options_leave():
    space = two_drives()
    within = {"roof": frozenset({None})}
    assert kept_choices(space, ["drive.gear=g1, g2"], ["drive=slow"], within) == {
        "drive": {"fast"},
        "drive.gear": {"g1", "g2"},
        "roof": {None},
    }
    with pytest.raises(DseError, match="nothing is left to choose at 'roof'"):
        kept_choices(space, [], ["roof=absent"], within)
