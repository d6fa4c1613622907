"""Values, shares and limits as a person reads them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from dse.analysis.data import ALL, Factor, StudyData
from dse.analysis.limits import Limit
from dse.analysis.probability import Interval
from dse.units import parse_unit, short_symbol, shown


def quantity(si: float, unit: str) -> str:
    """An SI number in *unit*, to three digits."""
    return f"{shown(parse_unit(unit).from_si(si), 3)} {short_symbol(unit)}".rstrip()


def difference(si: float, unit: str) -> str:
    """A difference of SI numbers in *unit*, to three digits: one of 20 degC is 20 K."""
    return f"{shown(si / float(parse_unit(unit).factor), 3)} {short_symbol(unit)}".rstrip()


def outwards(value: float, towards: Callable[[float], int]) -> float:
    """*value* rounded to four digits with *towards*, up or down; as it is if it has no more."""
    if not value or float(f"{value:.4g}") == value:
        return value
    step = 10.0 ** (math.floor(math.log10(abs(value))) - 3)
    return float(f"{towards(value / step) * step:.4g}")


def percent(share: float) -> str:
    """Whole percents, and a digit more near the ends, where nothing but 0 is 0 and nothing but 1 is 100."""
    shown = 100 * share
    if shown in (0.0, 100.0) or 1 <= round(shown) < 99:
        return f"{shown:.0f} %"
    return f"{min(max(shown, 0.1), 99.9):.1f} %"


def likely(share: Interval) -> str:
    """A share with its interval: ``53 % (50 … 56 %)``."""
    return f"{percent(share.value)} ({between(share)})"


def between(share: Interval) -> str:
    """The interval of a share: ``50 … 56 %``."""
    return f"{percent(share.low).removesuffix(' %')} … {percent(share.high)}"


def parts(told: Sequence[tuple[str, Interval, str]]) -> str:
    """What has which share, each with a remark: ``kp 53 % of the variance (47 … 58 %, rising), kd 29 % (…)``."""
    whole = [" of the variance"] + [""] * len(told)
    return ", ".join(
        f"{name} {percent(share.value)}{of} ({between(share)}{remark})"
        for (name, share, remark), of in zip(told, whole, strict=False)
    )


def listed(words: Sequence[str], last: str = "and") -> str:
    """``a, b and c``."""
    return f" {last} ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def at_all(conditions: int) -> str:
    """``at both conditions``; "" where there are none."""
    return f" at {'both' if conditions == 2 else f'all {conditions}'} conditions" if conditions > 1 else ""


def condition(limits: Sequence[Limit]) -> str:
    """All of *limits* in words: ``controller.kp < 0.96 1/s and sensor is lidar or radar``."""
    return listed([_limit(limit) for limit in limits])


def point(data: StudyData, number: int) -> str:
    """Where run *number* lies: ``controller.kp = 0.8 1/s, sensor = lidar``."""
    (row,) = np.flatnonzero(data.numbers == number)
    places = zip(data.factors, data.places[row].tolist(), strict=True)
    return ", ".join(f"{factor.name} = {value(factor, place)}" for factor, place in places if not math.isnan(place))


def value(factor: Factor, place: float) -> str:
    """What *factor* is at *place*."""
    return factor.level(place) if factor.is_choice else quantity(factor.value(place), factor.unit)


def requirement_label(data: StudyData, name: str) -> str:
    """A requirement with its title, if it has another."""
    titles = {entry.name: entry.title for entry in data.definition.requirements}
    title = titles.get(name, name)
    return f"{name} {title}" if title and name not in (title, ALL) else name


def _limit(limit: Limit) -> str:
    factor = limit.factor
    if factor.variable is None:
        others = [level for level in factor.levels if level not in limit.levels]
        is_longer = len(limit.levels) > len(others)
        return f"{factor.name} is not {listed(others, 'or')}" if is_longer else _is(factor.name, limit.levels)
    if values := factor.variable.values:
        inside = [v for i, v in enumerate(values) if _within((i + 0.5) / len(values), limit)]
        return _is(factor.name, [quantity(v, factor.unit) for v in inside])
    low, high = (quantity(factor.value(p), factor.unit) if p == p else "" for p in (limit.low, limit.high))  # noqa: PLR0124  # NaN
    if low and high:
        text = f"{low.removesuffix(short_symbol(factor.unit)).rstrip()} < {factor.name} < {high}"
    else:
        text = f"{factor.name} < {high}" if high else f"{factor.name} > {low}"
    return f"{text} (where it is there)" if limit.conditional else text


def _is(name: str, values: Sequence[str]) -> str:
    return f"{name} is {listed(values, 'or')}"


def _within(place: float, limit: Limit) -> bool:
    return not (place < limit.low or place > limit.high)
