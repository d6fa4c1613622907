"""How long a step of a generated model is: by its descriptor, by its scheduler or by its comments, in that order."""

from __future__ import annotations

import math
import re
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from dse.errors import Location, closest, fail

_SAMPLED = 2
"""The timing mode of what runs periodically."""

_SHORTEST, _LONGEST = 1e-9, 1e9
_FINEST = 10**12
"""Periods are fractions of a second with at most this denominator."""

_MOST_TICKS = 100_000
_PERIOD = r"Sample time: \[([\d.eE+-]+)s(?:, ([\d.eE+-]+)s)?\]"
_TICKED = re.compile(rf"TID\[\d+\]\)? > (\d{{1,9}})\)\s*\{{\s*(?:/\*|//) {_PERIOD}")
_COMPUTED = (
    ("stepSize0", re.compile(r"rtmSetTStep\([^,;]{0,120},\s*([\d.eE+-]+)\)|stepSize0\s*=\s*([\d.eE+-]+)")),
    ("the fixed step", re.compile(r"FixedStepSize\([^,]{0,120},\s*([\d.eE+-]+)\)")),
    ("its clock", re.compile(r"clockTick0\)?\s*\*\s*([\d.eE+-]+)")),
)
"""What the code computes with."""

_MAIN = re.compile(r"period\s+([\d.eE+-]+)\s+seconds\s+\((?:the\s+model's\s+base\s+sample\s+time|base\s+rate\s+of)")
"""What the generated main program says of whoever calls it: of the base rate, whatever rates blocks have."""

_COMMENTED = (
    ("the comment of its timer", re.compile(r"resolution of this integer timer is\s+\*?\s*([\d.eE+-]+)")),
    ("the comment of its step", re.compile(r"Sample time: \[([\d.eE+-]+)s")),
)


@dataclass(frozen=True, slots=True)
class Timing:
    """A step of *step* s, known from *source*; each function of a step runs every so many of them.

    *is_only_commented*: nothing computes with that step, so that the comment may be of a slower rate.
    """

    step: float
    source: str
    rates: tuple[int, ...]
    is_only_commented: bool = False


def timing(
    folder: Path,
    text: str,
    main: str,
    steps: Sequence[str],
    *,
    is_rated: bool,
    given: float | None,
    rates: Mapping[str, float],
    where: Location,
) -> Timing:
    """When the functions *steps* run, from the files in *folder*, the *text* of the model's own and of its *main*.

    *given* is what the user says, who is believed; *rates* is that for functions of a rate, by name. Raises DseError if
    nothing tells it, or not everything the same.
    """
    described = _descriptor(folder / "codedescriptor.dmr")
    for name in rates:
        if not is_rated:
            raise fail(f"the code has no function of its own for each rate, so '{name}' has no step", where, _GIVE)
        if name not in steps:
            raise fail(f"'{name}' is not a function of a rate in the code", where, closest(name, steps))
    if is_rated:
        return _rated(text, steps, given, rates, described, where)
    once = (1,) * len(steps)
    if given is not None:
        return Timing(given, "'step'", once)
    told = [("codedescriptor.dmr", described), ("its scheduler", _ticked(text, where))]
    told += [(source, _shortest(pattern, text)) for source, pattern in _COMPUTED]
    found = [(source, step) for source, step in told if step is not None]
    if any(not math.isclose(step, found[0][1], rel_tol=1e-6) for _, step in found):
        each = ", ".join(f"{step:g} s ({source})" for source, step in found)
        raise fail(f"the code gives several steps: {each}", where, _GIVE)
    if found:
        return Timing(found[0][1], found[0][0], once)
    base = _shortest(_MAIN, re.sub(r"^[ \t]*\*", "", main, flags=re.MULTILINE))
    if base is not None:
        return Timing(base, "its main program", once)
    for source, pattern in _COMMENTED:
        step = _shortest(pattern, text)
        if step is not None:
            return Timing(step, source, once, is_only_commented=True)
    raise fail("nothing in the code gives the length of a step", where, _GIVE)


_GIVE = "give it, as the model is configured: step: 10 ms (import: --step 10ms)"


def _shortest(pattern: re.Pattern[str], text: str) -> float | None:
    words = (word for found in pattern.findall(text) for word in ((found,) if isinstance(found, str) else found))
    return min((number for number in map(_number, words) if number > 0), default=None)


def _number(word: str) -> float:
    """0 for what is no time that a controller could have."""
    try:
        number = float(word)
    except ValueError:
        return 0.0
    return number if _is_period(number) else 0.0


def _common(periods: Iterable[float]) -> float:
    """The longest time that all *periods* (s) are multiples of, as the base of a model with these rates."""
    fractions = [Fraction(period).limit_denominator(_FINEST) for period in periods]
    bottom = math.lcm(*(each.denominator for each in fractions))
    return float(Fraction(math.gcd(*(int(each * bottom) for each in fractions)), bottom))


def _descriptor(path: Path) -> float | None:
    """The base of the periods in the data base that the coder writes beside the code since about 2018."""
    if not path.is_file():
        return None
    found: set[float] = set()
    try:
        with closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro&immutable=1", uri=True)) as base:
            tables = base.execute("select name from sqlite_master where type='table' and name like '%TimingInterface%'")
            for (table,) in tables.fetchall():
                quoted = '"' + table.replace('"', '""') + '"'
                what = '"P$SamplePeriod", "P$SampleOffset", "P$TimingMode"'
                rows = base.execute(f"select {what} from {quoted}")  # noqa: S608  # quoted
                found |= {time for *times, mode in rows if mode == _SAMPLED for time in times if _is_period(time)}
    except sqlite3.Error:
        return None  # another kind of file; the code may tell
    return _common(found) if found else None


def _is_period(value: object) -> bool:
    return isinstance(value, int | float) and _SHORTEST <= value <= _LONGEST


def _ticked(text: str, where: Location) -> float | None:
    """A scheduler within a step says how long slower rates are and how often the base runs in them."""
    bases = {round(_number(period) / (int(limit) + 1), 12) for limit, period, _ in _TICKED.findall(text)} - {0.0}
    if len(bases) > 1:
        raise fail(f"the scheduler of the code gives several steps: {sorted(bases)} s", where, _GIVE)
    return bases.pop() if bases else None


def _rated(
    text: str,
    steps: Sequence[str],
    given: float | None,
    rates: Mapping[str, float],
    described: float | None,
    where: Location,
) -> Timing:
    periods: list[float] = []
    for name in steps:
        found = re.search(rf"{re.escape(name)}\s*\([^;{{()]*\)\s*(?:/\*|//)\s*{_PERIOD}", text)
        told = _number(found[1]) if found else 0.0
        period = rates.get(name, told)
        if period <= 0:
            each = [f"{step}: {f'{rates[step]:g} s' if step in rates else 'TIME'}" for step in steps]
            hint = f"give them, as the model is configured: steps: {{{', '.join(each)}}} (import: --step {name}=10ms)"
            raise fail(f"nothing in the code gives how often '{name}' runs", where, hint)
        if told > 0 and not math.isclose(told, period, rel_tol=1e-6):
            what = f"its comment needs a step of {told:g} s for '{name}', but 'steps' gives {period:g} s"
            raise fail(what, where, "correct 'steps', or generate the code again")
        if found and _number(found[2] or "0") != 0:
            raise fail(
                f"'{name}' runs every {found[1]} s, but first at {found[2]} s", where, "generate it without offsets"
            )
        periods.append(period)
    base = _common(periods)
    ticks = tuple(round(period / base) for period in periods)
    if max(ticks) > _MOST_TICKS:
        listed = ", ".join(f"{period:g} s" for period in periods)
        raise fail(f"its rates have no step in common: {listed}", where, "generate it with one task")
    for source, step in (("codedescriptor.dmr gives", described), ("'step' gives", given)):
        if step is not None and not math.isclose(step, base, rel_tol=1e-6):
            by = "'steps'" if rates else "the comments of its functions"
            raise fail(f"{by} need a step of {base:g} s, but {source} {step:g} s", where)
    if described is not None:
        return Timing(base, "codedescriptor.dmr", ticks)
    if rates.keys() >= set(steps):
        return Timing(base, "'steps'", ticks)
    return Timing(base, "the comments of its steps", ticks, is_only_commented=given is None)
