"""From waveforms to numbers, all in SI, signed and unrounded; NaN where a number is not defined.

A waveform is an array x of n rows over *time*, in seconds and ascending, n ≥ 1; between rows it is taken as
straight. Definitions follow K. Ogata, Modern Control Engineering, 5th edition, section 5-3, made signed so
that a run that stays below its target is told from one that goes past it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Waveform = NDArray[np.float64]
ConditionArray = NDArray[np.bool_]


def rise_time(time: Waveform, x: Waveform, target: float) -> float:
    """Seconds from 10 % to 90 % of the way from x[0] to *target*; NaN if x does not come that far (Ogata, 5-3)."""
    start = x.item(0)
    way = target - start
    if not way:
        return math.nan
    return _crossing(time, x, start + 0.9 * way, way > 0) - _crossing(time, x, start + 0.1 * way, way > 0)


def reach_time(time: Waveform, x: Waveform, target: float, band: float = 0.02) -> float:
    """Seconds until x is first within target·(1 ± band); NaN if it never is."""
    low, high = _limits(target, band)
    start = x.item(0)
    if low <= start <= high:
        return 0.0
    return _crossing(time, x, low if start < low else high, start < low) - time.item(0)


def settling_time(time: Waveform, x: Waveform, target: float, band: float = 0.02) -> float:
    """Seconds until x is within target·(1 ± band) for good; NaN if it is outside in the last row (Ogata, 5-3)."""
    low, high = _limits(target, band)
    # Bytes are searched from the end by one library call; NaN counts as outside.
    last = ((x >= low) & (x <= high)).tobytes().rfind(b"\0")
    if last < 0:
        return 0.0
    if last == x.size - 1:
        return math.nan
    edge = low if x.item(last) < low else high
    return _between(time, x, last, edge) - time.item(0)


def steady_state_error(time: Waveform, x: Waveform, target: float, window: float = 1.0) -> float:
    """Mean of x - *target* over the rows of the last *window* seconds, in x's unit; NaN if the run is shorter."""
    end = time.item(-1)
    # The row at the window's start belongs to it, however its time was rounded.
    start = end - window - 1e-9 * max(abs(end), window)
    if time.item(0) - start > 2e-9 * max(abs(end), window) or not window >= 0:
        return math.nan
    tail = x[int(np.searchsorted(time, start)) :]
    return float(np.add.reduce(tail)) / tail.size - target


def minimum(x: Waveform) -> float:
    """The smallest value, in x's unit; NaN if x has one."""
    return float(np.minimum.reduce(x))


def maximum(x: Waveform) -> float:
    """The largest value, in x's unit; NaN if x has one."""
    return float(np.maximum.reduce(x))


def initial(x: Waveform) -> float:
    """The value in the first row, in x's unit."""
    return x.item(0)


def final(x: Waveform) -> float:
    """The value in the last row, in x's unit."""
    return x.item(-1)


def at_first(x: Waveform, condition: ConditionArray) -> float:
    """The value in the first row in which *condition* holds, in x's unit; NaN if it never does."""
    row = int(np.argmax(condition))
    return x.item(row) if condition[row] else math.nan


def time_to_collision(gap: Waveform, closing_speed: Waveform) -> Waveform:
    """gap / closing_speed row by row, in seconds; infinite where the gap does not close.

    J. C. Hayward, Near-miss determination through use of a scale of danger, 1972.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        time = gap / closing_speed
    np.copyto(time, math.inf, where=closing_speed <= 0)
    return time


def driver_gap(
    time: Waveform, gap: Waveform, speed: Waveform, risk: ConditionArray, delay: float, deceleration: float, jerk: float
) -> float:
    """Least *gap*, in m, of a driver who brakes to a standstill from *delay* after the first row with a *risk*.

    The driver's car is where the run's car is, and has its *speed*, in m/s, when the risk begins. Braking builds up
    with *jerk* to *deceleration*, both positive. Only the row times limit its accuracy. NaN if there is no risk.
    """
    first = int(np.argmax(risk))
    if not (risk[first] and deceleration > 0 and jerk > 0 and delay >= 0):
        return math.nan
    since, moved = time[first:] - time[first], speed[first:]
    own = np.concatenate([[0.0], np.cumsum(np.diff(since) * (moved[1:] + moved[:-1]) / 2)])
    start, built = float(moved[0]), deceleration / jerk
    held = start - jerk * built**2 / 2  # the speed when the brake is built up
    stop = built + held / deceleration if held > 0 else math.sqrt(2 * max(start, 0.0) / jerk)
    braking = np.clip(since - delay, 0.0, stop)
    rising, full = np.minimum(braking, built), np.maximum(braking - built, 0.0)
    way = start * (np.minimum(since, delay) + rising) - jerk * rising**3 / 6 + held * full - deceleration * full**2 / 2
    return float(np.min(gap[first:] + own - way))


def relative_excess(peak: float, target: float) -> float:
    """The overshoot: (peak - target) / |target|, negative if x never gets there.

    Ogata's maximum overshoot M_p with the steady state replaced by the target. NaN for a target of zero.
    """
    return (peak - target) / abs(target) if target else math.nan


def relative_shortfall(lowest: float, target: float) -> float:
    """The undershoot: (target - lowest) / |target|, negative if x stays above.

    The overshoot of a quantity that must not fall, as a gap. NaN for a target of zero.
    """
    return (target - lowest) / abs(target) if target else math.nan


def row_widths(time: Waveform) -> Waveform:
    """The seconds each row stands for in the trapezoidal rule."""
    widths = np.zeros_like(time)
    if time.size > 1:
        np.subtract(time[2:], time[:-2], out=widths[1:-1])
        widths[0] = time.item(1) - time.item(0)
        widths[-1] = time.item(-1) - time.item(-2)
        widths *= 0.5
    return widths


def rows_within(time: Waveform, start: float, end: float) -> slice:
    """The rows from *start* to *end* seconds, both included however their times were rounded."""
    slack = 1e-9 * max(abs(start), abs(end), abs(time.item(-1)))
    return slice(int(np.searchsorted(time, start - slack)), int(np.searchsorted(time, end + slack, "right")))


def within(x: Waveform, rows: slice) -> Waveform:
    """*x* in *rows*; where there are none its first row, of which `of_rows` makes nothing."""
    return x[rows] if rows.start < rows.stop else x[:1]


def of_rows(value: float, rows: slice) -> float:
    """*value*, which was computed from *rows*; NaN if there are none."""
    return value if rows.start < rows.stop else math.nan


def weighted_sum(x: Waveform, widths: Waveform) -> float:
    """∫ x dt by the trapezoidal rule over rows of these widths, in x's unit times seconds."""
    # Not a dot product: BLAS may split and order the sum differently from machine to machine.
    return float(np.add.reduce(x * widths))


def average(x: Waveform, widths: Waveform) -> float:
    """Time average of x over rows of these widths; NaN for a single row."""
    span = float(np.add.reduce(widths))
    return weighted_sum(x, widths) / span if span else math.nan


def root_average_square(x: Waveform, widths: Waveform) -> float:
    """Root of the time average of x² over rows of these widths; NaN for a single row."""
    return math.sqrt(average(x * x, widths))


def percentile(x: Waveform, widths: Waveform, q: float) -> float:
    """The smallest recorded value that x does not exceed for the share *q* of the time, in x's unit.

    Each row stands for its width, so that the spacing of rows does not count. 0 gives the minimum, 1 the maximum. NaN
    for a single row, for another *q*, and if x has a NaN. Definition 1 of R. J. Hyndman, Y. Fan, Sample quantiles in
    statistical packages, 1996, with weights.
    """
    if not (0.0 <= q <= 1.0 and widths.any()) or np.isnan(x).any():
        return math.nan
    return float(np.quantile(x, q, weights=widths, method="inverted_cdf"))


def rolling_mean(time: Waveform, x: Waveform, window: float) -> Waveform:
    """In each row the time average of x over the last *window* seconds, in x's unit, exact for x straight between rows.

    Rows before the first whole window have the average of that one, so that extremes are those of whole windows. NaN
    where x is not finite within the window, and everywhere if the run is shorter or *window* is not above zero.
    """
    slack = 1e-9 * max(abs(time.item(-1)), window)
    if not (window > 0 and time.item(-1) - time.item(0) >= window - slack):
        return np.full_like(x, math.nan)
    undefined = ~np.isfinite(x)
    flat = np.where(undefined, 0.0, x)
    steps = np.diff(time)
    area = np.concatenate(([0.0], np.cumsum(0.5 * (flat[1:] + flat[:-1]) * steps)))
    starts = np.maximum(time - window, time.item(0))
    first = np.clip(np.searchsorted(time, starts + slack, "right") - 1, 0, time.size - 2)
    past = starts - time[first]
    slope = np.divide(flat[first + 1] - flat[first], steps[first], out=np.zeros_like(x), where=steps[first] > 0)
    before = area[first] + past * (flat[first] + 0.5 * slope * past)
    holes = np.concatenate(([0], np.cumsum(undefined)))
    means = np.where(holes[1:] > holes[first], math.nan, (area - before) / window)
    whole = int(np.searchsorted(time, time.item(0) + window - slack))
    means[:whole] = means[whole]
    return means


def time_held(condition: ConditionArray, widths: Waveform) -> float:
    """Seconds during which *condition* holds; each row stands for half the way to its neighbours."""
    return float(np.add.reduce(widths[condition]))


def occurrences(condition: ConditionArray) -> float:
    """How many times *condition* begins to hold; a condition that holds in the first row has begun there."""
    return float(np.count_nonzero(condition[1:] & ~condition[:-1]) + bool(condition[0]))


def _limits(target: float, band: float) -> tuple[float, float]:
    half = abs(band * target) if band >= 0 else math.nan
    return target - half, target + half


def _crossing(time: Waveform, x: Waveform, level: float, rising: bool) -> float:
    """When x first comes to *level*; NaN if it does not."""
    beyond = x >= level if rising else x <= level
    first = int(beyond.argmax())
    if not beyond.item(first):
        return math.nan
    return _between(time, x, first - 1, level) if first else time.item(0)


def _between(time: Waveform, x: Waveform, row: int, level: float) -> float:
    """When x comes to *level* between *row* and the next."""
    before, after = x.item(row), x.item(row + 1)
    share = (level - before) / (after - before)
    return time.item(row) + share * (time.item(row + 1) - time.item(row))
