"""A configuration on its bench with everything a worker needs to simulate it, picklable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from dse.domain.bench import Requirement, Simulation
from dse.domain.component import Type
from dse.domain.design import Configuration
from dse.domain.system import SystemStructure
from dse.metrics.program import MetricProgram


@dataclass(frozen=True, slots=True)
class Setting:
    """A parameter or unconnected input that a run may be given: its name in the system, and its type."""

    target: str
    type: Type


@dataclass(frozen=True, slots=True)
class PreparedBench:
    """What `Executor` simulates.

    *columns* names what is recorded in every step, as ``part.port``; *system_columns* is the same in FMU
    variables. *kept* are the columns stored as waveforms. *settings* is everything a point may set, and
    *constants* the values metrics and targets use, in SI, at the bench's own point.
    """

    configuration: Configuration
    system: SystemStructure
    simulation: Simulation
    program: MetricProgram
    requirements: tuple[Requirement, ...]
    columns: tuple[str, ...]
    system_columns: tuple[str, ...]
    kept: tuple[str, ...]
    settings: Mapping[str, Setting]
    constants: Mapping[str, float]

    @property
    def timeout(self) -> float:
        """Seconds a single run may take."""
        return self.simulation.timeout

    def describe_progress(self, block: bytes) -> str:
        """The FMU, call and time a dead or hanging worker was at."""
        from dse.cosim.progress import describe

        return describe(block, self.system, self.simulation.step)
