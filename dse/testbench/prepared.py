"""A configuration on its bench with everything a worker needs to simulate it, picklable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from dse.cosim.wear import most_runs
from dse.domain.bench import Requirement, Simulation
from dse.domain.component import Type
from dse.domain.design import Configuration
from dse.domain.facts import FmuFacts
from dse.domain.fused import FusedLibrary
from dse.domain.method import PLAIN, Method
from dse.domain.system import SystemStructure
from dse.metrics.program import MetricProgram


@dataclass(frozen=True, slots=True)
class Setting:
    """A parameter or unconnected input that a run may be given: its name in the system, and its type."""

    target: str
    type: Type


@dataclass(frozen=True, slots=True)
class PreparedBench:
    """What `Runner` simulates.

    *columns* names what is recorded in every step, as ``part.port``; *system_columns* is the same in FMU
    variables. *kept* are the columns stored as waveforms. *settings* is everything a point may set, and
    *constants* the values metrics and targets use, in SI, at the bench's own point. *method* is the bench's, in
    names of the system. *facts* tells what is known of elements; *thread_safe*, that all are known to bear being
    simulated several times at once in threads. *fused* is the library made of the whole system, if there is one.
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
    method: Method = PLAIN
    facts: Mapping[str, FmuFacts] = field(default_factory=dict)
    thread_safe: bool = False
    fused: FusedLibrary | None = None

    @property
    def timeout(self) -> float:
        """Seconds a single run may take."""
        return self.simulation.timeout

    @property
    def memory(self) -> float:
        """Bytes a worker may be resident with."""
        return self.simulation.memory

    @property
    def most_runs(self) -> int | None:
        """How many runs one process may make; None for any number."""
        most = most_runs(self.system, self.facts)
        # A run that is made again with half the step needs twice the instances.
        return most if most is None or not self.simulation.check_step else max(1, most // 2)

    def describe_progress(self, block: bytes) -> str:
        """The FMU, call and time a dead or hanging worker was at."""
        from dse.cosim.failing.progress import describe_progress

        return describe_progress(block, self.system, self.simulation.step)
