"""How late a cruise control hears of its target, and who says how fast it drives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]


@pytest.mark.parametrize(
    ("name", "steps"), [("computer_small", 12), ("computer_middle", 6), ("computer_large", 2), ("computer_small", 0)]
)
def test_a_target_comes_out_of_a_computer_as_many_steps_late_as_it_says(
    new_part: NewPart, name: str, steps: int
) -> None:
    part = new_part(name)
    if not steps:
        part["delay"] = 0.0
    part.init()
    told = []
    for k in range(200):  # more than it remembers
        part["chosen.gap"], part["chosen.closing_speed"], part["chosen.detected"] = 100.0 - k, 0.5 * k, k % 7 < 4
        part.step()
        told.append((part["target.gap"], part["target.closing_speed"], part["target.detected"]))
    chosen = [(100.0 - k, 0.5 * k, k % 7 < 4) for k in range(200)]
    assert told[steps:] == chosen[: 200 - steps]
    assert told[:steps] == [(0.0, 0.0, False)] * steps


def test_without_an_assistant_the_wish_of_the_driver_is_driven(new_part: NewPart) -> None:
    part = new_part("driver_wish")
    part["wish"], part["lane.speed_limit"], part["lane.curvature"] = 36.0, 20.0, 0.02
    part.init()
    assert part["set_speed"] == 36.0
    part["wish"] = 30.0
    part.step()
    assert part["set_speed"] == 30.0
