"""A component of the kind udp in lockstep: what goes over the wire, what is mended, how a run ends."""

from __future__ import annotations

import contextlib
import struct
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from answerers import ANSWER, BUSY, END, START, Answerer, Asker, Proxy, bound_socket, packed, unpacked
from background import LIMIT, in_background
from live.conftest import COUNTED, REAL, outside, simulator_of
from live.halves import Halves
from live.test_udp_halves import NEAR, RECORD, folder, whole  # noqa: F401  # a fixture
from numpy.typing import NDArray

from dse.cosim import RunFailed, Simulator
from dse.domain.component import Causality, Kind, Parameter, Port, Type
from dse.domain.method import Method
from dse.domain.udp import LinkRole, UdpSource

GEAR = Type(Kind.ENUMERATION, items=("park", "reverse", "drive"))
INPUTS = ["u", Port("on", Causality.INPUT, Type(Kind.BOOLEAN)), Port("gear", Causality.INPUT, GEAR)]
OUTPUTS = ["y", Port("n", Causality.OUTPUT, Type(Kind.INTEGER)), Port("g", Causality.OUTPUT, GEAR), *COUNTED]
GAIN = Parameter("gain", REAL, 2.0)
STARTED = {"u": 1.5, "on": 1.0, "gear": 2.0}


def client(port: int, cache: Path, version: int = 2, wait: float = LIMIT):
    source = UdpSource(port, timeout=wait, wait=wait)
    return simulator_of(outside(source, cache, INPUTS, OUTPUTS, [GAIN], version), STARTED)


def plain(time: float, step: float, values: tuple[float, ...]) -> list[float]:
    return [values[0] * values[3] + time, round(100 * time), 1.0]


@pytest.mark.parametrize("version", [2, 3])
def test_inputs_and_parameters_go_out_and_outputs_come_back(port, cache, version):
    with Answerer(plain, port=port) as other, client(port, cache, version) as simulator:
        found = simulator.run(stop=0.03, step=0.01)
    assert found[:, :3].tolist() == [[3.0, 0, 1], [3.01, 1, 1], [3.02, 2, 1], [3.03, 3, 1]]
    heard = list(dict.fromkeys(map(unpacked, other.heard)))
    session = heard[0][0]
    assert session > 0
    values = (1.5, 1.0, 2.0, 2.0)
    times = [(0, START, 0.0), (1, 0, 0.0), (2, 0, 0.01), (3, 0, 0.02), (4, END, 0.02)]
    assert heard == [(session, sequence, flags, time, values) for sequence, flags, time in times]
    assert other.heard[0] == struct.pack("<4id4di", 0x44534531, session, 0, START, 0.0, *values, 0)


def test_every_run_of_a_simulator_is_a_session_of_its_own(port, cache):
    with Answerer(plain, port=port) as other, client(port, cache) as simulator:
        first, second = (simulator.run(stop=0.02, step=0.01)[:, : -len(COUNTED)].tobytes() for _ in range(2))
    assert first == second  # but for what is counted: a request that was sent again
    assert len({unpacked(packet)[0] for packet in other.heard}) == 2


@pytest.mark.parametrize("version", [2, 3])
def test_the_other_side_can_end_the_run_and_the_rows_until_then_are_the_result(port, cache, version):
    with Answerer(plain, ends_at=3, port=port), client(port, cache, version) as simulator:
        found = simulator.run(stop=1.0, step=0.01)
    assert found[:, 0].tolist() == [3.0, 3.01, 3.02]


def test_a_server_answers_and_its_run_ends_with_the_session(port, cache):
    source = UdpSource(port, role=LinkRole.SERVER, timeout=LIMIT, wait=LIMIT)
    told: list[tuple[int, float, tuple[float, ...]]] = []

    def ask() -> None:
        with Asker(port, 77) as asker, Asker(port, 78) as other:
            told.append(asker.ask(0, [0.25], START))
            told.extend(asker.ask(k, [k / 4]) for k in range(1, 4))
            told.append(other.ask(0, [9.0], START))
            asker.end(4, 1)

    model = outside(source, cache, ["u"], ["y"])
    with in_background(ask), simulator_of(model, {"u": 5.0}) as simulator:
        found = simulator.run(stop=1.0, step=0.01)
    assert [flags for flags, _, _ in told] == [ANSWER | START, ANSWER, ANSWER, ANSWER, ANSWER | BUSY]
    assert [(time, values) for _, time, values in told[:4]] == [(0.01 * k, (5.0,)) for k in range(4)]
    assert found.ravel().tolist() == [0.25, 0.25, 0.5, 0.75]


def test_a_server_answers_at_another_port_than_it_was_asked_from(port, cache):
    """As Modelica_DeviceDrivers: one socket sends, another one receives."""
    with bound_socket() as back, bound_socket() as out:
        back.settimeout(LIMIT)
        source = UdpSource(port, role=LinkRole.SERVER, timeout=LIMIT, wait=LIMIT, answers=back.getsockname())
        told: list[tuple[int, tuple[float, ...]]] = []

        def ask() -> None:
            back.settimeout(0.05)
            for number, flags in ((0, START), (1, 0), (2, 0)):
                told.append(exchanged(number, flags))
            out.sendto(packed(7, 3, END, 0.0, [0.0]), ("127.0.0.1", port))

        def exchanged(number: int, flags: int) -> tuple[int, tuple[float, ...]]:
            while True:
                out.sendto(packed(7, number, flags, 0.0, [number / 4]), ("127.0.0.1", port))
                with contextlib.suppress(TimeoutError):
                    _, sequence, _, _, values = unpacked(back.recv(65536))
                    if sequence == number:
                        return sequence, values

        model = outside(source, cache, ["u"], ["y"])
        with in_background(ask), simulator_of(model, {"u": 5.0}) as simulator:
            found = simulator.run(stop=1.0, step=0.01)
        assert told == [(0, (5.0,)), (1, (5.0,)), (2, (5.0,))]
        assert found.ravel().tolist() == [0.0, 0.25, 0.5]
        out.setblocking(False)
        with pytest.raises(BlockingIOError):
            out.recv(65536)


def answering(port: int, answers: Callable[[tuple[int, ...], int], list[bytes]], cache: Path) -> Answerer:
    """The other side sends what *answers* makes of a request's head, once if the request is sent again."""

    class Odd(Answerer):
        def _serve(self) -> None:
            answered = set()
            while True:
                data, sender = self.socket.recvfrom(65536)
                if not data:
                    return
                session, sequence, flags, time, _ = unpacked(data)
                if (session, sequence) in answered:
                    continue
                answered.add((session, sequence))
                for answer in answers((session, sequence, flags), round(time * 100)):
                    self.socket.sendto(answer, sender)

    return Odd(plain, port=port)


def wrong(session: int, sequence: int) -> dict[str, bytes]:
    """One packet of each kind that is wrong."""
    good = packed(session, sequence, ANSWER, 0.0, [7.0, 1.0, 0.0])
    return {
        "of a wrong size": good[:-8],
        "of another protocol or version": b"\x32" + good[1:],
        "torn": good[:-1] + b"\x01",
        "with flags that are wrong here": packed(session, sequence, 0, 0.0, [7.0, 1.0, 0.0]),
        "with values that are none": packed(session, sequence, ANSWER, 0.0, [float("nan"), 1.0, 0.0]),
        "of another session": packed(session ^ 1, sequence, ANSWER, 0.0, [7.0, 1.0, 0.0]),
        "old or doubled": packed(session, sequence + 5, ANSWER, 0.0, [7.0, 1.0, 0.0]),
    }


OUT_OF_RANGE = ([7.0, 0.5, 0.0], [7.0, 2.0**31, 0.0], [7.0, 1.0, 3.0], [7.0, 1.0, -1.0], [float("inf"), 1.0, 0.0])


def test_what_is_wrong_is_counted_and_ignored(port, cache):
    def answers(head: tuple[int, ...], k: int) -> list[bytes]:
        session, sequence, flags = head
        if flags & END:
            return []
        bad = [packed(session, sequence, ANSWER, 0.0, values) for values in OUT_OF_RANGE]
        return [*wrong(session, sequence).values(), *bad, packed(session, sequence, ANSWER, 0.0, [1.0, k, 2.0])]

    with answering(port, answers, cache), client(port, cache) as simulator:
        found = simulator.run(stop=0.02, step=0.01)
    assert found[:, :3].tolist() == [[1.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 2.0]]
    assert found[:, 4].tolist() == [12.0, 24.0, 36.0]


def test_a_run_that_hears_nothing_of_use_says_what_it_has_heard(port, cache):
    kinds: list[str] = []

    def answers(head: tuple[int, ...], k: int) -> list[bytes]:
        found = wrong(head[0], head[1])
        kinds[:] = found
        return list(found.values())

    for wait in (0.3, 3.0, 30.0):  # longer, if the other side was too busy to answer
        with (
            answering(port, answers, cache),
            client(port, cache, wait=wait) as simulator,
            pytest.raises(RunFailed) as failed,
        ):
            simulator.run(stop=0.02, step=0.01)
        said = str(failed.value)
        if kinds and all(kind in said for kind in kinds):
            break
    assert "it: fmi2ExitInitializationMode" in said
    assert f"in {wait:g} s no packet that can be used came from 127.0.0.1:{port}; ignored: " in said
    assert [kind for kind in kinds if kind not in said] == []
    assert "(the last of 44 bytes, right are 52)" in said


def test_a_run_without_anybody_says_so(port, cache):
    said = f"in 0.3 s no packet that can be used came from 127.0.0.1:{port}; nobody listens there"
    with client(port, cache, wait=0.3) as simulator, pytest.raises(RunFailed, match=said):
        simulator.run(stop=0.02, step=0.01)


def test_two_clients_of_one_server_take_turns(port, cache):
    first = threading.Event()

    def slow(time: float, step: float, values: tuple[float, ...]) -> list[float]:
        first.set()
        threading.Event().wait(0.01)
        return plain(time, step, values)

    def late() -> NDArray[np.float64]:
        assert first.wait(LIMIT)
        with client(port, cache) as simulator:
            return simulator.run(stop=0.05, step=0.01)[:, :3]

    with (
        Answerer(slow, port=port),
        in_background(late) as waiting,
        client(port, cache, version=3) as simulator,
    ):
        found = simulator.run(stop=0.05, step=0.01)[:, :3]
    assert np.array_equal(found, waiting.result())


@pytest.mark.parametrize(("runs", "steps"), [(2, 40), pytest.param(20, 500, marks=pytest.mark.thorough)])
def test_loss_doubling_and_reordering_change_nothing(folder, cache, port, runs, steps):  # noqa: F811
    made = whole(folder)
    with Simulator(made, RECORD) as simulator:
        expected = simulator.run(stop=0.01 * steps, step=0.01)
    harm = 0
    with Proxy(port, seed=0) as proxy:
        halves = Halves(made, NEAR, cache, port, asks_at=proxy.port)
        for _ in range(runs):
            near, far = halves.run(RECORD[:4], RECORD[4:], Method(), stop=0.01 * steps, step=0.01)
            assert near.tobytes() == expected[:, :4].tobytes()
            assert far.tobytes() == expected[:, 4:].tobytes()
        harm = min(proxy.lost, proxy.doubled, proxy.delayed)
    assert harm > 0
