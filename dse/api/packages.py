"""SSP packages: opened, simulated once, and what came of it as the system's own connectors show it."""

from __future__ import annotations

from dse.api.exploring import package_alone
from dse.domain.run import Waveforms
from dse.interchange.prepared import PreparedPackage, prepare_ssp

__all__ = ["PreparedPackage", "prepare_ssp", "simulate_package"]


def simulate_package(package: PreparedPackage) -> tuple[Waveforms | None, str]:
    """The package's signals by name at its own point, or None and what was wrong."""
    waveforms, problem = package_alone(package)
    return None if waveforms is None else package.signals(waveforms), problem
