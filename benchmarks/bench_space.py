"""Design spaces: every figure the engine promises, with other people's solvers in the same run.

``python benchmarks/bench_space.py [--seconds 10] [--exact]``; --exact adds the exact count of L with its three sums.
Each part runs in a process of its own, so that memory is that part's.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import spaces
from space_peers import peers

from dse.space.flat import FlatSpace
from dse.space.lowering import flatten
from dse.space.methods.engine import Engine
from dse.space.methods.grid.exact import exact_count
from dse.space.methods.listing.blocks import blocks, first
from dse.space.methods.mdd.diagram import compile_diagram, count
from dse.space.methods.sampling.estimate import estimate
from dse.space.methods.sampling.sample import sample
from dse.space.questions.conflict import conflict
from dse.space.questions.impact import impact

TRUE_L = 1003325110148026384508655
UVL = Path(__file__).parents[2] / "shared" / "data" / "uvl"


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def least(work: Callable[[], Any], times: int = 5) -> float:
    return min(timed(work)[0] for _ in range(times))


def small() -> None:
    flat = flatten(spaces.space_s())
    show("S count, compiling included", least(lambda: exact_count(compile_diagram(flat))), "s", "< 0.05")
    listing = least(lambda: sum(len(block) for block in blocks(compile_diagram(flat))))
    show("S list of 67,057, compiling included", listing, "s", "< 0.05")
    assert sum(len(block) for block in blocks(compile_diagram(flat))) == exact_count(compile_diagram(flat)) == 67_057


def large() -> None:
    space = spaces.space_l()
    seconds, flat = timed(lambda: flatten(space))
    show("L lowering of the expressions", seconds, "s", "")
    show("L first, compiling included", least(lambda: first(compile_diagram(flat))), "s", "< 0.05")
    show("L exact on the rules alone, compiling included", least(lambda: count(compile_diagram(flat))), "s", "< 0.1")
    diagram = compile_diagram(flat)
    seconds, drawn = timed(lambda: sample(diagram, 10_000, 0))
    assert len(drawn) == 10_000
    show("L 10,000 uniform samples", seconds, "s", "< 3")
    seconds, tally = timed(lambda: estimate(diagram, 0))
    show("L estimate", seconds, "s", "< 5")
    show("L half-width of the estimate", 50 * (tally.high - tally.low) / tally.value, "%", "< 0.5")
    show("L true count inside", float(tally.low <= TRUE_L <= tally.high), "", "1")
    show("L rows in blocks", _rate(diagram, objects=False), "/s", "> 0.8M")
    show("L rows as Python tuples", _rate(diagram, objects=True), "/s", "> 150k")


def two_sums() -> None:
    flat = flatten(spaces.space_l(sums=2))
    seconds, number = timed(lambda: exact_count(compile_diagram(flat)))
    assert number == 2756061488808238867758114
    show("L exact with two sums", seconds, "s", "< 5")


def three_sums() -> None:
    flat = flatten(spaces.space_l())
    seconds, number = timed(lambda: exact_count(compile_diagram(flat), most_work=1e12))
    assert number == TRUE_L
    show("L exact with three sums", seconds, "s", "< 30")


def tight() -> None:
    diagram = compile_diagram(flatten(spaces.space_l_tight()))
    show("Ltight first", least(lambda: first(diagram)), "s", "< 0.05")
    seconds, number = timed(lambda: sum(len(block) for block in blocks(diagram)))
    assert number == 5_340_209
    show("Ltight complete list of 5,340,209", seconds, "s", "< 120")


def chain() -> None:
    flat = flatten(spaces.space_chain())
    seconds, _ = timed(lambda: exact_count(compile_diagram(flat)))
    show("30 places of 8, three sums, exact", seconds, "s", "< 20")


def explained() -> None:
    engine = Engine.of(spaces.space_l_empty())
    seconds, found = timed(lambda: conflict(engine))
    show(f"empty L, minimal conflict of {len(found)}", seconds, "s", "< 1")
    numbers = [constraint.name for constraint in engine.flat.constraints]
    owners = {numbers.index(constraint.name) for constraint in found}
    assert all(first(compile_diagram(engine.flat.only(owners - {owner}))) is not None for owner in owners)
    seconds, table = timed(lambda: impact(Engine.of(spaces.space_l())))
    show(f"L, what each of {len(table)} constraints does", seconds, "s", "")


def feature_models() -> None:
    if not UVL.is_dir():
        print("no feature models here: ../shared is absent")
        return
    from dse.loading.uvl.reading import read_uvl

    known = json.loads((UVL / "counts.json").read_text(encoding="utf-8"))
    for name in known:
        start = time.perf_counter()
        number = Engine.of(read_uvl(UVL / f"{name}.uvl")).exactly()
        seconds = time.perf_counter() - start
        assert number == int(known[name]["count"]), name
        features = known[name]["features"]
        limit = "< 3" if name == "automotive01" else ""
        show(f"{name}, {features} features, read and counted", seconds, "s", limit)


def others(limit: float) -> None:
    for name, space in (("S", spaces.space_s()), ("L", spaces.space_l()), ("Ltight", spaces.space_l_tight())):
        flat = flatten(space)
        start = time.perf_counter()
        first(compile_diagram(flat))
        seconds = time.perf_counter() - start
        print(f"{name:7} dse     first {seconds:8.3f} s   {_first_rate(flat, limit):12,.0f} /s")
        for peer, solve in peers().items():
            figures = solve(flat, limit)
            shown = "    none" if figures.first is None else f"{figures.first:8.3f}"
            print(f"{name:7} {peer:7} first {shown} s   {figures.rate:12,.0f} /s")


def _first_rate(flat: FlatSpace, limit: float) -> float:
    number, start = 0, time.perf_counter()
    for block in blocks(compile_diagram(flat)):
        number += len(list(map(tuple, block.tolist())))
        if time.perf_counter() - start > limit:
            break
    return number / (time.perf_counter() - start)


def _rate(diagram: Any, *, objects: bool, most: int = 2_000_000) -> float:
    number, start = 0, time.perf_counter()
    for block in blocks(diagram):
        number += len(list(map(tuple, block.tolist()))) if objects else len(block)
        if number >= most:
            break
    return number / (time.perf_counter() - start)


def show(what: str, figure: float, unit: str, wanted: str) -> None:
    print(f"{what:52} {figure:14,.4g} {unit:3} {wanted}", flush=True)


PARTS = {part.__name__: part for part in (small, large, two_sums, three_sums, tight, chain, explained, feature_models)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="for each peer and space")
    parser.add_argument("--exact", action="store_true", help="count L exactly with three sums, too")
    parser.add_argument("--part", choices=[*PARTS, "others"])
    given = parser.parse_args()
    if given.part == "others":
        others(given.seconds)
    elif given.part:
        PARTS[given.part]()
        print(f"{'':52} {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:14,.0f} MB")
    else:
        for part in (*PARTS, "others"):
            if part != "three_sums" or given.exact:
                command = [sys.executable, __file__, "--part", part, "--seconds", str(given.seconds)]
                subprocess.run(command, check=True)


if __name__ == "__main__":
    main()
