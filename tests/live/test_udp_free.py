"""A component of the kind udp in real time: the newest counts, deadlines are kept or counted, nothing runs back."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable
from pathlib import Path
from time import sleep

import numpy as np
import pytest
from answerers import ANSWER, END, START, packed, unpacked
from live.conftest import COUNTED, outside, simulator_of

from dse.cosim import RunFailed
from dse.domain.udp import LinkMode, LinkRole, UdpSource


def free(port: int, role: LinkRole = LinkRole.CLIENT) -> UdpSource:
    return UdpSource(port, role=role, mode=LinkMode.FREE, timeout=0.5, wait=5.0)


def beside(port: int, talk: Callable[[socket.socket], None]) -> threading.Thread:
    """The other side: *talk* with the socket at *port*."""
    there = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    there.bind(("127.0.0.1", port))
    there.settimeout(5.0)

    def go() -> None:
        with there:
            talk(there)

    thread = threading.Thread(target=go)
    thread.start()
    return thread


def test_the_newest_counts_and_what_is_older_changes_nothing(port, cache):
    def talk(there: socket.socket) -> None:
        order = iter([0, 4, 2, 3, 1, 6, 6, 5, 9, 7])
        while True:
            data, sender = there.recvfrom(65536)
            session, _, flags, time, _ = unpacked(data)
            if flags & END:
                return
            number = next(order, None)
            if number is not None:
                there.sendto(packed(session, number, ANSWER | (START if not number else 0), time, [number]), sender)

    other = beside(port, talk)
    with simulator_of(outside(free(port), cache, ["u"], ["y", *COUNTED])) as simulator:
        found = simulator.run(stop=0.12, step=0.01)
    other.join()
    assert np.all(np.diff(found[:, 0]) >= 0.0)
    assert found[-1, 0] == 9.0
    assert found[-1, 2] == 6.0  # 2, 3, 1, 6 again, 5 and 7
    assert set(found[:, 0]) <= {0.0, 4.0, 6.0, 9.0}


def test_steps_end_at_their_deadlines_and_no_sooner(port, cache):
    def talk(there: socket.socket) -> None:
        while True:
            data, sender = there.recvfrom(65536)
            session, sequence, flags, time, _ = unpacked(data)
            if flags & END:
                return
            there.sendto(packed(session, sequence, ANSWER | (START if not sequence else 0), time, [time]), sender)

    other = beside(port, talk)
    with simulator_of(outside(free(port), cache, ["u"], ["y", *COUNTED])) as simulator:
        found = simulator.run(stop=0.12, step=0.01)
    other.join()
    assert np.all(found[1:, 4] >= 0.0)  # how late each step came back
    assert np.all(np.diff(found[:, 3]) >= 0.0)


def test_a_server_in_real_time_takes_the_newest_request_and_never_an_older_one(port, cache):
    said: list[tuple[int, float]] = []

    def ask() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
            line.connect(("127.0.0.1", port))
            line.settimeout(0.02)
            for number in (0, 3, 1, 2, 7, 4):
                for _ in range(200):
                    try:
                        line.send(packed(5, number, START if not number else 0, 0.0, [number]))
                        _, _, flags, time, _ = unpacked(line.recv(65536))
                    except (TimeoutError, ConnectionRefusedError):
                        sleep(0.02)
                        continue
                    said.append((flags, time))
                    break
            for _ in range(3):
                line.send(packed(5, 9, END, 0.0, [0.0]))

    asking = threading.Thread(target=ask)
    asking.start()
    with simulator_of(outside(free(port, LinkRole.SERVER), cache, ["u"], ["y"]), {"u": 1.0}) as simulator:
        found = simulator.run(stop=5.0, step=0.01)
    asking.join()
    assert len(found) < 500  # it was ended
    assert np.all(np.diff(found[:, 0]) >= 0.0)
    assert found[-1, 0] == 7.0
    times = [time for _, time in said]
    assert times == sorted(times)


def test_silence_ends_a_run_in_real_time_by_name(port, cache):
    def talk(there: socket.socket) -> None:
        data, sender = there.recvfrom(65536)
        there.sendto(packed(unpacked(data)[0], 0, ANSWER | START, 0.0, [1.0]), sender)

    other = beside(port, talk)
    said = r"it: .*in 0.5 s no packet that can be used came from 127"
    with simulator_of(outside(free(port), cache, ["u"], ["y"])) as simulator, pytest.raises(RunFailed, match=said):
        simulator.run(stop=5.0, step=0.01)
    other.join()


def test_a_socket_that_is_inherited_is_talked_through(cache: Path, monkeypatch):
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    monkeypatch.setenv("DSE_LIVE_SOCKET", str(theirs.fileno()))

    def talk() -> None:
        while True:
            session, sequence, flags, time, values = unpacked(ours.recv(65536))
            if flags & END:
                return
            ours.send(packed(session, sequence, ANSWER | (START if not sequence else 0), time, [2.0 * values[0]]))

    other = threading.Thread(target=talk)
    other.start()
    source = UdpSource(0, "", LinkRole.CLIENT, LinkMode.FREE)
    with ours, theirs:
        with simulator_of(outside(source, cache, ["u"], ["y"]), {"u": 4.0}) as simulator:
            found = simulator.run(stop=0.05, step=0.01)
        other.join()
    assert found.ravel().tolist() == [8.0] * 6
