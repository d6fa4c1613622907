"""How real-time is a shared world? Scripted seats in one world: lateness of the steps, overruns, who sees whom when.

python benchmarks/bench_shared_drive.py [BENCH] [--seats 16] [--seconds 60]
"""

from __future__ import annotations

import argparse
import os
import resource
import time
from pathlib import Path

import numpy as np

from dse.api import SharedDrive, open as open_workspace, open_shared_drive
from dse.live import Script, SharedWorld

BRAKES = Script((0.0, 10.0, 13.0), ({}, {"brake": 0.5}, {"brake": 0.0, "accelerator": 0.3}))
"""The first seat brakes at 10 s; the others drive as the bench's driver does."""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("bench", nargs="?", default="drive_motorway")
    parser.add_argument("--seats", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=60.0)
    given = parser.parse_args()
    bench = open_workspace(Path(__file__).parents[1]).benches[given.bench].noun
    world = SharedWorld(bench.simulation.step, most=given.seats)
    start = time.perf_counter()
    lives = [
        open_shared_drive(bench, world, driver=f"seat {number}", script=BRAKES if number == 0 else Script((), ()))
        for number in range(given.seats)
    ]
    opening = (time.perf_counter() - start) / given.seats
    for live in lives:
        live.start()
    while not all(live.session.newest or live.ended for live in lives):
        time.sleep(0.05)
    before = _processor()
    _watch(lives, given.seconds)
    own = (_processor() - before) / given.seconds
    load = os.getloadavg()[0]
    for live in lives:
        live.finish()
    ended = [live.session.wait(60) for live in lives]
    paces = [each.pace for each in ended if each and each.pace]
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    late = 1e3 * np.concatenate([live.seating.place.late[100:] for live in lives])
    print(f"{given.bench}, {given.seats} seats on {os.cpu_count()} processors, load {load:.1f}")
    print(f"opened in {opening:.2f} s each; {len(paces)} of {given.seats} ended well")
    print(f"{sum(each.steps for each in paces):,} steps, {sum(each.overruns for each in paces):,} overruns")
    print(f"the world took {100 * own:.0f} % of a processor, all other processes {used.ru_utime + used.ru_stime:.0f} s")
    print(
        f"late by {np.median(late):.2f} ms in the median, {np.quantile(late, 0.99):.2f} ms p99, {late.max():.1f} ms max"
    )
    world.close()


def _processor() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _watch(lives: list[SharedDrive], seconds: float) -> None:
    """Frames as a page of each would have them."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for live in lives:
            if live.ended is None:
                live.frame()
        time.sleep(1 / 30)


if __name__ == "__main__":
    main()
