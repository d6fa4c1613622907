"""The dealership at the front door: links, the cheapest, and a surprise."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, strategies as st

from dse.api import Dealership, choices_text, open as open_workspace, read_choices_text
from dse.errors import DseError


@pytest.fixture(scope="module")
def dealership():
    return Dealership(open_workspace(".").designs["acc_vehicle"])


def test_the_cheapest_and_a_surprise_are_whole_and_have_what_is_chosen(dealership):
    chosen = {"sensor": next(c.name for c in dealership.offer().point("sensor").choices if c.is_possible)}
    cheapest = dealership.offer(dealership.cheapest(chosen))
    least = next(total.low for total in dealership.offer(chosen).totals if total.name == "cost")
    assert cheapest.left == 1
    assert next(total.low for total in cheapest.totals if total.name == "cost") == least
    drawn = [dealership.surprise(chosen, seed) for seed in range(5)]
    assert all({**each, **chosen} == each and dealership.offer(each).left == 1 for each in drawn)
    assert dealership.surprise(chosen, 3) == drawn[3]
    assert len({json.dumps(each) for each in drawn}) > 1


def test_an_offer_goes_to_a_page_and_back(dealership):
    data = json.loads(json.dumps(dealership.offer({}).data()))
    assert int(data["total"]) == int(data["left"]) > 100
    assert all(each["because"] for point in data["points"] for each in point["alternatives"] if not each["is_possible"])


WORDS = st.text("abcxyz_0.", min_size=1, max_size=12)


@given(st.dictionaries(WORDS, WORDS))
def test_the_text_of_choices_gives_the_choices_back(chosen):
    assert read_choices_text(choices_text(chosen)) == chosen


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("sensor", "'sensor' is not a choice"),
        ("sensor:", "'sensor:' is not a choice"),
        ("a:b,,c:d", "'' is not a choice"),
        ("a:b:c", "'a:b:c' is not a choice"),
        ("a:b,a:c", "'a' is given twice"),
        ("x" * 30_000, "longer than 20,000 characters"),
    ],
)
def test_what_is_no_text_of_choices_is_refused_by_name(text, told):
    with pytest.raises(DseError, match=told):
        read_choices_text(text)
