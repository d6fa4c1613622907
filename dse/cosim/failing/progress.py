"""The progress block: which FMI call a simulation is in, readable from another process even after a crash.

The kernel writes the block before every FMI call and after the last one of a run. Put it in memory that outlives the
process (an mmap shared with the supervisor) and hand the memoryview to :class:`dse.cosim.simulator.Simulator`.
"""

from __future__ import annotations

import struct

from dse.cosim.binding.calls import Call, function_name
from dse.cosim.failing.failure import place
from dse.domain.system import SystemStructure

_BLOCK = struct.Struct("=4q")  # struct Progress in kernel.h: element, call, step, run

PROGRESS_BYTES = _BLOCK.size
"""Size of the block: four 64-bit integers in native order (element index, call, step or -1, runs begun)."""


def describe(block: bytes, system: SystemStructure, step: float) -> str:
    """The place a progress block tells of, as ``world: fmi2DoStep at t = 3.21 s``; *step* in seconds.

    "between two FMI calls" if the simulation was in none.
    """
    index, call, k, _ = _BLOCK.unpack(block[:PROGRESS_BYTES])
    if call == Call.IDLE or not 0 <= index < len(system.elements):
        return "between two FMI calls"
    element = system.elements[index]
    if call == Call.LOAD:
        return f"{element.name}: loading its library"
    name = function_name(call, element.model.version) or f"FMI call {call}"
    return place(element.name, name, k * step if k >= 0 else None)
