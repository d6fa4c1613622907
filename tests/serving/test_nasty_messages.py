"""Every value of what is sent to the server, and of what is stored in a study, replaced by what a stranger may send."""

from __future__ import annotations

import asyncio
import itertools
import json
import logging
import math
import random
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from asgi_calls import converse, post
from nasty import NASTY, nasty_texts
from served_studies import store_study
from small_drive import drive_workspace

from dse.api import LiveDrive, open as open_workspace
from dse.domain.component import Causality, Kind, Port, Type
from dse.errors import DseError
from dse.report import read_report, served_page
from dse.serving import drives as drives_module
from dse.serving.application import application
from dse.serving.drives import Held, LiveDrives
from dse.serving.driving import MOST_MISTAKES
from dse.serving.guard import Limits
from dse.serving.study_index import StudyIndex
from dse.storage import StudyFolder
from dse.storage.database import connection as stored

FREE = Limits(burst=1 << 40, messages=1e12)

MESSAGES = (
    {"type": "control", "n": 1, "values": {"steering": 0.1, "cruise": True, "gear": "drive", "lane": 2}},
    {"type": "tune", "n": 2, "values": {"car.gain": 1.0}},
    {"type": "finish", "n": 3},
)

KINDS = {
    "steering": Type(Kind.REAL),
    "cruise": Type(Kind.BOOLEAN),
    "gear": Type(Kind.ENUMERATION, items=("park", "drive")),
    "lane": Type(Kind.INTEGER),
}


class Steered(LiveDrive):
    """A drive without a run: what it is told must be numbers."""

    def __init__(self) -> None:
        gain = SimpleNamespace(type=Type(Kind.REAL), minimum=0.0, maximum=9.0, title="")
        ports = tuple(Port(name, Causality.OUTPUT, kind) for name, kind in KINDS.items())
        self.driver_in_loop: Any = SimpleNamespace(controls=ports, tunables={"car.gain": gain})
        self._first = {"tune.car.gain": 1.0}
        self.orders, self._session = 0, self

    session: Any = property(lambda self: self)
    ended: Any = None
    start = finish = lambda self: None
    frame = lambda self: None  # noqa: E731
    scene = lambda self: {}  # noqa: E731

    def command(self, values: Mapping[str, float], number: int) -> None:
        self.orders += 1
        assert all(type(each) is float and math.isfinite(each) for each in values.values())
        assert type(number) is int
        assert 0 <= number < 1 << 53


@pytest.fixture
def live() -> Steered:
    return Steered()


@pytest.fixture
def driven(tmp_path: Path, live: Steered, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(drives_module, "open_drive", lambda *_, **__: live)
    monkeypatch.setattr(drives_module, "MOST_AT_ONCE", 1)
    on = LiveDrives(open_workspace(drive_workspace(tmp_path / "drives")), most=1 << 30)
    on._held["known"] = Held("known", live)
    return application(StudyIndex(store_study(tmp_path / "st", [0.5])), limits=FREE, drives=on)


def say(driven, texts: Iterable[str | bytes]) -> int:
    """How many messages were sent; sockets are closed after some mistakes, and never by anything else."""
    sent, left = 0, (text for text in texts if len(text) <= FREE.message)

    async def all_of_them() -> None:
        nonlocal sent
        while some := [*itertools.islice(left, MOST_MISTAKES)]:
            for part in (some, some[len(some) // 2 :]):  # the first mistakes do not hide what comes behind them
                answers = await converse(driven, "/drive/live?drive=known", part)
                sent += len(part)
                assert {each.get("code", 1008) for each in answers} == {1008}

    asyncio.run(all_of_them())
    return sent


def told(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]


def test_no_value_in_a_control_message_is_more_than_a_mistake(driven, live: Steered, caplog) -> None:
    assert say(driven, map(json.dumps, MESSAGES)) > 0
    assert live.orders == 3  # the second message is sent twice
    say(driven, itertools.chain.from_iterable(map(nasty_texts, MESSAGES)))
    assert live.orders > 20  # not all is nasty where it stands
    assert told(caplog) == []


@pytest.mark.nightly
def test_a_hundred_thousand_messages_of_chance_are_no_more_than_mistakes(driven, caplog) -> None:
    known = [*NASTY, *map(json.dumps, MESSAGES), *itertools.chain.from_iterable(map(nasty_texts, MESSAGES))]
    assert say(driven, of_chance(known, 70_000)) >= 100_000
    assert told(caplog) == []


def of_chance(known: list[str], count: int) -> Iterator[str | bytes]:
    chance = random.Random(7)  # noqa: S311  # can be repeated
    for _ in range(count):
        text = bytearray(chance.choice(known).encode()[:4000] or b" ")
        for _ in range(chance.randrange(4)):
            text[chance.randrange(len(text))] = chance.randrange(32, 127)
        yield text.decode() if chance.random() < 0.9 else bytes(text)


BODIES = {
    "/simulate?study=st": {"configuration": "c1", "point": {"controller.kp": 0.5}},
    "/drive/start": {"bench": "field", "chosen": {"car": "dot"}, "configuration": "", "driver": "Ada"},
    "/drive/start?": {"bench": "field", "chosen": "car:dot"},
    "/stop?study=st": {},
    "/replay?study=st&run=0": {},
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", BODIES)
def test_no_value_in_a_body_is_more_than_a_refusal(driven, caplog, path: str) -> None:
    async def all_of_them() -> list[int]:
        found = []
        for text in (json.dumps(BODIES[path]), *NASTY, *nasty_texts(BODIES[path])):
            status, words = await post(driven, path, text.encode())
            assert status in (200, 409, 413), (text[:200], words[:200])
            assert status == 200 or words.strip(), text[:200]
            found.append(status)
        return found

    statuses = asyncio.run(all_of_them())
    assert 409 in statuses
    assert told(caplog) == []


def rewrite(path: Path, key: str, text: str) -> None:
    """Put *text* in the place of a fact, with a seal that fits if it can be made."""
    with closing(sqlite3.connect(path / "study.sqlite")) as connection, connection:
        facts = dict(connection.execute("SELECT key, value FROM facts")) | {key: text}
        try:
            checksum = stored._header_checksum(
                {key: json.loads(value) for key, value in facts.items()}, stored.read_sampler_requests(connection)
            )
        except (ValueError, RecursionError, KeyError):
            checksum = ""
        connection.execute("INSERT OR REPLACE INTO facts VALUES (?, ?)", (key, text))
        connection.execute("UPDATE facts SET value = ? WHERE key = 'seal'", (json.dumps(checksum),))


def facts_of(path: Path) -> dict[str, str]:
    with closing(sqlite3.connect(path / "study.sqlite")) as connection:
        return dict(connection.execute("SELECT key, value FROM facts WHERE key != 'seal'"))


def shown(path: Path) -> bool:
    """Whether there is a report. Nothing but a DseError may be the reason that there is none."""
    try:
        served_page(read_report(path), {})
    except DseError:
        return False
    return True


def nasty_facts(path: Path) -> list[tuple[str, str]]:
    return [(key, text) for key, value in facts_of(path).items() for text in nasty_texts(json.loads(value))]


def full_study(path: Path) -> Path:
    """A study whose header has something of everything."""
    store_study(path, [0.5, 1.5])
    definition = json.loads(facts_of(path)["definition"])
    definition["variables"][0] |= {
        "role": "uncertain",
        "distribution": {"kind": "uniform", "numbers": {"low": 0.0, "high": 1.0}, "values": []},
    }
    definition |= {
        "figures": [{"name": "f", "title": "", "unit": "m", "current": "world.gap", "target": "world.goal"}],
        "objectives": [{"name": "overshoot", "maximize": False, "is_total": False, "is_composite": False}],
        "derived": {"controller.ki": "controller.kp / 2"},
        "constraints": ["controller.kp < 2"],
        "correlations": [{"one": "controller.kp", "other": "controller.kp", "value": 0.5}],
        "other_simulations": {"town": {"stop": 1.0, "step": 0.1, "record_every": 0.1, "method": {"kind": "plain"}}},
        "ignored": ["a"],
        "fmus": {"radar": "0123"},
    }
    rewrite(path, "definition", json.dumps(definition))
    step = {"constraint": "budget", "because": "", "rule": "", "count": 3.0, "text": "3"}
    absent = {"place": "sensor", "choice": "lidar", "constraints": ["budget"]}
    funnel = {"design": "vehicle", "count": 4.0, "text": "4", "steps": [step], "absent": [absent]}
    rewrite(path, "notes", json.dumps({"sources": [], "funnel": funnel, "unfunnelled": ""}))
    return path


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of numbers near the ends of what floats can be
@pytest.mark.parametrize("part", [pytest.param(97, id="some"), pytest.param(1, id="all", marks=pytest.mark.nightly)])
def test_no_value_of_a_stored_header_is_more_than_damage(tmp_path: Path, part: int) -> None:
    path = full_study(tmp_path / "st")
    whole, found = facts_of(path), []
    assert shown(path)
    for key, text in nasty_facts(path)[::part]:
        rewrite(path, key, text)
        found.append(shown(path))
        rewrite(path, key, whole[key])
    assert shown(path)
    assert {*found} == {True, False}


def test_no_value_of_a_stored_point_is_more_than_damage(tmp_path: Path) -> None:
    path = store_study(tmp_path / "st", [0.5, 1.5])
    for text in NASTY:
        with closing(sqlite3.connect(path / "study.sqlite")) as connection, connection:
            connection.execute("""UPDATE runs SET seal = NULL, "p:controller.kp" = ? WHERE number = 1""", (text,))
        with StudyFolder.open(path) as folder, suppress(DseError):
            folder.table()
        shown(path)
