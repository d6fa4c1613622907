"""Messages from processes that run FMUs: what was packed, or a ValueError, and never anything that is called."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dse.plain_messages import packed, unpacked


@dataclass(frozen=True, slots=True)
class Pair:
    left: Any
    right: Any = 0


@dataclass(frozen=True)
class Other:
    value: int


PARTS = (
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8) | st.binary(max_size=8)
)
MESSAGES = st.recursive(
    PARTS,
    lambda each: (
        st.lists(each, max_size=4).map(tuple)
        | st.dictionaries(st.integers(), each, max_size=4)
        | st.builds(Pair, each, each)
    ),
    max_leaves=8,
)


@given(MESSAGES)
def test_what_is_unpacked_was_packed(message: object) -> None:
    assert unpacked(packed(message), Pair) == message


@pytest.mark.parametrize("kind", ["f8", "i8", "u1", "?"])
def test_arrays_come_bit_by_bit(kind: str) -> None:
    array = np.frombuffer(np.random.default_rng(1).bytes(96), np.dtype(kind)).reshape(3, -1)
    if kind == "?":
        array = array.view(np.uint8) > 99
    got = unpacked(packed([array, array[:0]]))
    assert [part.tobytes() for part in got] == [array.tobytes(), b""]
    assert [(part.shape, part.dtype) for part in got] == [(part.shape, part.dtype) for part in (array, array[:0])]
    assert math.isnan(unpacked(packed(math.nan)))


@given(MESSAGES, st.data())
def test_bytes_that_were_changed_are_a_message_or_a_value_error(message: object, data: st.DataObject) -> None:
    content = bytearray(packed(message))
    for _ in range(3):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    try:
        unpacked(bytes(content), Pair)
    except ValueError:
        return


@pytest.mark.parametrize("message", [Other(1), np.array([object()]), np.array([(1, 2)], "i4,i4")])
def test_only_what_was_named_is_made(message: object) -> None:
    with pytest.raises((ValueError, TypeError)):
        unpacked(packed(message), Pair)


def test_nothing_else_is_packed() -> None:
    with pytest.raises(TypeError, match="object is not a part of a message"):
        packed({"a": [object()]})
