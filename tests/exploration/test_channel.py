"""Messages on the channel arrive whole or not at all, and nobody waits for the rest of one."""

from __future__ import annotations

import pickle
import socket
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import pytest
from hypothesis import given, strategies as st

from dse.exploration.supervision.channel import _HEAD, _MARK, Channel, GarbledError, receive, send

MESSAGES = st.lists(st.binary(max_size=300) | st.none() | st.integers(), max_size=6)


@pytest.fixture
def ends() -> Iterator[tuple[Channel, socket.socket]]:
    near, far = socket.socketpair()
    with near, far:
        yield Channel(near), far


def bytes_of(*messages: object) -> bytes:
    near, far = socket.socketpair()
    with near, far:
        for message in messages:
            send(near, message)
        near.shutdown(socket.SHUT_WR)
        return b"".join(iter(lambda: far.recv(1 << 16), b""))


def taken(channel: Channel) -> list[object]:
    return list(channel.arrived())


@given(MESSAGES, st.integers(1, 50))
def test_messages_arrive_as_they_were_sent_in_pieces_of_any_size(messages: list[object], size: int) -> None:
    content = bytes_of(*messages)
    near, far = socket.socketpair()
    with near, far:
        channel, got = Channel(near), []
        for begin in range(0, len(content), size):
            far.sendall(content[begin : begin + size])
            got += taken(channel)
    assert got == messages


@given(st.lists(st.binary(max_size=300), min_size=1, max_size=4), st.data())
def test_a_byte_that_was_changed_is_told_or_makes_a_message_be_missed(
    messages: list[bytes], data: st.DataObject
) -> None:
    content = bytearray(bytes_of(*messages))
    place = data.draw(st.integers(0, len(content) - 1))
    content[place] ^= data.draw(st.integers(1, 255))
    near, far = socket.socketpair()
    with near, far:
        far.sendall(content)
        got: list[object] = []
        with suppress(GarbledError):
            got.extend(Channel(near).arrived())
    # No message is taken for another one.
    assert got == messages[: len(got)]
    assert len(got) < len(messages)


@given(st.binary(min_size=8, max_size=100).filter(lambda content: not content.startswith(b"dse line")))
def test_what_is_no_message_is_told_at_once(content: bytes) -> None:
    near, far = socket.socketpair()
    with near, far:
        far.sendall(content)
        with pytest.raises(GarbledError):
            taken(Channel(near))


class Told:
    """Tells that it was made."""

    made = False

    def __reduce__(self) -> tuple[object, ...]:
        return setattr, (Told, "made", True)


def test_what_a_worker_sends_calls_nothing(ends: tuple[Channel, socket.socket]) -> None:
    channel, far = ends
    body = pickle.dumps(Told())
    far.sendall(_HEAD.pack(_MARK, len(body), zlib.crc32(body)) + body)
    with pytest.raises(GarbledError):
        taken(channel)
    assert not Told.made


def test_what_was_sent_before_garbage_is_taken_first(ends: tuple[Channel, socket.socket]) -> None:
    channel, far = ends
    send(far, "good")
    far.sendall(b"garbage")
    arrived = channel.arrived()
    assert next(arrived) == "good"
    with pytest.raises(GarbledError):
        next(arrived)


def test_nobody_waits_for_the_rest_of_a_message(ends: tuple[Channel, socket.socket]) -> None:
    channel, far = ends
    content = bytes_of("whole")
    far.sendall(content[:-1])
    assert taken(channel) == []
    far.sendall(content[-1:])
    assert taken(channel) == ["whole"]


def test_the_end_of_the_worker_is_told_after_what_it_sent(ends: tuple[Channel, socket.socket]) -> None:
    channel, far = ends
    send(far, "last words")
    far.close()
    arrived = channel.arrived()
    assert next(arrived) == "last words"
    with pytest.raises(EOFError):
        next(arrived)


def test_sending_waits_for_nobody_and_loses_nothing(ends: tuple[Channel, socket.socket]) -> None:
    channel, far = ends
    messages = [bytes([n]) * 1_000_000 for n in range(5)]  # more than any system keeps for a socket
    for message in messages:
        channel.send(message)  # nobody reads
    with ThreadPoolExecutor(1) as pool:
        got = pool.submit(lambda: [receive(far) for _ in messages])
        while not got.done():
            channel.flush()
        assert got.result() == messages


def test_a_worker_whose_supervisor_is_gone_is_told(ends: tuple[Channel, socket.socket]) -> None:
    channel, far = ends
    channel.close()
    with pytest.raises(EOFError):
        receive(far)
