"""The lines of house.toml hold: what grows is named, what shrinks can be written down."""

from __future__ import annotations

import runpy
from pathlib import Path

compared = runpy.run_path(str(Path(__file__).parents[1] / ".ci" / "house.py"))["compared"]

TEXT = """# a comment stays
[dse] # Python
lines = 100 # 50
files = 7

[rooms]
space = { lines = 60, files = 4 }
spaces = { lines = 40, files = 3 }
"""


def test_what_grows_is_named_with_its_line_and_changes_nothing() -> None:
    wrong, text = compared(TEXT, {"dse": {"lines": 103}, "rooms.space": {"files": 5}}, lowers=True)
    assert wrong == [
        "dse: 103 lines, 3 above the line of 100 in house.toml",
        "rooms.space: 5 files, 1 above the line of 4 in house.toml",
    ]
    assert text == TEXT


def test_a_room_without_a_line_is_named() -> None:
    wrong, _ = compared(TEXT, {"rooms.new": {"lines": 9}}, lowers=False)
    assert wrong == ["rooms.new has no line for lines in house.toml; today: 9"]


def test_what_shrinks_is_written_down_if_it_is_asked_for() -> None:
    numbers = {"dse": {"lines": 90, "files": 7}, "rooms.space": {"lines": 50, "files": 4}}
    wrong, text = compared(TEXT, numbers, lowers=True)
    assert wrong == []
    assert text == TEXT.replace("lines = 100 # 50", "lines = 90 # 50").replace("lines = 60", "lines = 50")
    assert compared(TEXT, numbers, lowers=False) == ([], TEXT)
