"""A configuration on its bench with everything a worker needs to simulate it, picklable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from dse.cosim import most_runs
from dse.domain.bench import Requirement, Simulation
from dse.domain.component import Type
from dse.domain.design import Configuration
from dse.domain.facts import FmuFacts
from dse.domain.fused import FusedLibrary
from dse.domain.noise import NoiseStream
from dse.domain.system import SystemStructure
from dse.metrics import MetricProgram, RowProgram
from dse.testbench.variations import Checks


@dataclass(frozen=True, slots=True)
class Setting:
    """What a run may be given: its name in the system, its type, and its value at the bench's own point, in SI."""

    target: str
    type: Type
    value: float


@dataclass(frozen=True, slots=True)
class Recording:
    """What is recorded in every step: *columns* as ``part.port``, *variables* the same as the system calls them.

    *kept* are the columns stored as waveforms.
    """

    columns: tuple[str, ...]
    variables: tuple[str, ...]
    kept: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PreparedBench:
    """What `Runner` simulates.

    *simulation* is the bench's, its method in names of the system. *settings* is everything a point may set. *facts*
    tells what is known of elements; *thread_safe*, that all are known to bear being simulated several times at once in
    threads. *fused* is the library made of the whole system, if there is one. *checks* are what error bars are made of.
    *derived* settings are computed from others in every run, in their order; *streams* are the seeds that follow from a
    run's draw. *fixed* are values that metrics use and no
    run can change, as they belong to the other half of a bench in two.
    """

    configuration: Configuration
    system: SystemStructure
    simulation: Simulation
    program: MetricProgram
    recording: Recording
    requirements: tuple[Requirement, ...] = ()
    settings: Mapping[str, Setting] = field(default_factory=dict)
    facts: Mapping[str, FmuFacts] = field(default_factory=dict)
    thread_safe: bool = False
    fused: FusedLibrary | None = None
    checks: Checks = field(default_factory=Checks)
    derived: Mapping[str, RowProgram] = field(default_factory=dict)
    streams: tuple[NoiseStream, ...] = ()
    fixed: Mapping[str, float] = field(default_factory=dict)

    @property
    def constants(self) -> dict[str, float]:
        """The values metrics and targets use at the bench's own point."""
        return {**self.fixed, **{name: setting.value for name, setting in self.settings.items()}}

    @property
    def kept(self) -> tuple[str, ...]:
        """The columns stored as waveforms."""
        return self.recording.kept

    @property
    def timeout(self) -> float:
        """Seconds a single run may take, with those that it is compared with."""
        return self.simulation.timeout * (1.0 + sum(variation.cost for variation in self.checks.variations))

    @property
    def memory(self) -> float:
        """Bytes a worker may be resident with."""
        return self.simulation.memory

    @property
    def most_runs(self) -> int | None:
        """How many runs one process may make; None for any number."""
        most = most_runs(self.system, self.facts)
        # A run that is compared with others needs instances for each of them.
        return None if most is None else max(1, most // (1 + len(self.checks.variations)))

    def describe_progress(self, block: bytes) -> str:
        """The FMU, call and time a dead or hanging worker was at."""
        from dse.cosim import describe_progress

        return describe_progress(block, self.system, self.simulation.step)
