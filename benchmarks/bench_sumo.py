"""Steps per second of traffic by SUMO on one core: SUMO alone, with host and movers, and, as in a run, over a socket.

Processor time of all who take part, without the warm-up. `bench_world.py` has our own traffic.
"""

from __future__ import annotations

import os
import resource
import socket
import struct
import time
from pathlib import Path

import numpy as np

from dse.fmu import build, open_fmu
from dse.loading import Workspace
from dse.world import lane_middle, open_roads, place, road_tables
from dse.world.sumo.simulation import Simulation

STEPS, H = 2000, 0.01
CASES = ((700 / 3600, 140.0), (4600 / 3600, 140.0))
"""The flow per second, and the warm-up in s: some 24 vehicles, and some 200."""


def parameters(component: object, flow: float, warm_up: float) -> dict[str, float]:
    found: dict[str, float] = {}
    for each in component.parameters:  # type: ignore[attr-defined]
        factor = float(each.type.unit.factor) if each.type.unit.symbol else 1.0
        found[each.name] = each.type.items.index(each.start) if each.type.items else float(each.start) * factor
    return {**found, "flow": flow, "warm_up": warm_up}


def spent() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def over_a_socket(simulation: Simulation, inputs: list[dict[str, float]]) -> float:
    """Seconds of processor time for a step: a fork drives, this process asks."""
    ours, theirs = socket.socketpair()
    names = list(inputs[0])
    before = spent()
    child = os.fork()
    if not child:
        ours.close()
        while question := theirs.recv(8 * len(names), socket.MSG_WAITALL):
            numbers = struct.unpack(f"={len(names)}d", question)
            theirs.sendall(struct.pack("=104d", *simulation.step(dict(zip(names, numbers, strict=True)), H)))
        os._exit(0)
    theirs.close()
    for each in inputs:
        ours.sendall(struct.pack(f"={len(names)}d", *each.values()))
        ours.recv(8 * 104, socket.MSG_WAITALL)
    ours.close()
    os.waitpid(child, 0)
    return (spent() - before) / STEPS


def measured(folder: Path, given: dict[str, float], inputs: list[dict[str, float]]) -> None:
    simulation = Simulation(folder, given)
    socketed = over_a_socket(simulation, inputs)
    begun = time.process_time()
    for each in inputs:
        simulation.step(each, H)
    whole = (time.process_time() - begun) / STEPS
    begun = time.process_time()
    for _ in range(STEPS):
        simulation._sumo.simulation.step()  # noqa: SLF001  # what it would cost without us
    alone = (time.process_time() - begun) / STEPS
    count = simulation._sumo.vehicle.getIDCount()  # noqa: SLF001
    costs = {"SUMO alone": alone, "with host and movers": whole, "over a socket": socketed}
    rates = ", ".join(f"{title} {1 / cost:,.0f}" for title, cost in costs.items())
    print(f"{count} vehicles: steps/s of processor time: {rates}")


def main() -> None:
    workspace = Workspace(Path(__file__).parents[1])
    component = workspace.component("sumo_traffic")
    folder = open_fmu(build(component)).folder / "resources"
    path = road_tables(open_roads("motorway", workspace)).paths[0]
    stations = 1000.0 + 0.28 * np.arange(STEPS)
    at = place(path, stations, lane_middle(path, stations))
    inputs = [
        {"lane.station": s, "motion.x": x, "motion.y": y, "motion.heading": heading, "motion.speed": 28.0}
        for s, x, y, heading in zip(stations, at.x, at.y, at.heading, strict=True)
    ]
    for flow, warm_up in CASES:
        if not (child := os.fork()):  # one simulation a process
            measured(folder, parameters(component, flow, warm_up), inputs)
            os._exit(0)
        os.waitpid(child, 0)


if __name__ == "__main__":
    main()
