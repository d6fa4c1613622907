"""Datagrams between two processes on this machine: exchanges per second in lockstep, and lateness in real time.

    python benchmarks/bench_udp.py --steps 50000 --seconds 60

Both sides are FMUs of the kind udp, a client and a server, each the only element of a run.
"""

from __future__ import annotations

import argparse
import hashlib
import multiprocessing
import os
import socket
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.cosim import Simulator
from dse.domain.component import Causality, Component, Interface, Kind, Port, Type
from dse.domain.system import Element, SystemStructure
from dse.domain.udp import LINK, LinkMode, LinkRole, UdpSource
from dse.fmu import build, open_fmu
from dse.units import parse_unit

VALUES, H = 12, 0.01


def half(source: UdpSource, cache: Path, stop: float) -> NDArray[np.float64]:
    """What a run of that half records: the values heard, then those counted."""
    real, seconds = Type(Kind.REAL), Type(Kind.REAL, parse_unit("s"))
    ports = [Port(f"{way}{n}", side, real) for way, side in SIDES for n in range(VALUES)]
    ports += [Port(name, Causality.OUTPUT, seconds if name == LINK[-1] else real) for name in LINK]
    component = Component("half", Interface("half", tuple(ports)), source=source)
    model = open_fmu(build(component, cache=cache), cache=cache)
    outputs = tuple(variable for variable in model.variables.values() if variable.causality == "output")
    start = {f"u{n}": n / 7 for n in range(VALUES)}
    system = SystemStructure("half", (Element("half", model, (), outputs, start),), ())
    with Simulator(system, [f"half.{variable.name}" for variable in outputs]) as simulator:
        return simulator.run(stop=stop, step=H)


SIDES = (("u", Causality.INPUT), ("y", Causality.OUTPUT))


def both(mode: LinkMode, cache: Path, stop: float) -> tuple[NDArray[np.float64], float, float]:
    """What the client records, and how long it took: in s, and in s of its processor time."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    server = UdpSource(port, role=LinkRole.SERVER, mode=mode, wait=60.0)
    other = multiprocessing.Process(target=half, args=(server, cache, stop + H))
    other.start()
    client = UdpSource(port, mode=mode, wait=60.0)
    half(client, cache, H)  # built, and both are there
    other.join()
    other = multiprocessing.Process(target=half, args=(server, cache, stop + H))
    other.start()
    before, busy = time.perf_counter(), time.process_time()
    table = half(client, cache, stop)
    took = time.perf_counter() - before, time.process_time() - busy
    other.join()
    return table, *took


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=50_000)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--times", type=int, default=1)
    given = parser.parse_args()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(given.times):
            table, took, busy = both(LinkMode.LOCKSTEP, Path(folder), given.steps * H)
            digest = hashlib.sha256(np.ascontiguousarray(table[:, :VALUES]).tobytes()).hexdigest()[:16]
            each = f"{busy / given.steps * 1e6:.0f} us of processor time each on this side"
            print(f"lockstep, {VALUES} values each way: {given.steps / took:,.0f} exchanges/s, {each}, hash {digest}")
        table, _, _ = both(LinkMode.FREE, Path(folder), given.seconds)
        late = table[1:, VALUES + 3] * 1e3
        told = ", ".join(f"{name} {np.percentile(late, q):.3f} ms" for name, q in (("median", 50), ("p99", 99)))
        missed = f"{table[-1, VALUES + 2]:.0f} of {len(late)} deadlines missed"
        print(f"real time, 100 Hz, {given.seconds:.0f} s: lateness {told}, most {late.max():.3f} ms; {missed}")


if __name__ == "__main__":
    main()
