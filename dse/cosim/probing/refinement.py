"""Experiments that make the numerics of an FMU finer, to see what that changes.

Inputs keep one value throughout: what changes then is the FMU's own doing, and not that it sees its inputs more often.
"""

from __future__ import annotations

import time
from dataclasses import replace
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from dse.cosim.binding.integration import DEFAULT_TOLERANCE
from dse.cosim.failure.run_failed import RunFailed
from dse.cosim.probing.convergence import Settling, grid_of, moves, settling_of
from dse.cosim.probing.excitation import Excitation
from dse.cosim.probing.journal import Journal
from dse.cosim.probing.single_fmu import alone
from dse.cosim.probing.subject import Subject
from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.system import Element

_MOST_VALUES = 2**22
_LONG = 4.0
"""Seconds after which no finer run is begun."""

_LEAST, _LEAST_BY_TOLERANCE = 1e-9, 1e-13
_TIGHTER = (1e-2, 1e-4, 1e-6)
_FINEST_TOLERANCE = 1e-13


def shorter_steps(
    journal: Journal, element: Element, step: float, steps: int, halvings: int
) -> tuple[tuple[bytes, bytes], tuple[float, ...], float, bool]:
    """Digests of two runs, the `Settling` of steps halved so often, the inner grid, and whether outputs move."""
    end, stop = time.monotonic() + _LONG, steps * step
    journal.note("simulating it by itself")
    with alone(element) as simulator:
        tables = [simulator.run(stop=stop, step=step).copy()]
        digests = _digest(tables[0]), _digest(simulator.run(stop=stop, step=step))
        grid = grid_of(tables[0], step)
        for number in range(1, halvings + 1):
            parts = 2**number
            if (steps * parts + 1) * max(1, tables[0].shape[1]) > _MOST_VALUES or time.monotonic() > end:
                break
            journal.note(f"simulating it in steps of {step / parts:.6g} s")
            try:
                table = simulator.run(stop=stop, step=step / parts)
            except RunFailed:
                break
            tables.append(table[::parts].copy())
            grid = grid_of(table, step / parts)
    settling = settling_of(tables, least=_LEAST)
    return digests, _plain(settling), grid, any(moves(table) for table in tables)


def longer_steps(journal: Journal, element: Element, step: float, steps: int) -> float | None:
    """What doubling the step changes, if doubling it again changes more."""
    steps -= steps % 4
    if not steps:
        return None
    journal.note("simulating it in longer steps")
    with alone(element) as simulator:
        runs = [simulator.run(stop=steps * step, step=step * 2**k)[:: 4 // 2**k].copy() for k in range(3)]
    first, second = (settling_of(pair, least=_LEAST).change for pair in (runs[:2], runs[1:]))
    return first if 1.2 * first <= second and first > 0.0 else None


def tighter_tolerances(journal: Journal, element: Element, step: float, steps: int) -> tuple[float, ...]:
    """The `Settling` of tolerances of a hundredth, and so on."""
    journal.note("simulating it with other tolerances")
    runs = [_run(element, step, steps)]
    for tolerance in tighter(element.model):
        try:
            runs.append(_run(_with_tolerance(element, tolerance), step, steps))
        except RunFailed:
            break  # one that it cannot keep
    return _plain(settling_of(runs, least=_LEAST_BY_TOLERANCE))


def exchanged(journal: Journal, element: Element, exchange: FmuModel, step: float, steps: int) -> float | None:
    """How far it is from itself for model exchange, if that is the more exact."""
    journal.note("simulating it for model exchange")
    tolerances = tighter(exchange)
    runs = [_run(element, step, steps)]
    runs += [
        _run(_with_tolerance(replace(element, model=exchange), tolerance), step, steps) for tolerance in tolerances[:2]
    ]
    apart, own = (settling_of(pair, least=_LEAST_BY_TOLERANCE).change for pair in (runs[:2], runs[1:]))
    return apart if own <= max(apart, 1e-6) else None


def forgets(journal: Journal, model: FmuModel, step: float) -> bool:
    """Whether outputs follow from the inputs of the last two steps alone, and do follow them."""
    drive = Excitation(step, 12)
    first, second = replace(drive, seed=1), replace(drive, seed=2)

    def rows(*, until: int) -> list[tuple[bytes, ...]]:
        with Subject(model, journal) as subject:
            subject.initialize(drive)
            found = []
            for k in range(drive.steps):
                subject.write(first if k < until else second, 0)
                subject.advance(drive, k, 1.0)
                found.append(subject.read((k + 1) * step))
            return found

    other, same = rows(until=8), rows(until=0)
    return len(set(same[2:])) == 1 and other[-1] == same[-1] != other[7]


def digest_of_run(journal: Journal, element: Element, step: float, steps: int) -> bytes:
    """What tells one run's outputs from another's."""
    journal.note("simulating it in another process")
    return _digest(_run(element, step, steps))


def _run(element: Element, step: float, steps: int) -> NDArray[np.float64]:
    with alone(element) as simulator:
        return simulator.run(stop=steps * step, step=step).copy()


def _digest(table: NDArray[np.float64]) -> bytes:
    return blake2b((table + 0.0).tobytes(), digest_size=16).digest()  # -0.0 is 0.0


def _plain(settling: Settling) -> tuple[float, ...]:
    return settling.at, settling.change, settling.last, settling.place


def _with_tolerance(element: Element, tolerance: float) -> Element:
    experiment = replace(element.model.experiment, tolerance=tolerance)
    return replace(element, model=replace(element.model, experiment=experiment))


def tighter(model: FmuModel) -> tuple[float, ...]:
    """Tolerances below the one that *model* is told, or would be."""
    own = model.experiment.tolerance or DEFAULT_TOLERANCE
    if model.interface is FmiInterface.MODEL_EXCHANGE:
        own = min(own, DEFAULT_TOLERANCE)
    return tuple(dict.fromkeys(max(own * factor, min(own, _FINEST_TOLERANCE)) for factor in _TIGHTER))
