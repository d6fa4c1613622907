"""SSP packages: opened, simulated once, and what came of it as the system's own connectors show it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dse.api.exploring import package_alone
from dse.domain.run import Waveforms
from dse.interchange.prepared import PreparedPackage, prepare_ssp

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dse.interchange.resolving.conversion import Carry

__all__ = ["PreparedPackage", "prepare_ssp", "simulate_package"]


def simulate_package(package: PreparedPackage) -> tuple[Waveforms | None, str]:
    """The package's signals by name at its own point, or None and what was wrong."""
    waveforms, problem = package_alone(package)
    if waveforms is None:
        return None, problem
    signals = package.resolved.signals
    return Waveforms(waveforms.time, {s.name: _carried(s.carry, waveforms.values[s.label]) for s in signals}), problem


def _carried(carry: Carry, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Recorded values as the system's own connector shows them."""
    import numpy as np

    if carry.table is None and carry.is_linear_identity:
        return values
    return np.array([carry.apply(float(value)) for value in values], np.float64)
