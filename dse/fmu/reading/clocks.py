"""Clocks of FMI 3.0: what ticks when, and which variables belong to them."""

from __future__ import annotations

from dse.domain.fmu import ClockKind, Timing
from dse.errors import Problem
from dse.formats import XmlElement, shortened, whole_of

_MOST = 2**53  # as exact as a double


def read_clocks(element: XmlElement, problems: list[Problem]) -> tuple[int, ...]:
    """The references of the clocks that a variable belongs to."""
    words = element.get("clocks").split()
    found = [number for number in map(whole_of, words) if number is not None]
    if len(found) < len(words):
        what = f"<{element.tag}>: 'clocks' must be a list of references, not '{shortened(element.get('clocks'))}'"
        problems.append(Problem(what, element.where))
    return tuple(dict.fromkeys(found))


def read_timing(element: XmlElement, subject: str, problems: list[Problem]) -> Timing:
    """When the clock ticks that *element* describes and messages call *subject*."""
    word = element.word("intervalVariability", [kind.value for kind in ClockKind], problems)
    if "intervalVariability" not in element.attributes:
        problems.append(
            Problem(f"{subject} does not declare when it ticks: it has no 'intervalVariability'", element.where)
        )
    kind = ClockKind(word) if word else ClockKind.TRIGGERED
    has_fractions = element.flag("supportsFraction", problems)
    counts = {
        name: element.whole(name, problems, least=0, most=_MOST)
        for name in ("resolution", "intervalCounter", "shiftCounter")
    }
    seconds = {name: element.real(name, problems) for name in ("intervalDecimal", "shiftDecimal")}
    interval, shift, resolution = seconds["intervalDecimal"], seconds["shiftDecimal"] or 0.0, 1.0
    if counts["resolution"] and counts["intervalCounter"]:
        interval, shift = float(counts["intervalCounter"]), float(counts["shiftCounter"] or 0)
        resolution = float(counts["resolution"])
    if interval is None:
        if kind is ClockKind.CONSTANT:
            problems.append(Problem(f"{subject} is a constant clock, but has no interval", element.where))
        return Timing(kind, has_fractions=has_fractions)
    if not (0.0 < interval < float("inf") and 0.0 <= shift < float("inf")):
        what = f"{subject} cannot tick every {interval / resolution:g} s from {shift / resolution:g} s on"
        problems.append(Problem(what, element.where))
    return Timing(kind, True, interval, shift, resolution, has_fractions)
