"""A component of the kind udp in real time: the newest counts, deadlines are kept or counted, nothing runs back."""

from __future__ import annotations

import contextlib
import select
import socket
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from answerers import ANSWER, END, START, Asker, bound_socket, packed, unpacked
from background import LIMIT, in_background
from live.conftest import COUNTED, outside, simulator_of

from dse.cosim import RunFailed
from dse.domain.fmu import FmuModel
from dse.domain.udp import LinkMode, LinkRole, UdpSource

AGES = 3600.0
"""Seconds of a run that somebody else ends."""


@pytest.fixture
def asking(port: int, cache: Path) -> FmuModel:
    """A client in real time."""
    return outside(free(port), cache, ["u"], ["y", *COUNTED])


def free(port: int, role: LinkRole = LinkRole.CLIENT, timeout: float = LIMIT) -> UdpSource:
    return UdpSource(port, role=role, mode=LinkMode.FREE, timeout=timeout, wait=LIMIT)


@contextlib.contextmanager
def beside(port: int, talk: Callable[[socket.socket], None]) -> Iterator[None]:
    """The other side: *talk* with the socket at *port*."""
    with bound_socket(port) as there:
        there.settimeout(LIMIT)
        with in_background(talk, there):
            yield


def after_a_step(line: socket.socket) -> tuple[bytes, tuple[str, int]]:
    """The next packet but one, and its sender: who sent it has taken all that was sent before."""
    while select.select([line], [], [], 0.0)[0]:  # what came meanwhile
        line.recvfrom(65536)
    line.recvfrom(65536)
    return line.recvfrom(65536)


def test_the_newest_counts_and_what_is_older_changes_nothing(port, asking):
    def talk(there: socket.socket) -> None:
        for number in (0, 4, 2, 3, 1, 6, 6, 5, 9, 7):
            data, sender = there.recvfrom(65536)
            session, _, _, time, _ = unpacked(data)
            there.sendto(packed(session, number, ANSWER | (START if not number else 0), time, [number]), sender)
        session, _, _, time, _ = unpacked(after_a_step(there)[0])
        there.sendto(packed(session, 10, ANSWER | END, time, [10]), sender)

    with beside(port, talk), simulator_of(asking) as simulator:
        found = simulator.run(stop=AGES, step=0.01)
    assert np.all(np.diff(found[:, 0]) >= 0.0)
    assert found[-1, 0] == 9.0
    assert found[-1, 2] == 6.0  # 2, 3, 1, 6 again, 5 and 7
    assert set(found[:, 0]) <= {0.0, 4.0, 6.0, 9.0}


def test_steps_end_at_their_deadlines_and_no_sooner(port, asking):
    def talk(there: socket.socket) -> None:
        while True:
            data, sender = there.recvfrom(65536)
            session, sequence, flags, time, _ = unpacked(data)
            if flags & END:
                return
            there.sendto(packed(session, sequence, ANSWER | (START if not sequence else 0), time, [time]), sender)

    with beside(port, talk), simulator_of(asking) as simulator:
        found = simulator.run(stop=0.12, step=0.01)
    assert np.all(found[1:, 4] >= 0.0)  # how late each step came back
    assert np.all(np.diff(found[:, 3]) >= 0.0)


def test_a_server_in_real_time_takes_the_newest_request_and_never_an_older_one(port, cache):
    said: list[tuple[int, float]] = []

    def ask() -> None:
        with Asker(port, 5) as asker:
            said.append(asker.ask(0, [0.0], START)[:2])
            asker.socket.settimeout(LIMIT)
            for number in (3, 1, 2, 7, 4):
                asker.socket.send(packed(5, number, 0, 0.0, [number]))
                _, _, flags, time, _ = unpacked(asker.socket.recv(65536))
                said.append((flags, time))
            after_a_step(asker.socket)
            asker.end(9, 1)

    model = outside(free(port, LinkRole.SERVER), cache, ["u"], ["y"])
    with in_background(ask), simulator_of(model, {"u": 1.0}) as simulator:
        found = simulator.run(stop=AGES, step=0.01)
    assert len(found) < 100 * AGES  # it was ended
    assert np.all(np.diff(found[:, 0]) >= 0.0)
    assert found[-1, 0] == 7.0
    times = [time for _, time in said]
    assert times == sorted(times)


def test_silence_ends_a_run_in_real_time_by_name(port, cache):
    def talk(there: socket.socket) -> None:
        data, sender = there.recvfrom(65536)
        there.sendto(packed(unpacked(data)[0], 0, ANSWER | START, 0.0, [1.0]), sender)

    model = outside(free(port, timeout=0.5), cache, ["u"], ["y"])
    said = r"it: .*in 0.5 s no packet that can be used came from 127"
    with beside(port, talk), simulator_of(model) as simulator, pytest.raises(RunFailed, match=said):
        simulator.run(stop=AGES, step=0.01)


def test_a_socket_that_is_inherited_is_talked_through(cache: Path, monkeypatch):
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)

    def talk() -> None:
        while True:
            session, sequence, flags, time, values = unpacked(ours.recv(65536))
            if flags & END:
                return
            ours.send(packed(session, sequence, ANSWER | (START if not sequence else 0), time, [2.0 * values[0]]))

    with ours, theirs:
        monkeypatch.setenv("DSE_LIVE_SOCKET", str(theirs.fileno()))
        ours.settimeout(LIMIT)
        model = outside(UdpSource(0, "", LinkRole.CLIENT, LinkMode.FREE, LIMIT, LIMIT), cache, ["u"], ["y"])
        with in_background(talk), simulator_of(model, {"u": 4.0}) as simulator:
            found = simulator.run(stop=0.05, step=0.01)
    assert found.ravel().tolist() == [8.0] * 6
