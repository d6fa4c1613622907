"""Quantities of a road, each within what makes sense."""

from __future__ import annotations

from dse.errors import closest, fail
from dse.formats import Entry
from dse.loading.sections import Plain
from dse.loading.values import read_number
from dse.units import parse_unit

MOST = 100_000.0
"""Metres of a segment, or of a radius; a larger number is a slip."""
STEEPEST = 0.4
"""The largest grade."""
FLAT = 1e-12
"""The largest grade that is none."""
LEVEL = "end the segment before with 'grade: 0'"


def within(raw: Plain, symbol: str, entry: Entry, least: float, most: float) -> float:
    """An SI number, taken to be in the unit *symbol* if it says none, from *least* to *most*. Raises DseError."""
    unit = parse_unit(symbol)
    value = read_number(raw, unit, entry.where)
    if not least <= value <= most:
        bounds = " to ".join(f"{unit.from_si(bound):.6g} {unit}".rstrip() for bound in (least, most))
        name = next(step for step in reversed(entry.path) if isinstance(step, str))
        raise fail(f"'{name}' cannot be {raw}", entry.where, f"from {bounds}")
    return value


def length_of(raw: Plain, entry: Entry) -> float:
    """A length of a stretch of road, in m. Raises DseError."""
    return within(raw, "m", entry, 0.1, MOST)


def pair_of(raw: list[Plain], entry: Entry, least: float, most: float, form: str) -> tuple[float, float]:
    """Two lengths in m, the smaller first, written as *form*. Raises DseError."""
    if len(raw) != 2:
        raise fail(f"'{entry.name}' has a start and an end", entry.where, f"write it as {form}")
    low, high = (within(each, "m", entry[number], least, most) for number, each in enumerate(raw))
    if low >= high:
        raise fail(f"'{entry.name}' ends before it starts", entry.where, f"write it as {form}")
    return low, high


def require_word(word: str, words: tuple[str, ...], entry: Entry) -> None:
    """Raise DseError unless *word* is one of *words*."""
    if word not in words:
        raise fail(f"'{entry.name}' cannot be '{word}'", entry.where, closest(word, words))
