"""Reads how much memory a simulation may use."""

from __future__ import annotations

from dse.errors import DseError, Location, Problem
from dse.loading.values import Raw, read_number, read_unit

_LEAST = 256e6


def read_memory(raw: Raw, where: Location, problems: list[Problem]) -> float:
    """Bytes; what is wrong with *raw* is added to *problems*."""
    byte = read_unit("B", where)
    try:
        value = read_number(raw, byte, where) / float(byte.factor)  # the registry counts in bits
    except DseError:
        problems.append(Problem(f"'memory' is no amount of memory: '{raw}'", where, "write it as '4 GB'"))
        return _LEAST
    if value < _LEAST:
        shown = raw if isinstance(raw, str) and not raw[-1:].isdigit() else f"{raw} B"
        what = f"'memory' is {shown}, less than a simulating process needs by itself"
        problems.append(Problem(what, where, "write it as '4 GB'; at least 256 MB"))
    return value
