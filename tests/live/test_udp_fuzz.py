"""Datagrams that nobody in good order sends: no crash, no other state, all counted."""

from __future__ import annotations

import random
import socket
import struct

import pytest
from answerers import ANSWER, START, Answerer, Asker, packed, unpacked
from background import LIMIT, in_background
from live.conftest import COUNTED, outside, simulator_of

from dse.domain.udp import LinkRole, UdpSource

COUNTS = pytest.mark.parametrize("count", [2000, pytest.param(100_000, marks=pytest.mark.thorough)])
BATCH = 50
"""So many junk datagrams go with each request: a socket holds them all, so that none is lost uncounted."""


def junk(chance: random.Random, good: bytes) -> bytes:
    """Random bytes, or *good* with something changed."""
    kind = chance.randrange(6)
    if kind == 0:
        return chance.randbytes(chance.randrange(1, 200))
    if kind == 1:
        return chance.randbytes(len(good))
    if kind == 2:
        return good[: chance.randrange(1, len(good))]
    if kind == 3:
        return good + chance.randbytes(chance.randrange(1, 60))
    if kind == 4:  # another head, and whole again at its end
        head = [chance.choice([0x44534531, chance.getrandbits(31)]), *(chance.getrandbits(31) for _ in range(2)), 32]
        return struct.pack("<4i", *head) + good[16:-4] + struct.pack("<i", head[2])
    place = chance.choice([*range(12), *range(len(good) - 4, len(good))])
    return good[:place] + bytes([good[place] ^ (1 + chance.randrange(255))]) + good[place + 1 :]


@COUNTS
def test_a_client_takes_no_harm(port, cache, count):
    chance = random.Random(1)  # noqa: S311  # no secret
    steps = count // BATCH

    class Noisy(Answerer):
        def _serve(self) -> None:
            while True:
                data, sender = self.socket.recvfrom(65536)
                if not data:
                    return
                session, sequence, flags, time, _ = unpacked(data)
                if sequence == len(self.heard) and sequence <= steps:
                    self.heard.append(data)
                    good = packed(session, sequence, ANSWER | flags, time, [float(sequence), 1.0])
                    for _ in range(BATCH):
                        self.socket.sendto(junk(chance, good), sender)
                    self.socket.sendto(good, sender)

    source = UdpSource(port, timeout=LIMIT, wait=LIMIT)
    model = outside(source, cache, ["u"], ["y", "z", *COUNTED])
    with Noisy(lambda *_: [], port=port), simulator_of(model) as simulator:
        found = simulator.run(stop=steps * 0.01, step=0.01)
    assert found[:, 0].tolist() == [float(k) for k in range(steps + 1)]
    assert set(found[:, 1]) == {1.0}
    assert found[-1, 3] == BATCH * (steps + 1)


@COUNTS
def test_a_server_takes_no_harm(port, cache, count):
    chance = random.Random(2)  # noqa: S311  # no secret
    steps = count // BATCH

    def ask() -> None:
        with Asker(port, 77) as asker, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            asker.ask(0, [0.0], START)
            for k in range(1, steps):
                good = packed(77, k, 0, 0.0, [float(k)])
                for number in range(BATCH):
                    bad = junk(chance, good)
                    if number % 2:
                        asker.socket.send(bad)
                    else:
                        stranger.sendto(bad, ("127.0.0.1", port))
                asker.ask(k, [float(k)])
            asker.end(steps, 1)

    source = UdpSource(port, role=LinkRole.SERVER, timeout=LIMIT, wait=LIMIT)
    model = outside(source, cache, ["u"], ["y", *COUNTED])
    with in_background(ask), simulator_of(model) as simulator:
        found = simulator.run(stop=steps * 0.01, step=0.01)
    assert found[:, 0].tolist() == [0.0, *(float(k) for k in range(1, steps))]
    assert found[-1, 2] >= BATCH * (steps - 1)
