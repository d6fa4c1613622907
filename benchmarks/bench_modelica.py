"""Modelica powertrains: what a step of 10 ms costs in the loop of the paper, and how long builds take.

The step: one run of `acc_following` for each powertrain, in turns with the ideal one; the difference a step is what
the Modelica powertrain costs beyond a lag in C (inputs change in every step, so the integrator starts anew each time).
The build: into an empty cache, first one component (which loads the front-end and the compiler), then each of the
others alone, then all of them at once.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from statistics import median

from dse.cosim.simulator import Simulator
from dse.domain.component import Component, ModelicaSource
from dse.fmu.component_build import build, build_all
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.prepare import prepare_bench
from dse.testbench.prepared_bench import PreparedBench

ROOT = Path(__file__).parents[1]
TURNS = 7
BASE = "combustion_ideal"
FIXED = {"sensor": "radar_77ghz_mid", "controller": "pd_acc"}


def main() -> None:
    workspace = Workspace.around(ROOT)
    show_steps(workspace)
    show_builds(workspace)


def show_steps(workspace: Workspace) -> None:
    bench = workspace.bench("acc_following")
    chosen = {}
    for configuration in open_space(bench.design).configurations():
        picked = dict(configuration.choices)
        if "video" not in picked and all(picked[place] == name for place, name in FIXED.items()):
            chosen.setdefault(picked["powertrain"], configuration)
    prepared = prepare_bench(bench, list(chosen.values()))
    benches = {name: prepared[configuration.id] for name, configuration in chosen.items()}
    spent = in_turns(benches)
    steps = benches[BASE].simulation.stop / benches[BASE].simulation.step
    print(f"{'powertrain':<20}{'run':>9}{'a step':>10}{'beyond the ideal one':>24}")
    for name, seconds in sorted(spent.items(), key=lambda item: item[1]):
        beyond = f"{(seconds - spent[BASE]) / steps * 1e6:.2f} us"
        print(f"{name:<20}{seconds * 1e3:>6.1f} ms{seconds / steps * 1e6:>7.2f} us{beyond:>24}")


def in_turns(benches: Mapping[str, PreparedBench]) -> dict[str, float]:
    """Median seconds of a run on reset instances, by powertrain."""
    simulators = {name: Simulator(bench.system, bench.recording.variables) for name, bench in benches.items()}
    taken: dict[str, list[float]] = {name: [] for name in benches}
    for turn in range(TURNS + 2):
        for name, simulator in simulators.items():
            start = time.perf_counter()
            simulator.run(stop=benches[name].simulation.stop, step=benches[name].simulation.step)
            if turn > 1:  # the first two prove that a reset is as good as a fresh instance
                taken[name].append(time.perf_counter() - start)
    for simulator in simulators.values():
        simulator.close()
    return {name: median(seconds) for name, seconds in taken.items()}


def show_builds(workspace: Workspace) -> None:
    parts = [workspace.component(name) for name in sorted(workspace.component_files)]
    parts = [part for part in parts if isinstance(part.source, ModelicaSource)]
    with tempfile.TemporaryDirectory() as scratch:
        alone = {part.name: timed(part, Path(scratch) / "alone") for part in parts}
        first, *others = alone.values()
        print(f"\nbuild of the first of {len(parts)} components: {first:.2f} s")
        print(f"of each of the others: {min(others):.2f} to {max(others):.2f} s, {sum(others):.1f} s in all")
        print(f"once more, out of the cache: {timed(parts[-1], Path(scratch) / 'alone') * 1e3:.0f} ms")
        print(f"with another start value: {timed(restarted(parts[0]), Path(scratch) / 'alone') * 1e3:.0f} ms")
        start = time.perf_counter()
        build_all(parts, cache=Path(scratch) / "together")
        print(f"all {len(parts)} at once: {time.perf_counter() - start:.1f} s")


def timed(part: Component, cache: Path) -> float:
    start = time.perf_counter()
    build(part, cache=cache)
    return time.perf_counter() - start


def restarted(part: Component) -> Component:
    """The component with another start value of its first parameter that is not structural."""
    first = next(p for p in part.parameters if isinstance(p.start, float) and p.tunable)
    other = replace(first, start=float(first.start) * 1.01)
    return replace(part, parameters=tuple(other if p is first else p for p in part.parameters))


if __name__ == "__main__":
    main()
