"""Experiments that strain an FMU: many runs through the kernel, one after the other and in threads."""

from __future__ import annotations

import threading
import time
from math import nan

import psutil

from dse.cosim.failure.run_failed import RunFailed
from dse.cosim.probing.excitation import Excitation
from dse.cosim.probing.journal import Journal
from dse.cosim.probing.single_fmu import alone, element_of
from dse.cosim.simulator import Simulator
from dse.domain.fmu import FmuModel

MOST_INSTANCES = 2000
_WARM_UP = 50
_SHORT = 20
_THREADS = 2


def instances_in_a_row(journal: Journal, model: FmuModel, drive: Excitation, seconds: float) -> tuple[float, float]:
    """Short runs, each on a fresh instance, at most 2,000 and as many as *seconds* allow; counted.

    Returns the bytes the process grew by with the first instance, and by each run once warm.
    """
    process, end = psutil.Process(), time.monotonic() + seconds
    steps = min(_SHORT, drive.steps)
    before = first = warm = process.memory_info().rss
    journal.note("making one instance after the other")
    with _alone(model, drive) as simulator:
        number = 0
        for number in range(1, MOST_INSTANCES + 1):
            simulator.run(stop=steps * drive.step, step=drive.step)
            journal.count(number)
            if number == 1:
                first = process.memory_info().rss
            if number == _WARM_UP:
                warm = process.memory_info().rss
            if time.monotonic() > end:
                break
    runs = number - _WARM_UP
    growth = max(0.0, (process.memory_info().rss - warm) / runs) if runs > 0 else nan
    return max(0.0, float(first - before)), growth


def cost_of_a_step(journal: Journal, model: FmuModel, drive: Excitation, seconds: float) -> float:
    """Wall time of one communication step through the kernel, in seconds: the best of the runs *seconds* allow."""
    journal.note("measuring time")
    end = time.monotonic() + seconds
    best = {1: float("inf"), drive.steps: float("inf")}
    with _alone(model, drive) as simulator:
        while time.monotonic() < end:
            for steps, least in best.items():
                begin = time.perf_counter()
                simulator.run(stop=steps * drive.step, step=drive.step)
                best[steps] = min(least, time.perf_counter() - begin)
    return max(0.0, best[drive.steps] - best[1]) / (drive.steps - 1) if drive.steps > 1 else best[1]


def runs_in_threads(journal: Journal, model: FmuModel, drive: Excitation, other: Excitation, seconds: float) -> str:
    """What goes wrong if two threads each make fresh instances and run them for *seconds*, "" if nothing does."""
    journal.note("running alone")
    expected = [_waveforms(model, each) for each in (drive, other)]
    journal.note("running in two threads at once")
    found: list[str] = []
    barrier = threading.Barrier(_THREADS)
    end = time.monotonic() + seconds

    def work(each: Excitation, right: bytes) -> None:
        barrier.wait()
        try:
            with _alone(model, each) as simulator:
                while not found and time.monotonic() < end:
                    if simulator.run(stop=each.stop, step=each.step).tobytes() != right:
                        found.append("outputs differ from those of a run alone")
        except RunFailed as failure:
            found.append(str(failure))

    threads = [threading.Thread(target=work, args=pair) for pair in zip((drive, other), expected, strict=True)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found[0] if found else ""


def _waveforms(model: FmuModel, drive: Excitation) -> bytes:
    with _alone(model, drive) as simulator:
        return simulator.run(stop=drive.stop, step=drive.step).tobytes()


def _alone(model: FmuModel, drive: Excitation) -> Simulator:
    """The FMU alone; its inputs keep the values the drive begins with."""
    return alone(element_of(model, {**drive.parameters(model), **drive.inputs(model, 0)}))
