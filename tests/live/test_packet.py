"""The packet against a codec of its own: the byte table of docs/udp.md as a structured array."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dse.live import MOST_VALUES, Flag, Packet, PacketError, pack, size_of, unpack

COUNTS = (0, 1, 2, 7, 24)
EACH = 20_000
INT32 = st.integers(-(2**31), 2**31 - 1)


def table(count: int) -> np.dtype:
    """The layout by offsets, with nothing between."""
    names = ["magic", "session", "sequence", "flags", "time", "values", "closing"]
    formats = ["<i4", "<i4", "<i4", "<i4", "<f8", ("<f8", (count,)), "<i4"]
    offsets = [0, 4, 8, 12, 16, 24, 24 + 8 * count]
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": 28 + 8 * count})


def filled(count: int, rows: int, seed: int) -> np.ndarray:
    """Packets with anything that is allowed: sessions and sequences up to the ends, doubles of any bit pattern."""
    random = np.random.default_rng(seed)
    made = np.zeros(rows, table(count))
    made["magic"] = 0x44534531
    made["session"] = random.integers(1, 2**31, rows)
    made["sequence"] = made["closing"] = random.integers(0, 2**31, rows)
    made["flags"] = random.integers(0, 32, rows)
    doubles = random.integers(0, 2**64, (rows, count + 1), np.uint64).view(np.float64)
    doubles[~np.isfinite(doubles)] = -0.0
    made["time"], made["values"] = doubles[:, 0], doubles[:, 1:]
    return made


def bits(packet: Packet) -> bytes:
    return np.array([packet.time, *packet.values]).tobytes()


@pytest.mark.parametrize("count", COUNTS)
def test_a_hundred_thousand_packets_are_read_and_written_as_the_byte_table_says(count):
    made = filled(count, EACH, seed=count)
    stream, size = made.tobytes(), 28 + 8 * count
    read = [unpack(stream[start : start + size], count) for start in range(0, len(stream), size)]
    assert [packet.session for packet in read] == made["session"].tolist()
    assert [packet.sequence for packet in read] == made["sequence"].tolist()
    assert [packet.flags for packet in read] == made["flags"].tolist()
    expected = np.concatenate([made["time"][:, None], made["values"].reshape(EACH, count)], axis=1)
    assert b"".join(map(bits, read)) == expected.tobytes()
    assert b"".join(map(pack, read)) == stream


def test_the_largest_packet_is_a_udp_datagram():
    assert size_of(MOST_VALUES) <= 65_507
    one = Packet(1, 1, Flag(0), 0.0, (0.5,) * MOST_VALUES)
    assert unpack(pack(one), MOST_VALUES) == one
    with pytest.raises(PacketError, match="8001 values: a packet has 0 to 8000"):
        pack(Packet(1, 1, Flag(0), 0.0, (0.5,) * 8001))


@given(st.binary(max_size=80), st.integers(0, 4))
def test_bytes_of_any_kind_are_a_packet_that_is_written_as_it_came_or_refused(data, count):
    try:
        packet = unpack(data, count)
    except PacketError:
        return
    assert pack(packet) == data


@given(INT32, INT32, INT32, INT32, st.lists(st.floats(), max_size=3), st.floats(), INT32 | st.none())
def test_only_what_the_byte_table_allows_is_read(magic, session, sequence, flags, values, time, closing):
    row = np.zeros(1, table(len(values)))
    closing = sequence if closing is None else closing
    row["magic"] = 0x44534531 if magic % 8 else magic
    for name, value in (("session", session), ("sequence", sequence), ("flags", flags), ("closing", closing)):
        row[name] = value
    row["time"], row["values"] = time, [values]
    is_right = (
        row["magic"][0] == 0x44534531
        and session > 0
        and sequence == closing >= 0
        and 0 <= flags < 32
        and all(map(math.isfinite, [time, *values]))
    )
    try:
        packet = unpack(row.tobytes(), len(values))
    except PacketError:
        assert not is_right
    else:
        assert is_right
        assert pack(packet) == row.tobytes()


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("magic", 0x44534532, "begins with 0x44534532, not with 0x44534531"),
        ("session", 0, "session 0: sessions are positive"),
        ("session", -3, "session -3"),
        ("flags", 32, "flags 0x20"),
        ("flags", -1, "flags 0xffffffff"),
        ("closing", 8, "sequence 7 at the beginning, 8 at the end: the packet is torn"),
        ("time", math.inf, "the time is inf"),
        ("values", [1.0, math.nan], "value 2 is nan"),
    ],
)
def test_what_is_wrong_is_told(field, value, said):
    row = np.zeros(1, table(2))
    row["magic"], row["session"], row["sequence"], row["closing"] = 0x44534531, 5, 7, 7
    unpack(row.tobytes(), 2)
    row[field] = value
    with pytest.raises(PacketError, match=said):
        unpack(row.tobytes(), 2)


@pytest.mark.parametrize("length", range(44))
def test_every_other_size_is_refused(length):
    whole = pack(Packet(1, 2, Flag.ANSWER, 0.1, (1.0, 2.0)))
    with pytest.raises(PacketError, match=f"{length} bytes: a packet of 2 values has 44"):
        unpack(whole[:length], 2)


@pytest.mark.parametrize("session", [0, -1, 2**31])
def test_what_could_not_be_read_is_not_written(session):
    with pytest.raises(PacketError, match="positive int32"):
        pack(Packet(session, 0, Flag.START, 0.0, ()))
