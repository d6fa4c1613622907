"""A system cut in two: elements of the kind udp stand for the other half, and both halves run at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from background import LIMIT, in_background
from live.conftest import outside
from numpy.typing import NDArray

from dse.cosim import Simulator
from dse.domain.method import Algorithm, Method
from dse.domain.system import Element, SystemStructure, Wire
from dse.domain.udp import LinkRole, UdpSource


class Halves:
    """*near* are the elements of the client's half; *asks_at* is the port at which it finds the other, at *port*."""

    def __init__(
        self, whole: SystemStructure, near: Sequence[str], cache: Path, port: int, asks_at: int = 0, version: int = 2
    ) -> None:
        crossing = [w for w in whole.wires if (w.source in near) is not (w.target in near)]
        out, back = (
            sorted({f"{w.source}_{w.source_variable}" for w in crossing if (w.source in near) is is_near})
            for is_near in (True, False)
        )
        client = UdpSource(asks_at or port, timeout=LIMIT, wait=LIMIT)
        server = UdpSource(port, role=LinkRole.SERVER, timeout=LIMIT, wait=LIMIT)
        there = Element("outside", outside(client, cache, out, back, version=version), (), (), {})
        here = Element("outside", outside(server, cache, back, out, version=version), (), (), {})
        self.near = _half(whole, [*(e for e in whole.elements if e.name in near), there])
        self.far = _half(whole, [here, *(e for e in whole.elements if e.name not in near)])

    def run(
        self, near_record: Sequence[str], far_record: Sequence[str], method: Method, *, stop: float, step: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The waveforms of both. A session that was begun anew with other values is a run that ended at its start."""
        leads = replace(method, leading=("outside",))
        found: list[NDArray[np.float64]] = []

        def serve() -> None:
            with Simulator(self.far, far_record, method=leads) as simulator:
                while not found or len(found[-1]) < 2:
                    found.append(simulator.run(stop=stop + step, step=step))

        with in_background(serve), Simulator(self.near, near_record, method=method) as simulator:
            near = simulator.run(stop=stop, step=step)
        return near, found[-1]


def _half(whole: SystemStructure, elements: Sequence[Element]) -> SystemStructure:
    names = [element.name for element in elements]
    wires = [_ended_here(wire, names) for wire in whole.wires if wire.source in names or wire.target in names]
    wires = list(dict.fromkeys(wires))
    used = {(w.source, w.source_variable) for w in wires} | {(w.target, w.target_variable) for w in wires}
    (other,) = (element for element in elements if element.name == "outside")
    ports = [v for v in other.model.variables.values() if ("outside", v.name) in used]
    joined = replace(
        other,
        inputs=tuple(v for v in ports if v.causality == "input"),
        outputs=tuple(v for v in ports if v.causality == "output"),
    )
    return SystemStructure("half", tuple(joined if e is other else e for e in elements), tuple(wires))


def _ended_here(wire: Wire, names: Sequence[str]) -> Wire:
    crossing = f"{wire.source}_{wire.source_variable}"
    if wire.source not in names:
        return replace(wire, source="outside", source_variable=crossing)
    if wire.target not in names:
        return Wire(wire.source, wire.source_variable, "outside", crossing)
    return wire


ORDERLY = (Method(), Method(Algorithm.GAUSS_SEIDEL))
