"""Start-up: what a command costs before it does anything, in a small workspace and in one of 10,000 components.

``python benchmarks/bench_startup.py [--runs 7] [--components 10000] [--cold]``; --cold also shows the first run, with
nothing kept. Medians; CPU seconds (user and system) bear a busy machine better than the time on the wall. Byte code
is kept as it is for an installed package, all else in a temporary cache folder.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

INTERFACES = 100
ROOT = Path(__file__).parents[1]


def workspace(root: Path, components: int, *, collected: bool) -> Path:
    """A workspace whose design `big` has a place for each interface; components in files of their own, or in one."""
    draw = random.Random(1)  # noqa: S311  # a benchmark, no secret
    (root / "components").mkdir(parents=True)
    (root / "designs").mkdir()
    ports = "{inputs: {a: m, b: m/s}, outputs: {x: N.m, y: rad/s}}"
    lines = [f"  i{number}: {ports}\n" for number in range(INTERFACES)]
    (root / "components" / "interfaces.yaml").write_text("interfaces:\n" + "".join(lines))
    places: list[list[str]] = [[] for _ in range(INTERFACES)]
    together = []
    for number in range(components):
        place = number % INTERFACES
        name = f"c{place}_{number // INTERFACES}"
        places[place].append(name)
        cost, mass = draw.randint(10, 9999), draw.randint(10, 9999)
        facts = f"implements: i{place}, properties: {{cost: {cost} EUR, mass: {mass} g}}"
        together.append(f"  {name}: {{{facts}}}\n")
        if not collected:
            (root / "components" / name).mkdir()
            (root / "components" / name / "component.yaml").write_text(f"{{component: {name}, {facts}}}\n")
    if collected:
        (root / "components" / "parts.yaml").write_text("components:\n" + "".join(together))
    tree = [f"    p{place}: {{alternatives: [{', '.join(names)}]}}\n" for place, names in enumerate(places)]
    rule = "constraints: {pair: {require: p0 is c0_0 implies p1 is c1_0}}\n"
    (root / "designs" / "big.yaml").write_text("design: big\nroot:\n  compound:\n" + "".join(tree) + rule)
    return root


def seconds(command: list[str], folder: Path, environment: dict[str, str]) -> tuple[float, float]:
    """Time on the wall, and of the processor."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--components", type=int, default=10_000)
    parser.add_argument("--cold", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        separate = workspace(folder / "separate", options.components, collected=False)
        collected = workspace(folder / "collected", options.components, collected=True)
        kept = {"DSE_CACHE": str(folder / "cache"), "PYTHONPYCACHEPREFIX": str(folder / "code")}
        environment = {**os.environ, **kept, "PYTHONPATH": str(ROOT)}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        dse = [sys.executable, "-m", "dse"]
        number = f"{options.components:,} components"
        cases = [
            ("python alone", [sys.executable, "-c", "pass"], folder, ""),
            ("import dse", [sys.executable, "-c", "import dse"], folder, "50 ms with Python"),
            ("import numpy", [sys.executable, "-c", "import numpy"], folder, "to compare machines by"),
            ("dse --help", [*dse, "--help"], folder, ""),
            ("dse enumerate acc_vehicle --count", [*dse, "enumerate", "acc_vehicle", "--count"], ROOT, "< 400 ms"),
            (f"dse space count, {number} in files", [*dse, "space", "count", "big"], separate, "< 1000 ms"),
            (f"dse space count, {number} in one file", [*dse, "space", "count", "big"], collected, "< 1000 ms"),
        ]
        print(f"{'':50} {'wall':>7} {'CPU':>7}  ms")
        first = [seconds(command, where, environment) for _, command, where, _ in cases]
        times: list[list[tuple[float, float]]] = [[] for _ in cases]
        for _ in range(options.runs):
            for found, (_, command, where, _) in zip(times, cases, strict=True):
                found.append(seconds(command, where, environment))
        for (name, *_, aim), (wall, cpu), found in zip(cases, first, times, strict=True):
            if options.cold:
                print(f"{name + ', first time':50} {wall * 1e3:7.0f} {cpu * 1e3:7.0f}")
            walls, cpus = zip(*found, strict=True)
            print(f"{name:50} {statistics.median(walls) * 1e3:7.0f} {statistics.median(cpus) * 1e3:7.0f}  {aim}")


if __name__ == "__main__":
    main()
