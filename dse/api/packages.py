"""SSP packages: simulated once, and what came of it as the system's own connectors show it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dse.domain.run import Run, Waveforms
from dse.exploration.supervision.single_run import simulate_alone
from dse.storage.rows import Measures
from dse.testbench.execute import make_runner

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dse.interchange.prepared import PreparedPackage
    from dse.interchange.resolving.conversion import Carry


def simulate_package(package: PreparedPackage) -> Run:
    """The run of the package at its own point; its waveforms are the package's signals by name."""
    run = simulate_alone(package.bench, make_runner, "ssp", Measures())
    if run.waveforms is None:
        return run
    recorded = run.waveforms
    values = {s.name: _carried(s.carry, recorded.values[s.label]) for s in package.resolved.signals}
    return replace(run, waveforms=Waveforms(recorded.time, values))


def _carried(carry: Carry, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Recorded values as the system's own connector shows them."""
    import numpy as np

    if carry.table is None and carry.is_linear_identity:
        return values
    return np.array([carry.apply(float(value)) for value in values], np.float64)
