from __future__ import annotations

import base64
import zlib

import numpy as np
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from dse.report.page.encoding import MISSING, STEPS, Block, quantise, second_differences

waveforms = arrays(
    np.float64, st.tuples(st.integers(1, 4), st.integers(1, 40)), elements=st.floats(-1e9, 1e9) | st.just(float("nan"))
)


@given(waveforms)
def test_a_quantised_waveform_is_off_by_no_more_than_half_a_step(values: np.ndarray) -> None:
    packed = quantise(values)
    restored = packed.low[:, None] + (packed.high - packed.low)[:, None] * (packed.codes / STEPS)
    known = np.isfinite(values)
    half = (packed.high - packed.low)[:, None] / STEPS / 2
    assert np.all(np.abs(restored - values)[known] <= np.broadcast_to(half * (1 + 1e-9) + 1e-6, values.shape)[known])
    assert np.array_equal(packed.codes == MISSING, ~known)


@given(arrays(np.uint16, st.tuples(st.integers(1, 3), st.integers(1, 30))))
def test_differences_can_be_summed_back(codes: np.ndarray) -> None:
    packed = second_differences(codes)
    signed = (packed >> 1) ^ np.where(packed & 1, np.uint16(0xFFFF), np.uint16(0))
    once = np.cumsum(signed, axis=1, dtype=np.uint16)
    assert np.array_equal(np.cumsum(once, axis=1, dtype=np.uint16), codes)


def test_two_levels_of_a_target_are_kept_exactly() -> None:
    target = np.array([[70.0, 70.0, 50.0, 50.0]])
    assert quantise(target).error == 0.0


def test_a_block_holds_the_bytes_of_each_number_apart() -> None:
    block = Block()
    block.add("a", "u2", np.array([0x0102, 0x0304]))
    block.add("b", "u1", np.array([True, False]))
    assert zlib.decompress(base64.b64decode(block.text())) == bytes([2, 4, 1, 3, 1, 0])
    assert block.directory[1] == {"name": "b", "kind": "u1", "length": 2}
