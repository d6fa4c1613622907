"""How far metrics may be off because waveforms are known in their rows alone.

A highest value lies between two rows, and a condition begins to hold somewhere between the last row without and the
first with it. Half the step need not show that: it may miss as much. So each function that picks a row says by how much
its result may be off, and what the rest of the program makes of that is seen by computing it again::

    x = 0, 3, 4, 3, 0 in rows 1 s apart        maximum: the parabola through 3, 4, 3 has its vertex at 4: off by 0
    x = 1, 4, 4, 1                             ... through 1, 4, 4 has it at 4.375: off by 0.375
    duration(x > 3.5), overshoot(x, 2)         begins and ends between rows: 2 s; (4.375 - 2)/2 - (4 - 2)/2 = 19 %

Integrals and means are left to the repetition with half the step, which shows what their rows miss.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import Judgement
from dse.metrics import functions
from dse.metrics.functions import ConditionArray, Waveform
from dse.metrics.machine import MetricProgram

_CORNER = 0.5
"""Where the slope changes by less than so much of what it changes by at the peak, the peak is a corner."""


def between_rows(
    program: MetricProgram,
    time: NDArray[np.float64],
    columns: Mapping[str, NDArray[np.float64]],
    constants: Mapping[str, float],
) -> tuple[dict[str, float], list[Judgement]]:
    """By how much each metric of *program* may be off because of what happens between rows, SI; and judgements of the
    run if it is off by that. The arguments are those of `MetricProgram.evaluate`.
    """
    registers = program.registers(time, columns, constants)
    step = float(np.diff(time).max(initial=0.0))
    off = dict.fromkeys(program.metrics, 0.0)
    judgements: list[Judgement] = []
    for place, instruction in enumerate(program.instructions):
        may_miss = _MISSES.get(instruction.function)
        if may_miss is None:
            continue
        missed = may_miss(step, registers[instruction.target], *(registers[each] for each in instruction.arguments))
        if not missed > 0.0:
            continue
        found = [_continued(program, registers, place, side * missed) for side in (-1.0, 1.0)]
        for name, register in program.metrics.items():
            off[name] += max(_apart(float(other[register]), float(registers[register])) for other in found)
        judgements += [judgement for other in found for judgement in program.judge(other)]
    return off, judgements


def _continued(program: MetricProgram, registers: Sequence[Any], place: int, change: float) -> list[Any]:
    """*registers* with the result of the instruction at *place* changed, and all that follows from it."""
    first, *later = program.instructions[place:]
    changed = list(registers)
    changed[first.target] = registers[first.target] + change
    targets = {first.target}
    with np.errstate(all="ignore"):
        for step in later:
            if not targets.isdisjoint(step.arguments):
                changed[step.target] = step.function(*[changed[argument] for argument in step.arguments])
                targets.add(step.target)
    return changed


def _apart(a: float, b: float) -> float:
    return 0.0 if a == b or (math.isnan(a) and math.isnan(b)) else math.inf if math.isnan(a - b) else abs(a - b)


def _above(x: Waveform) -> float:
    """By how much *x* may go past its largest row: on the parabola through three rows, or to where two lines meet."""
    top = int(np.argmax(x))
    middle = min(max(top, 1), x.size - 2)
    if x.size < 3:
        return 0.0
    before, at, after = x[middle - 1 : middle + 2].tolist()
    bend = 2.0 * at - before - after
    if not (math.isfinite(bend) and bend > 0.0 and abs(after - before) < 2.0 * bend):  # the vertex is in these gaps
        return 0.0
    peak: float = x.item(top)
    parabola: float = max(at + (after - before) ** 2 / (8.0 * bend) - peak, 0.0)
    return max(parabola, _corner(x, top - 1, bend, peak), _corner(x, top, bend, peak))


def _corner(x: Waveform, left: int, bend: float, peak: float) -> float:
    """By how much the lines through two rows on either side of the gap that follows row *left* meet above *peak*."""
    rows = x[left - 2 : left + 4] if left >= 2 else x[:0]
    if rows.size < 6 or not np.isfinite(rows).all():
        return 0.0
    bends = np.abs(np.diff(rows, 2))
    if max(bends.item(0), bends.item(3)) > _CORNER * bend:
        return 0.0
    rising, falling = rows.item(2) - rows.item(1), rows.item(3) - rows.item(4)
    if not (rising > 0.0 and falling > 0.0):
        return 0.0
    share = (rows.item(3) + falling - rows.item(2)) / (rising + falling)
    return max(rows.item(2) + share * rising - peak, 0.0) if 0.0 <= share <= 1.0 else 0.0


def _of_maximum(_step: float, _value: float, x: Waveform) -> float:
    return _above(x)


def _of_minimum(_step: float, _value: float, x: Waveform) -> float:
    return _above(-x)


def _of_duration(step: float, _value: float, condition: ConditionArray, _widths: Waveform) -> float:
    return step * float(np.count_nonzero(condition[1:] != condition[:-1]))


def _of_at_first(_step: float, _value: float, x: Waveform, condition: ConditionArray) -> float:
    row = int(np.argmax(condition))
    return abs(x.item(row) - x.item(row - 1)) if row else 0.0


def _of_crossing(step: float, value: float, *_: object) -> float:
    """Somewhere between two rows; nowhere, if it was there from the beginning or never is."""
    return step if value > 0.0 else 0.0


def _of_two_crossings(step: float, value: float, *_: object) -> float:
    return 2.0 * _of_crossing(step, value)


def _of_percentile(_step: float, value: float, x: Waveform, widths: Waveform, q: float) -> float:
    """How much the value changes where the time below it is off by the widest row."""
    if math.isnan(value):
        return 0.0
    off = widths.max() / widths.sum()
    return max(abs(functions.percentile(x, widths, share) - value) for share in (max(q - off, 0.0), min(q + off, 1.0)))


_MISSES: Mapping[Callable[..., Any], Callable[..., float]] = {
    functions.maximum: _of_maximum,
    functions.minimum: _of_minimum,
    functions.time_held: _of_duration,
    functions.at_first: _of_at_first,
    functions.percentile: _of_percentile,
    functions.reach_time: _of_crossing,
    functions.settling_time: _of_crossing,
    functions.rise_time: _of_two_crossings,
}
"""By how much the result of a function may be off, from the longest step, that result and the function's arguments."""
