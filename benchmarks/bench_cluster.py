"""One study made by one machine, in shards of which some are killed, and by a Dask cluster that loses half its workers.

    python benchmarks/bench_cluster.py --runs 2000 --step "0.5 ms"

All three must give the same table to the byte. What is compared is processor time, of all processes that took part, so
that a busy machine does not matter. Every way has a cache folder of its own: no run is taken from another's.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

ROOT = Path(__file__).parents[1]
STUDY = """\
study: %s
testbench: acc_fine
configurations:
  where: >-
    sensor is radar_77ghz_mid and controller is pd_acc and brake is hydraulic_booster
    and powertrain is combustion_ideal and video is absent
design_variables:
  controller.kp_speed: {range: [0.1 1/s, 3 1/s], nominal: 1.2 1/s}
  controller.kd_speed: {range: [0, 1], nominal: 0.5}
sampler: {halton: {samples: %d}}
keep_waveforms: none
executor: %s
"""
DSE = (sys.executable, "-m", "dse")
SHARDS, KILLED = 8, (3, 6)
BECOME_SUBREAPER = 36


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=2000)
    parser.add_argument("--step", default="10 ms")
    given = parser.parse_args()
    # What a killed process leaves behind is waited for here, so that its time is counted.
    ctypes.CDLL(None).prctl(BECOME_SUBREAPER, 1)
    with tempfile.TemporaryDirectory() as scratch:
        root = Path(scratch)
        workspace(root, given.runs, given.step)
        dse(root, "built", "explore", "gains", "-o", str(root / "none"), "--dry-run")
        seconds = {}
        for name, way in {"local": local, "shards": shards, "dask": dask}.items():
            shutil.copytree(root / "built", root / name)
            seconds[name] = measured(way, root, given.runs)
            table = dse(root, name, "results", str(root / f"{name}.out"))
            (root / f"{name}.csv").write_bytes(table)
            same = table == (root / "local.csv").read_bytes()
            more = f"{seconds[name] / seconds['local'] - 1:+.1%}"
            per_run = f"{seconds[name] / given.runs * 1e3:.1f} ms a run"
            took = f"{seconds[name]:.1f} s of processor time, {per_run}, {more}"
            print(f"{name}: {took}; same table: {same}", flush=True)


def local(root: Path, runs: int) -> None:
    del runs
    dse(root, "local", "explore", "gains", "-o", str(root / "local.out"), "-j", "2")


def shards(root: Path, runs: int) -> None:
    out = root / "shards.out"
    todo = list(range(1, SHARDS + 1))
    kill = set(KILLED)
    while todo:
        pair, todo = todo[:2], todo[2:]
        started = {
            n: start(root, "shards", "explore", "gains", "-o", str(out), "-j", "1", "--shard", f"{n}/{SHARDS}")
            for n in pair
        }
        for number, process in started.items():
            if number in kill:
                wait_for_rows(out / f"shard-{number}-of-{SHARDS}", runs // SHARDS // 3, process)
                os.killpg(process.pid, signal.SIGKILL)
                kill.discard(number)
                todo.append(number)
        for process in started.values():
            process.wait()
    print(dse(root, "shards", "merge", str(out)).decode(), end="")


def dask(root: Path, runs: int) -> None:
    command = (sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard", "--host", "127.0.0.1")
    scheduler = spawn(root, "dask", *command, "--port", "18786")
    command = (sys.executable, "-m", "distributed.cli.dask_worker", "tcp://127.0.0.1:18786", "--no-dashboard")
    workers = [spawn(root, "dask", *command, "--nthreads", "1") for _ in range(4)]
    coordinator = start(root, "dask", "explore", "gains_by_dask", "-o", str(root / "dask.out"))
    wait_for_rows(root / "dask.out", runs // 3, coordinator)
    for worker in workers[:2]:
        os.killpg(worker.pid, signal.SIGKILL)
    coordinator.wait()
    for process in (*workers[2:], scheduler):
        os.killpg(process.pid, signal.SIGTERM)
    for process in (*workers, scheduler):
        process.wait()


def measured(way: Callable[[Path, int], None], root: Path, runs: int) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    way(root, runs)
    try:
        while True:
            os.waitpid(-1, 0)
    except ChildProcessError:
        pass
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def workspace(root: Path, runs: int, step: str) -> None:
    for name in ("components", "designs", "testbenches"):
        shutil.copytree(ROOT / name, root / name)
    bench = (root / "testbenches" / "acc_following.yaml").read_text(encoding="utf-8")
    fine = bench.replace("acc_following", "acc_fine").replace("step: 10 ms", f"step: {step}")
    (root / "testbenches" / "acc_fine.yaml").write_text(fine, encoding="utf-8")
    (root / "testbenches" / "gains.pet.yaml").write_text(STUDY % ("gains", runs, "local"), encoding="utf-8")
    by_dask = STUDY % ("gains_by_dask", runs, "{dask: 'tcp://127.0.0.1:18786'}")
    (root / "testbenches" / "gains_by_dask.pet.yaml").write_text(by_dask, encoding="utf-8")


def wait_for_rows(folder: Path, rows: int, process: subprocess.Popen[bytes]) -> None:
    while process.poll() is None:
        time.sleep(0.05)
        try:
            with closing(sqlite3.connect(f"file:{folder / 'study.sqlite'}?mode=ro", uri=True)) as connection:
                if connection.execute("SELECT count(*) FROM runs").fetchone()[0] >= rows:
                    return
        except sqlite3.Error:
            continue


def dse(root: Path, cache: str, *arguments: str) -> bytes:
    done = subprocess.run([*DSE, *arguments], cwd=root, env=environment(root, cache), capture_output=True, check=False)
    if done.returncode:
        sys.exit(done.stderr.decode())
    return done.stdout


def start(root: Path, cache: str, *arguments: str) -> subprocess.Popen[bytes]:
    return spawn(root, cache, *DSE, *arguments)


def spawn(root: Path, cache: str, *command: str) -> subprocess.Popen[bytes]:
    nowhere = subprocess.DEVNULL
    return subprocess.Popen(
        command, cwd=root, env=environment(root, cache), start_new_session=True, stdout=nowhere, stderr=nowhere
    )


def environment(root: Path, cache: str) -> dict[str, str]:
    return {**os.environ, "DSE_CACHE": str(root / cache)}


if __name__ == "__main__":
    main()
