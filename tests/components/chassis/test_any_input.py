"""What holds for every input: numbers stay numbers, and the same inputs give the same numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import Phase, example, given, settings, strategies as st

NewPart = Callable[..., Any]
ALL = ("longitudinal", "single_track", "two_track")
FINITE = st.floats(allow_nan=False, allow_infinity=False)
VALUES = FINITE | st.floats(-3000, 3000) | st.sampled_from([0.0, 1.0])


@pytest.mark.thorough
@pytest.mark.parametrize("name", ALL)
def test_no_finite_input_makes_something_that_is_no_number(new_part: NewPart, name: str) -> None:
    part = new_part(name)
    ports = part.component.interface.ports
    inputs = [port.name for port in ports if port.causality == "input"]
    outputs = [port.name for port in ports if port.causality == "output"]

    @settings(
        max_examples=40, deadline=None, derandomize=True, phases=[Phase.explicit, Phase.generate]
    )  # shrinking takes minutes
    @given(
        values=st.lists(st.lists(VALUES, min_size=len(inputs), max_size=len(inputs)), min_size=3, max_size=3),
        speed=st.floats(0, 70),
        step=st.sampled_from([1e-3, 0.01, 0.1]),
    )
    @example(values=[[1e308] * len(inputs), [-1e308] * len(inputs), [0.0] * len(inputs)], speed=30.0, step=0.1)
    def check(values: list[list[float]], speed: float, step: float) -> None:
        part["initial_speed"] = speed
        for k, row in enumerate(values):
            for port, value in zip(inputs, row, strict=True):
                part[port] = value
            if k == 0:
                part.init()
            for _ in range(10):
                part.step(step)
            assert [port for port in outputs if not math.isfinite(part[port])] == []

    check()


@pytest.mark.parametrize("name", ALL)
def test_a_drive_repeats_itself_bit_for_bit(new_part: NewPart, name: str) -> None:
    def drive() -> list[bytes]:
        part, found = new_part(name, initial_speed=17.0), []
        for i in range(1, 5):
            part[f"ground[{i}].friction"] = 1.0 - 0.1 * i
        part.init()
        for k in range(300):
            part["steering"], part["wheels.rear"] = 0.1 * math.sin(0.03 * k), 800.0 * math.cos(0.05 * k)
            part["brake.front"] = 4000.0 if 150 < k < 200 else 0.0
            part.step(0.01)
            found.append(part.values())
        return found

    first = drive()
    assert first == drive()
    assert len(set(first)) == len(first)
