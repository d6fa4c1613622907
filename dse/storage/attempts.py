"""Tries at runs: who made them, how long they took and what they came to. Apart from the results, which never tell."""

from __future__ import annotations

import os
import socket
from dataclasses import dataclass
from functools import cache

STOPPED = "stopped with the program"
"""What a try came to that was under way when its program was stopped or killed."""


@dataclass(frozen=True, slots=True)
class Attempt:
    """One try at *run* by the process *maker* (``HOST/PID``, "" where nobody knows) that took *seconds* (NaN: unknown).

    *cause* is "" if it gave its row, otherwise what it came to, in words.
    """

    run: int
    maker: str
    cause: str
    seconds: float


def this_process() -> str:
    """This process as a maker."""
    return made_by(os.getpid())


def made_by(process: int) -> str:
    """Another process of this machine as a maker."""
    return f"{_host()}/{process}"


@cache
def _host() -> str:
    return socket.gethostname()
