"""The progress block: which FMI call a simulation is in, readable from another process even after a crash.

The kernel writes the block before every FMI call and after the last one of a run. Put it in memory that outlives the
process (an mmap shared with the supervisor) and hand the memoryview to :class:`dse.cosim.simulator.Simulator`.
"""

from __future__ import annotations

import ctypes

from dse.cosim.binding.calls import Call, function_name
from dse.cosim.binding.layout import Progress
from dse.cosim.failure.fmu_messages import place
from dse.domain.system import SystemStructure

PROGRESS_BYTES = ctypes.sizeof(Progress)
"""Size of the block."""


def run_and_step(block: bytes) -> tuple[int, int]:
    """The number of the run that a progress block tells of, and its communication step; -1 before the first."""
    progress = Progress.from_buffer_copy(block)
    return int(progress.run), int(progress.step)


def describe_progress(block: bytes, system: SystemStructure, step: float) -> str:
    """The place a progress block tells of, as ``world: fmi2DoStep at t = 3.21 s``; *step* in seconds.

    "between two FMI calls" if the simulation was in none.
    """
    progress = Progress.from_buffer_copy(block)
    if progress.place.call == Call.IDLE or not 0 <= progress.place.element < len(system.elements):
        return "between two FMI calls"
    element = system.elements[progress.place.element]
    if progress.place.call == Call.LOAD:
        return f"{element.name}: loading its library"
    name = function_name(progress.place.call, element.model.version) or f"FMI call {progress.place.call}"
    return place(element.name, name, progress.step * step if progress.step >= 0 else None)
