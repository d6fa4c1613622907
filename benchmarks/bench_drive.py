"""How real-time is a drive? Several at once on this machine: lateness of their steps, overruns, key to echo.

python benchmarks/bench_drive.py [BENCH] [--drives 8] [--seconds 20]
"""

from __future__ import annotations

import argparse
import os
import time
from pathlib import Path

import numpy as np

from dse.api import LiveDrive, open as open_workspace, open_drive


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("bench", nargs="?", default="drive_following")
    parser.add_argument("--drives", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=20.0)
    given = parser.parse_args()
    bench = open_workspace(Path(__file__).parents[1]).benches[given.bench].noun
    start = time.perf_counter()
    lives = [open_drive(bench) for _ in range(given.drives)]
    opening = (time.perf_counter() - start) / given.drives
    for live in lives:
        live.start()
    while not all(live.session.newest or live.ended for live in lives):
        time.sleep(0.05)
    _drive(lives, given.seconds)
    for live in lives:
        live.finish()
    print(f"{given.bench}, {given.drives} at once on {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
    print(f"opened in {opening:.2f} s each")
    for live in lives:
        ended = live.session.wait(60)
        if ended is None or ended.pace is None:
            print("ended:", ended and ended.text)
            continue
        delays, pace = np.array(live.session.delays), ended.pace
        print(
            f"{pace.steps} steps, {pace.overruns} overruns, late by {1e3 * pace.median:.2f} ms in the median, "
            f"{1e3 * pace.p99:.2f} ms p99; echo {1e3 * np.median(delays):.1f} ms, "
            f"{1e3 * np.quantile(delays, 0.99):.1f} ms p99"
        )


def _drive(lives: list[LiveDrive], seconds: float) -> None:
    """Commands and frames as a page of each would have them."""
    end, number = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        number += 1
        for live in lives:
            if live.ended is None:
                live.control({"accelerator": 0.2 + 0.1 * (number % 2)}, number)
                live.frame()
        time.sleep(1 / 30)


if __name__ == "__main__":
    main()
