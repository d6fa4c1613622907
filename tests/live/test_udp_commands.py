"""`dse udp` as people use it who write a world, or a client."""

from __future__ import annotations

import contextlib
import ctypes
import json
import math
import random
import select
import shutil
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from answerers import packed, unpacked
from background import LIMIT, in_background
from command_line import run_dse
from live_worlds import ANSWER, END, START, World, free_port, right_bytes, running, served

from dse.errors import DseError
from dse.live import Datagram, check_client, listen_at, read_recording, tap, write_datagram, write_head
from dse.live.client import trial_values

PATIENT = ("--timeout", str(LIMIT))
CLIENTS = Path(__file__).parents[2] / "clients"


@pytest.fixture
def dse(tmp_path):
    return lambda *words: run_dse(tmp_path, *words, cache=tmp_path / "cache")


# ---- check ----


def test_check_tells_a_right_world_by_its_exit_code(dse):
    with served(World()) as port:
        done = dse("udp", "check", f"127.0.0.1:{port}", "--out", "1", "--back", "2", "--steps", "5", *PATIENT)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "ok        answers BUSY to a second client" in done.stdout
    assert "median [ms]" in done.stdout


def test_check_tells_what_is_wrong_and_ends_with_3(dse):
    with served(World(write=lambda *told: right_bytes(*told)[:-4], copies=20)) as port:  # which are given up at once
        words = ("--out", "1", "--back", "2", "--steps", "5", *PATIENT, "--format", "json")
        done = dse("udp", "check", f"127.0.0.1:{port}", *words)
    assert done.returncode == 3
    told = {check["check"]: check for check in json.loads(done.stdout)["checks"]}
    assert "the closing sequence is missing" in told["bytes of its packets"]["said"][0]
    assert told["answers every step"]["ok"] is None


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("check", "--out", "1", "--back", "1"), "give either HOST:PORT of a world, or --listen"),
        (("check", "localhost", "--out", "1"), "'localhost' is not a HOST:PORT"),
        (("check", "127.0.0.1:5005"), "define the values"),
        (("check", "127.0.0.1:5005", "--out", "8001"), "8001 values: a packet has 8000 at most"),
        (("check", "no.such.host.invalid:5005", "--out", "1"), "no.such.host.invalid:5005"),
        (("show", "missing.jsonl"), "missing.jsonl"),
        (("layout", "--layout", "missing.yaml"), "missing.yaml"),
    ],
)
def test_what_cannot_be_is_refused_in_one_error(dse, words, said):
    done = dse("udp", *words)
    assert done.returncode in (1, 2)
    assert said in " ".join(done.stderr.replace("│", " ").split())
    assert "Traceback" not in done.stderr


# ---- a client that is checked ----


def ask_all(port: int, steps: int, resends: bool = True, time_of=lambda step: 0.01 * step, ends: bool = True) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.connect(("127.0.0.1", port))
        line.settimeout(0.02)
        for sequence in range(steps + 1):
            request = packed(5, sequence, 0 if sequence else START, time_of(max(0, sequence - 1)), [0.25])
            line.send(request)
            for _ in range(int(LIMIT / 0.02)):
                try:
                    data = line.recv(65536)
                except TimeoutError:
                    if not resends:
                        break
                    line.send(request)
                    continue
                if len(data) == 44 and data[4:12] == request[4:12] and data[-4:] == request[-4:]:
                    break
        if ends:
            line.send(packed(5, steps + 1, 2, 1.0, [0.25]))


def checked_client(patience: float = LIMIT, **client) -> dict[str, str]:
    with listen_at("127.0.0.1", 0) as line, in_background(ask_all, line.getsockname()[1], 25, **client):
        found = check_client(line, 1, 2, step=0.01, wait=2 * LIMIT, patience=patience)
    assert found.is_right == all(check.is_right for check in found.checks)
    return {check.name: " / ".join(check.said) for check in found.checks if not check.is_right}


def test_a_client_that_mends_what_is_lost_is_right():
    assert checked_client() == {}


def test_a_client_that_comes_late_has_as_much_time_for_its_steps(monkeypatch):
    clock = 0.0

    def wait(lines: list[socket.socket], _writes: list, _errors: list, left: float):
        """The first packet comes after more than the patience for those that follow."""
        nonlocal clock
        if clock == 0.0:
            clock = min(left, 1.5 * LIMIT)
            if clock == left:
                return [], [], []
        return select.select(lines, [], [], left)

    told = SimpleNamespace(monotonic=lambda: clock, perf_counter=lambda: clock)
    monkeypatch.setattr("dse.live.client_check.time", told)
    monkeypatch.setattr("dse.live.client_check.select", SimpleNamespace(select=wait))
    assert checked_client() == {}


def test_a_client_that_never_asks_again_is_told():
    assert "although the last one was not answered" in checked_client(resends=False)["repeats unanswered requests"]


def test_a_client_whose_time_stands_is_told():
    assert "is not later than that of the one before" in checked_client(time_of=lambda step: 0.5)["time advances"]


def test_a_client_that_goes_without_a_word_is_told():
    assert "no END arrived" in checked_client(patience=0.2, ends=False)["sends END"]


# ---- record and show ----


class _Enough(Exception):  # noqa: N818  # ends a tap
    """The last datagram came."""


@contextlib.contextmanager
def tapped(line: socket.socket, onward: tuple[str, int]) -> Iterator[list[Datagram]]:
    """What comes to *line* meanwhile, and is passed *onward*."""
    kept: list[Datagram] = []

    def keep(datagram: Datagram) -> None:
        if datagram.data == b"enough":
            raise _Enough
        kept.append(datagram)

    def go() -> None:
        with contextlib.suppress(_Enough):
            tap(line, onward, keep, most=sys.maxsize, seconds=10 * LIMIT)

    with in_background(go), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ending:
        try:
            yield kept
        finally:
            ending.sendto(b"enough", line.getsockname())


@pytest.mark.thorough
def test_a_tap_between_both_sides_keeps_every_datagram_and_changes_none(tmp_path, dse):
    world = World()
    with (
        served(world) as port,
        listen_at("127.0.0.1", 0) as line,
        tapped(line, ("127.0.0.1", port)) as kept,
    ):
        to = f"127.0.0.1:{line.getsockname()[1]}"
        done = dse("udp", "check", to, "--out", "1", "--back", "2", "--steps", "5", *PATIENT)
    assert done.returncode == 0, done.stdout
    assert [datagram.data for datagram in kept if not datagram.is_answer] == world.heard
    answers = [datagram.data for datagram in kept if datagram.is_answer]
    assert len(answers) > 20
    assert answers == world.said[: len(answers)]  # the last may have come when the tap had ended
    path = tmp_path / "kept.jsonl"
    with path.open("w", encoding="utf-8") as file:
        write_head(file)
        for datagram in kept:
            write_datagram(file, datagram)
    assert [datagram.data for datagram in read_recording(path)] == [datagram.data for datagram in kept]
    shown = dse("udp", "show", str(path), "--out", "1", "--back", "2", "--limit", "50")
    assert shown.returncode == 0
    assert "START|ANSWER" in shown.stdout
    assert f"and {len(kept) - 50} more" in shown.stderr


def test_answers_go_to_a_port_of_their_own_if_a_client_listens_elsewhere():
    with served(World()) as port, listen_at("127.0.0.1", 0) as line, listen_at("127.0.0.1", 0) as ear:
        kept: list[Datagram] = []
        options = {"most": 2, "seconds": LIMIT, "answers": ("127.0.0.1", ear.getsockname()[1])}
        ear.settimeout(LIMIT)
        with (
            in_background(tap, line, ("127.0.0.1", port), kept.append, **options),
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as mouth,
        ):
            mouth.sendto(packed(5, 0, START, 0.0, [0.5]), ("127.0.0.1", line.getsockname()[1]))
            assert ear.recv(65536) == right_bytes(5, 0, ANSWER | START, 0.0, (0.5, 1.0))


@pytest.mark.thorough
def test_record_writes_what_comes_to_a_port_and_show_says_what_is_wrong_with_it(tmp_path, dse):
    port, path = free_port(), tmp_path / "heard.jsonl"
    command = [sys.executable, "-m", "dse", "udp", "record", str(port), str(path), "--count", "2"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as recording:
        assert "listening" in recording.stderr.readline()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
            line.sendto(packed(5, 1, ANSWER, 0.5, [7.25]), ("127.0.0.1", port))
            line.sendto(b"hello", ("127.0.0.1", port))
        assert "2 datagrams" in recording.communicate(timeout=LIMIT)[0]
    assert recording.returncode == 0
    first, second = json.loads(dse("udp", "show", str(path), "--format", "json").stdout)
    assert (first["values"], first["wrong"]) == ({"1": 7.25}, "")
    assert "begins with 0x6c6c6568" in second["wrong"]


@pytest.mark.parametrize("text", ["", "{}\n", "[" * 9000, '{"format": "dse udp recording 1"}\n{"time": 1}\n'])
def test_a_file_that_is_no_recording_is_refused_with_its_line(tmp_path, text):
    path = tmp_path / "other.jsonl"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DseError, match=r"other.jsonl:[12]"):
        list(read_recording(path))


def test_a_line_that_was_being_written_is_left_out(tmp_path):
    path = tmp_path / "cut.jsonl"
    with path.open("w", encoding="utf-8") as file:
        write_head(file)
        write_datagram(file, Datagram(0.5, False, "x:1", b"ab"))
        file.write('{"time": 1')
    assert [datagram.data for datagram in read_recording(path)] == [b"ab"]


# ---- layout ----


def test_a_layout_is_written_and_read_again(tmp_path, dse):
    path = tmp_path / "car.yaml"
    path.write_text('out: ["torque[1] [N*m]", mode]\nback: [speed]\n', encoding="utf-8")
    again = tmp_path / "again.yaml"
    assert dse("udp", "layout", "--layout", str(path), "-o", str(again)).returncode == 0
    told = [json.loads(dse("udp", "layout", "--layout", str(f), "--format", "json").stdout) for f in (path, again)]
    assert told[0] == told[1]
    assert told[0]["out"]["values"][0] == {"offset": 24, "name": "torque[1]", "unit": "N*m"}
    assert (told[0]["out"]["size"], told[0]["back"]["size"]) == (44, 36)
    assert "sequence again" in dse("udp", "layout", "--layout", str(path)).stdout


def test_a_component_is_asked_with_values_that_its_ports_can_have(tmp_path, dse):
    path = tmp_path / "car.yaml"
    path.write_text('out: [force, "on [0 or 1]", "gear [0 park, 1 drive]"]\nback: []\n', encoding="utf-8")
    with listen_at("127.0.0.1", 0) as line:
        heard: list[Datagram] = []
        with in_background(tap, line, None, heard.append, most=2, seconds=LIMIT):
            dse("udp", "check", f"127.0.0.1:{line.getsockname()[1]}", "--layout", str(path), "--timeout", "0.1")
    assert unpacked(heard[0].data)[4] == (0.0, 0.0, 0.0)
    trial = trial_values(3, 1, frozenset({1, 2}))
    assert (0 < trial[0] < 1, trial[1:]) == (True, (1.0, 1.0))


# ---- clients/ ----


@pytest.fixture(scope="module")
def c_world(tmp_path_factory):
    compiler = shutil.which("cc")
    if not compiler:
        pytest.skip("no C compiler")
    made = tmp_path_factory.mktemp("c") / "example_world"
    options = ["-std=c99", "-D_DEFAULT_SOURCE", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wno-unused-function"]
    subprocess.run([compiler, *options, "-O2", str(CLIENTS / "c/example_world.c"), "-o", str(made)], check=True)
    return [str(made)]


@pytest.fixture(scope="module")
def csharp_world(tmp_path_factory):
    compiler, runtime = shutil.which("mcs"), shutil.which("mono")
    if not (compiler and runtime):
        pytest.skip("no C# compiler: mcs and mono of the packages mono-mcs and mono-runtime")
    made = tmp_path_factory.mktemp("csharp") / "ExampleWorld.exe"
    sources = [str(CLIENTS / name) for name in ("unity/Runtime/DseUdp.cs", "csharp/ExampleWorld.cs")]
    subprocess.run([compiler, "-langversion:7", "-warnaserror", f"-out:{made}", *sources], check=True)
    return [runtime, str(made)]


@pytest.mark.parametrize("language", ["c", "csharp", "unity", "godot"])
@pytest.mark.thorough
def test_the_example_worlds_pass_the_check(language, request, dse):
    port = free_port()
    with running([*request.getfixturevalue(f"{language}_world"), str(port)]):
        for _ in range(2):  # a world is there for more than one client
            done = dse("udp", "check", f"127.0.0.1:{port}", "--out", "1", "--back", "3", "--steps", "50", *PATIENT)
            assert done.returncode == 0, done.stdout


@pytest.mark.thorough
def test_the_deadlines_of_a_world_in_c_are_absolute(tmp_path):
    """Of a step of 10 ms, however late each wake-up is; a delay of more than 0.1 s moves the later deadlines."""
    compiler = shutil.which("cc")
    if not compiler:
        pytest.skip("no C compiler")
    made = tmp_path / "clock.so"
    (tmp_path / "clock.c").write_text(
        '#include "dse_udp.h"\n'
        "double next_deadline(double last, double now) { return dse_udp_deadline(last, 0.01, now); }\n"
    )
    options = ["-std=c99", "-D_DEFAULT_SOURCE", "-shared", "-fPIC", "-Wno-unused-function", f"-I{CLIENTS / 'c'}"]
    subprocess.run([compiler, *options, str(tmp_path / "clock.c"), "-o", str(made)], check=True)
    following = ctypes.CDLL(str(made)).next_deadline
    following.restype, following.argtypes = ctypes.c_double, [ctypes.c_double, ctypes.c_double]
    deadline = 100.0
    for late in [0.009, 0.0, 0.05, 0.02] * 50:  # each wake-up is so late
        deadline = following(deadline, deadline + late)
    assert deadline == pytest.approx(102.0)
    assert following(102.0, 102.2) == 102.2


@pytest.mark.thorough
@pytest.mark.parametrize("language", ["c", "csharp"])
def test_in_free_mode_the_example_worlds_go_on_by_their_own_clock(language, request):
    port = free_port()
    with (
        running([*request.getfixturevalue(f"{language}_world"), str(port), "free"]),
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line,
    ):
        line.connect(("127.0.0.1", port))
        line.settimeout(LIMIT)
        for session in (5, 6):
            line.send(packed(session, 0, START, 2.0, [0.0]))
            heard = [unpacked(line.recv(65536))]
            while heard[0][0] == session - 1:  # what was on its way
                heard = [unpacked(line.recv(65536))]
            line.send(packed(session, 4, 0, 2.0, [1200.0]))
            line.send(packed(session, 3, 0, 2.0, [-1200.0]))  # overtaken: never back
            while heard[-1][4][1] < 0.05:
                heard.append(unpacked(line.recv(65536)))
            line.send(packed(session, 5, 2, 2.0, [0.0]))
            numbers = [(sequence, flags) for _, sequence, flags, _, _ in heard]
            assert numbers == [(0, ANSWER | START), *((k, ANSWER) for k in range(1, len(heard)))]
            assert {its for its, *_ in heard} == {session}
            assert [time for _, _, _, time, _ in heard] == pytest.approx([2 + 0.01 * k for k in range(len(heard))])
            speeds = [values[1] for *_, values in heard]
            assert speeds == sorted(speeds)


@pytest.mark.thorough
@pytest.mark.parametrize("language", ["c", "csharp", "godot"])
def test_a_model_in_modelica_drives_up_to_the_wall_of_the_example_worlds(language, request, tmp_path):
    """Translated by our compiler; against the same motion in Python, the drive's lag solved exactly in each step."""
    shutil.copytree(CLIENTS / "modelica", tmp_path / "wall")
    port = free_port()
    component = tmp_path / "wall/components/outside/component.yaml"
    patient = component.read_text("utf-8").replace("timeout: 5 s", f"timeout: {LIMIT:g} s")
    component.write_text(patient.replace("5005", str(port)), encoding="utf-8")
    with running([*request.getfixturevalue(f"{language}_world"), str(port)]):
        done = run_dse(tmp_path / "wall", "simulate", "wall", "--format", "json", cache=tmp_path / "cache")
    told = json.loads(done.stdout)
    assert (done.returncode, told["outcome"]) == (0, "done")
    place = speed = force = shown = 0.0
    decay = math.exp(-0.01 / 0.2)
    for _ in range(4000):
        wanted = 300 * (20 - place - 5) - 1500 * speed
        shown, force = force, wanted + (force - wanted) * decay
        middle = speed
        speed += 0.01 * shown / 1200
        place += 0.005 * (middle + speed)
    assert told["metrics"]["final_gap"] == pytest.approx(20 - place, abs=1e-5)  # the model's tolerance is 1e-6


# ---- anything may come ----


def rubbish(count: int, size: int) -> list[bytes]:
    """Random bytes, and packets with a few bytes changed."""
    chance = random.Random(7)  # noqa: S311  # chance that can be repeated
    made = []
    for _ in range(count):
        data = bytearray(packed(chance.choice([5, 6]), chance.randrange(4), chance.randrange(32), 0.5, [0.5] * size))
        if chance.random() < 0.5:
            data = bytearray(chance.randbytes(chance.choice([len(data), chance.randrange(200)])))
        elif chance.random() < 0.8:
            data[chance.randrange(len(data))] = chance.randrange(256)
        made.append(bytes(data))
    return made


def send_all(line: socket.socket, port: int, datagrams: list[bytes]) -> None:
    for number, data in enumerate(datagrams):
        line.sendto(data, ("127.0.0.1", port))
        if number % 50 == 0:
            threading.Event().wait(0.001)  # the other end's buffer is small


@pytest.mark.parametrize("count", [2000, pytest.param(100_000, marks=pytest.mark.thorough)])
def test_random_datagrams_neither_end_a_check_nor_go_uncounted(count):
    is_over = threading.Event()

    def talk(line: socket.socket, port: int, datagrams: list[bytes]) -> None:
        """Send the datagrams, then a session in order, again and again: the check's buffer may be full."""
        send_all(line, port, datagrams)
        heads = [struct.unpack_from("<4i", data) for data in datagrams if len(data) == 36]
        begun = {session for _, session, sequence, flags in heads if flags & START and not sequence}
        ends = [packed(session, 9, END, 1.0, [0.5]) for session in begun | {5}]
        while not is_over.wait(0.01):
            send_all(line, port, [packed(5, 0, START, 0.0, [0.5]), packed(5, 1, 0, 0.0, [0.5]), *ends])

    with listen_at("127.0.0.1", 0) as line, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as theirs:
        line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        with in_background(talk, theirs, line.getsockname()[1], rubbish(count, 1)):
            try:
                found = check_client(line, 1, 2, step=0.01, wait=LIMIT, patience=LIMIT)
            finally:
                is_over.set()
    assert not found.is_right
    assert found.ignored > 0


@pytest.mark.parametrize("count", [2000, pytest.param(100_000, marks=pytest.mark.thorough)])
def test_random_datagrams_are_recorded_as_they_came(tmp_path, count):
    sent, path, is_over = rubbish(count, 1), tmp_path / "rubbish.jsonl", threading.Event()

    def talk(line: socket.socket, port: int) -> None:
        """Send all, then as many others as were dropped."""
        send_all(line, port, sent)
        while not is_over.wait(0.001):
            send_all(line, port, 20 * [b"in place of a dropped one"])

    with (
        listen_at("127.0.0.1", 0) as line,
        path.open("w", encoding="utf-8") as file,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as theirs,
    ):
        line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        write_head(file)
        with in_background(talk, theirs, line.getsockname()[1]):
            try:
                heard = tap(line, None, lambda datagram: write_datagram(file, datagram), most=count, seconds=10 * LIMIT)
            finally:
                is_over.set()
    kept = [datagram.data for datagram in read_recording(path)]
    assert len(kept) == heard == count
    kept = [data for data in kept if data != b"in place of a dropped one"]
    assert kept
    wanted = iter(sent)
    assert all(data in wanted for data in kept)  # in order; the system may have dropped some
