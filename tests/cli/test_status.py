"""What a person at a terminal is told while a command takes long."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

SLOW = """
import sys, time
from dse.cli import terminal
from dse.cli.terminal import status_line
terminal._PATIENCE = float(sys.argv[2])
with status_line() as show:
    show("checking components: 7 of 29 (combustion[6at]\\x1b[31m)")
    time.sleep(float(sys.argv[1]))
print("done")
"""


def on_a_terminal(*arguments):
    """What the command writes to a terminal, as the terminal gets it."""
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "100"}
    process = subprocess.Popen([sys.executable, "-c", SLOW, *arguments], env=environment, stdout=theirs, stderr=theirs)
    os.close(theirs)
    said = b""
    try:
        while part := os.read(ours, 4096):
            said += part
    except OSError:  # how Linux says that the other side has gone
        pass
    os.close(ours)
    assert process.wait() == 0
    return said.decode()


@pytest.mark.thorough
def test_what_takes_more_than_a_second_is_told_on_a_terminal():
    said = on_a_terminal("1.6", "1")
    assert "checking components: 7 of 29 (combustion[6at]" in said
    assert "\x1b[31m" not in said
    assert said.rstrip().endswith("done")


def test_what_is_done_at_once_is_not_told():
    assert on_a_terminal("0", "60").strip() == "done"


@pytest.mark.thorough
def test_nothing_is_told_where_there_is_no_terminal():
    done = subprocess.run([sys.executable, "-c", SLOW, "1.2", "1"], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("done\n", "")
