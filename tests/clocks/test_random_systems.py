"""Systems of FMUs with clocks, put together at random: the same bits as the master on FMPy."""

from __future__ import annotations

import random

import pytest

from clocks.fmus import Workshop
from clocks.test_clocks_equal_reference import (
    AFTER_RING,
    AGAIN,
    ALONE_MODE,
    TIMINGS,
    same_bits,
    start_of,
)

RECORDED = ("count", "at", "sum", "seen", "rings", "heard", "y")
CLOCKED, FREE = ("count", "sum", "at", "seen"), ("y", "rings", "heard", "count")


def wires_of(chance: random.Random, names: str) -> list[str]:
    found = []
    for position, name in enumerate(names):
        before = names[:position]
        others = names.replace(name, "")
        # Sums go one way only: round and round they would have to be solved.
        if before and chance.random() < 0.5:
            found.append(f"{chance.choice(before)}.sum -> {name}.u")
        elif chance.random() < 0.7:
            found.append(f"{chance.choice(others)}.{chance.choice(('count', 'at', 'y'))} -> {name}.u")
        if chance.random() < 0.7:
            found.append(f"{chance.choice(others)}.{chance.choice((*CLOCKED, 'y'))} -> {name}.v")
        if chance.random() < 0.5:
            found.append(f"{chance.choice(others)}.{chance.choice(FREE)} -> {name}.x")
        if chance.random() < 0.6:
            found.append(f"{chance.choice(others)}.bell -> {name}.ring")
    return found


@pytest.mark.sampled(12)
@pytest.mark.parametrize("seed", range(120))
def test_whatever_is_wired_to_whatever(workshop: Workshop, seed):
    chance = random.Random(seed)  # noqa: S311  # no secret
    names = "abcd"[: chance.randint(2, 4)]
    fmus, start = {}, {}
    for name in names:
        timing = chance.choice(list(TIMINGS))
        fmus[name] = workshop.ticker(TIMINGS[timing])
        mode = chance.choice([0, 0, 0, AGAIN, *([AFTER_RING] if "countdown" in timing else [])])
        period = chance.choice([0.05, 0.1, 0.15, 0.3, 0.125])
        delay = chance.choice([0.0, 0.02, 0.25]) if mode == AFTER_RING else 0.0
        more = {"every": float(chance.randint(0, 3)), "mode": mode, "delay": delay, "bias": chance.randint(0, 3)}
        start |= start_of(name, timing, period, **more)
        if mode == AFTER_RING and "parts" in timing:
            start[f"{name}.delay"] *= 1000.0
    wires = wires_of(chance, names)
    record = [f"{name}.{variable}" for name in names for variable in RECORDED]
    telling = {wire[0] for wire in wires if ".bell" in wire}
    # A clock without a wire of its own ticks with those of the values: a sum belongs to a bell, too.
    rung = {wire[-6] for wire in wires if ".bell" in wire}
    telling |= {wire[0] for wire in wires if ".sum -> " in wire and wire.endswith(".v") and wire[-3] not in rung}
    early = telling.pop() if len(telling) == 1 else ""
    if early and chance.random() < 0.5 and f"{early}.ring" not in " ".join(wires):
        start |= {f"{early}.mode": float(ALONE_MODE), f"{early}.delay": 0.21, f"{early}.every": 0.0}
    same_bits(workshop, fmus, wires, start, record, step=chance.choice([0.25, 0.1, 0.05, 0.2]), early=early)
